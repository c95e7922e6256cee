"""Runs of a user's own: from a file or a list, what is refused, and the bounds that they give."""

import json

import numpy as np
import pytest

from deployable import campaign
from deployable.campaign.config.check import check_config, load_config
from deployable.campaign.config.own_runs import OwnRunsError
from deployable.campaign.errors import ConfigError
from deployable.campaign.plan.plan import TimeStep, make_plan
from deployable.campaign.report.page import render
from deployable.campaign.report.read import from_results

DISC = """
parameters:
  k: {value: 0.05, unit: N m/rad, range: [0.001, 1]}
  c: {value: 1e-4, unit: N m s/rad, range: [0, 0.1]}
points: {o: [0, 0, 0]}
bodies: {disc: {mass: 0.5, centre: o, inertia: [0.001, 0.001, 0.001]}}
joints: {wire: {type: revolute, parts: [ground, disc], at: o, axis: z, opening: 30 deg}}
actions:
  spring: {type: torsion spring, joint: wire, stiffness: k}
  air: {type: damper, joint: wire, damping: c}
"""
ROWS = "k,c\n0.045,0\n0.055,0\n0.045,4e-4\n0.055,4e-4\n0.05,1e-4\n0.0475,3e-4\n"


@pytest.fixture
def config(tmp_path):
    """A config of the disc, with runs in `doe.csv`."""
    (tmp_path / "disc.yaml").write_text(DISC)
    (tmp_path / "doe.csv").write_text(ROWS)
    intervals = {"k": {"lower": 0.045, "upper": 0.055}, "c": {"lower": 0, "upper": 4e-4}}
    return {
        "campaign": "own", "scene": {"file": str(tmp_path / "disc.yaml")},
        "solver": {"duration": 0.2, "instants": 101}, "intervals": intervals,
        "design": {"file": str(tmp_path / "doe.csv")}, "responses": {"phi": {"opening": "wire"}},
    }  # fmt: skip


def test_a_parameter_that_no_run_varies_leaves_all_open(config, tmp_path):
    (tmp_path / "doe.csv").write_text("k\n0.045\n0.05\n0.055\n")
    config |= {"quantities": {"peak": {"largest": "phi"}}}
    config["requirements"] = {"low": {"peak": {"at_most": "45 deg"}}}
    campaign.run(config, tmp_path, figures=False, notify=lambda text: None)
    facts = json.loads((tmp_path / "own/summary.json").read_text())
    assert facts["unvaried"] == ["c"] and facts["together"]["met"] == "undecided"
    assert facts["together"]["share_uncertainty"] == 1
    said = "No run varies `c`, so no bound and no answer includes its influence."
    assert said in (tmp_path / "own/summary.md").read_text()
    (warning,) = check_config(config).experiment.warnings
    assert warning == f"design: {said} Add such runs."
    page = render(from_results(tmp_path / "own"))
    assert said.replace("`c`", "<code>c</code>") in page


def planned(config):
    """Values of k and c in the runs, the nominal one first."""
    time = TimeStep(1e-3, 2, 1e-2, "none")
    return make_plan(check_config(config).experiment, time).runs.values


@pytest.mark.parametrize(
    "text",
    [
        ROWS,
        ROWS.replace(",", ";").replace(".", ","),
        "run;c;k [N mm/rad];note\n1;0;45;a\n2;0;55;\n3;4e-4;45;\n"
        "4;4e-4;55;\n5;1e-4;50;\n6;3e-4;47,5;\n",
        "note;k [N mm/rad];c\n;45;0\n;55;0\n#WERT!;45;4e-4\n#N/A;55;4e-4\n"
        ";50;1e-4\n####;47,5;3e-4\n",
        "k / N mm/rad;c;;\n45;0;;\n55;0\n45;4e-4;;\n55;4e-4\n50;1e-4\n47,5;3e-4\n;;;\n",
    ],
    ids=["plain", "decimal commas", "units and other columns", "errors of a sheet", "of a sheet"],
)
def test_rows_are_the_runs(config, tmp_path, text):
    (tmp_path / "doe.csv").write_text(text)
    expected = [[0.05, 2e-4], *np.loadtxt(ROWS.splitlines()[1:], delimiter=",")]
    np.testing.assert_allclose(planned(config), expected, rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize(
    ("rows", "design", "words"),
    [
        ("k,c\n0.05,0\n0.06,0\n", {}, "doe.csv, line 3: k = 0.06 is outside its interval; allowed: "
         "0.045 to 0.055"),
        ("k\n0.05\n", {}, "design.file: no run differs from the nominal one; allowed: at least"),
        ("k ± 1,c\n0.05,0\n", {}, "there is no interval k ± 1 (did you mean k?), and no column k;"),
        ("k,cc\n0.05,0\n", {}, "there is no interval cc (did you mean c?), and no column c;"),
        ("k [m],c\n0.05,0\n", {}, "line 1: the unit of k does not fit; allowed: N m rad-1"),
        ("run,k [N mm/rad],note\n1,45,0\n2,47,5\n", {}, "line 2: '45,0' could be 45.0 or two num"),
        ("run,note\n1,a\n", {}, "line 1: no column of a parameter; allowed: k, c"),
        ("k,c\n0.05,0\n0.051,1e-4\n", {}, "design: 3 runs with the nominal one do not "),
        (ROWS, {"order": 3}, "design.order: not allowed beside design.file; allowed: one of"),
        (ROWS, {"values": [1]}, "design.values: not allowed beside design.file; allowed: one of"),
        (ROWS, {"file": "absent.csv"}, "design.file: absent.csv: No such file or directory"),
        (ROWS, {"file": None}, "design.file: null is not allowed; allowed: the path of a CSV file"),
    ],
)  # fmt: skip
def test_runs_that_cannot_be_made_are_refused(config, tmp_path, rows, design, words):
    (tmp_path / "doe.csv").write_text(rows)
    config["design"] |= design
    with pytest.raises(ConfigError) as error:
        check_config(config)
    assert words in str(error.value)


def test_other_keys_that_do_not_go_with_own_runs_are_refused(config):
    with pytest.raises(ConfigError, match=r"held_out: not allowed beside design.file"):
        check_config({**config, "held_out": 2})
    with pytest.raises(
        ConfigError, match=r"bounds.model: 'polynomial' is not allowed with runs of"
    ):
        check_config({**config, "bounds": {"model": "polynomial"}})
    with pytest.raises(
        ConfigError, match=r"design.values: they are of one parameter, and the inte"
    ):
        check_config({**config, "design": {"values": [0.05]}})


def test_runs_that_leave_an_end_out_are_warned_of(config, tmp_path):
    def texts():
        return [t for t in check_config(config).experiment.warnings if "extrapolated" in t]

    assert not texts()
    (tmp_path / "doe.csv").write_text(ROWS.replace("0.045", "0.0475").replace("0.0475,3", "0.05,3"))
    (text,) = texts()
    assert "k from 0.0475 to 0.055" in text


def test_a_file_is_sought_beside_the_config_and_its_content_counts(config, tmp_path):
    (tmp_path / "c.yaml").write_text(json.dumps({**config, "design": {"file": "doe.csv"}}))
    first = load_config([tmp_path / "c.yaml"]).experiment
    (tmp_path / "doe.csv").write_text(ROWS.replace("0.0475", "0.0476"))
    second = load_config([tmp_path / "c.yaml"]).experiment
    assert first.design.digest != second.design.digest
    with pytest.raises(OwnRunsError, match="it changed since it was checked"):
        make_plan(first, TimeStep(1e-3, 2, 1e-2, "none"))


@pytest.mark.slow
def test_bounds_of_own_runs_are_those_of_the_closed_form(config, tmp_path):
    campaign.run({**config, "quantities": {"last": {"final": "phi"}}}, tmp_path, figures=False,
                 notify=lambda text: None)  # fmt: skip
    (tmp_path / "doe.csv").unlink()  # results stand on their own
    facts = json.loads((tmp_path / "own/summary.json").read_text(encoding="utf-8"))

    def final(k, c, inertia=1e-3, time=0.2):
        decay = c / inertia / 2
        rate = np.sqrt(k / inertia - decay**2)
        return (
            np.pi
            / 6
            * np.exp(-decay * time)
            * (np.cos(rate * time) + decay / rate * np.sin(rate * time))
        )

    (last,) = facts["quantities"]
    found = [last["lower"], last["upper"]]
    np.testing.assert_allclose(found, [final(0.055, 0), final(0.045, 4e-4)], rtol=5e-4)
    assert facts["design"]["method"] == "own" and facts["runs"]["design"] == 7
