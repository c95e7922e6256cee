"""Checks of a config that need the scene, as of names, ranges, responses and requirements."""

import itertools
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import fpm
from deployable.campaign.config.measured import resolve_tests
from deployable.campaign.config.models import Aim, Config
from deployable.campaign.config.own_runs import OwnRunsError, key_problems
from deployable.campaign.config.read import sentence, show
from deployable.campaign.config.resolve import (
    allows,
    campaign_of,
    intervals_of,
    parameter_problems,
    real_names,
    unknown,
)
from deployable.campaign.config.sections import (
    BY_STANDARD,
    LARGE,
    OWN_RUNS,
    Campaign,
    Choose,
    Experiment,
    bytes_of_run,
    corners,
    count_first_runs,
    design_points,
    make_design,
    most_instants,
    scene_type,
    steps_problems,
    widen_intervals,
)
from deployable.campaign.text.numbers import size_text
from deployable.intervals import IntervalError, check_spline_runs, held_out_points
from deployable.intervals.box import MAX_DIMENSION, MOST_FULL
from deployable.intervals.scalars.requirements import ENDS
from fpm.errors import likely
from fpm.files.outcome import eventful
from fpm.reading.margins import find_drives, read_label, travel_of
from fpm.reading.quantity_definitions import parse
from fpm.solver.pack import topology
from fpm.structures.plausible import GIVES, find_barrier, opening_text
from fpm.travel.components import springs_of

EXCLUSIVE = ("design", "bounds", "held_out")
"""Keys that a config with `accuracy` must not have: it chooses what they say."""


def resolve(config: Config, user_config: Mapping) -> tuple[Campaign | None, list[str]]:
    """Resolve a checked config into a campaign and check it against its structure; returns the
    campaign, None if the structure cannot be read, and a sentence for each problem."""
    section = config.scene
    try:
        structure = scene_type(section.name or "", section.file or "")
    except fpm.SceneError as error:
        return None, [*_scene_problems(error, "scene.file")]
    intervals, trouble = intervals_of(config.intervals, section.parameters, structure)
    problems = [*parameter_problems("scene.parameters", section.parameters, structure), *trouble]
    campaign = campaign_of(config, user_config, structure, intervals)
    problems += key_problems(user_config)
    if not problems:
        problems += _build_problems(campaign.experiment)
    is_built = not problems
    if is_built:
        problems += _time_problems(campaign.experiment)
    with suppress(fpm.SceneError):  # where neither it nor the structure as it stands can be built
        scene = campaign.experiment.nominal_scene if is_built else structure.sample
        problems += _response_problems(campaign, scene, config.margins)
    if not problems and config.margins:
        problems += _travel_problems(campaign.experiment)
    if not problems:
        problems += _run_problems(campaign)
    if not problems and campaign.experiment.is_adaptive:
        campaign, problems = _keep_choice_runs(campaign)
    if not problems and config.measured:
        tests, problems = resolve_tests(config.measured, campaign.experiment)
        campaign = replace(campaign, measured=tests)
    if not trouble:
        problems += _design_problems(campaign)
    return campaign, problems


def _build_problems(experiment: Experiment) -> Iterator[str]:
    """Describe the first inconsistency that the scene finds, at the nominal values or a corner."""
    first = None
    places = itertools.chain(["the nominal values"], itertools.repeat("a corner of the intervals"))
    for place, values in zip(places, corners(experiment.intervals), strict=False):
        point = ", ".join(f"{name} = {value:.9g}" for name, value in values.items())
        try:
            scene = experiment.nominal_scene if first is None else experiment.build(values)
        except fpm.SceneError as error:
            yield from _scene_problems(error, f"scene: at {place} ({point})", str(error))
            return
        scene_topology = topology(scene)
        first = scene_topology if first is None else first
        if scene_topology != first:
            yield (
                f"intervals: at {place} ({point}) the structure has other parts than at the "
                "nominal values; allowed: intervals over which it has the same particles, elements "
                "and supports"
            )
            return


_LONG = 60.0  # s


def _time_problems(experiment: Experiment) -> Iterator[str]:
    """Check at nominal values that step and instants allow a run; the plan checks corners."""
    solver, scene = experiment.solver, experiment.nominal_scene
    if solver.step != "auto" or solver.duration > _LONG:
        limit = fpm.find_stable_step(scene).step
        step = solver.safety * limit if solver.step == "auto" else solver.step
        if solver.step != "auto" and solver.duration >= step > 2 * limit:
            yield (
                f"solver.step: {step:.6g} s is far above what is stable; allowed: auto, or below "
                f"{limit:.4g}"
            )
        yield from steps_problems(solver, step)


def _response_problems(campaign: Campaign, scene: Any, margins: Mapping) -> Iterator[str]:
    responses = campaign.experiment.responses
    for name, definition in responses.items():
        if name not in margins and name.removesuffix(BY_STANDARD) in margins:
            continue  # what is wrong with it is told of the margin that it stands beside
        try:
            fpm.responses.parse(name, definition, scene)
        except fpm.SceneError as error:
            key = error.key
            if name in margins:  # as its section has it
                key = re.sub(rf"^responses\.{name}\.(margin|with)\b", f"margins.{name}.along", key)
                key = key.replace(f"responses.{name}", f"margins.{name}")
            yield sentence(key, error)
    for name in (name for name in campaign.published if name not in responses):
        yield f"published.{name}: {unknown(name, 'response', responses)}"


def _travel_problems(experiment: Experiment) -> Iterator[str]:
    """Describe travels that the structure cannot make, at the nominal values and a few positions,
    or that a latch or a stop keeps well before their ends, and wrong evidence of a spring out."""
    scene = experiment.nominal_scene
    hinges = [hinge.name for hinge in scene.hinges]
    for curve in (curve for curve in experiment.response_list if curve.kind == "margin"):
        path, _ = read_label(curve.columns[0][1])
        key, number = f"margins.{curve.name}", hinges.index(path.openings[0])
        if reason := find_barrier(scene, number, curve.along.last, GIVES):
            text = opening_text(scene.hinges[number], curve.along.last)
            yield f"{key}.to: {text} is {reason}; allowed: an opening before that"
            continue
        try:
            drives = find_drives(travel_of(scene, path, positions=9).work)
        except fpm.SceneError as error:
            yield sentence(f"{key}.along", error)
            continue
        springs = [name for name in springs_of(scene) if name in drives]
        inactive = list(experiment.responses[curve.name].get("without", ()))
        is_one = len(springs) > 1 and len(inactive) == 1 and inactive[0] in springs
        if "spring out" in curve.subjects and not is_one:
            remedy = (
                f"`without` one of {', '.join(springs)}" if len(springs) > 1 else "other evidence"
            )
            yield (
                f"{key}.evidence: 'spring out' is of one of several springs that drive, and "
                f"{' and '.join(inactive) or 'nothing'} is out; allowed: {remedy}"
            )


def _design_problems(campaign: Campaign) -> Iterator[str]:
    """Check that the disk has room for a large scan, that the design can be made, and that it has
    as many runs as the model of the bounds needs."""
    experiment = campaign.experiment
    design, box = experiment.design, experiment.box
    if design.method == "sobol" and design.samples > LARGE:
        size, room = bytes_of_run(campaign), shutil.disk_usage(Path.cwd()).free
        if design.samples > (most := int(room / size)):
            text = f"{design.samples} runs with jobs.keep {campaign.jobs.keep} take about "
            text += f"{size_text(design.samples * size)}, and the disk has {size_text(room)}"
            yield f"design.samples: {text}; allowed: at most {most}"
            return
    if experiment.is_adaptive:
        return
    model, is_own = campaign.bounds.model, design.method == OWN_RUNS
    is_plain = design.method == "sobol" and design.order is None
    has_none = is_plain and model in ("auto", "polynomial")
    try:
        nodes = make_design(experiment, replace(design, samples=2) if has_none else design).points
    except OwnRunsError as error:
        yield f"design.{error}"
        return
    except IntervalError as error:
        yield sentence(f"design.{error.key}", error)
        return
    if is_own and model == "polynomial":
        text = "'polynomial' is not allowed with runs of your own"
        yield f"bounds.model: {text}; allowed: auto, spline, aligned"
    elif is_own or (not has_none and model in ("spline", "aligned")):
        if box.free.sum() > MOST_FULL:
            text = f"{model!r} is not allowed with {box.free.sum()} intervals; allowed: polynomial"
            yield f"bounds.model: {text}"
            return
        points = [box.to_unit(experiment.nominal)[None], nodes]
        if design.method != "sobol":
            points.append(held_out_points(box.free, experiment.held_out, nodes))
        try:
            check_spline_runs(np.concatenate(points))
        except IntervalError as error:
            text = f"bounds.model: {model!r} is not allowed with {error.value} runs"
            text = f"{text}; allowed: polynomial, or {error.allowed}"
            own_text = f"design: {error.value} runs with the nominal one do not determine a model"
            yield f"{own_text}; allowed: {error.allowed}" if is_own else text


def _scene_problems(error: Any, key: str, text: str = "") -> Iterator[str]:
    """Turn a scene's error into sentences: all problems of a file, or the one of a known scene."""
    problems = getattr(error, "problems", ())
    for problem in problems:
        is_missing = not Path(error.source).exists()
        allowed = "; allowed: a path from the folder of the campaign's file" * is_missing
        yield f"{key}: {error.source}, {problem}{allowed}"
    if not problems:
        yield f"{key}: {text}" if text else sentence(error.key, error)


def accuracy_problems(config: Config, user_config: Mapping) -> Iterator[str]:
    """Check the section `accuracy` of a config: yields a sentence for each key beside it that it
    would choose itself, and each unknown name in it. user_config: the config without defaults."""
    if config.accuracy is None:
        return
    for key in (key for key in EXCLUSIVE if key in user_config):
        yield f"{key}: accuracy makes this choice itself; allowed: {key} or accuracy, not both"
    if len(config.intervals) > MOST_FULL:
        yield (
            f"accuracy: not allowed with {len(config.intervals)} intervals; allowed: up to "
            f"{MOST_FULL} intervals, or design.method: screening for up to {MAX_DIMENSION}"
        )
    names = [*config.responses, *config.quantities]
    tolerances = config.accuracy.tolerance_by_name if isinstance(config.accuracy, Aim) else ()
    for name in (name for name in tolerances if name not in names):
        text = unknown(name, "response or quantity", names)
        yield f"accuracy.tolerance_by_name.{name}: {text}"


def _keep_choice_runs(campaign: Campaign) -> tuple[Campaign, list[str]]:
    """Return the campaign, whose `accuracy` keeps the runs of its choice; what `max_runs` lacks."""
    experiment, reserve = campaign.experiment, 0
    if campaign.choose.parameters:
        reserve = len(design_points(widen_intervals(experiment, campaign.choose), campaign.choose))
    accuracy = replace(experiment.accuracy, reserve=reserve)
    experiment = replace(experiment, accuracy=accuracy)
    least, most = 2 * (int(experiment.box.free.sum()) + 1), accuracy.max_runs
    missing = least - count_first_runs(experiment)
    problems = [
        f"accuracy.max_runs: {most} are too few for the first runs and a check of step and mesh"
        f"{', and those of the choice' if reserve else ''}; allowed: at least {most + missing}"
    ] * (missing > 0)
    return replace(campaign, experiment=experiment), problems


def _run_problems(campaign: Campaign) -> Iterator[str]:
    """Check what is taken of runs that can be made: whether those side by side find room in memory,
    and the sections `quantities`, `requirements`, `choose`."""
    experiment, quantities = campaign.experiment, campaign.experiment.quantities
    instants, most = experiment.solver.instants, most_instants(experiment)
    if instants > most:
        text = " and what its responses ask for" * bool(experiment.record)
        text = f"{instants} are more than memory should hold of this scene{text}"
        yield f"solver.instants: {text}; allowed: at most {most}"
        return
    elements = eventful(experiment.nominal_scene) if quantities else ()
    _, errors = parse(quantities, experiment.response_list, elements)
    yield from (sentence(error.key, error) for error in errors)
    for name, limits in campaign.requirements.items():
        for quantity in (quantity for quantity in limits if quantity not in quantities):
            text = unknown(quantity, "quantity", quantities)
            if quantity in experiment.responses:
                example = f"`quantities: {{largest_{quantity}: {{largest: {quantity}}}}}`"
                text = f"this is a response; allowed: a quantity, such as {example}"
            yield f"requirements.{name}.{quantity}: {text}"
    if campaign.choose.parameters:
        problems = [*_choose_problems(experiment, campaign.choose)]
        yield from problems
        if not problems and len({*experiment.intervals, *campaign.choose.parameters}) > 8:
            yield "choose.parameters: more than 8 with the intervals; allowed: fewer"


def _choose_problems(experiment: Experiment, choose: Choose) -> Iterator[str]:
    goals, quantities, scene = choose.goals, experiment.quantities, experiment.scene_type
    if not 1 <= len(goals) <= 2:
        hint = f" (add one, such as `minimise: upper({next(iter(quantities), 'q')})`)" * (not goals)
        yield f"choose: it has {len(goals) or 'no'} goals{hint}; allowed: one or two"
    for sign, end, quantity in goals:
        key = f"choose.{'minimise' if sign > 0 else 'maximise'}"
        if end not in ENDS or not quantity:
            text = f"{end}({quantity})" if quantity else end
            goal = (ENDS[0], end) if end in quantities else (likely(end, ENDS), quantity)
            hint = " (did you mean {}({})?)".format(*goal) * all(goal)
            allowed = f"{', '.join(f'{word}(q)' for word in ENDS)} of a quantity q"
            yield f"{key}: {text!r} is not allowed{hint}; allowed: {allowed}"
        elif quantity not in quantities:
            yield f"{key}: {unknown(quantity, 'quantity', quantities)}"
    for name, (low, high) in choose.parameters.items():
        key, real = f"choose.parameters.{name}", real_names(scene)
        if name not in real:
            yield f"{key}: {unknown(name, 'real parameter', real)}"
        elif not low < high:
            text = "is not allowed; allowed: first the lower end, then the upper end"
            yield f"{key}: {show([low, high])} {text}"
        else:
            parameter = scene.parameters[name]
            ends = [end for end in choose.ends(name, experiment) if not allows(parameter, end)]
            text = "with its interval, extends beyond the range; allowed:"
            yield from (f"{key}: {end:.9g}, {text} {parameter.allowed}" for end in ends[:1])
