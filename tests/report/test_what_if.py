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
from deployable.campaign.report.failing_region import prices
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
@pytest.mark.parametrize("share", [0.03, 0.77])
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
        assert window.ask(VERDICT) == f"{text} (by the fit)."


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
def test_the_error_of_what_is_below_nothing_lies_about_the_bounds(window, opened, tmp_path):
    """A response that has no least value may be negative: its error does not end at 0."""
    (found,) = opened.responses
    below = replace(found, lower=found.lower - 100, upper=found.upper - 100)
    write_page(replace(opened, responses=(below,)), tmp_path / "report.html")
    window.open(tmp_path / "report.html")
    window.settle()
    height = "document.querySelector('path.{}').getBBox().height"
    band, doubt = (window.ask(height.format(kind)) for kind in ("band", "doubt"))
    assert 0 < band <= doubt < 2 * band
