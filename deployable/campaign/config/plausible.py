"""What a campaign states that is allowed, but hardly meant: each told with its number and a remedy.

What its structure has of the kind is told by `fpm.structures.plausible`."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from deployable.campaign.config.own_runs import CONSTANT_TEXT, own_points
from deployable.campaign.text.numbers import code
from fpm.elements import Latch, Stop, kinds_of
from fpm.elements.openings.latch import SIDES
from fpm.scenes.timestep import find_curve_step
from fpm.structures.plausible import GIVES, extent, find_barrier, opening_text

ENDS = {"smallest": -1, "largest": 1}
"""Kinds of quantity that are ends of a curve, and the sign of what is farther out."""

FEWEST = 20
"""Number of recorded instants below which curves are hardly resolved."""

WIDEST = 10.0
"""Half width of an interval by its nominal value above which the unit is hardly meant."""

LARGEST = 100.0
"""Length that a requirement states, by the structure's extent, and end of a curve, by that of the
runs, above which it says nothing."""

SPARSEST, BRIEFEST = 30.0, 300.0
"""Second time of a curve by the duration of the runs, above which the same holds, and duration by
the length of a curve that is not a pulse, above which it is odd."""


def experiment_warnings(experiment: Any) -> Iterator[str]:
    """Yield sentences on what of intervals, design, instants and levels is hardly meant."""
    for check in (_interval_texts, _design_texts, _time_texts, _level_texts):
        yield from check(experiment)


def requirement_warnings(campaign: Any) -> Iterator[str]:
    """Yield sentences on limits of a `Campaign` that are hardly meant: those below what a quantity
    can be, times that no run can reach or none can exceed, lengths far beyond the structure's
    extent, angles of more than a turn without a motor."""
    experiment = campaign.experiment
    duration, size = experiment.solver.duration, extent(experiment.nominal_scene)
    quantities = {quantity.name: quantity for quantity in experiment.quantity_list}
    limits = [
        (f"requirements.{name}.{quantity}.{end}", end, quantities[quantity], limit)
        for name, section in campaign.requirements.items()
        for quantity, ends in section.items()
        for end, limit in ends.items()
        if end in ("at_least", "at_most")
    ]
    for key, end, quantity, limit in limits:
        least = quantity.least
        is_last = end == "at_most" and limit == duration and quantity.always_exists
        if least is not None and (limit <= least if end == "at_least" else limit < least):
            verdict = "none can meet it"
            if end == "at_least":
                is_sure = quantity.always_exists
                verdict = "no run can break it" if is_sure else "it asks only that it happens"
            yield (
                f"{key}: {limit:g}, but {quantity.name} is never below {least:g}, so that "
                f"{verdict}: take another limit"
            )
        elif _is_instant(quantity) and (limit > duration or is_last):
            verdict = "none can meet it" if end == "at_least" else "all where it happens meet it"
            if end == "at_most" and quantity.always_exists:
                verdict = "no run can break it"
            yield (
                f"{key}: {limit:g} s, but runs end at {duration:g} s, so that {verdict}: take a "
                "longer solver.duration, or another limit"
            )
        elif quantity.unit == "m" and abs(limit) > LARGEST * size > 0:
            yield (
                f"{key}: {limit:g} m, but the structure's extent is {size:.4g} m: did you mean "
                f"{limit / 1000:g}, for {limit:g} mm?"
            )
        elif quantity.unit == "rad":
            yield from _turn_texts(key, limit, experiment)
        else:
            ends = {row[1] for row in limits if row[2] is quantity}
            yield from _sign_texts(key, limit, ends, quantity, experiment.nominal_scene)


def _sign_texts(key: str, limit: float, ends: set[str], quantity: Any, scene: Any) -> Iterator[str]:
    """A limit with the wrong sign on what has one, unless its counterpart is stated. ends: of all
    limits of the quantity."""
    sign = _sign(quantity, scene)
    counterpart = ("at_least", "at_most")[sign > 0]
    if sign * limit >= 0 or counterpart in ends:
        return
    word, peak = ("positive", "negative")[sign > 0], ("smallest", "largest")[sign > 0]
    place = f", of its {peak} value" * (quantity.kind in ENDS and quantity.kind != peak)
    yield (
        f"{key}: {limit:g}, but {quantity.name} is never {word} as the joint is stopped, so that "
        f"no run can break it: did you mean {counterpart}: {-limit:g}{place}?"
    )


def _is_instant(quantity: Any) -> bool:
    """Return whether a quantity is an instant of the run, such as that of a smallest value."""
    at_peak = quantity.kind.endswith("_at") and not quantity.response.along
    return quantity.is_time or at_peak


def _sign(quantity: Any, scene: Any) -> int:
    """Return 1 or -1 if a quantity is the signed impulse of a latch, that end of its moment which
    stops the joint, or an end of the moment of a stop, and thus positive or negative, else 0."""
    response, signs = quantity.response, set()
    if response is None:
        return 0
    part = response.subjects[1] if response.kind == "joint_moment" else response.kind
    is_impulse = part == "latch_impulse" or (
        part == "latch_impact" and response.component == "signed"
    )
    if part == "stop" and quantity.kind in ENDS:
        stops = [stop for stop in Stop.find(scene) if _joint(scene, stop) == response.subjects[0]]
        return {("above",): -1, ("below",): 1}.get(tuple({stop.side for stop in stops}), 0)
    if not (is_impulse or (part in ("latch", "latch_moment") and quantity.kind in ENDS)):
        return 0
    for latch in Latch.find(scene):
        if response.subjects[0] in (latch.label(scene), _joint(scene, latch)):
            opening = scene.hinges[latch.hinge].opening
            signs.add(-1 if (SIDES[latch.side] or latch.angle - opening) > 0 else 1)
    sign = signs.pop() if len(signs) == 1 else 0
    return sign if ENDS.get(quantity.kind, sign) == sign else 0


def _joint(scene: Any, element: Any) -> str:
    return scene.hinges[element.hinge].name


def _interval_texts(experiment: Any) -> Iterator[str]:
    """Intervals without width, or much wider than their nominal values."""
    for name, interval in experiment.intervals.items():
        lower, nominal, upper = interval.lower, interval.nominal, interval.upper
        unit, default = (p := experiment.scene_type.parameters[name]).unit, p.default or 0.0
        degrees = np.degrees(nominal)
        if unit == "degree" and abs(degrees - default) < 0.01 * abs(default):
            yield f"intervals.{name}: did you mean {degrees:.4g}, for {nominal:g} rad, not deg?"
        elif lower == upper:
            yield (
                f"intervals.{name}: {lower:g} to {upper:g} has no width, so that nothing of it is "
                f"uncertain: state one, or put {name}: {lower:g} under scene.parameters, which is "
                "of all cases"
            )
        elif unit not in ("degree", "rad") and upper - lower > 2 * WIDEST * abs(nominal) > 0:
            yield (
                f"intervals.{name}: {lower:g} to {upper:g} about {nominal:g}: all are in the unit "
                f"{unit} of {name}; did you mean another width?"
            )


def _design_texts(experiment: Any) -> Iterator[str]:
    """Keys that the design does not use, and own runs that leave part of the box out."""
    design = experiment.design
    if design.method == "own":
        points = own_points(experiment)
        if names := experiment.box.constant_names(points):
            yield f"design: {CONSTANT_TEXT.format(' or '.join(map(code, names)))} Add such runs."
        values = experiment.box.from_unit(points)
        for column, (name, interval) in zip(values.T, experiment.intervals.items(), strict=True):
            low, high, ends = column.min(), column.max(), (interval.lower, interval.upper)
            margin = 0.05 * (ends[1] - ends[0])
            if name not in names and (low > ends[0] + margin or high < ends[1] - margin):
                yield (
                    f"design: the runs have {name} from {low:.4g} to {high:.4g}, and its interval "
                    f"is {ends[0]:.4g} to {ends[1]:.4g}: bounds beyond the runs are extrapolated; "
                    "add runs at its ends"
                )
    takes_samples = experiment.is_adaptive or design.method in ("sobol", "screening")
    if design.samples != type(design).samples and not takes_samples:
        yield (
            f"design.samples: {design.samples} is of sobol and screening alone, {design.method} "
            "has as many runs as its `order` takes: take that, or another `method`"
        )


def _time_texts(experiment: Any) -> Iterator[str]:
    """Too few instants for any curve, and instants beyond the end; a stated step, longer than a
    feature of a curve of time; curves that runs hardly reach."""
    solver, scene = experiment.solver, experiment.nominal_scene
    count, duration = solver.instants, solver.duration
    if count < FEWEST:
        yield (
            f"solver.instants: {count} for {duration:g} s are {duration / (count - 1):.4g} s "
            "apart, and curves between them are not seen: take 201 or more"
        )
    for quantity in experiment.quantity_list:
        if isinstance(quantity.instant, float | int) and not 0 <= quantity.instant <= duration:
            yield (
                f"quantities.{quantity.name}.at: {quantity.instant:g} s, but runs last from 0 to "
                f"{duration:g} s, so that it has no value: take an instant within, or a longer "
                "solver.duration"
            )
    feature = find_curve_step(scene, duration)
    for curve in scene.curves:
        times, values, points = curve.times, curve.values, len(curve.times)
        length, is_table = np.ptp(times), curve.powers.shape[1] < 4
        is_pulse = abs(values[-1] - values[0]) < 0.01 * np.ptp(values)
        is_pulse &= abs(1000 * length - duration) > 0.1 * duration  # else ms may be s
        is_odd = times[-1] <= 0 or times[0] >= duration
        is_odd |= points > 1 and times[1] > (SPARSEST if points > 2 else LARGEST) * duration
        is_odd |= points >= FEWEST and length > LARGEST * duration
        is_odd |= points >= FEWEST and is_table and not is_pulse and BRIEFEST * length < duration
        if np.ptp(values) and is_odd:
            yield (
                f"solver.duration: {duration:g} s, but a curve of {points} values lasts from "
                f"{times[0]:.12g} to {times[-1]:.12g} s: check the unit of its times, such as ms, "
                "and where they begin"
            )
    if solver.step != "auto" and solver.step > feature:
        yield (
            f"solver.step: {solver.step:g} s is longer than {feature:.3g} s, a quarter of the time "
            "in which a curve of time rises or falls: its mean over each step acts, but its "
            f"instant is not resolved; take auto, or at most {feature:.3g}"
        )


def _level_texts(experiment: Any) -> Iterator[str]:
    """Levels of openings that are in degrees, or that a latch or stop keeps them from."""
    scene = experiment.nominal_scene
    numbers = {hinge.name: number for number, hinge in enumerate(scene.hinges)}
    for quantity in experiment.quantity_list:
        if quantity.kind != "crossing" or quantity.response.kind != "opening":
            continue
        key, level = f"quantities.{quantity.name}.level", quantity.level
        number = numbers[quantity.response.subjects[0]]
        texts = list(_turn_texts(key, level, experiment))
        reason = find_barrier(scene, number, level, GIVES)
        if reason and not texts:
            text = opening_text(scene.hinges[number], level)
            texts = [f"{key}: {level:g}, {text}, is {reason}: take a level before that"]
        yield from texts


def _turn_texts(key: str, angle: float, experiment: Any) -> Iterator[str]:
    """An angle of more than a turn where nothing drives it on."""
    scene = experiment.nominal_scene
    is_motor = any(kind.acts_as == "motor" for kind in kinds_of([scene]))
    if abs(angle) > 2 * np.pi and not (is_motor or scene.spin.any() or scene.drives):
        text = f"{key}: {angle:g} rad are {np.degrees(angle):.4g} deg"
        if float(f"{angle:.4g}") == angle:  # as written, not converted from degrees
            yield f"{text}: did you mean {np.radians(angle):.4g}, for {angle:g} deg?"
        else:
            yield f"{text}, more than a turn, and nothing drives it so far"
