"""The shipped campaigns keep the bounds that they had before the program was rearranged.

values.json holds lower and upper bounds at twelve instants of each campaign (of `scan`, with 64
samples). Processors without fused multiply-adds differ from those with them by up to 1.5e-10 of
the largest value, measured on the paper's and the small campaign; 1e-8 of it is allowed.
"""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray

from deployable import campaign
from deployable.campaign.cli import main
from deployable.campaign.config.loader import load

HERE = Path(__file__).parent
GOLDEN = json.loads((HERE / "values.json").read_text(encoding="utf-8"))
CONFIGS = HERE.parents[1] / "config"


LARGE = ("three", "six")


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n in LARGE else n for n in GOLDEN]
)
def test_bounds_are_those_of_before(name, tmp_path):
    if name == "scan64":
        config = load(CONFIGS / "scan.yaml")
        config["design"]["samples"] = 64
        bounds = campaign.run(config, tmp_path, figures=False, tell=lambda text: None)
    else:  # as the README says
        path, results = str(CONFIGS / f"{name}.yaml"), str(tmp_path)
        assert main(["run", path, "--results", results, "--no-figures"]) == 0
        with xarray.open_dataset(tmp_path / name / "bounds.nc") as file:
            bounds = file.load()
    golden = GOLDEN[name]
    assert set(bounds["response"].values.tolist()) == set(golden["responses"])
    for response, sides in golden["responses"].items():
        for side, expected in sides.items():
            found = bounds[side].sel(response=response).values
            scale = np.abs(found).max()
            np.testing.assert_allclose(
                found[golden["instants"]], expected, rtol=0, atol=1e-8 * scale
            )
