"""The parameter values that a config asks for, and what the scene finds wrong with them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from campaign.schema_checks import did_you_mean, show


@dataclass(frozen=True)
class Interval:
    """An uncertain parameter: `lower` <= `nominal` <= `upper`, in the parameter's unit."""

    lower: float
    nominal: float
    upper: float


def intervals_of(config: Mapping, scene_type: Any) -> tuple[dict[str, Interval], list[str]]:
    """The intervals by parameter name, and one sentence for each that cannot be used."""
    found: dict[str, Interval] = {}
    problems: list[str] = []
    for name, definition in config["intervals"].items():
        try:
            found[name] = _interval(name, definition, config["scene"]["parameters"], scene_type)
        except _RefusedError as error:
            problems.append(f"intervals.{name}{error}")
    return found, problems


class _RefusedError(Exception):
    """Why an interval cannot be used; the text follows its key."""


def _interval(name: str, definition: Mapping, given: Mapping, scene_type: Any) -> Interval:
    """The interval of one parameter, inside the range that the scene allows."""
    real = [name for name, p in scene_type.parameters.items() if p.kind == "real"]
    if name not in scene_type.parameters:
        raise _RefusedError(
            f": the scene {scene_type.name} has no such parameter{did_you_mean(name, real)}; "
            f"allowed: {', '.join(real)}"
        )
    parameter = scene_type.parameters[name]
    if parameter.kind != "real":
        raise _RefusedError(
            f": {name} is a {parameter.kind} and cannot be an interval; allowed: {', '.join(real)}"
        )
    if name in given and "nominal" in definition:
        raise _RefusedError(
            f".nominal: {name} is defined twice, here and by scene.parameters.{name}; "
            "allowed: one of the two"
        )
    interval = _ends(definition, given.get(name, parameter.default))
    for end, value in (("lower", interval.lower), ("upper", interval.upper)):
        if not in_range(parameter, value):
            raise _RefusedError(
                f": its {end} end {value:.12g} leaves the range of {name}; "
                f"allowed: {allowed_range(parameter)}"
            )
    return interval


def _ends(definition: Mapping, default: Any) -> Interval:
    """The interval that a definition means; `default` is the scene's value."""
    ways = [way for way in ("relative", "absolute", "lower", "upper") if way in definition]
    if ways not in (["relative"], ["absolute"], ["lower", "upper"]):
        given = " and ".join(ways) if ways else "none of them"
        raise _RefusedError(f": it gives {given}; allowed: relative, absolute, or lower with upper")
    if ways == ["lower", "upper"]:
        lower, upper = float(definition["lower"]), float(definition["upper"])
        if lower > upper:
            raise _RefusedError(
                f".lower: {lower:.12g} is above upper {upper:.12g}; allowed: at most upper"
            )
        nominal = float(definition.get("nominal", 0.5 * (lower + upper)))
        if not lower <= nominal <= upper:
            raise _RefusedError(
                f".nominal: {nominal:.12g} is outside; allowed: {lower:.12g} to {upper:.12g}"
            )
        return Interval(lower, nominal, upper)
    nominal = definition.get("nominal", default)
    if isinstance(nominal, bool) or not isinstance(nominal, int | float):
        raise _RefusedError(".nominal: missing, and the scene has no value; allowed: a number")
    nominal = float(nominal)
    half = float(definition.get("absolute", 0.0))
    if ways == ["relative"]:
        half = abs(nominal) * float(definition["relative"])
        if half == 0.0 < definition["relative"]:
            raise _RefusedError(".relative: the nominal value is 0; allowed: absolute instead")
    return Interval(nominal - half, nominal, nominal + half)


def parameter_problems(config: Mapping, scene_type: Any) -> list[str]:
    """What is wrong with `scene.parameters`, one sentence each."""
    problems = []
    for name, value in config["scene"]["parameters"].items():
        key = f"scene.parameters.{name}"
        if name not in scene_type.parameters:
            known = list(scene_type.parameters)
            problems.append(
                f"{key}: the scene {scene_type.name} has no such parameter"
                f"{did_you_mean(name, known)}; allowed: {', '.join(known)}"
            )
        elif not in_range(scene_type.parameters[name], value):
            allowed = allowed_range(scene_type.parameters[name])
            problems.append(f"{key}: {show(value)} is not allowed; allowed: {allowed}")
    return problems


def in_range(parameter: Any, value: Any) -> bool:
    """Whether the scene's parameter may have this value."""
    if parameter.kind == "choice":
        return value in parameter.choices
    if parameter.kind == "boolean":
        return isinstance(value, bool)
    if value is None and parameter.default is None:
        return True
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    if parameter.kind == "integer" and not isinstance(value, int):
        return False
    low, high = parameter.lower, parameter.upper
    above = low is None or value > low or (value == low and not parameter.lower_open)
    below = high is None or value < high or (value == high and not parameter.upper_open)
    return above and below


def allowed_range(parameter: Any) -> str:
    """What `in_range` accepts, in words."""
    if parameter.kind == "choice":
        return "one of " + ", ".join(str(choice) for choice in parameter.choices)
    if parameter.kind == "boolean":
        return "true or false"
    words = ["a whole number" if parameter.kind == "integer" else "a number"]
    if parameter.lower is not None and parameter.lower != float("-inf"):
        words.append(f"{'above' if parameter.lower_open else 'at least'} {parameter.lower:.12g}")
    if parameter.upper is not None and parameter.upper != float("inf"):
        words.append(f"{'below' if parameter.upper_open else 'at most'} {parameter.upper:.12g}")
    unit = f" ({parameter.unit})" if parameter.unit and parameter.unit != "1" else ""
    return " ".join([words[0], " and ".join(words[1:])]).strip() + unit


def scene_values(config: Mapping, values: Mapping[str, float]) -> dict[str, Any]:
    """All parameter values that differ from the scene's defaults in the run with `values`."""
    return {**config["scene"]["parameters"], **values}
