"""The parameter values that a config asks for, and what the scene finds wrong with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from deployable.campaign.config.keys import RefusedError
from deployable.campaign.config.models import Around
from deployable.campaign.config.read import show
from deployable.campaign.config.sections import Interval
from fpm.errors import did_you_mean


def intervals_of(
    arounds: Mapping[str, Around], given: Mapping, scene_type: Any
) -> tuple[dict[str, Interval], list[str]]:
    """The intervals by parameter name, and one sentence for each that cannot be used.

    `given` are the parameters of the scene that the config sets.
    """
    found: dict[str, Interval] = {}
    problems: list[str] = []
    for name, around in arounds.items():
        try:
            found[name] = _interval(name, around, given, scene_type)
        except RefusedError as error:
            problems.append(f"intervals.{name}{error.key}: {error.text}")
    return found, problems


def _interval(name: str, around: Around, given: Mapping, scene_type: Any) -> Interval:
    """The interval of one parameter, inside the range that the scene allows."""
    allowed = ", ".join(real_names(scene_type))
    if name not in scene_type.parameters:
        raise RefusedError("", no_parameter(name, scene_type, real_names(scene_type)))
    parameter = scene_type.parameters[name]
    if parameter.kind != "real":
        told = f"{name} is of kind {parameter.kind} and cannot be an interval; allowed: {allowed}"
        raise RefusedError("", told)
    if name in given and around.nominal is not None:
        told = f"{name} is defined twice, here and by scene.parameters.{name}"
        raise RefusedError(".nominal", f"{told}; allowed: one of the two")
    interval = _ends(around, given.get(name, parameter.default))
    for end, value in (("lower", interval.lower), ("upper", interval.upper)):
        if not allows(parameter, value):
            told = f"its {end} end {value:.12g} leaves the range of {name}"
            raise RefusedError("", f"{told}; allowed: {parameter.allowed}")
    return interval


def _ends(around: Around, default: Any) -> Interval:
    """The interval that is meant; `default` is the scene's value."""
    lower, nominal, upper = around.lower, around.nominal, around.upper
    if lower is not None:
        return Interval(lower, 0.5 * (lower + upper) if nominal is None else nominal, upper)
    nominal = default if nominal is None else nominal
    if isinstance(nominal, bool) or not isinstance(nominal, int | float):
        raise RefusedError(".nominal", "missing, and the scene has no value; allowed: a number")
    half = around.absolute
    if half is None:
        half = abs(nominal) * around.relative
        if half == 0.0 < around.relative:
            raise RefusedError(".relative", "the nominal value is 0; allowed: absolute instead")
    return Interval(float(nominal - half), float(nominal), float(nominal + half))


def real_names(scene_type: Any) -> list[str]:
    """Names of the parameters that may be intervals."""
    return [name for name, parameter in scene_type.parameters.items() if parameter.kind == "real"]


def no_parameter(name: str, scene_type: Any, known: Sequence[str]) -> str:
    """That a structure has no such parameter, with the likely one."""
    return (
        f"the scene {scene_type.name} has no such parameter{did_you_mean(name, known)}; "
        f"allowed: {', '.join(known)}"
    )


def parameter_problems(given: Mapping, scene_type: Any) -> list[str]:
    """What is wrong with `scene.parameters`, one sentence each."""
    problems, known = [], scene_type.parameters
    for name, value in given.items():
        if name not in known:
            told = no_parameter(name, scene_type, list(known))
        elif not allows(known[name], value):
            told = f"{show(value)} is not allowed; allowed: {known[name].allowed}"
        else:
            continue
        problems.append(f"scene.parameters.{name}: {told}")
    return problems


def allows(parameter: Any, value: Any) -> bool:
    """Whether the scene's parameter may have this value."""
    from fpm import SceneError

    try:
        parameter.check("", value)
    except SceneError:
        return False
    return True
