"""The parameter values that a config asks for, and what the scene finds wrong with them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from deployable.campaign.config.keys import RefusedError
from deployable.campaign.config.models import Around
from deployable.campaign.config.read import show
from deployable.campaign.config.sections import Interval
from fpm.errors import did_you_mean


def intervals_of(
    definitions: Mapping[str, Around], given: Mapping, scene_type: Any
) -> tuple[dict[str, Interval], list[str]]:
    """The intervals by parameter name, and one sentence for each that cannot be used.

    `given` are the parameters of the scene that the config sets.
    """
    found: dict[str, Interval] = {}
    problems: list[str] = []
    for name, definition in definitions.items():
        try:
            found[name] = _interval(name, definition, given, scene_type)
        except RefusedError as error:
            problems.append(f"intervals.{name}{error.key}: {error.text}")
    return found, problems


def _interval(name: str, around: Around, given: Mapping, scene_type: Any) -> Interval:
    """The interval of one parameter, inside the range that the scene allows."""
    real = [name for name, p in scene_type.parameters.items() if p.kind == "real"]
    if name not in scene_type.parameters:
        raise RefusedError(
            text=f"the scene {scene_type.name} has no such parameter{did_you_mean(name, real)}; "
            f"allowed: {', '.join(real)}"
        )
    parameter = scene_type.parameters[name]
    if parameter.kind != "real":
        raise RefusedError(
            text=f"{name} is of kind {parameter.kind} and cannot be an interval; "
            f"allowed: {', '.join(real)}"
        )
    if name in given and around.nominal is not None:
        raise RefusedError(
            ".nominal",
            f"{name} is defined twice, here and by scene.parameters.{name}; "
            "allowed: one of the two",
        )
    interval = _ends(around, given.get(name, parameter.default))
    for end, value in (("lower", interval.lower), ("upper", interval.upper)):
        if not _allows(parameter, value):
            raise RefusedError(
                text=f"its {end} end {value:.12g} leaves the range of {name}; "
                f"allowed: {parameter.allowed}"
            )
    return interval


def _ends(around: Around, default: Any) -> Interval:
    """The interval that is meant; `default` is the scene's value."""
    lower, nominal, upper = around.lower, around.nominal, around.upper
    if lower is not None:
        return Interval(lower, 0.5 * (lower + upper) if nominal is None else nominal, upper)
    nominal = default if nominal is None else nominal
    if isinstance(nominal, bool) or not isinstance(nominal, int | float):
        raise RefusedError(".nominal", "missing, and the scene has no value; allowed: a number")
    nominal = float(nominal)
    half = around.absolute
    if half is None:
        half = abs(nominal) * around.relative
        if half == 0.0 < around.relative:
            raise RefusedError(".relative", "the nominal value is 0; allowed: absolute instead")
    return Interval(nominal - half, nominal, nominal + half)


def parameter_problems(given: Mapping, scene_type: Any) -> list[str]:
    """What is wrong with `scene.parameters`, one sentence each."""
    problems = []
    for name, value in given.items():
        key = f"scene.parameters.{name}"
        if name not in scene_type.parameters:
            known = list(scene_type.parameters)
            problems.append(
                f"{key}: the scene {scene_type.name} has no such parameter"
                f"{did_you_mean(name, known)}; allowed: {', '.join(known)}"
            )
        elif not _allows(parameter := scene_type.parameters[name], value):
            problems.append(f"{key}: {show(value)} is not allowed; allowed: {parameter.allowed}")
    return problems


def _allows(parameter: Any, value: Any) -> bool:
    """Whether the scene's parameter may have this value."""
    from fpm import SceneError

    try:
        parameter.check("", value)
    except SceneError:
        return False
    return True
