"""What a config asks of its quantities: requirements, and the best choice of parameters."""

from __future__ import annotations

import re
from collections.abc import Mapping

from deployable.campaign.config.models import Around, Choosing, Limits
from deployable.campaign.config.parameters import allows, real_names
from deployable.campaign.config.read import show
from deployable.campaign.config.sections import Campaign, Choose, Experiment
from fpm.errors import did_you_mean

LIMITS = tuple(Limits.__dataclass_fields__)
_GOAL = re.compile(r"(\w+)\((\w+)\)")


def choose_of(given: Choosing, intervals: Mapping[str, Around]) -> Choose:
    """What `choose` of a config asks for; `intervals` as the user gave them."""
    relative = [n for n in given.parameters if n in intervals and intervals[n].relative is not None]
    goals = {"minimise": given.minimise, "maximise": given.maximise}
    goals = {key: (one,) if isinstance(one, str) else one for key, one in goals.items()}
    return Choose(given.parameters, **goals, order=given.order, relative=(*relative,))


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
        for quantity in limits:
            if quantity not in known:
                key = f"requirements.{name}.{quantity}"
                problems.append(f"{key}: {_no_quantity(quantity, known)}")
    if campaign.choose.parameters:
        problems += _choose_problems(campaign.experiment, campaign.choose)
    return problems


def _no_quantity(name: str, known: Mapping) -> str:
    allowed = f"one of {', '.join(known)}" if known else "none, without `quantities`"
    return f"there is no such quantity{did_you_mean(name, known)}; allowed: {allowed}"


def _choose_problems(experiment: Experiment, choose: Choose) -> list[str]:
    from deployable.intervals.scalars.requirements import ENDS

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
    problems += [
        f"choose.parameters.{name}: {told}"
        for name in choose.parameters
        if (told := _choice_problem(name, choose, experiment))
    ]
    if not problems and len({*experiment.intervals, *choose.parameters}) > 8:
        problems.append("choose.parameters: more than 8 with the intervals; allowed: fewer")
    return problems


def _choice_problem(name: str, choose: Choose, experiment: Experiment) -> str:
    """What is wrong with the range of a parameter's choices; nothing where it is right."""
    scene, (low, high) = experiment.scene_type, choose.parameters[name]
    if name not in (real := real_names(scene)):
        hint = did_you_mean(name, real)
        return f"there is no such real parameter{hint}; allowed: {', '.join(real)}"
    if not low < high:
        return f"{show([low, high])} is not allowed; allowed: a lower and a larger upper end"
    parameter = scene.parameters[name]
    for value in choose.ends(name, experiment):
        if not allows(parameter, value):
            told = f"{value:.9g}, with its interval, leaves the range"
            return f"{told}; allowed: {parameter.allowed}"
    return ""
