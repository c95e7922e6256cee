"""The checks of a config that need the scene: names, ranges, consistency, responses, solver."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import Any

from campaign.parameters import Interval, all_parameters, intervals_of, parameter_problems
from campaign.schema_checks import did_you_mean, show

OWN_FIGURES = ("linkage", "sensitivities")  # those of no response


def scene_problems(config: Mapping) -> list[str]:
    """What is wrong with a config that follows the schema, one sentence each."""
    import fpm

    try:
        scene_type = fpm.scenes.get(config["scene"]["name"])
    except fpm.SceneError as error:
        return [_sentence(error.key, error)]
    problems = parameter_problems(config, scene_type)
    intervals, trouble = intervals_of(config, scene_type)
    problems += trouble
    if not problems:
        problems += _build_problems(config, scene_type, intervals)
    problems += _response_problems(config, scene_type)
    if intervals.keys() == config["intervals"].keys():
        problems += _design_problems(config, intervals)
    return problems


def corners(intervals: Mapping[str, Interval], most: int = 16) -> Iterator[dict[str, float]]:
    """The nominal values, then corners of the box; beyond `most` only both ends of each axis."""
    nominal = {name: interval.nominal for name, interval in intervals.items()}
    yield nominal
    if 2 ** len(intervals) <= most:
        ends = [dict.fromkeys((i.lower, i.upper)) for i in intervals.values()]
        for values in itertools.product(*ends):
            yield dict(zip(intervals, values, strict=True))
    else:
        for name, interval in intervals.items():
            yield {**nominal, name: interval.lower}
            yield {**nominal, name: interval.upper}


def _build_problems(config: Mapping, scene_type: Any, intervals: Mapping) -> list[str]:
    """What the scene finds inconsistent, at the nominal values or at the first bad corner."""
    import fpm

    for place, values in zip(
        itertools.chain(["nominal values"], itertools.repeat("a corner of the intervals")),
        corners(intervals),
        strict=False,
    ):
        try:
            scene_type.build(**all_parameters(config, scene_type, values))
        except fpm.SceneError as error:
            at = ", ".join(f"{name} = {value:.9g}" for name, value in values.items())
            return [f"scene: at the {place} ({at}): {error}".replace("the a corner", "a corner")]
    return []


def _response_problems(config: Mapping, scene_type: Any) -> list[str]:
    import fpm

    problems = []
    for name, definition in config["responses"].items():
        if name in OWN_FIGURES:
            problems.append(
                f"responses.{name}: a figure of every campaign has this name; allowed: another name"
            )
        try:
            fpm.responses.parse(name, definition, scene_type)
        except fpm.SceneError as error:
            problems.append(_sentence(error.key, error))
    known = list(config["responses"])
    for name in config["published"]:
        if name not in known:
            problems.append(
                f"published.{name}: there is no such response{did_you_mean(name, known)}; "
                f"allowed: {', '.join(known)}"
            )
    return problems


def _design_problems(config: Mapping, intervals: Mapping) -> list[str]:
    from campaign.adaptive import start_config
    from campaign.nodes import make_design
    from intervals import IntervalError

    problems = []
    design = config["design"]
    automatic = design["order"] == "auto"
    if automatic and design["method"] == "scan":
        problems.append("design.order: 'auto' is not allowed with scan; allowed: a whole number")
    elif automatic:
        config = start_config(config)
    problems += _bounds_problems(config["bounds"], design["order"], automatic)
    try:
        if not problems:
            made = make_design(config, intervals)
            if config["bounds"]["model"] == "spline":
                problems += _spline_problems(config, intervals, made)
    except IntervalError as error:
        problems.append(_sentence(f"design.{error.key}", error))
    solver = config["solver"]
    if solver["step"] != "auto" and solver["step"] > solver["duration"]:
        problems.append(
            f"solver.step: {solver['step']:.6g} s is longer than the duration; "
            f"allowed: auto, or at most {solver['duration']:.6g}"
        )
    return problems


def _bounds_problems(bounds: Mapping, order: Any, automatic: bool) -> list[str]:
    """What of the section `bounds` does not go together, with itself and with the order."""
    align, problems = bounds["align"], []
    if align != "none" and (automatic or order is None):
        problems.append(
            f"bounds.align: {show(align)} is not allowed with order auto or without order; "
            "allowed: none"
        )
    if bounds["model"] == "spline" and align != "none":
        problems.append(
            f"bounds.model: 'spline' is not allowed with align {align}; "
            "allowed: polynomial, or align none"
        )
    elif bounds["model"] == "spline" and automatic:
        problems.append(
            "bounds.model: 'spline' is not allowed with order auto, whose rounds need polynomials; "
            "allowed: polynomial, or a whole number as order"
        )
    if bounds["enclose"] and align == "none":
        problems.append(
            "bounds.enclose: true is not allowed with align none; "
            "allowed: false, or align stretch or shift"
        )
    return problems


def _spline_problems(config: Mapping, intervals: Mapping, design: Any) -> list[str]:
    """Whether the runs of a plan are enough, and not too many, for a spline."""
    import numpy as np

    from campaign.nodes import box_of
    from intervals import IntervalError, check_spline_runs, held_out_points

    box = box_of(intervals)
    points = [box.to_unit([interval.nominal for interval in intervals.values()])[None]]
    points.append(design.points)
    if config["design"]["method"] != "scan":
        points.append(held_out_points(box.free, config["held_out"], design.points))
    try:
        check_spline_runs(np.concatenate(points))
    except IntervalError as error:
        return [
            f"bounds.model: 'spline' is not allowed with {error.value} runs; "
            f"allowed: polynomial, or {error.allowed}"
        ]
    return []


def _sentence(key: str, error: Any) -> str:
    """An error of `fpm` or `intervals`, which know value and allowed, as a sentence."""
    return f"{key}: {show(error.value)} is not allowed; allowed: {error.allowed}"
