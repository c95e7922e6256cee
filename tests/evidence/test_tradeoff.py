"""The study "error against cost" on a small scene, its rows and its files."""

import copy
import json
import sys
from dataclasses import replace

import numpy as np
import pytest

from evidence.results import write
from evidence.tradeoff import rows, study
from evidence.tradeoff.figures import pareto
from evidence.tradeoff.measure import peers, reference
from evidence.tradeoff.measure.bounds import Band, distance, hull, judge_estimate, phases_of
from evidence.tradeoff.measure.cases import CASES, Case, Choice, Level
from evidence.tradeoff.measure.points import design_of, held_out_of, points_of
from evidence.tradeoff.measure.records import measure_case
from evidence.tradeoff.measure.runs import _impacts, simulate

CHOICES = (
    Choice("tensor_lobatto", 2),
    Choice("tensor_lobatto", 8),
    Choice("sobol", samples=8),
    Choice("tensor_lobatto", 2, model="spline"),
    Choice("sobol", samples=8, model="spline"),
)
SMALL = Case(
    "small",
    "Pendulum, L ± 10 %",
    scene="pendulum",
    mesh="elements",
    responses={"x": {"position": "T", "component": "x"}},
    intervals={"L": 0.1},
    fixed={"E": 1e10},
    duration=2.0,
    instants=201,
    held_out=4,
    levels=(Level(2, 0.9, 24, CHOICES), Level(4, 0.9, 24, CHOICES)),
    trajectories=((2, 0.9), (8, 0.9), (16, 0.9)),
)


@pytest.fixture(scope="module")
def measured() -> dict:
    """The small case, measured once, as it comes back from its file."""
    return json.loads(json.dumps(measure_case(SMALL, lambda text: None), allow_nan=False))


@pytest.mark.slow
def test_a_higher_order_is_less_wrong_and_costs_more(measured):
    low, high = (rows.pick(measured, 4, f"tensor_lobatto {n}") for n in (2, 8))
    assert rows.worst(high, "surrogate") < 0.2 * rows.worst(low, "surrogate")
    assert high["cpu_batch"] * 2 <= high["cpu"]
    assert (low["runs"], high["runs"], high["held_out"]) == (3, 9, 4)


def test_the_finest_level_has_no_error_but_the_surrogates(measured):
    coarse, fine = (rows.pick(measured, n, "tensor_lobatto 8") for n in (2, 4))
    assert fine["total"] == fine["surrogate"]
    assert rows.worst(coarse, "total") > 2 * rows.worst(coarse, "surrogate")


def test_single_runs_come_closer_on_finer_meshes(measured):
    errors = [row["rms"][0]["all"] for row in measured["trajectories"]]
    assert errors[0] > errors[1] > errors[2] == 0


def test_the_reference_contains_the_runs_of_all_designs(measured):
    for record in measured["records"]:
        if record["choice"] == "scan 8":
            # a scan looks from the inside: it is nowhere wider than the hull of all runs
            assert record["surrogate"][0]["all"]["width_ratio"] <= 1
            assert record["scan"][0]["coverage"] < 1


def test_a_spline_counts_the_held_out_runs_that_it_goes_through(measured):
    plain, spline = (rows.pick(measured, 4, f"tensor_lobatto 2{more}") for more in ("", ", spline"))
    assert (plain["runs"], plain["held_out"]) == (3, 4)
    assert (spline["runs"], spline["held_out"]) == (7, 0)
    assert rows.worst(spline, "surrogate") < rows.worst(plain, "surrogate")
    names = [row.name for row in rows.all_rows({"small": measured}, None)]
    kinds = [name.rsplit(" ", 1)[1] for name in names if "covers the error" in name]
    assert kinds == ["surrogates", "splines", "scans"]


@pytest.mark.slow
def test_rounds_widen_the_reference_more_than_a_longer_scan(monkeypatch):
    monkeypatch.setattr(reference, "SEEK", 12)
    case = replace(SMALL, intervals={"L": 0.1, "g": 0.1})
    level = Level(2, 0.9, 24, (), rounds=3)
    runs, many = (
        simulate(case, 2, 0.9, points_of(case, (), samples)) for samples in (level.scan, 300)
    )
    phases = phases_of(runs)
    last, rounds = reference.seek_runs(level, runs)
    assert len(rounds) == 4
    assert len(last.points) == len(last.values) == len(last.events) <= 60
    assert len(np.unique(np.round(last.points, 12), axis=0)) == len(last.points)
    both = hull(last.with_runs(many))

    def short(found):
        return distance(runs.time, hull(found), both, phases)[0]["all"]["hausdorff_integrated"]

    longer = simulate(case, 2, 0.9, points_of(case, (), len(last.points)))
    assert short(last) < 0.2 * short(longer)
    told = reference.missing(case, level, rounds, phases)[0]["all"]
    # with three rounds the rest is told to a power of ten, and not as nothing
    assert told["hausdorff_integrated"] > 0.1 * short(last)


def test_the_rest_of_a_geometric_growth():
    found = reference._rest({"hausdorff_integrated": 0.4}, {"hausdorff_integrated": 0.3})
    assert found["hausdorff_integrated"] == pytest.approx(0.9)
    found = reference._rest({"hausdorff_integrated": 0.1}, {"hausdorff_integrated": 0.2})
    assert found["hausdorff_integrated"] == pytest.approx(0.2 * 0.95 / 0.05)


def test_a_broken_result_is_a_failing_row(measured):
    told = rows.all_rows({"small": measured}, None)
    estimate = next(r for r in told if "covers the error, surrogates" in r.name)
    assert estimate.passed
    broken = copy.deepcopy(measured)
    for record in broken["records"]:
        for row in record["estimate"]:
            row["all"]["covered"] = 0.5
    told = rows.all_rows({"small": broken}, None)
    assert not next(r for r in told if "covers the error, surrogates" in r.name).passed


@pytest.mark.slow
def test_the_report_has_its_files(measured, tmp_path):
    write(tmp_path, "tradeoff", study.report({"small": measured}))
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["rows"] and {row["group"] for row in summary["rows"]} == {"small"}
    assert "tensor_lobatto 8" in (tmp_path / "table.md").read_text(encoding="utf-8")
    assert (tmp_path / "pareto_small.png").stat().st_size > 10_000


def test_the_front_keeps_what_nothing_beats():
    points = [(1, 5), (2, 3), (2, 4), (3, 3), (4, 1)]
    assert pareto(points) == [(1, 5), (2, 3), (4, 1)]


def test_distance_and_estimate_of_a_known_band():
    time = np.linspace(0, 1, 11)
    reference = Band(np.zeros((1, 11)), np.ones((1, 11)), np.zeros((1, 11)))
    half = np.where(time < 0.5, 0.1, 0.3)[None]
    band = Band(reference.lower - 0.2, reference.upper, half)
    phases = {"all": np.ones(11, dtype=bool), "late": time >= 0.5}
    found = distance(time, band, reference, phases)[0]
    assert found["all"]["hausdorff_integrated"] == pytest.approx(0.2)
    assert found["late"]["width_ratio"] == pytest.approx(1.2)
    estimate = judge_estimate(time, band, reference, phases)[0]
    assert estimate["all"]["covered"] == pytest.approx(6 / 11)
    assert estimate["all"]["worst"] == pytest.approx(0.1)
    assert estimate["late"]["covered"] == 1
    assert estimate["late"]["ratio"] == pytest.approx(1.5)


def test_phases_end_at_the_first_closure_of_any_run():
    class Runs:
        time = np.linspace(0, 1, 11)
        closures = ([0.42, 0.9], [0.35, 0.81], [0.5])

    phases = phases_of(Runs)
    assert Runs.time[phases["before"]].max() == pytest.approx(0.3)
    assert Runs.time[phases["between"]][[0, -1]] == pytest.approx([0.4, 0.8])
    assert Runs.time[phases["after"]].min() == pytest.approx(0.9)


def test_chatter_of_several_contacts_is_one_closure():
    times, contact = [0.5, 0.5, 0.51, 0.512, 0.513, 0.52, 0.9], [0, 1, 0, 1, 0, 0, 1]
    events = np.array([times, contact, [1, 1, 0, 0, 1, 0, 1]]).T
    assert _impacts(events, gap=0.02).tolist() == [0.5, 0.9]
    assert _impacts(events, gap=0.0005).tolist() == [0.5, 0.513, 0.9]
    long = np.array([[0.1, 0, 1], [0.5, 0, 0], [0.6, 0, 1]])
    assert _impacts(long, gap=0.2).tolist() == [0.1]


@pytest.mark.slow
def test_every_choice_has_its_points_among_those_of_its_level():
    for case in CASES:
        for level in case.levels:
            points = {tuple(p) for p in np.round(points_of(case, level.choices, 0), 9) + 0.0}
            for choice in level.choices:
                design = design_of(case, choice)
                wanted = np.concatenate([design.points, held_out_of(case, choice, design)])
                assert {tuple(p) for p in np.round(wanted, 9) + 0.0} <= points


def test_a_peer_that_is_not_there_is_skipped_with_its_command(monkeypatch):
    monkeypatch.setenv("PEER_PUN", "/nowhere/python")
    assert "could not be run" in peers.run_peer("pyuncertainnumber", {})["skipped"]
    monkeypatch.delenv("PEER_PUN")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    skipped = peers.run_peer("pyuncertainnumber", {})["skipped"]
    assert "pip install PyUncertainNumber" in skipped
    (row,) = rows.all_rows({}, {"fits": [], "bounds": [{"by": "x", "skipped": skipped}]})
    assert row.value is None and row.passed is None and row.skipped == skipped


def test_a_peer_that_fails_says_so(monkeypatch):
    monkeypatch.setenv("PEER_CHAOSPY", sys.executable)
    monkeypatch.setenv("PYTHONPATH", "")
    found = peers.run_peer("chaospy", {"points": np.zeros((2, 1))})
    assert "failed" in found["skipped"]
