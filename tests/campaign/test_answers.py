"""Intervals of quantities, through a whole campaign, against closed forms."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from opening_panel import PANEL, exact_time, panel, run
from stored_runs import curves_in

from deployable.campaign.answers import quantity_bounds
from deployable.campaign.folder import Folder
from deployable.campaign.results.quantity_results import FittedRuns, QuantityResults
from deployable.campaign.results.ranges import ranges
from deployable.intervals.scalars import fit_scalar
from fpm.files.seals import unseal


@pytest.fixture(scope="module")
def opened(tmp_path_factory) -> Folder:
    return run(panel(), tmp_path_factory.mktemp("panel"))


def test_every_run_has_its_numbers(opened):
    with xr.open_dataset(opened.samples) as samples:
        times = samples["quantities"].sel(quantity="t_open").values
        np.testing.assert_allclose(times, exact_time(samples["parameter_k"].values), rtol=1e-6)
        assert samples["quantity_units"].values.tolist() == ["s", "s", "rad"]
        late = samples["quantities"].sel(quantity="t_late").values
        exact = exact_time(samples["parameter_k"].values, opening=0.52 * np.pi)
        np.testing.assert_allclose(late, np.where(exact < 2.0, exact, np.nan), rtol=1e-6)


def test_the_interval_of_a_time_is_the_exact_one(opened):
    with xr.open_dataset(opened.quantities) as found:
        assert found.attrs["Conventions"] == "CF-1.8"  # as all files
        one = found.sel(quantity="t_open")
        for side, k in (("lower", 0.105), ("upper", 0.095)):
            exact = exact_time(k)
            for kind in ("", "simulated_", "surrogate_"):
                assert float(one[f"{kind}{side}"]) == pytest.approx(exact, rel=1e-6)
            assert float(one[f"unconverged_{side}"]) == 0
        assert float(one["argmin"].sel(parameter="k")) == pytest.approx(0.105)
        assert float(one["argmax"].sel(parameter="k")) == pytest.approx(0.095)
        assert float(one["nominal"]) == pytest.approx(exact_time(0.1), rel=1e-6)
        assert 0 < float(one["error"]) < 1e-5
        assert float(one["happens"]) == 1


def test_the_share_of_the_box_in_which_it_happens_is_the_exact_one(opened):
    """It comes too late where sqrt(k) is below that of 2 s."""
    border = exact_time(1.0, opening=0.52 * np.pi) ** 2 / 4
    with xr.open_dataset(opened.quantities) as found:
        late = found.sel(quantity="t_late")
        assert float(late["happens"]) == pytest.approx((0.105 - border) / 0.01, abs=1e-3)
        assert 0 < int(late["runs_without"]) < found.attrs["runs"]
        assert float(late["lower"]) == pytest.approx(exact_time(0.105, opening=0.52 * np.pi))
        assert float(late["upper"]) == pytest.approx(2.0, abs=1e-3)
        assert float(late["happens_uncertainty"]) < 1e-2


def test_the_ends_are_simulated_and_found_again(tmp_path):
    """No run of the design is at a corner: further ones are made there, once."""
    raw = panel(
        held_out=0,
        intervals={"k": {"nominal": 0.1, "relative": 0.05}, "mass": {"relative": 0.02}},
        design={"method": "tensor_roots", "order": 2},
        quantities={"t_open": PANEL["quantities"]["t_open"]},
    )
    folder = run(raw, tmp_path)
    trajectories = set(folder.runs("trajectories").iterdir())
    with xr.open_dataset(folder.quantities) as found, xr.open_dataset(folder.refinement) as further:
        one = found.sel(quantity="t_open")
        lower, upper = exact_time(0.105, 0.98), exact_time(0.095, 1.02)
        assert float(one["simulated_lower"]) == pytest.approx(lower, rel=1e-6)
        assert float(one["simulated_upper"]) == pytest.approx(upper, rel=1e-6)
        np.testing.assert_allclose(
            further["value"].sel(parameter=["k", "mass"]), [[0.105, 0.98], [0.095, 1.02]]
        )
        np.testing.assert_allclose(further["quantities"].values[:, 0], [lower, upper], rtol=1e-6)
        assert curves_in(folder.runs("trajectories")).keys() >= {*further["run_id"].values}
        # t goes with sqrt(mass / k): what is left when either is known exactly, or twice as well.
        fixed = [exact_time(0.1, 1.02) - exact_time(0.1, 0.98),
                 exact_time(0.095) - exact_time(0.105)]  # fmt: skip
        np.testing.assert_allclose(one["fixed"].sel(parameter=["k", "mass"]), fixed, rtol=2e-3)
        halved = exact_time(0.0975, 1.02) - exact_time(0.1025, 0.98)
        assert float(one["halved"].sel(parameter="k")) == pytest.approx(halved, rel=2e-3)
    before = unseal(folder.quantities)
    again = run(raw, tmp_path)
    assert set(again.runs("trajectories").iterdir()) == trajectories
    with xr.open_dataset(again.quantities) as found:
        assert found.attrs["further_runs"] == 2
    assert unseal(again.quantities) == before


def test_runs_that_keep_responses_only_have_the_same_numbers(opened, tmp_path):
    folder = run(panel(jobs={"keep": "responses"}), tmp_path)
    with xr.open_dataset(folder.quantities) as ours, xr.open_dataset(opened.quantities) as theirs:
        np.testing.assert_array_equal(ours["simulated_lower"], theirs["simulated_lower"])
        # Rounded to single precision, runs lead to other further runs: equal up to convergence.
        np.testing.assert_allclose(ours["upper"], theirs["upper"], rtol=1e-4)


def test_the_summary_tells_the_intervals(opened):
    summary = json.loads((opened / "summary.json").read_text())
    rows = {row["name"]: row for row in summary["quantities"]}
    assert rows["t_open"]["argmax"]["k"] == pytest.approx(0.095)
    assert rows["t_open"]["predicted_ends"] == []
    text = (opened / "summary.md").read_text()
    assert "1.8682 to 1.9640 s" in text and "| error of the fit | ends |" in text
    assert "by 2 s, the end of the runs. In the rest, it happens after 2 s or never." in text
    assert "In the earliest run, it happens at 1.91 s" in text
    # The nominal run is a node, too, and counts once.
    made = len(curves_in(opened.runs("trajectories")))
    assert {row["runs_with"] + row["runs_without"] for row in rows.values()} == {made}
    assert "The interval of `t_late` covers the first part" in text


def test_what_vanishes_inside_the_box_is_bordered_by_further_runs(tmp_path):
    """Released at rest, it swings to twice the angle at which the spring rests, and no further."""
    level = 120.3
    folder = run(
        panel(
            scene={**PANEL["scene"], "parameters": {"elements": 2, "k": 1}},
            intervals={"rest": {"nominal": 60, "absolute": 5}},
            quantities={"t": {"crossing": "psi", "level": float(np.radians(level))},
                        "top": {"largest": "psi"}},
        ),
        tmp_path,
    )  # fmt: skip
    with xr.open_dataset(folder.quantities) as found:
        t, top = (found.sel(quantity=name) for name in ("t", "top"))
        assert float(t["happens_uncertainty"]) < 1e-4
        assert float(t["happens"]) == pytest.approx((65 - level / 2) / 10, abs=1e-4)
        assert float(top["upper"]) == pytest.approx(np.radians(130), rel=1e-3)
        # cos(t sqrt(k / J)) = 1 - level / rest, at the largest angle of rest.
        exact = np.sqrt(1 / 3 + 0.01 / 12) * np.arccos(1 - level / 65)
        assert float(t["lower"]) == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("count", [1, 2])
def test_a_quantity_is_drawn_over_its_parameters_and_no_lower_than_it_can_be(count):
    """As its interval is told: a norm whose fit swings below zero is drawn at zero there."""
    x = np.stack(np.meshgrid(*[np.linspace(-1, 1, 7)] * count), axis=-1).reshape(-1, count)
    speed = np.maximum(x[:, 0] - 0.3, 0.0)
    row = {"name": "v", "long_name": "speed", "units": "m/s", "lower": 0.0, "upper": 0.7}
    row |= {"argmin": {"a": 1.0, "b": 1.0}, "argmax": {"a": 3.0, "b": 3.0}}
    parameters = [{"name": name, "units": "m", "lower": 1.0, "upper": 3.0} for name in "ab"[:count]]
    runs = FittedRuns(x, speed[:, None], np.full((len(x), 1), np.nan))
    results = QuantityResults([row], parameters, 0, 0, None)
    ax, *_ = ranges(results, runs, [fit_scalar(x, speed, limits=(0.0, np.inf))]).axes
    values = ax.lines[0].get_ydata() if count == 1 else ax.collections[0].get_array()
    assert 0.0 <= values.min() < 0.1 and values.max() == pytest.approx(0.7, abs=0.1)
    assert (ax.get_xlabel(), "b (m)" in ax.get_ylabel()) == ("a (m)", count == 2)


@pytest.fixture
def bench(monkeypatch):
    """A bench of no quantity but one that is never rough, whose searches ask for what they get."""

    class Bench:
        failures, points = (), np.zeros((1, 1))
        experiment = SimpleNamespace(quantity_list=[None])

        def surrogates(self):
            return [None]

        def add(self, points):
            self.points = np.vstack([self.points, np.reshape(points, (-1, 1))])

    for name, value in {
        "_infill": lambda ends: [np.array([0.0])] * len(ends),
        "_spread": lambda *_: [np.zeros(1)],
        "_mispredictions": lambda bench, bounds, known: known,
        "_turning_points": lambda bench: [],
        "_is_rough": lambda surrogate: False,
        "_follow_ends": lambda climbs, bounds, mispredictions: bounds,
    }.items():
        monkeypatch.setattr(quantity_bounds, name, value)
    monkeypatch.setattr(quantity_bounds._Climbs, "run", lambda climbs: None)
    return Bench()


@pytest.mark.parametrize(
    ("fall", "most", "count"), [(0.5, 1000, 7), (1.0, 1000, 2), (0.95, 1000, 2), (0.5, 5, 5)]
)
def test_searches_for_an_accuracy_go_on_while_errors_fall(fall, most, count, bench, monkeypatch):
    """From 1.0, to at most 0.01, in iterations that double the runs and let the error fall by a
    factor; beyond the iterations that it is given. An error that does not fall is given up once
    there are twice the runs; so is the search where no more may be made."""
    made = []

    def add(points):
        if len(points) and len(made) < most:
            made.append(points)
            bench.points = np.zeros((2 * len(bench.points), 1))

    bench.add = add
    monkeypatch.setattr(
        quantity_bounds, "_bounds", lambda *_: SimpleNamespace(relative_error=fall ** len(made))
    )
    quantity_bounds.converge_bounds(bench, 2, tolerances=[0.01])
    assert len(made) == count


@pytest.mark.parametrize("rounds", [0, 1, 3])
def test_ends_take_no_more_rounds_than_they_may(rounds, bench, monkeypatch):
    """Where every round asks for another one."""
    monkeypatch.setattr(quantity_bounds, "_bounds", lambda *_: len(bench.points))
    bench.points = np.zeros((0, 1))
    assert quantity_bounds.converge_bounds(bench, rounds) == [rounds]
    assert len(bench.points) == rounds
