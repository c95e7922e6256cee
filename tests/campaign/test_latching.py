"""A panel with a latch: when it catches, over the interval of its spring."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr
from opening_panel import ROOT, exact_time, panel, run


def latched(folder: Path) -> dict:
    """The campaign of a panel with a latch at a right angle."""
    text = (ROOT / "config/structures/panel.yaml").read_text()
    latch = "  pin: {type: latch, joint: hinge, angle: 90 deg, stiffness: 1, damping: 0.05}"
    path = folder / "latched.yaml"
    path.write_text(text.replace("record:", f"{latch}\n\nrecord:"))
    scene = {"file": str(path), "parameters": {"elements": 2}}
    quantities = {"t_latch": {"event": "latches"}, "t_miss": {"event": "misses", "of": "pin"}}
    return panel(scene=scene, quantities=quantities, solver={"duration": 2.2, "instants": 441})


@pytest.mark.slow
def test_the_interval_of_the_time_of_latching_is_the_exact_one(tmp_path):
    folder = run(latched(tmp_path), tmp_path)
    with xr.open_dataset(folder.quantities) as found:
        one = found.sel(quantity="t_latch")
        assert float(one["lower"]) == pytest.approx(exact_time(0.105), rel=1e-6)
        assert float(one["upper"]) == pytest.approx(exact_time(0.095), rel=1e-6)
        assert float(one["happens"]) == 1
        assert float(found.sel(quantity="t_miss")["happens"]) == 0
