"""The checks of a config that need the scene: names, ranges, consistency, responses, solver."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any

from deployable.campaign.config.accuracy import with_accuracy
from deployable.campaign.config.answers import answer_problems, choose_of
from deployable.campaign.config.design import make_design, steps_problems
from deployable.campaign.config.kept import keep_problems
from deployable.campaign.config.models import Config
from deployable.campaign.config.parameters import intervals_of, parameter_problems
from deployable.campaign.config.read import show
from deployable.campaign.config.scenes import scene_type
from deployable.campaign.config.sections import (
    Accuracy,
    Campaign,
    DesignChoice,
    Experiment,
    Interval,
    SceneChoice,
)
from fpm.errors import did_you_mean
from fpm.files.outcome import eventful
from fpm.reading.quantity_definitions import parse
from fpm.reading.variables import numbers


def resolve(config: Config, given: Mapping) -> tuple[Campaign | None, list[str]]:
    """The campaign of a config, of which `given` are the keys that the user gave, and what is wrong
    with it, one sentence each. No campaign without a scene."""
    import fpm

    stated = config.scene
    try:
        found = scene_type(stated.name or "", stated.file or "")
    except fpm.SceneError as error:
        return None, _scene_problems(error, "scene.file")
    intervals, trouble = intervals_of(config.intervals, stated.parameters, found)
    problems = parameter_problems(stated.parameters, found) + trouble
    campaign = _campaign(config, given, found, intervals)
    if not problems:
        problems += _build_problems(campaign.experiment)
    is_built = not problems
    if is_built:
        problems += _time_problems(campaign.experiment)
    with suppress(fpm.SceneError):  # where neither it nor the structure as it stands can be built
        scene = campaign.experiment.nominal_scene if is_built else found.sample
        problems += _response_problems(campaign, scene)
    if not problems:
        problems += _memory_problems(campaign.experiment)
    if not problems:
        problems += _quantity_problems(campaign.experiment) + answer_problems(campaign)
    if not trouble:
        problems += _design_problems(campaign)
    return campaign, problems


def _campaign(config: Config, given: Mapping, found: Any, intervals: Mapping) -> Campaign:
    """The campaign of a config with a structure and the intervals of its parameters."""
    accuracy, order = Accuracy(), config.design.order
    if config.design.method == "scan" and "order" not in given.get("design", {}):
        order = None
    if config.accuracy is not None:
        config, accuracy = with_accuracy(config, found)
        order = None
    experiment = Experiment(
        name=config.campaign,
        scene=SceneChoice(found.name, config.scene.parameters, config.scene.file or ""),
        solver=config.solver,
        # In the scene's order: in which one a config has them must not matter, to no design.
        intervals={name: intervals[name] for name in found.parameters if name in intervals},
        design=DesignChoice(**vars(config.design) | {"order": order}),
        held_out=config.held_out,
        responses=config.responses,
        quantities=config.quantities,
        accuracy=accuracy,
    )
    rest = ("bounds", "published", "error", "figures", "verify", "jobs")
    return Campaign(
        experiment=experiment,
        requirements={
            name: {quantity: limits.given for quantity, limits in limited.items()}
            for name, limited in config.requirements.items()
        },
        choose=choose_of(config.choose, config.intervals),
        **{name: getattr(config, name) for name in rest},
    )


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


def _build_problems(experiment: Experiment) -> list[str]:
    """What the scene finds inconsistent, at the nominal values or at the first bad corner."""
    import fpm
    from fpm.solver.pack import topology

    first = None
    places = itertools.chain(["the nominal values"], itertools.repeat("a corner of the intervals"))
    for place, values in zip(places, corners(experiment.intervals), strict=False):
        at = ", ".join(f"{name} = {value:.9g}" for name, value in values.items())
        try:
            scene = experiment.nominal_scene if first is None else experiment.build(values)
        except fpm.SceneError as error:
            return _scene_problems(error, f"scene: at {place} ({at})", str(error))
        found = topology(scene)
        first = found if first is None else first
        if found != first:
            return [
                f"intervals: at {place} ({at}) the structure has other parts than at the nominal "
                "values; allowed: intervals over which it has the same particles, elements and "
                "supports"
            ]
    return []


MOST_NUMBERS = 2**27
"""Numbers recorded of the runs that are integrated side by side: 1 GiB."""

_LONG = 60.0  # s


def _time_problems(experiment: Experiment) -> list[str]:
    """Whether a run can be done with the step and the instants, judged at the nominal values.

    The plan checks the number of steps again, at all corners; to find the stable step here takes
    too long for every call, and is only done where there is doubt.
    """
    import fpm

    solver, problems = experiment.solver, []
    scene = experiment.nominal_scene
    if solver.step != "auto" or solver.duration > _LONG:
        limit = fpm.stable_step(scene).step
        step = solver.safety * limit if solver.step == "auto" else solver.step
        if solver.step != "auto" and solver.duration >= step > 2 * limit:
            problems.append(
                f"solver.step: {step:.6g} s is far above what is stable; allowed: auto, or below "
                f"{limit:.4g}"
            )
        problems += steps_problems(solver, step)
    return problems


def _memory_problems(experiment: Experiment) -> list[str]:
    """Whether the runs that are integrated side by side find room in memory."""
    instants, scene = experiment.solver.instants, experiment.nominal_scene
    more = numbers(scene, experiment.record) if experiment.record else 0
    found = 8 * (6 * len(scene.points) + len(scene.hinges) + 10 + more)
    if instants * found <= MOST_NUMBERS:
        return []
    return [
        f"solver.instants: {instants} are more than memory should hold of this scene"
        f"{' and what its responses ask for' if more else ''}; allowed: at most "
        f"{MOST_NUMBERS // found}"
    ]


def _response_problems(campaign: Campaign, scene: Any) -> list[str]:
    import fpm

    problems = []
    known = campaign.experiment.responses
    for name, definition in known.items():
        try:
            fpm.responses.parse(name, definition, scene)
        except fpm.SceneError as error:
            problems.append(_sentence(error.key, error))
    return problems + [
        f"published.{name}: there is no such response{did_you_mean(name, known)}; "
        f"allowed: {', '.join(known)}"
        for name in campaign.published
        if name not in known
    ]


def _quantity_problems(experiment: Experiment) -> list[str]:
    """What of the quantities cannot be read off a run of the scene."""
    if not experiment.quantities:
        return []
    elements = eventful(experiment.nominal_scene)
    _, errors = parse(experiment.quantities, experiment.curves, elements)
    return [_sentence(error.key, error) for error in errors]


def _design_problems(campaign: Campaign) -> list[str]:
    """Whether what is kept goes with the design, and whether it can be made."""
    from deployable.intervals import IntervalError

    experiment, design = campaign.experiment, campaign.experiment.design
    is_plain = design.method == "scan" and design.order is None
    has_none = experiment.is_sought or (is_plain and campaign.bounds.model == "polynomial")
    if (problems := keep_problems(campaign)) or has_none:
        return problems
    try:
        made = make_design(design, experiment.box)
    except IntervalError as error:
        return [_sentence(f"design.{error.key}", error)]
    return _spline_problems(experiment, made) if campaign.bounds.model == "spline" else []


def _spline_problems(experiment: Experiment, design: Any) -> list[str]:
    """Whether the runs of a plan are enough, and not too many, for a spline."""
    import numpy as np

    from deployable.intervals import IntervalError, check_spline_runs, held_out_points

    box = experiment.box
    points = [box.to_unit(experiment.nominal)[None], design.points]
    if experiment.design.method != "scan":
        points.append(held_out_points(box.free, experiment.held_out, design.points))
    try:
        check_spline_runs(np.concatenate(points))
    except IntervalError as error:
        return [
            f"bounds.model: 'spline' is not allowed with {error.value} runs; "
            f"allowed: polynomial, or {error.allowed}"
        ]
    return []


def _scene_problems(error: Any, key: str, text: str = "") -> list[str]:
    """A scene's error as sentences: all that is wrong with a file, or the one of a known scene."""
    if problems := getattr(error, "problems", None):
        return [f"{key}: {error.source}, {problem}" for problem in problems]
    return [f"{key}: {text}" if text else _sentence(error.key, error)]


def _sentence(key: str, error: Any) -> str:
    """An error of `fpm` or `intervals`, which know value and allowed, as a sentence."""
    return f"{key}: {show(error.value)} is not allowed; allowed: {error.allowed}"
