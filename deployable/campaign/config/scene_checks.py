"""Checks of a config that need the scene, as of names, ranges, responses and requirements."""

import itertools
import re
import shutil
from collections.abc import Mapping
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
        return None, _scene_problems(error, "scene.file")
    intervals, trouble = intervals_of(config.intervals, section.parameters, structure)
    problems = parameter_problems("scene.parameters", section.parameters, structure) + trouble
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


def _build_problems(experiment: Experiment) -> list[str]:
    """Describe inconsistencies that the scene finds at the nominal values or at the first bad
    corner."""
    first = None
    places = itertools.chain(["the nominal values"], itertools.repeat("a corner of the intervals"))
    for place, values in zip(places, corners(experiment.intervals), strict=False):
        point = ", ".join(f"{name} = {value:.9g}" for name, value in values.items())
        try:
            scene = experiment.nominal_scene if first is None else experiment.build(values)
        except fpm.SceneError as error:
            return _scene_problems(error, f"scene: at {place} ({point})", str(error))
        scene_topology = topology(scene)
        first = scene_topology if first is None else first
        if scene_topology != first:
            return [
                f"intervals: at {place} ({point}) the structure has other parts than at the "
                "nominal values; allowed: intervals over which it has the same particles, elements "
                "and supports"
            ]
    return []


_LONG = 60.0  # s


def _time_problems(experiment: Experiment) -> list[str]:
    """Return whether step and instants allow a run, judged at nominal values; the plan checks
    corners."""
    solver, problems = experiment.solver, []
    scene = experiment.nominal_scene
    if solver.step != "auto" or solver.duration > _LONG:
        limit = fpm.find_stable_step(scene).step
        step = solver.safety * limit if solver.step == "auto" else solver.step
        if solver.step != "auto" and solver.duration >= step > 2 * limit:
            problems.append(
                f"solver.step: {step:.6g} s is far above what is stable; allowed: auto, or below "
                f"{limit:.4g}"
            )
        problems += steps_problems(solver, step)
    return problems


def _response_problems(campaign: Campaign, scene: Any, margins: Mapping) -> list[str]:
    problems = []
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
            problems.append(sentence(key, error))
    names = [name for name in campaign.published if name not in responses]
    return problems + [f"published.{n}: {unknown(n, 'response', responses)}" for n in names]


def _travel_problems(experiment: Experiment) -> list[str]:
    """Describe travels that the structure cannot make, at the nominal values and a few positions,
    or that a latch or a stop keeps well before their ends."""
    from fpm.structures.plausible import GIVES, find_barrier, opening_text

    problems, scene = [], experiment.nominal_scene
    for curve in experiment.response_list:
        if curve.kind == "margin":
            path, _ = read_label(curve.columns[0][1])
            number = [hinge.name for hinge in scene.hinges].index(path.openings[0])
            if reason := find_barrier(scene, number, curve.along.last, GIVES):
                text = opening_text(scene.hinges[number], curve.along.last)
                text = f"{text} is {reason}; allowed: an opening before that"
                problems.append(f"margins.{curve.name}.to: {text}")
                continue
            try:
                travel = travel_of(scene, path, positions=9)
            except fpm.SceneError as error:
                problems.append(sentence(f"margins.{curve.name}.along", error))
                continue
            problems += _spring_out_problems(experiment, curve, travel.work)
    return problems


def _spring_out_problems(experiment: Experiment, curve: Any, work: Mapping) -> list[str]:
    """Return whether a margin by the factors of a spring that is out is without one, of several."""
    if "spring out" not in curve.subjects:
        return []
    drive = find_drives(work)
    springs = [name for name in springs_of(experiment.nominal_scene) if name in drive]
    inactive = list(experiment.responses[curve.name].get("without", ()))
    if len(springs) > 1 and len(inactive) == 1 and inactive[0] in springs:
        return []
    allowed = f"`without` one of {', '.join(springs)}" if len(springs) > 1 else "other evidence"
    return [
        f"margins.{curve.name}.evidence: 'spring out' is of one of several springs that drive, "
        f"and {' and '.join(inactive) or 'nothing'} is out; allowed: {allowed}"
    ]


def _design_problems(campaign: Campaign) -> list[str]:
    """Return whether what is kept goes with the design, and whether it can be made."""
    experiment, design = campaign.experiment, campaign.experiment.design
    is_plain = design.method == "sobol" and design.order is None
    has_none = is_plain and campaign.bounds.model in ("auto", "polynomial")
    if (problems := _room_problems(campaign)) or experiment.is_adaptive:
        return problems
    try:
        choice = replace(design, samples=2) if has_none else design
        node_design = make_design(experiment, choice)
    except OwnRunsError as error:
        return [f"design.{error}"]
    except IntervalError as error:
        return [sentence(f"design.{error.key}", error)]
    if design.method == OWN_RUNS and campaign.bounds.model == "polynomial":
        text = "'polynomial' is not allowed with runs of your own"
        return [f"bounds.model: {text}; allowed: auto, spline, aligned"]
    is_spline = not has_none and campaign.bounds.model in ("spline", "aligned")
    is_spline = is_spline or design.method == OWN_RUNS
    return _spline_problems(campaign, node_design) if is_spline else []


def _spline_problems(campaign: Campaign, design: Any) -> list[str]:
    """Describe the problem if a plan has too few or too many runs for a spline."""
    experiment, model, box = campaign.experiment, campaign.bounds.model, campaign.experiment.box
    if box.free.sum() > MOST_FULL:
        text = f"{model!r} is not allowed with {box.free.sum()} intervals; allowed: polynomial"
        return [f"bounds.model: {text}"]
    points = [box.to_unit(experiment.nominal)[None], design.points]
    if experiment.design.method != "sobol":
        points.append(held_out_points(box.free, experiment.held_out, design.points))
    try:
        check_spline_runs(np.concatenate(points))
    except IntervalError as error:
        if experiment.design.method == OWN_RUNS:
            text = "with the nominal one do not determine a model"
            return [f"design: {error.value} runs {text}; allowed: {error.allowed}"]
        text = f"bounds.model: {model!r} is not allowed with {error.value} runs"
        return [f"{text}; allowed: polynomial, or {error.allowed}"]
    return []


def _scene_problems(error: Any, key: str, text: str = "") -> list[str]:
    """Turn a scene's error into sentences: all problems of a file, or the one of a known scene."""
    if problems := getattr(error, "problems", None):
        is_missing = not Path(error.source).exists()
        allowed = "; allowed: a path from the folder of the campaign's file" * is_missing
        return [f"{key}: {error.source}, {problem}{allowed}" for problem in problems]
    return [f"{key}: {text}" if text else sentence(error.key, error)]


def accuracy_problems(config: Config, user_config: Mapping) -> list[str]:
    """Check the section `accuracy` of a config: returns a sentence for each key beside it that it
    would choose itself, and each unknown name in it. user_config: the config without defaults."""
    if config.accuracy is None:
        return []
    text = "accuracy makes this choice itself; allowed: {key} or accuracy, not both"
    problems = [f"{key}: {text.format(key=key)}" for key in EXCLUSIVE if key in user_config]
    if len(config.intervals) > MOST_FULL:
        problems.append(
            f"accuracy: not allowed with {len(config.intervals)} intervals; allowed: up to "
            f"{MOST_FULL} intervals, or design.method: screening for up to {MAX_DIMENSION}"
        )
    names = [*config.responses, *config.quantities]
    tolerances = config.accuracy.tolerance_by_name if isinstance(config.accuracy, Aim) else ()
    key, noun = "accuracy.tolerance_by_name", "response or quantity"
    wrong = [name for name in tolerances if name not in names]
    return problems + [f"{key}.{name}: {unknown(name, noun, names)}" for name in wrong]


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


def _run_problems(campaign: Campaign) -> list[str]:
    """Check what is taken of runs that can be made: whether those side by side find room in memory,
    and the sections `quantities`, `requirements`, `choose`."""
    experiment, quantities = campaign.experiment, campaign.experiment.quantities
    instants, most = experiment.solver.instants, most_instants(experiment)
    if instants > most:
        text = " and what its responses ask for" * bool(experiment.record)
        text = f"{instants} are more than memory should hold of this scene{text}"
        return [f"solver.instants: {text}; allowed: at most {most}"]
    elements = eventful(experiment.nominal_scene) if quantities else ()
    _, errors = parse(quantities, experiment.response_list, elements)
    problems = [sentence(error.key, error) for error in errors]
    for name, limits in campaign.requirements.items():
        for quantity in limits:
            if quantity not in quantities:
                text = unknown(quantity, "quantity", quantities)
                if quantity in experiment.responses:
                    example = f"`quantities: {{largest_{quantity}: {{largest: {quantity}}}}}`"
                    text = f"this is a response; allowed: a quantity, such as {example}"
                problems.append(f"requirements.{name}.{quantity}: {text}")
    if campaign.choose.parameters:
        problems += _choose_problems(experiment, campaign.choose)
    return problems


def _choose_problems(experiment: Experiment, choose: Choose) -> list[str]:
    problems, goals, quantities = [], choose.goals, experiment.quantities
    if not 1 <= len(goals) <= 2:
        hint = f" (add one, such as `minimise: upper({next(iter(quantities), 'q')})`)" * (not goals)
        problems.append(f"choose: it has {len(goals) or 'no'} goals{hint}; allowed: one or two")
    for sign, end, quantity in goals:
        key = f"choose.{'minimise' if sign > 0 else 'maximise'}"
        if end not in ENDS or not quantity:
            text = f"{end}({quantity})" if quantity else end
            goal = (ENDS[0], end) if end in quantities else (likely(end, ENDS), quantity)
            hint = " (did you mean {}({})?)".format(*goal) * all(goal)
            allowed = f"{', '.join(f'{word}(q)' for word in ENDS)} of a quantity q"
            problems.append(f"{key}: {text!r} is not allowed{hint}; allowed: {allowed}")
        elif quantity not in quantities:
            problems.append(f"{key}: {unknown(quantity, 'quantity', quantities)}")
    for name in choose.parameters:
        if text := _choice_problem(name, choose, experiment):
            problems.append(f"choose.parameters.{name}: {text}")
    if not problems and len({*experiment.intervals, *choose.parameters}) > 8:
        problems.append("choose.parameters: more than 8 with the intervals; allowed: fewer")
    return problems


def _choice_problem(name: str, choose: Choose, experiment: Experiment) -> str:
    """Describe the problem with the range of a parameter's choices, if there is one."""
    scene, (low, high) = experiment.scene_type, choose.parameters[name]
    if name not in (real := real_names(scene)):
        return unknown(name, "real parameter", real)
    if not low < high:
        return (
            f"{show([low, high])} is not allowed; allowed: first the lower end, then the upper end"
        )
    parameter = scene.parameters[name]
    for value in choose.ends(name, experiment):
        if not allows(parameter, value):
            text = f"{value:.9g}, with its interval, leaves the range"
            return f"{text}; allowed: {parameter.allowed}"
    return ""


def _room_problems(campaign: Campaign) -> list[str]:
    """Check that the disk has room for a large scan: returns a sentence, in a list, if not."""
    design = campaign.experiment.design
    if design.method != "sobol" or design.samples <= LARGE:
        return []
    size, room = bytes_of_run(campaign), shutil.disk_usage(Path.cwd()).free
    if design.samples <= (most := int(room / size)):
        return []
    text = f"{design.samples} runs with jobs.keep {campaign.jobs.keep} take about "
    text += f"{size_text(design.samples * size)}, and the disk has {size_text(room)}"
    return [f"design.samples: {text}; allowed: at most {most}"]
