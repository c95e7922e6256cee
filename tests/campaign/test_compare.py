"""Results side by side: numbers of both, as text, JSON and a page."""

import json
import shutil

import numpy as np
import pytest
import xarray
from opening_panel import exact_time, panel, run

from deployable.campaign.cli import main
from deployable.campaign.files import read_json, write_result
from deployable.campaign.folder import Folder
from deployable.campaign.results.compare import _curve, _state
from deployable.campaign.results.response_bounds import ResponseBounds
from fpm.files.seals import check


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Results of a panel with a weak and with a strong spring, of other designs and instants."""
    results, early = tmp_path_factory.mktemp("pair"), {"early": {"t_open": {"at_most": 1.9}}}
    strong = {"k": {"nominal": 0.2, "relative": 0.05}}
    raws = [panel(campaign="weak", requirements=early),
            panel(campaign="strong", intervals=strong, requirements=early)]  # fmt: skip
    raws[1]["design"]["order"], raws[1]["solver"]["instants"] = 4, 801
    raws[1]["responses"]["1"] = {"opening_rate": "hinge"}
    for raw, level in zip(raws, (9.0, 0.1), strict=True):  # one name, two limits
        raw["requirements"] = early | {"far": {"wide": {"at_least": level}}}
    raws[1]["verify"] = {"max_iterations": 5}
    raws[0]["display"] = {"angle": "deg"}
    return [str(run(raw, results).path) for raw in raws]


@pytest.mark.slow
def test_requirements_quantities_and_curves_stand_side_by_side(pair, capsys, tmp_path):
    assert main(["compare", *pair, "--json", "--html", str(tmp_path / "page.html")]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert [case["name"] for case in facts["cases"]] == ["weak", "strong"]
    assert [case["changes"] for case in facts["cases"]] == [
        "k 0.1 N m/rad, ± 5 %; solver.instants 401; design.order 3; verify.max_iterations 6; "
        "requirements.far final opening of the `hinge` is at least 9 rad; no responses.1",
        "k 0.2 N m/rad, ± 5 %; solver.instants 801; design.order 4; verify.max_iterations 5; "
        "requirements.far final opening of the `hinge` is at least 0.1 rad; "
        "responses.1 opening_rate: hinge"]  # fmt: skip
    (t_open,) = [row for row in facts["quantities"] if row["name"] == "t_open"]
    for row, k in zip(t_open["by_case"], (0.1, 0.2), strict=True):
        expected = [exact_time(1.05 * k), exact_time(0.95 * k)]
        np.testing.assert_allclose([row["lower"], row["upper"]], expected, rtol=2e-3)
    early, far = facts["requirements"]
    met = [row["met"] for row in early["limits"][0]["by_case"]]
    expected = [exact_time(0.95 * k) <= 1.9 for k in (0.1, 0.2)]
    assert [m == "all" for m in met] == expected
    assert [(x["level"], x["met"], x["cases"]) for x in far["limits"]] == [
        (9.0, "none", ["weak"]), (0.1, "all", ["strong"])]  # fmt: skip
    curve, only = facts["curves"]
    assert only["name"] == "1" and [bool(row) for row in only["by_case"]] == [False, True]
    files = [xarray.load_dataset(f"{folder}/bounds.nc") for folder in pair]
    bounds = [file.sel(response="psi") for file in files]
    for end in ("lower", "upper"):
        change = np.abs(bounds[1][end].values[::2] - bounds[0][end].values).max()
        assert curve["by_case"][1][f"{end}_change"] == pytest.approx(change)
        assert f"{end}_change" not in curve["by_case"][0]
    for row, data in zip(curve["by_case"], bounds, strict=True):
        assert row["width"] == pytest.approx(float((data["upper"] - data["lower"]).max()))
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64") == 2 and "http" not in page.split("</style>")[1]
    assert main(["compare", *pair]) == 0
    text = capsys.readouterr().out
    assert text.startswith("# Comparison of weak, strong\n") and "## Curves by case" in text
    assert "- `1`: " in text and "\n  - weak: –\n" in text and "\\`" not in text
    assert "No: 1 of 2 cases (“weak”) does not meet all requirements." in text
    assert f"{np.degrees(curve['by_case'][1]['width']):.3g} deg apart" in text
    assert " rad" not in text.replace("N m/rad", "") and main(["compare", *pair[::-1]]) == 0
    assert " deg" not in capsys.readouterr().out  # the first has no units of its own


@pytest.mark.parametrize(("duration", "instants"), [(0.5, 9), (0.4 / np.sqrt(2), None)])
def test_curves_are_compared_where_both_have_values(duration, instants):
    """Curves that are parabolas: their straight lines are off by a quarter of a squared step."""
    rows = {}
    for label, end, offset in (("first", 0.4, 0.0), ("other", duration, 0.3)):
        time = np.linspace(0, end, 41)
        rows[label] = ResponseBounds("x", "x of P", "m", time, time**2 + offset, time**2 + 1)
    row = _curve(rows, [*rows])["by_case"][1]
    error = 0.0 if instants else (duration / 40) ** 2 / 4
    assert (row.get("instants"), row.get("interpolation_error", 0.0)) == (
        instants,
        pytest.approx(error),
    )
    for end, change in (("lower_change", 0.3), ("upper_change", 0.0)):
        assert change - 1e-12 <= row[end] <= change + error + 1e-12


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (["a"], "a: nothing to compare; allowed: two different folders or more"),
        (["a", "./a"], "a: the same folder is given twice; allowed: two different folders"),
        (["a", "b"], "a is not the path of a folder; allowed: a folder of finished results"),
        (["empty", "a"], "empty has no summary.json; allowed: a folder of finished results"),
        (["begun", "a"], "begun has no bounds.nc; allowed: a folder of finished results"),
    ],
)
def test_what_cannot_be_compared_is_refused(names, words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder, files in {"empty": [], "begun": ["summary.json", "plan.json"]}.items():
        (tmp_path / folder).mkdir()
        for name in files:
            (tmp_path / folder / name).touch()
    assert main(["compare", *names]) == 1
    assert words in capsys.readouterr().err


def test_own_runs_that_changed_are_said_by_the_name_of_their_file(tmp_path, monkeypatch):
    facts = {"scene": "panel", "duration": 1.0, "fixed": [], "parameters": [], "bounds": "b"}
    plan = {"config": {"design": {"file": "doe.csv", "digest": "d9c1"}}, "mechanics": "m"}
    monkeypatch.setattr("deployable.campaign.results.compare.read_json", lambda path: plan)
    state = _state(facts, Folder(tmp_path))
    assert state["design.file"] == "doe.csv" and state["checksum of doe.csv"] == "d9c1"
    assert "design.digest" not in state


@pytest.mark.slow
def test_results_of_another_program_that_lack_data_are_to_be_made_again(
    pair, tmp_path, capsys, monkeypatch
):
    folder = shutil.copytree(pair[0], tmp_path / "old")
    (path, facts) = (folder / "summary.json", read_json(folder / "summary.json"))
    del facts["quantities"]
    write_result(path, json.dumps(facts, indent=1), plan=check(path)["plan"])
    commands = ["compare", pair[1], str(folder)], ["page", str(folder), "--config", "{}"]
    with pytest.raises(KeyError):  # of this program it is a fault of its own
        main(commands[0])
    monkeypatch.setattr("deployable.campaign.plan.plan.program_digest", lambda: "another")
    for command in commands:
        assert main(command) == 1
        text = f"{folder}: made by another version of this program ('quantities' is missing): run"
        assert f"{text} the campaign again\n" in capsys.readouterr().err
