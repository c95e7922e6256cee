"""Results in the units of `display`: the same converted numbers wherever people read them, SI units
in the files of programs."""

from __future__ import annotations

import shutil
from dataclasses import replace

import numpy as np
import pytest

from deployable import campaign
from deployable.campaign.config.models import Display
from deployable.campaign.config.sections import Experiment
from deployable.campaign.export.tables import tabulate_quantities, tabulate_runs
from deployable.campaign.files import read_json
from deployable.campaign.folder import Folder
from deployable.campaign.report import from_results
from deployable.campaign.report.pack import _Arrays, payload
from deployable.campaign.report.page import render
from deployable.campaign.results.display import (
    shown_bounds,
    shown_quantities,
    shown_table,
    shown_unit,
)
from deployable.campaign.results.figures import envelope
from deployable.campaign.results.quantity_results import FittedRuns, QuantityResults
from deployable.campaign.results.ranges import ranges
from deployable.campaign.results.response_bounds import read_bounds
from deployable.campaign.stages.answers import summarise
from deployable.campaign.text.numbers import interval

MM = Display(length="mm", angle="deg")


@pytest.mark.parametrize(("units", "factor", "shown"), [
    ("m", 1000, "mm"), ("m s-2", 1000, "mm s-2"), ("rad s-1", 180 / np.pi, "degree s-1"),
    ("degree", 1, "degree"), ("N m", 1, "N m"), ("m2", 1, "m2"), ("1", 1, "1"), ("Pa", 1, "Pa"),
])  # fmt: skip
def test_lengths_and_angles_and_their_rates_change_and_nothing_else(units, factor, shown):
    assert shown_unit(units, MM) == (pytest.approx(factor), shown)
    assert shown_unit(units, Display()) == (1.0, units)


def test_the_runs_of_a_campaign_do_not_depend_on_its_display(raw):
    plain = campaign.check_config(raw).experiment
    shown = campaign.check_config(raw | {"display": {"length": "mm", "angle": "deg"}}).experiment
    assert shown == replace(plain, display=MM)


def arrays_of(data):
    """The page's data, and a function that gives an array of it."""
    arrays = _Arrays()
    content = payload(data, arrays)
    return content, lambda x: np.frombuffer(bytes(arrays.data), x["kind"], x["count"], x["at"])


def test_people_read_the_same_number_everywhere_and_files_stay_in_si_units(
    rich, tmp_path, monkeypatch
):
    folder = Folder(shutil.copytree(rich[0].path, tmp_path / "rich"))
    before, (plain, numbers) = read_json(folder / "summary.json"), arrays_of(from_results(folder))
    read = Experiment.read
    monkeypatch.setattr(Experiment, "read", lambda config: replace(read(config), display=MM))
    summary = summarise(folder, {}, ["requirements", "choice"])
    assert read_json(folder / "summary.json") | {"config": before["config"]} == before

    row = before["quantities"][0]
    lower, upper = 1000 * row["lower"], 1000 * row["upper"]
    text = interval({**row, "lower": lower, "upper": upper, "error": 1000 * row["error"],
                     "units": "mm"})  # fmt: skip
    data = from_results(folder)
    assert text in summary and text in render(data).replace("\xa0", " ")
    assert "is at most 200 mm" in summary

    shown, arrays = arrays_of(data)
    for key, unit in (("responses", "mm"), ("parameters", "mm")):
        assert shown[key][0]["unit"] == unit
    for old, new, scale in (
        (plain["responses"][0]["upper"], shown["responses"][0]["upper"], 1000),
        (plain["moving"][0]["curves"][0], shown["moving"][0]["curves"][0], 1000),
        (plain["judged"]["numbers"], shown["judged"]["numbers"], 1000),
        (plain["judged"]["values"], shown["judged"]["values"], 1000),
        (plain["judged"]["met"], shown["judged"]["met"], 1),
        *((plain["whatIf"]["quantities"][0]["value"][key],
           shown["whatIf"]["quantities"][0]["value"][key], 1000)
          for key in ("coefficients", "weights")),
    ):  # fmt: skip
        assert arrays(new) == pytest.approx(scale * numbers(old), rel=1e-6)
    assert shown["runs"][0]["values"] == [35.0]
    chosen, plainly = (x["whatIf"]["choice"]["parameters"][0] for x in (shown, plain))
    assert chosen["upper"] == pytest.approx(1000 * plainly["upper"])
    assert [limit["level"] for limit in shown["whatIf"]["limits"]] == [200.0]
    marks = data.facts["choice"]["tried"][0]["values"]
    assert marks == pytest.approx([1000 * x for x in before["choice"]["tried"][0]["values"]])

    bounds = shown_bounds(read_bounds(folder), MM)
    (ax, *_) = envelope(bounds.responses[:1]).axes
    assert ax.get_ylabel().endswith("(mm)") and "mm" in str(ax.get_legend_handles_labels()[1])
    runs, results = FittedRuns.read(folder), QuantityResults.read(folder)
    experiment = read(data.config)
    figure = ranges(shown_quantities(results, replace(experiment, display=MM)), runs,
                    runs.surrogates(experiment))  # fmt: skip
    (line, *_) = figure.axes[0].lines
    assert figure.axes[0].get_ylabel() == "most (mm)" and figure.axes[0].get_xlabel() == "a (mm)"
    assert line.get_ydata().max() == pytest.approx(upper, rel=1e-3)

    head, first, *_ = shown_table(tabulate_runs(folder), MM)
    assert head[2:4] == ["a (mm)", "most (mm)"] and first[2] == 35.0
    head, first, *_ = tabulate_quantities(folder)
    assert first[:2] == ["most", "mm"] and first[head.index("upper")] == pytest.approx(upper)
    assert "a (mm) at the upper end" in head
