"""A campaign whose jobs share no folder: each gets the files that its rule declares, no others."""

from __future__ import annotations

import importlib.util

import pytest
import xarray as xr

from deployable import campaign

PLUGIN = "snakemake_storage_plugin_fs"
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not importlib.util.find_spec(PLUGIN), reason=f"{PLUGIN} not installed"),
]

CONFIG = """\
campaign: far
scene: {name: bennett, parameters: {elements: 2}}
solver: {duration: 0.02, instants: 41}
intervals:
  E: {nominal: 1e9, relative: 0.01}
design: {order: 3}
responses:
  BD: {distance: [B, D]}
jobs: {runs_per_job: 3}
"""


def test_campaign_runs_through_a_storage(workplace, tmp_path):
    config, far = workplace.config("far", CONFIG), tmp_path / "far"
    how = (
        "--configfile", config, "--default-storage-provider", "fs",
        "--default-storage-prefix", str(far),
        "--shared-fs-usage", "persistence", "software-deployment", "sources", "source-cache",
    )  # fmt: skip
    done = workplace.snakemake(*how)
    assert done.returncode == 0, done.stdout
    # Nothing was left for other jobs but what is in the storage.
    assert not [path for path in (workplace.folder / "results").rglob("*") if path.is_file()]
    kept = far / "results" / "far"
    assert {path.name for path in (kept / "batches").glob("*.tar")} == {
        f"{n}.tar" for n in range(3)
    }
    assert (kept / "report.html").stat().st_size > 1e5

    alone = campaign.run(config, tmp_path / "alone", figures=False)
    with xr.open_dataset(kept / "bounds.nc") as bounds:
        assert alone.equals(bounds.load())

    again = workplace.snakemake(*how)
    assert "Nothing to be done" in again.stdout, again.stdout
