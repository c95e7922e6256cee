"""The page tells what was asked of quantities before anything else."""

import copy
import re
from dataclasses import replace

import numpy as np
import pytest
import xarray
from opening import CONFIG
from stored_runs import curves_in

from deployable import campaign
from deployable.campaign.report import from_results, make_motions
from deployable.campaign.report.failing_region import panels
from deployable.campaign.report.page import render
from deployable.campaign.report.read import REFINEMENT, meets
from deployable.campaign.results.templates import sentence


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
        r"Not everywhere: all requirements are met in 6\d\.\d+ % of the tolerance box "
        r"\(by volume, not a probability\)\. "
        r"`in_time` fails in 3\d\.\d+ % of the box, at worst by 0\.0306 s\.",
        text,
    )
    assert " at 1.8682 to 1.9640 s (`t_open`)." in sentence("ranges", opened.facts)


def test_the_runs_that_are_told_add_up_to_those_that_were_made(folder, opened):
    parts = r"(\d+) (?:runs|belong to|refine|compare)"
    total, *parts = map(int, re.findall(parts, sentence("given", opened.facts)))
    assert len(parts) == 3
    assert total == sum(parts) == len(curves_in(folder / "trajectories"))


def test_the_page_has_verdicts_intervals_and_tables(opened):
    page = render(opened).replace("\N{NO-BREAK SPACE}", " ")
    assert page.index("all requirements are met in ") < page.index('id="quantities"')
    for words_ in ("1.8682 to 1.9640 s", "Least at k = ", 'id="requirements"',
                   "Just beyond that size, <code>in_time</code>",
                   "Choose <code>k</code> = ",
                   'id="choice"', "6", "<b>The box</b> is ", "<b>The fit</b> is "):  # fmt: skip
        assert words_ in page
    assert len(re.findall(r"(?:Least|Largest) at k = [\d.]+ N m/rad\.", page)) == 2
    assert "t_never" in page
    assert "does not happen in any run" in page


def test_sentences_of_the_page_are_short(opened):
    """Without what stands in brackets, and lists."""
    body = re.sub(r"<(script|style|svg|pre).*?</\1>", "", render(opened), flags=re.S)
    texts = re.findall(r"<(?:p|dd|div class=\"caution\")\b[^>]*>(.*?)</(?:p|dd|div)>", body, re.S)
    plain = [" ".join(re.sub(r"<[^>]+>|\([^()]*\)", "", text).split()) for text in texts]
    sentences = [s for text in plain for s in re.split(r"(?<=[.!?]) (?=[A-Z])", text)]
    counts = {s: len(s.split()) for s in sentences if ": " not in s}
    assert not {s: n for s, n in counts.items() if n > 25}
    assert len(counts) > 50 and sum(counts.values()) / len(counts) < 15


def test_an_end_that_no_run_reached_is_not_told_as_one_that_did(opened):
    """Not in bold, and said in the headline: without rounds, say, it may be below all runs."""
    (row,) = (row for row in opened.facts["quantities"] if row["name"] == "t_open")
    assert "predicted" not in render(opened).split("</style>")[1]
    row = row | {"predicted_ends": ["lower"], "lower": row["lower"] - 0.01}
    data = replace(opened, facts=opened.facts | {"quantities": [row]})
    told = " at 1.858 to 1.964 s (`t_open`; lower end predicted, not simulated)."
    assert told in sentence("ranges", data.facts)
    page = render(data).replace("\N{NO-BREAK SPACE}", " ")
    assert 'class="range predicted"' in page and "Lower end predicted, a run gives 1.868" in page


def test_the_part_of_the_box_that_fails_is_drawn(opened):
    """The panel is in time where its spring is stiff: k of 0.095 to 0.105 N m/rad."""
    limit, (panel,) = 1.9334, panels(opened)
    exact = 0.1 * (opened.facts["quantities"][0]["nominal"] / limit) ** 2  # t goes with k^-1/2
    assert {met for _, _, met, _ in panel.marks} == {True, False}
    assert all(near for *_, near in panel.marks)  # there is no other parameter
    for x, _, met, _ in panel.marks:
        k = 0.095 + 0.01 * x
        assert met == (k > exact) or abs(k - exact) < 1e-6 * exact, "runs lie at the very border"
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
    nominal, *others = (data.runs[i] for i in data.moving)
    assert nominal.label == "nominal run"
    with xarray.open_dataset(folder / "quantities.nc") as found:
        for what in ("earliest", "latest"):
            (run,) = [each for each in others if f"{what} t_open" in each.label]
            end = found["argmin" if what == "earliest" else "argmax"].sel(quantity="t_open").values
            np.testing.assert_allclose(run.values, end, rtol=1e-12)
            (opening,) = curves_in(folder / "trajectories")[run.id].openings.values()
            # Its step is that of the run but for rounding, as nothing is read between instants.
            np.testing.assert_allclose(run.curves[0], opening, rtol=1e-11, atol=1e-15)
    further = [run for run in data.runs if run.role == REFINEMENT]
    assert not set(map(data.runs.index, further)) & set(data.unfitted_runs)
