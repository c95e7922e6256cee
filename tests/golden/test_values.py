"""The shipped campaigns keep the bounds that they had before the program was rearranged.

values.json holds lower and upper bounds at twelve instants of each campaign (of `scan`, with 64
samples). Processors without fused multiply-adds differ from those with them by up to 1.5e-10 of
the largest value, measured on the paper's and the small campaign; 1e-8 of it is allowed.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray

from deployable import campaign
from deployable.campaign.config.loader import read_file

HERE = Path(__file__).parent
GOLDEN = json.loads((HERE / "values.json").read_text(encoding="utf-8"))
CONFIGS = HERE.parents[1] / "config"


LARGE = ("three", "scan64")
OTHER_PROCESSORS = {
    "other linear algebra": ("six", {"OPENBLAS_CORETYPE": "Nehalem"}),
    "no fused multiply-add": ("paper", {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}),
}
"""What a processor has or lacks, by a campaign that it concerns most: of six parameters, whose
fits are the largest, and of runs, which are alike in all."""


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.slow) if n in LARGE else n for n in GOLDEN if n != "six"],
)
def test_bounds_are_those_of_before(name, shipped, tmp_path):
    """Those of six parameters with the linear algebra of another processor, below."""
    if name == "scan64":
        config = read_file(CONFIGS / "scan.yaml").data
        config["design"]["samples"] = 64
        bounds = campaign.run(config, tmp_path, figures=False, notify=lambda text: None)
    else:  # as the README says
        bounds = bounds_of(shipped(name)[0])
    compare(bounds, GOLDEN[name])


@pytest.mark.slow
@pytest.mark.parametrize("processor", OTHER_PROCESSORS)
def test_another_processor_has_the_same_bounds(processor, tmp_path):
    name, changes = OTHER_PROCESSORS[processor]
    environment = {**os.environ, **changes}
    if "NUMBA_CPU_NAME" in environment:
        environment["NUMBA_CACHE_DIR"] = str(tmp_path)
    command = [sys.executable, "-m", "deployable", "run", str(CONFIGS / f"{name}.yaml")]
    command += ["--results", str(tmp_path), "--no-figures"]
    subprocess.run(command, env=environment, check=True, timeout=400, cwd=CONFIGS.parent)
    compare(bounds_of(tmp_path / name), GOLDEN[name])


def bounds_of(folder: Path) -> xarray.Dataset:
    with xarray.open_dataset(folder / "bounds.nc") as file:
        return file.load()


def compare(bounds: xarray.Dataset, golden: dict) -> None:
    assert set(bounds["response"].values.tolist()) == set(golden["responses"])
    for response, sides in golden["responses"].items():
        for side, expected in sides.items():
            values = bounds[side].sel(response=response).values
            scale = np.abs(values).max()
            np.testing.assert_allclose(
                values[golden["instants"]], expected, rtol=0, atol=1e-8 * scale
            )
