"""Results in the units of a config's section `display`, for people; files have SI units."""

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, get_args, get_type_hints

import numpy as np

from deployable.campaign.config.models import Display
from deployable.campaign.config.sections import Experiment
from deployable.campaign.results.quantity_results import QuantityResults
from deployable.campaign.results.response_bounds import CampaignBounds
from deployable.campaign.text import name_response, words_of
from fpm.arithmetic.units import unit
from fpm.errors import SceneError

_KINDS = {kind: get_args(names) for kind, names in get_type_hints(Display).items()}
_PLACES = "at", "lower_at", "argmin", "argmax"  # keys of parameter values by name
_OTHER_KEYS = re.compile(
    "time|share|ratio|happens|runs|undivided|target|bands|fraction|duration|error_share"
)
"""Beginnings of the keys of numbers that are not in the unit of the row that they are in."""


def shown_unit(units: str, display: Display) -> tuple[float, str]:
    """Return the factor from numbers in `units`, spelled as in files, to those shown, and units."""
    first, _, rest = units.replace("degree", "deg").partition(" ")
    for kind, names in _KINDS.items():
        name = getattr(display, kind)
        if name and first in names and re.fullmatch(r"(s-\d)?", rest):
            old, new = unit(first), unit(name)
            return old.si(new.denominator) / new.numerator, f"{new.udunits} {rest}".strip()
    return 1.0, units


def _converter(
    display: Display, scales: Mapping[str, float], words: Mapping[str, Mapping]
) -> Callable:
    """Make a function that converts results. scales: of parameters; words: of quantities."""

    def show(value: Any, key: str = "", scale: float = 1.0) -> Any:
        """Return what stands below a key, of numbers that are multiplied by `scale`. A mapping with
        units has a scale of its own, and gets it as `scale`."""
        if _OTHER_KEYS.match(key) and not (key == "bands" and isinstance(value, list)):
            return value
        if key in _PLACES:
            return {n: x if x is None else x * scales[n] for n, x in value.items()}
        if isinstance(value, Mapping):
            unit_key = next((name for name in ("units", "unit") if name in value), "")
            scale, units = shown_unit(value[unit_key], display) if unit_key else (scale, "")
            row = {name: show(item, name, scale) for name, item in value.items()}
            if "words" in row and unit_key == "units":
                row |= words[str(row.get("quantity", row.get("name")))]
            return row | {unit_key: units, "scale": scale} if unit_key else row
        if isinstance(value, list):
            return [show(item, key, scale) for item in value]
        is_number = type(value) in (int, float, np.ndarray) and scale != 1.0
        return value * scale if is_number else value

    return show


def shown_facts(facts: Mapping[str, Any], experiment: Experiment) -> dict[str, Any]:
    """Return the content of `summary.json` in the units of the experiment's `display`."""
    display = experiment.display
    words: dict[str, dict] = {}
    with suppress(SceneError):  # the structure's file has changed since: words stay as they are
        words |= {row.name: {"words": name_response(row)} for row in experiment.response_list}
        for quantity in experiment.quantity_list:
            texts = words_of(quantity, lambda units: shown_unit(units, display))
            if quantity.kind in ("crossing", "settling"):  # whose long name has a number
                texts["long_name"] = texts["words"].replace("`", "")
            words[quantity.name] = texts
    choice = facts.get("choice", {"parameters": ()})  # perhaps of a parameter that has no value
    rows = [*facts.get("fixed", ()), *facts["parameters"], *choice["parameters"]]
    scales = {row["name"]: shown_unit(row["units"], display)[0] for row in rows}
    show, unshown_parts = _converter(display, scales, words), {"review", "mechanism"}
    result = {key: x if key in unshown_parts else show(x, key) for key, x in facts.items()}
    result["deepest"] = show({"value": facts.get("overlap", 0.0), "units": "rad"})
    result["metre"] = show({"value": 1.0, "units": "m"})
    for trial in result.get("choice", {"tried": ()})["tried"]:
        sections = (("values", "parameters"), ("goals", "goals"), ("margins", "limits"))
        for key, section in sections:
            pairs = zip(trial[key], result["choice"][section], strict=True)
            trial[key] = [x if x is None else x * row["scale"] for x, row in pairs]
    for pair in result.get("measured", {}).get("trade_offs", ()):
        first, second = (scales[name] for name in pair["names"])
        pair["slope"] *= second / first
    return result


def shown_quantities(results: QuantityResults, experiment: Experiment) -> QuantityResults:
    """Return quantities, and the intervals of parameters, in the units of `display`."""
    facts = {"parameters": results.parameters, "quantities": results.rows}
    copy = shown_facts(facts, experiment)
    return results._replace(rows=copy["quantities"], parameters=copy["parameters"])


def shown_bounds(bounds: CampaignBounds, display: Display) -> CampaignBounds:
    """Return bounds of responses, and the intervals of parameters, in the units of `display`."""
    show = _converter(display, {}, {})
    rows = tuple(replace(row, **show(vars(row))) for row in bounds.responses)
    return replace(bounds, responses=rows, parameters=show(bounds.parameters))


def shown_table(rows: Sequence[Sequence], display: Display) -> list[list]:
    """Return a table, whose first row has headings such as `x (m)`, in the units of `display`."""
    heads, scales = [], []
    for heading in rows[0]:
        name, bracket, units = heading.removesuffix(")").rpartition(" (")
        scale, units = shown_unit(units, display) if bracket else (1.0, "")
        heads.append(f"{name} ({units})" if scale != 1.0 else heading)
        scales.append(scale)
    # A cell without a number is empty.
    body = [[x * s if s != 1.0 and x != "" else x for x, s in zip(row, scales, strict=True)]
            for row in rows[1:]]  # fmt: skip
    return [heads, *body]
