"""The page tells what was asked of quantities before anything else."""

import copy
import re
from dataclasses import replace

import numpy as np
import pytest
import xarray
from opening import CONFIG

from deployable import campaign
from deployable.campaign.report import from_results, make_motions
from deployable.campaign.report.data import REFINEMENT, RunVerdicts
from deployable.campaign.report.failing_region import meets, panels
from deployable.campaign.report.page import render
from deployable.campaign.results.templates import sentence, summary_text


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The results of a panel with requirements that part of the box meets, and a choice."""
    results = tmp_path_factory.mktemp("results")
    campaign.run(copy.deepcopy(CONFIG), results, figures=False, notify=lambda text: None)
    return results / CONFIG["campaign"]


@pytest.fixture(scope="module")
def opened(folder):
    """The page's data of it."""
    return from_results(folder)


def test_the_headline_is_the_answer(opened):
    text = sentence("headline", opened.facts)
    assert re.fullmatch(
        r"Not always: all requirements are met in 6\d\.\d+ % of the tolerated combinations "
        r"\(by volume, no probability\)\.",
        text,
    )
    assert "is 1.8682 to 1.9640 s." in sentence("ranges", opened.facts)


def test_the_runs_that_are_told_add_up_to_those_that_were_made(folder, opened):
    parts = r"(\d+) (?:runs|of the design|further ones|for the best choice)"
    total, *parts = map(int, re.findall(parts, sentence("given", opened.facts)))
    assert len(parts) == 3
    assert total == sum(parts) == len(list((folder / "trajectories").glob("*.nc")))
    assert opened.work[0]["task"] == (
        f"Integrating {parts[0]} runs, {parts[1] + parts[2]} for quantities and choice not counted"
    )


@pytest.mark.parametrize(
    ("changes", "start"),
    [
        ({"met": "all"}, "None: all requirements are met"),
        ({"met": "undecided"}, "None because of the requirements"),
        ({"max_interval_scale": 0.0}, "None yet: the nominal values fail already, by in_time ("),
    ],
)
def test_no_tolerance_is_to_be_paid_for_where_that_changes_nothing(opened, changes, start):
    facts = opened.facts
    both = [*facts["parameters"], {**facts["parameters"][0], "name": "other"}]
    facts = facts | {"together": facts["together"] | changes, "parameters": both}
    assert sentence("tolerance", facts).startswith(start)
    failures = len(np.unique(opened.verdicts.values[~opened.verdicts.met], axis=0))
    assert f"In {failures} of {facts['together']['runs']} runs some" in sentence("required", facts)


def test_the_headline_tells_how_many_quantities_it_leaves_out(opened):
    (row,) = (row for row in opened.facts["quantities"] if row["name"] == "t_open")
    assert sentence("ranges", {"quantities": [row] * 4}).endswith(" 2 more below.")


def test_the_page_has_verdicts_intervals_and_tables(opened):
    page = render(opened).replace("\N{NO-BREAK SPACE}", " ")
    assert page.index("all requirements are met in ") < page.index('id="quantities"')
    for words_ in ("1.8682 to 1.9640 s", "both ends are simulated runs", 'id="requirements"',
                   "The nearest failure is of in_time", "Best choice: k = ", 'id="choice"',
                   "6", "<b>The box</b> is ", "<b>the surrogate</b> is "):  # fmt: skip
        assert words_ in page
    ends = re.findall(r"<dd>(k = [^<]*)</dd>", page)
    assert len(ends) == 2 and all(re.fullmatch(r"k = [\d.]+ N m/rad", end) for end in ends)
    assert "t_never" in page
    assert "does not happen in any run" in page


def test_an_end_that_no_run_reached_is_not_told_as_one_that_did(opened):
    """Not in bold, and said in the headline: without rounds, say, it may be below all runs."""
    (row,) = (row for row in opened.facts["quantities"] if row["name"] == "t_open")
    assert "predicted" not in render(opened).split("</style>")[1]
    row = row | {"predicted_ends": ["lower"], "lower": row["lower"] - 0.01}
    data = replace(opened, facts=opened.facts | {"quantities": [row]})
    assert "is 1.858 to 1.964 s, lower end predicted." in sentence("ranges", data.facts)
    page = render(data).replace("\N{NO-BREAK SPACE}", " ")
    assert 'class="big range predicted"' in page
    assert "over the box; lower predicted, attained by a run to 1.868" in page


def test_the_part_of_the_box_that_fails_is_drawn(opened):
    """The panel is in time where its spring is stiff: k of 0.095 to 0.105 N m/rad."""
    limit, (panel,) = 1.9334, panels(opened)
    exact = 0.1 * (opened.facts["quantities"][0]["nominal"] / limit) ** 2  # t goes with k^-1/2
    assert {met for _, _, met, _ in panel.marks} == {True, False}
    assert all(near for *_, near in panel.marks)  # there is no other parameter
    for x, _, met, _ in panel.marks:
        assert met == (0.095 + 0.01 * x > exact)
    (low, bottom), (high, top) = panel.feasible
    share = opened.facts["together"]["max_interval_scale"]
    assert (low, high) == pytest.approx((0.5 - 0.5 * share, 0.5 + 0.5 * share))
    assert (bottom, top) == (0, 1)
    assert 0.095 + 0.01 * low == pytest.approx(exact, rel=1e-3)
    page = render(opened)
    assert (
        len(re.findall(r'<path data-judged="\d+" class="fails"', page))
        == sum(not met for _, _, met, _ in panel.marks)
        > 0
    )


def test_marks_whose_other_parameters_lie_outside_the_frame_are_faint(opened):
    """So that none that fails can be seen within it, where nothing does."""
    (k,) = opened.parameters
    values = np.array([[0.099, 0.1], [0.1, 0.104], [0.095, 0.1], [0.1, 0.1]])
    data = replace(
        opened,
        facts=opened.facts | {"parameters": [k, {**k, "name": "other"}, {**k, "name": "third"}]},
        verdicts=RunVerdicts(
            np.column_stack([values, [0.1] * 4]),
            np.array([True, False, True, True]),
            np.ones((4, 2)),
        ),
    )
    share = data.facts["together"]["max_interval_scale"]
    for panel in panels(data):
        for x, y, met, _ in panel.marks:
            inside = max(abs(x - 0.5), abs(y - 0.5)) <= 0.5 * share
            assert met or not inside
    assert any(not near for panel in panels(data) for *_, near in panel.marks)


def test_what_does_not_happen_meets_only_a_wish_for_that():
    numbers = np.array([[1.0, 5.0], [2.0, np.nan], [3.0, 7.0]])

    def met(quantity, kind, level):
        limit = {"quantity": quantity, "kind": kind, "level": level}
        return meets([limit], ["t", "v"], numbers).tolist()

    assert met("t", "at_most", 2.0) == [True, True, False]
    assert met("v", "at_least", 6.0) == [False, False, True]
    assert met("v", "at_most", 6.0) == [True, False, False]
    assert met("v", "happens", True) == [True, False, True]
    assert met("v", "happens", False) == [False, True, False]


def test_the_runs_at_the_ends_of_quantities_move(folder):
    make_motions(folder, frames=11)
    data = from_results(folder)
    nominal, *others = data.moving
    assert nominal.label == "nominal run"
    with xarray.open_dataset(folder / "quantities.nc") as found:
        for what in ("least", "largest"):
            (shown,) = [each for each in others if f"{what} t_open" in each.label]
            end = found["argmin" if what == "least" else "argmax"].sel(quantity="t_open").values
            run = data.runs[shown.run]
            np.testing.assert_allclose(run.values, end, rtol=1e-12)
            with xarray.open_dataset(folder / "trajectories" / f"{run.id}.nc") as alone:
                np.testing.assert_array_equal(run.curves[0], alone["opening"].sel(hinge="hinge"))
    further = [run for run in data.runs if run.role == REFINEMENT]
    assert not set(map(data.runs.index, further)) & set(data.unfitted_runs)


def test_a_page_without_requirements_has_the_intervals_only(opened, tmp_path):
    raw = {name: CONFIG[name] for name in CONFIG if name not in ("requirements", "choose")}
    raw["quantities"] = {"t_never": CONFIG["quantities"]["t_never"]}
    campaign.run(raw, tmp_path, figures=False, notify=lambda text: None)
    data = from_results(tmp_path / CONFIG["campaign"])
    assert sentence("headline", data.facts) == "None of the quantities happens in any run."
    page = render(data)
    assert 'id="quantities"' in page
    assert 'id="requirements"' not in page


EVIL = " <script>x</script> <img src=x onerror=y> [a](javascript:z) `|*\n\n# b \x1b[31m &lt;"
OF_THE_PROGRAM = {"kind", "met", "grade", "end", "sense", "predicted_ends", "bounds", "units"}
"""Keys of facts that no user names, and templates look at."""


def poisoned(facts, taken=(), key=""):
    """Facts whose texts, and names among their keys, end in what a reader must not meet raw."""
    if isinstance(facts, dict):
        return {
            name + EVIL * (name in taken): poisoned(value, taken, name)
            for name, value in facts.items()
        }
    if isinstance(facts, list):
        return [poisoned(one, taken, key) for one in facts]
    return facts + EVIL if isinstance(facts, str) and key not in OF_THE_PROGRAM else facts


def test_texts_from_outside_are_nothing_else_in_summary_and_page(opened):
    facts = copy.deepcopy(opened.facts)
    facts["quantities"][0]["doubt"] = facts["responses"][0]["doubt"] = "state `stiffness`"
    facts["review"] = {"title": "a", "head": ["b"], "heads": {"c": "d"}}
    facts["review"]["rows"] = [{"c": "e", "state": "met"}]
    facts["review"]["budgets"] = [{"title": "f", "heads": ["g"], "rows": [["h"]], "sum": "i"}]
    named = {row["name"] for key in ("parameters", "fixed", "quantities") for row in facts[key]}
    text = summary_text(poisoned(facts, named)) + summary_text(poisoned(facts), "review.md.jinja")
    assert text.count("script") > 100
    assert not re.findall(r"(?<!\\)(?:<|>|\[|\]|&)|\x1b|^# b", text, re.M)
    free = {"description", "long_name", "words", "event", "about", "scene", "doubt", "contact"}

    def worded(facts, key=""):
        if isinstance(facts, dict):
            return {name: worded(value, name) for name, value in facts.items()}
        if isinstance(facts, list):
            return [worded(one, key) for one in facts]
        return facts + EVIL if key in free else facts

    del facts["review"]
    page = render(replace(opened, facts=worded(facts)))
    page = page.replace("\N{NO-BREAK SPACE}", " ")
    assert page.count("&lt;script&gt;x") >= 10
    assert "<script>x" not in page and "<img src=x" not in page and "=javascript" not in page
