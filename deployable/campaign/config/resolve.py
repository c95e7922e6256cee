"""From a config to its campaign: names, numbers and defaults in place of what it leaves open."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any, cast

from deployable.campaign.config.keys import RefusedError
from deployable.campaign.config.models import Aim, BoundsChoice, Config, IntervalSpec, Limits
from deployable.campaign.config.own_runs import file_digest
from deployable.campaign.config.read import sentence, show
from deployable.campaign.config.sections import (
    ADAPTIVE,
    BY_STANDARD,
    OWN_RUNS,
    Accuracy,
    Campaign,
    Choose,
    DesignChoice,
    Experiment,
    Interval,
    SceneChoice,
)
from fpm import SceneError
from fpm.arithmetic.units import number_hint
from fpm.errors import did_you_mean
from fpm.reading.margins import OPTIONAL
from fpm.reading.responses import KINDS, kind_of

FACTOR_KEYS = ("uncertainty_factors", "actuation_factors", "classes")
"""Keys of a margin by which it is no longer that of its standard."""


def campaign_of(
    config: Config, user_config: Mapping, structure: Any, intervals: Mapping
) -> Campaign:
    """Resolve a checked config into a campaign, with numbers for what it leaves open. user_config:
    without defaults; structure: the `SceneType`; intervals: resolved, by name."""
    accuracy = Accuracy()
    order: int | None = config.design.order
    design = user_config.get("design", {})
    if config.design.method in ("sobol", "screening") and "order" not in design:
        order = None
    method, held_out, digest = config.design.method, config.held_out, ""
    if config.design.file or config.design.values:
        method, order, held_out = cast(Any, OWN_RUNS), None, 0
        digest = file_digest(config.design.file)
    if config.accuracy is not None:
        config, accuracy = with_accuracy(config, structure)
        method, order, held_out = config.design.method, None, config.held_out
    experiment = Experiment(
        name=config.campaign,
        scene=SceneChoice(structure.name, config.scene.parameters, config.scene.file or ""),
        solver=config.solver,
        # In the scene's order: in which one a config has them must not matter, to no design.
        intervals={name: intervals[name] for name in structure.parameters if name in intervals},
        design=DesignChoice(
            **vars(config.design) | {"order": order, "method": method, "digest": digest}
        ),
        held_out=held_out,
        responses=config.responses,
        quantities=config.quantities,
        accuracy=accuracy,
        display=config.display,
    )
    specs = {name: config.intervals.get(name) for name in config.choose.parameters}
    goals = (config.choose.minimise, config.choose.maximise)
    minimise, maximise = ((goal,) if isinstance(goal, str) else goal for goal in goals)
    relative = tuple(name for name, spec in specs.items() if spec and spec.relative is not None)
    rest = ("bounds", "published", "review", "verify", "jobs")
    return Campaign(
        experiment=experiment,
        requirements={
            name: {quantity: limits.by_name for quantity, limits in section.items()}
            for name, section in config.requirements.items()
        },
        choose=Choose(config.choose.parameters, minimise, maximise, relative),
        **{name: getattr(config, name) for name in rest},
    )


BRIEFLY = {"duration": 1e-3, "instants": 201}
"""What a campaign of margins alone takes of a motion that tells nothing, if nothing is said."""


def with_margins(config: Config, solver: Mapping) -> tuple[Config, list[str]]:
    """Turn `margins` into responses, quantities of their least values, and requirements that these
    be at least 0 unless the config requires something else; returns the new config and problems.
    solver: as the user wrote it; without a duration and other responses runs simulate 1 ms."""
    if not (config.responses or config.quantities or "duration" in solver):
        brief: dict[str, Any] = {key: value for key, value in BRIEFLY.items() if key not in solver}
        config = replace(config, solver=replace(config.solver, **brief))
    responses, quantities = dict(config.responses), dict(config.quantities)
    requirements, problems = dict(config.requirements), []
    standards = _by_standard(config)
    for name, definition in {**config.margins, **standards}.items():
        least, standard = f"{name}_least", name + BY_STANDARD
        try:
            if standard in standards.keys() & config.margins.keys():
                text = f"its margin by the standard's factors is to be called {standard}, which is "
                raise RefusedError("", f"{text}taken; allowed: another name")
            responses[name] = _response_of_margin(name, definition, config)
            quantities[least] = {"smallest": name}
            is_required = any(least in limits for limits in requirements.values())
            if name in config.margins and not is_required:
                label = f"{name}_margin" if name in requirements else name
                if label in requirements:
                    text = f"there are requirements.{name} and requirements.{label}, and that of "
                    text += f"{least} needs one of these names; allowed: another name, or a "
                    raise RefusedError("", f"{text}requirement of {least}")
                requirements[label] = {least: Limits(at_least=0.0)}
        except RefusedError as error:
            problems.append(f"margins.{name}: {error.text}")
        except SceneError as error:
            if name in config.margins:  # else it is told of the one that it stands beside
                problems.append(sentence(error.key, error))
    config = replace(config, responses=responses, quantities=quantities, requirements=requirements)
    return config, problems


def _by_standard(config: Config) -> dict[str, dict]:
    """Margins by the standard's factors, of which a review tells beside those by others."""
    return {
        name + BY_STANDARD: {k: v for k, v in definition.items() if k not in FACTOR_KEYS}
        for name, definition in (config.margins if config.review else {}).items()
        if {*FACTOR_KEYS} & definition.keys()
    }


_MARGIN = KINDS["margin"]._replace(optional=tuple(k for k in OPTIONAL if k != "with"))
"""Keys of a margin in a config, where `along` stands for the response's `margin` and `with`."""


def _response_of_margin(name: str, definition: Mapping, config: Config) -> dict[str, Any]:
    """Return the definition of the response that a margin, whose keys are checked, is."""
    conflicts = [f"responses.{name}"] * (name in config.responses)
    conflicts += [f"quantities.{name}_least"] * (f"{name}_least" in config.quantities)
    if conflicts:
        raise RefusedError("", f"there is {' and '.join(conflicts)}; allowed: another name")
    openings = definition.get("along")
    first, *followers = openings if isinstance(openings, list) and openings else [openings]
    if not all(isinstance(opening, str) for opening in (first, *followers)):
        allowed = "the opening that is moved, or a list of those that are moved together"
        raise SceneError(f"margins.{name}.along", openings, allowed)
    kind_of(f"margins.{name}", definition, {"along": _MARGIN})
    rest = {key: value for key, value in definition.items() if key != "along"}
    return {"margin": first, **({"with": followers} if followers else {}), **rest}


def with_accuracy(config: Config, scene_type: Any) -> tuple[Config, Accuracy]:
    """Replace what the `accuracy` of a config decides (mesh, design, model of the bounds, checks);
    returns the new config, and the `Accuracy` with a tolerance for every response and quantity. The
    mesh starts at half of the default, unless the config gives it. scene_type: `fpm` structure."""
    aim, scene, mesh = config.accuracy, config.scene, scene_type.mesh
    aim = aim if isinstance(aim, Aim) else Aim(tolerance=aim)
    if mesh is None or mesh in scene.parameters:
        mesh = ""
    else:
        parameter = scene_type.parameters[mesh]
        start = int(max(parameter.least, 2, parameter.default // 2))
        scene = replace(scene, parameters={**scene.parameters, mesh: start})
    names = [*config.responses, *config.quantities]
    tolerances = {name: aim.tolerance_by_name.get(name, aim.tolerance) for name in names}
    config = replace(
        config,
        scene=scene,
        design=DesignChoice(cast(Any, ADAPTIVE), None),
        bounds=BoundsChoice("auto"),
        held_out=0,
        verify=replace(config.verify, discretization=True),
    )
    return config, Accuracy(tolerances, aim.max_runs, aim.max_core_minutes, mesh)


def intervals_of(
    specs: Mapping[str, IntervalSpec], scene_values: Mapping, scene_type: Any
) -> tuple[dict[str, Interval], list[str]]:
    """Resolve the section `intervals`: returns them by name, and a sentence for each bad one."""
    intervals: dict[str, Interval] = {}
    problems: list[str] = []
    for name, spec in specs.items():
        try:
            intervals[name] = _interval(name, spec, scene_values, scene_type)
        except RefusedError as error:
            problems.append(f"intervals.{name}{error.key}: {error.text}")
    return intervals, problems


def _interval(name: str, spec: IntervalSpec, scene_values: Mapping, scene_type: Any) -> Interval:
    """Return the interval of one parameter, inside the range that the scene allows."""
    real, parameter = real_names(scene_type), scene_type.parameters.get(name)
    if parameter is None:
        raise RefusedError("", _unknown_parameter(name, scene_type, real))
    if parameter.is_whole:
        text = f"{name} is a whole number and cannot be an interval"
        text = f"{text} (give one value under scene.parameters, or several as cases)"
        raise RefusedError("", f"{text}; allowed: {', '.join(real)}")
    if name in scene_values and spec.nominal is not None:
        text = f"{name} is defined twice, here and by scene.parameters.{name}"
        raise RefusedError(".nominal", f"{text}; allowed: one of the two")
    nominal = spec.nominal
    if spec.lower is not None:
        middle = 0.5 * (spec.lower + spec.upper) if nominal is None else nominal
        interval = Interval(spec.lower, middle, spec.upper)
    else:
        nominal = scene_values.get(name, parameter.default) if nominal is None else nominal
        if isinstance(nominal, bool) or not isinstance(nominal, int | float):
            raise RefusedError(".nominal", "missing, and the scene has no value; allowed: a number")
        half = abs(nominal) * spec.relative if spec.absolute is None else spec.absolute
        if spec.absolute is None and half == 0.0 < spec.relative:
            raise RefusedError(".relative", "the nominal value is 0; allowed: absolute instead")
        interval = Interval(float(nominal - half), float(nominal), float(nominal + half))
    for end, value in (("lower", interval.lower), ("upper", interval.upper)):
        if not allows(parameter, value):
            text = f"its {end} end, {value:.12g}, lies outside the range of {name}"
            if spec.relative is not None and spec.relative >= 1:
                text += f" (did you mean {spec.relative / 100:g}, for {spec.relative:g} %?)"
            raise RefusedError("", f"{text}; allowed: {parameter.allowed}")
    return interval


def real_names(scene_type: Any) -> list[str]:
    """List a structure's real-valued parameters, which may be intervals; scene_type: its type."""
    return [name for name, parameter in scene_type.parameters.items() if not parameter.is_whole]


def unknown(name: str, noun: str, names: Iterable[str], likely: Iterable[str] = ()) -> str:
    """Write the end of a message about an unknown name: that there is no such `noun`, a hint such
    as the most similar name, and all allowed `names`; likely: names to suggest before others."""
    guess = " or ".join(likely)
    hint = f" (did you mean {guess}?)" if guess else did_you_mean(name, names)
    return f"there is no such {noun}{hint}; allowed: {', '.join(names) or 'none'}"


def _unknown_parameter(name: str, scene_type: Any, names: Iterable[str]) -> str:
    """As `unknown`, of a structure's parameter, whose description may have the name as a word."""
    words = [(n, re.findall(r"\w+", scene_type.parameters[n].text.lower())) for n in names]
    likely = [n for n, text in words if name.lower() in text]
    return unknown(name, f"parameter of {scene_type.name}", names, likely)


def parameter_problems(key: str, values: Mapping, scene_type: Any) -> Iterator[str]:
    """Check values of a structure's parameters that a section of the config called `key` sets."""
    parameters = scene_type.parameters
    for name, value in values.items():
        if name not in parameters:
            yield f"{key}.{name}: {_unknown_parameter(name, scene_type, parameters)}"
        elif not allows(parameters[name], value):
            hint = number_hint(value, with_unit=False) if isinstance(value, str) else ""
            text = f"{show(value)} is not allowed{hint}; allowed: {parameters[name].allowed}"
            yield f"{key}.{name}: {text}"


def allows(parameter: Any, value: Any) -> bool:
    """Return whether a parameter of an `fpm` structure (`Parameter`) may have a value."""
    try:
        parameter.check("", value)
    except SceneError:
        return False
    return True
