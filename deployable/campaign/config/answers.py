"""What a config asks of its quantities: requirements, and the best choice of parameters."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from deployable.campaign.config.schema_checks import show
from deployable.campaign.config.sections import Campaign, Choose, Experiment
from fpm.errors import did_you_mean

LIMITS = ("at_least", "at_most", "happens")
ENDS = ("upper", "lower", "width")
_GOAL = re.compile(r"(\w+)\((\w+)\)")


def choose_data(raw: Mapping, intervals: Mapping) -> dict:
    """The section `choose` of a config as plain data of a `Choose`; `intervals` as the user gave
    them."""
    goals = {key: raw.get(key, []) for key in ("minimise", "maximise")}
    goals = {key: [value] if isinstance(value, str) else value for key, value in goals.items()}
    parameters = raw.get("parameters", {})
    relative = [name for name in parameters if "relative" in intervals.get(name, {})]
    ranges = {name: [float(end) for end in ends] for name, ends in parameters.items()}
    return {"parameters": ranges, "order": raw["order"], "relative": relative, **goals}


def goals_of(choose: Choose) -> list[tuple[float, str, str]]:
    """Goals as (1 to minimise or -1 to maximise, end of the interval, quantity)."""
    found = []
    for sign, texts in ((1.0, choose.minimise), (-1.0, choose.maximise)):
        for text in texts:
            match = _GOAL.fullmatch(text.replace(" ", ""))
            found.append((sign, match[1], match[2]) if match else (sign, text, ""))
    return found


def answer_problems(campaign: Campaign) -> list[str]:
    """What is wrong with `requirements` and `choose`, one sentence each."""
    problems = []
    known = campaign.experiment.quantities
    for name, limits in campaign.requirements.items():
        for quantity, kept in limits.items():
            key = f"requirements.{name}.{quantity}"
            if quantity not in known:
                problems.append(f"{key}: {_no_quantity(quantity, known)}")
            else:
                problems += _limit_problems(key, kept)
    if campaign.choose.parameters:
        problems += _choose_problems(campaign.experiment, campaign.choose)
    return problems


def _no_quantity(name: str, known: Mapping) -> str:
    allowed = f"one of {', '.join(known)}" if known else "none, without `quantities`"
    return f"there is no such quantity{did_you_mean(name, known)}; allowed: {allowed}"


def _limit_problems(key: str, kept: Any) -> list[str]:
    least, most = kept.get("at_least"), kept.get("at_most")
    if least is not None and most is not None and least > most:
        return [f"{key}.at_least: {show(least)} is above at_most; allowed: at most {most:g}"]
    if kept.get("happens") is False and len(kept) > 1:
        return [f"{key}.happens: false allows no other limit; allowed: true, or happens alone"]
    return []


def _choose_problems(experiment: Experiment, choose: Choose) -> list[str]:
    from fpm import SceneError

    problems, goals, known = [], goals_of(choose), experiment.quantities
    if not 1 <= len(goals) <= 2:
        problems.append(f"choose: it has {len(goals)} goals; allowed: one or two")
    for sign, end, quantity in goals:
        key = f"choose.{'minimise' if sign > 0 else 'maximise'}"
        if end not in ENDS or not quantity:
            text = f"{end}({quantity})" if quantity else end
            problems.append(f"{key}: {text!r} is not allowed; allowed: e.g. upper(q) of a quantity "
                            f"q, with {', '.join(ENDS)}")  # fmt: skip
        elif quantity not in known:
            problems.append(f"{key}: {_no_quantity(quantity, known)}")
    scene = experiment.scene_type
    for name, (low, high) in choose.parameters.items():
        key = f"choose.parameters.{name}"
        parameter = scene.parameters.get(name)
        real = [n for n, p in scene.parameters.items() if p.kind == "real"]
        if parameter is None or parameter.kind != "real":
            hint = did_you_mean(name, real)
            problems.append(f"{key}: there is no such real parameter{hint}; allowed: "
                            f"{', '.join(real)}")  # fmt: skip
        elif not low < high:
            problems.append(f"{key}: {show([low, high])} is not allowed; allowed: a lower and a "
                            "larger upper end")  # fmt: skip
        else:
            for value in choose.ends(name, experiment):
                try:
                    parameter.check("", value)
                except SceneError:
                    problems.append(f"{key}: {value:.9g}, with its interval, leaves the range; "
                                    f"allowed: {parameter.allowed}")  # fmt: skip
    if not problems and len({*experiment.intervals, *choose.parameters}) > 8:
        problems.append("choose.parameters: more than 8 with the intervals; allowed: fewer")
    return problems
