"""Sliders, and runs that are clicked, tell what Python tells."""

import copy
import json
from dataclasses import replace

import numpy as np
import pytest
from browser import MISSING, Browser
from opening import CONFIG
from scipy.optimize import brentq

from deployable import campaign
from deployable.campaign.report import from_results, make_motions, write_page
from deployable.campaign.report.data import RunVerdicts
from deployable.campaign.report.failing_region import MOST_PARAMETERS, lines, prices
from deployable.campaign.report.page import render

in_a_browser = pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}")

SLIDE = """(() => {{ const slider = document.querySelector('#sliders input');
slider.value = {}; const start = performance.now(); slider.dispatchEvent(new Event('input'));
return performance.now() - start; }})()"""
TOLD = "document.getElementById('what-if').dataset.numbers"
LIMIT = 1.9334  # s, of in_time
VERDICT = "document.getElementById('what-verdict').textContent"


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    """The page's data of a panel with requirements that part of the box meets."""
    results = tmp_path_factory.mktemp("results")
    config = copy.deepcopy(CONFIG) | {"bounds": {"model": "polynomial"}}  # which sliders move
    campaign.run(config, results, figures=False, notify=lambda text: None)
    make_motions(results / CONFIG["campaign"], frames=21)
    return from_results(results / CONFIG["campaign"])


@pytest.fixture(scope="module")
def window(opened, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    write_page(opened, path)
    with Browser() as browser:
        browser.open(path)
        browser.settle()
        yield browser
        assert browser.errors() == []


@in_a_browser
@pytest.mark.parametrize("share", [0.03, 0.31, 0.5, 0.77, 0.99])
def test_a_slider_asks_what_python_asks(window, opened, share):
    """Quantities, verdict and curves, to less than a millionth of their widths, within 50 ms."""
    (k,) = opened.parameters
    value = k["lower"] + share * (k["upper"] - k["lower"])
    window.ask(SLIDE.format(repr(value)))
    milliseconds = min(window.ask(SLIDE.format(repr(v))) for v in (k["nominal"], value) * 2)
    assert milliseconds < 50
    window.ask(SLIDE.format(repr(value)))
    unit = np.array([[2 * share - 1]])
    wanted = [surrogate.evaluate(unit)[0] for surrogate in opened.what_if.quantities.values()]
    for found, number, row in zip(
        json.loads(window.ask(TOLD)), wanted, opened.facts["quantities"], strict=True
    ):
        assert (found is None) == np.isnan(number)
        if found is not None:
            assert found == pytest.approx(number, abs=1e-6 * (row["upper"] - row["lower"]))
    assert ("Meets all" in window.ask(VERDICT)) == (wanted[0] <= LIMIT)
    curve = np.array(window.ask("Array.from(document.querySelector('#charts .asked').curve)"))
    powers = opened.what_if.indices[:, 0]
    exact = np.cos(powers * np.arccos(unit[0, 0])) @ opened.what_if.coefficients[0]
    width = (opened.responses[0].upper - opened.responses[0].lower).max()
    np.testing.assert_allclose(curve, exact, rtol=0, atol=1e-6 * width)


@in_a_browser
def test_a_value_within_its_error_of_a_limit_is_about_at_it(window, opened):
    """Neither met nor failed: what was fitted does not decide there."""
    (k,) = opened.parameters
    time = next(iter(opened.what_if.quantities.values()))
    unit = brentq(lambda x: time.evaluate(np.array([[x]]))[0] - LIMIT, -1, 1)
    for step, text in ((0.0, "About at the limit: in_time"), (0.1, "Meets all requirements")):
        share = (unit + step + 1) / 2
        window.ask(SLIDE.format(repr(k["lower"] + share * (k["upper"] - k["lower"]))))
        assert window.ask(VERDICT) == f"{text} (by what was fitted)."


@in_a_browser
def test_sliders_reach_the_best_choice(window, opened):
    """Beyond the box its quantities are those fitted to the runs of the choice, without curves; a
    mark of a choice that was tried sets its values."""
    (chosen,) = opened.facts["choice"]["parameters"]
    (box,) = opened.parameters
    lower, upper = opened.what_if.choice_intervals["k"]
    surrogate = opened.what_if.choice_quantities["t_open"]
    values = [
        chosen["value"],
        upper,
        *(trial["values"][0] for trial in opened.facts["choice"]["tried"]),
    ]
    marks = "[...document.querySelectorAll('[data-choice]')]"
    for i, value in enumerate(values):
        if i == 0:
            window.ask("document.getElementById('chosen-values').click()")
        elif i == 1:
            window.ask(SLIDE.format(repr(value)))
        else:
            window.ask(f"{marks}[{i - 2}].dispatchEvent(new Event('click'))")
        beyond = not box["lower"] <= value <= box["upper"]
        unit = np.array([[2 * (value - lower) / (upper - lower) - 1]])
        if beyond:
            assert json.loads(window.ask(TOLD))[0] == pytest.approx(
                surrogate.evaluate(unit)[0], rel=1e-6
            )
        assert ("beyond the box" in window.ask(VERDICT)) == beyond
        assert (
            window.ask("document.querySelector('#charts .asked').getAttribute('d')") == ""
        ) == beyond
    told = "document.querySelector('#sliders input').getAttribute('aria-valuetext')"
    assert window.ask(told).endswith("N m/rad")


@in_a_browser
def test_keys_move_a_slider_and_not_the_time(window):
    read = "[Number(document.querySelector('#sliders input').value), Number(view.dataset.time)]"
    window.ask("document.getElementById('usual').click()")
    window.ask("document.querySelector('#sliders input').focus()")
    before = window.ask(read)
    window.press("\ue014")
    window.settle()
    assert window.ask(read)[0] > before[0] and window.ask(read)[1] == before[1]
    assert window.ask("document.querySelector('#sliders output').textContent").endswith("N m/rad")


@in_a_browser
def test_a_run_that_is_clicked_is_told_as_it_was_simulated(window, opened):
    run = window.ask("Number(document.querySelector('path[data-judged]').dataset.judged)")
    window.ask("document.querySelector('path[data-judged]').dispatchEvent(new Event('click'))")
    slider = float(window.ask("document.querySelector('#sliders input').value"))
    assert slider == pytest.approx(opened.verdicts.values[run, 0], rel=1e-9)
    numbers = [None if np.isnan(n) else n for n in opened.verdicts.numbers[run]]
    assert json.loads(window.ask(TOLD)) == numbers
    assert window.ask(VERDICT) == "Fails: in_time (simulated)."
    assert window.ask("document.querySelectorAll('.asked[data-judged]').length") == 1
    window.ask("document.getElementById('usual').click()")
    assert float(window.ask("document.querySelector('#sliders input').value")) == pytest.approx(0.1)


def test_runs_of_many_parameters_are_lines_along_all(opened):
    (k,) = opened.parameters
    count = MOST_PARAMETERS + 1
    values = np.random.default_rng(1).uniform(k["lower"], k["upper"], (30, count))
    met = values[:, 0] > 0.1
    facts = {
        **{name: fact for name, fact in opened.facts.items() if name != "choice"},
        "parameters": [{**k, "name": f"k{i}"} for i in range(count)],
        "quantities": [row for row in opened.facts["quantities"] if row["lower"] is None],
        "requirements": [],
        "together": {**opened.facts["together"], "fails": None, "halved": {}},
    }
    data = replace(
        opened,
        facts=facts,
        verdicts=RunVerdicts(values, met, np.ones((30, 2))),
        what_if=None,
        responses=tuple(replace(one, shares=None, widths=None) for one in opened.responses),
    )
    found = lines(data)
    assert [each for _, each, _ in found] == sorted(met, reverse=True)
    for run, _, places in found:
        unit = (values[run] - k["lower"]) / (k["upper"] - k["lower"])
        np.testing.assert_allclose(places, unit, atol=1e-4)
    assert render(data).count("<polyline") == 30
    assert lines(opened) == []
    # Of many runs, some of each kind are drawn.
    many = np.arange(2000) % 100 == 0
    values = np.resize(values, (2000, count))
    drawn = [each for _, each, _ in lines(replace(data, verdicts=RunVerdicts(values, many, None)))]
    assert len(drawn) == 400 and sum(drawn) == 20


def test_what_choices_cost_leaves_out_those_that_end_with_the_runs(opened):
    (panel,) = prices(opened.facts)
    assert panel.marks[-1][2] is None  # the best
    assert len(panel.marks) == len(opened.facts["choice"]["tried"]) + 1
    late = copy.deepcopy(opened.facts)
    late["choice"]["goals"][0]["end"] = "upper"
    late["choice"]["tried"][0]["goals"] = [late["duration"]]
    assert len(prices(late)[0].marks) == len(panel.marks) - 1
    assert prices({"duration": 1.0}) == []


@pytest.mark.parametrize(
    ("kept", "told"), [(True, ", is the best"), (False, "misses them least: none meets all")]
)
def test_the_best_choice_where_none_meets_all_is_told_as_such(opened, kept, told):
    choice = {**opened.facts["choice"], "kept": kept}
    assert told in render(replace(opened, facts=opened.facts | {"choice": choice}))


@in_a_browser
def test_the_error_of_what_is_below_nothing_lies_about_the_bounds(opened, tmp_path):
    """A response that has no least value may be negative: its error does not end at 0."""
    (found,) = opened.responses
    below = replace(found, lower=found.lower - 100, upper=found.upper - 100)
    write_page(replace(opened, responses=(below,)), tmp_path / "report.html")
    with Browser() as browser:
        browser.open(tmp_path / "report.html")
        browser.settle()
        height = "document.querySelector('path.{}').getBBox().height"
        band, doubt = (browser.ask(height.format(kind)) for kind in ("band", "doubt"))
    assert 0 < band <= doubt < 2 * band


LEFT = "document.getElementById('what-tests').textContent"


@in_a_browser
@pytest.mark.parametrize(
    ("after", "inside", "outside"),
    [
        (0.6, "Within the intervals that the measured curves leave.", "exclude this: k."),
        (None, "leave nothing of the box.", "leave nothing of the box."),
    ],
)
def test_sliders_tell_what_measured_curves_leave(opened, tmp_path, after, inside, outside):
    """The lower part of the interval is left, or nothing."""
    (k,) = opened.parameters
    width = k["upper"] - k["lower"]
    row = {"name": "k", "units": k["units"], "before": [k["lower"], k["upper"]], "seen": "upper",
           "after": after and [k["lower"], k["lower"] + after * width], "best": 0}  # fmt: skip
    worst = {"time": 0.1, "test": "t", "response": "y", "bands": 3.0, "residual": 1.0, "units": "m"}
    measured = {"parameters": [row], "refuted": after is None, "least": 3.0, "attained": 0.5,
                "hull": 0.6, "worst": worst}  # fmt: skip
    keys = ("tests", "checks", "quantities", "next", "trade_offs", "singles", "disjoint")
    measured |= {key: [] for key in keys}
    misfits = [0.5 * 16**share for share in (0, 0.25, 0.5, 0.75, 1)]
    measured["misfits"] = {"points": [[-1.0], [-0.5], [0.0], [0.5], [1.0]], "values": misfits}
    measured["left"] = 0.6
    path = tmp_path / "left.html"
    write_page(replace(opened, facts=opened.facts | {"measured": measured}), path)
    with Browser() as browser:
        browser.open(path)
        browser.settle()
        for share, words, bands in ((0.0, inside, "0.5"), (1.0, outside, "8")):
            browser.ask(SLIDE.format(repr(k["lower"] + share * width)))
            assert words in browser.ask(LEFT)
            assert browser.ask(LEFT).endswith(f" Their curve deviates by about {bands} bands.")
        assert browser.errors() == []
