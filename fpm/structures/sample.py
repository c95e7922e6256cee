"""Samples of a structure: the values of its parameters become a scene.

Where values differ in what acts only (springs, cables, motions), all else is built once, for a
first sample, and the others share it (`share_parts`). Else each is built on its own."""

from collections.abc import Callable, Collection, Iterable, Mapping
from copy import copy

import numpy as np

from fpm.assembly import MisfitError, assemble, balance
from fpm.elements import Gravity
from fpm.elements.batch import turns_of
from fpm.elements.joints.turn import Turn
from fpm.elements.openings.opening import turning_at_start, unit_of
from fpm.errors import SceneError
from fpm.scenes.scene import Scene
from fpm.solver.start import check_masses, consistent_scene
from fpm.structures.builder import Body, Builder, Ground, Point
from fpm.structures.model import FileStatements
from fpm.structures.plausible import find_doubts, find_far_point
from fpm.structures.reading import Problems, SkippedError
from fpm.structures.statement import PARTS, Entry

RATE_TOL = 1e-6
"""Share of the fastest opening by which a stated rate may be missed at the start."""

FIRST_GROUPS = ("materials", "sections", *PARTS, "masses", "supports", "joints", "curves", "drives")
"""Groups that are built before parts are forced together, which drives hold as supports do."""

LATE_GROUPS = ("actions", "loads", "drags", "cables", "struts")
"""Groups that only add elements, which nothing else refers to but others of these groups."""

MOTIONS = "initial_velocities"
"""Group that is built last: as rigid bodies, from where the parts are."""


def build_sample(model: FileStatements, values: Mapping[str, float], problems: Problems) -> Builder:
    """Build one sample of a structure file; its Builder's `scene` is complete if `problems` is
    empty. values: of parameters by name (SI units)."""
    build = Builder(problems)
    with np.errstate(all="ignore"):
        find_numbers(build, model, values, model.names.order)
        points = _place(build, model)
        build.scene = _scene(build, model)
        build.scene.doubts += find_far_point(points)
        for entry in model.entries:
            if entry.statement.group in FIRST_GROUPS:
                build_entry(build, entry)
        _assemble(build, model)
        for entry in sorted(model.entries, key=lambda entry: entry.statement.type == "release"):
            if entry.statement.group not in (*FIRST_GROUPS, MOTIONS):
                build_entry(build, entry)  # releases last: they may watch a latch
        if build.gravity_curve and not build.problems:
            build.scene.kinds[Gravity] = [Gravity(build.scene.gravity, build.gravity_curve(build))]
        _balance(build, model)
        for entry in model.entries:
            if entry.statement.group == MOTIONS:
                build_entry(build, entry)
        finish(build, model)
    return build


def find_numbers(build: Builder, model: FileStatements, values: Mapping, names: Iterable) -> None:
    """Set the `numbers` of a Builder, and note which have no value. values: of parameters by name
    (SI units); names: of numbers, each after those it depends on."""
    for name in names:
        number = model.names.numbers[name]
        if name in values:
            build.numbers[name] = float(values[name])
        elif number.count is not None:
            build.numbers[name] = number.count
        elif number.bound is not None:
            try:
                build.numbers[name] = build.number(number.bound, number.key)
            except SceneError as error:
                _note(build, number.line, number.key, error)
            except SkippedError:
                pass


def _place(build: Builder, model: FileStatements) -> dict[str, np.ndarray]:
    """Store the points of a sample; returns their positions (3,), m, by name."""
    positions = {}
    for name in model.points:
        axes = [build.numbers.get(f"{name}.{axis}") for axis in "xyz"]
        place = build.numbers.get(f"point {name}", None if None in axes else axes)
        if place is not None:
            positions[name] = np.array(place)
            build.store("points", name, Point(name, positions[name]))
    if positions:
        build.size = float(np.ptp(list(positions.values()), axis=0).max())
    return positions


def _scene(build: Builder, model: FileStatements) -> Scene:
    try:
        scene = model.overall.statement.build(build, model.overall.values(build))
    except SkippedError:
        scene = Scene(model.overall.name)
    except SceneError as error:
        model.overall.refuse(error, build.problems)
        scene = Scene(model.overall.name)
    if "parts:ground" in model.names.uses:
        ground = int(scene.add_particles((0.0, 0.0, 0.0), 1.0, 1.0)[0])
        scene.fix(ground)
        build.store("parts", "ground", Ground("ground", {}))
    return scene


def build_entry(build: Builder, entry: Entry) -> None:
    """Add what an entry states to a sample, or note why it cannot be."""
    group, count0 = entry.statement.group, len(build.scene.position)
    counts = {kind: len(elements) for kind, elements in build.scene.kinds.items()}
    try:
        values = entry.values(build)
        value = entry.statement.build(build, values)
    except SkippedError:
        return
    except SceneError as error:
        entry.refuse(error, build.problems)
        return
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        _note(build, entry.line, entry.key, SceneError("", str(error), "possible numbers"))
        return
    build.scene.doubts += find_doubts(group, values, build.size)
    new: list[tuple[type, int]] = []
    for kind, elements in build.scene.kinds.items() if group in LATE_GROUPS else ():
        new += [(kind, i) for i in range(counts.get(kind, 0), len(elements))]
    build.additions[group, entry.name] = new
    if group == "actions":
        build.scene.action_names |= dict.fromkeys(new, entry.name)
    if word := vars(values).get("class"):
        classes = build.scene.classes if word == "S" else {}  # hysteresis of a spring is hysteresis
        build.scene.classes |= {element: classes.get(element, word) for element in new}
    if isinstance(value, Body):
        value.particles = np.arange(count0, len(build.scene.position))
        build.store("parts", entry.name, value)
    build.store(group, entry.name, value)


def _assemble(build: Builder, model: FileStatements) -> None:
    """Force parts together that do not meet, if the file asks for it."""
    if build.hold is None or build.problems:
        return
    line = model.overall.node.lines.get("assemble", 0)
    try:
        assemble(build.scene, [build.scene.hinges[hinge].name for hinge in build.hold(build)])
    except MisfitError as error:
        _note(build, line, f"assemble: {error.key}", error)
    except SceneError as error:
        _note(build, line, error.key, error)


def _balance(build: Builder, model: FileStatements) -> None:
    """Bring the sample into equilibrium, if the file asks for it."""
    scene = build.scene
    if not build.is_balanced or build.problems:
        return
    hinges = [h.hinge for h in Turn.find(scene) if h.rate_at_start(scene) is not None]
    hinges += build.hold(build) if build.hold else []
    openings = {h: build.openings.get(h, scene.hinges[h].opening) for h in hinges}
    try:
        balance(scene, {scene.hinges[h].name: opening for h, opening in openings.items()})
    except MisfitError as error:
        _note(build, model.overall.node.lines.get("start", 0), error.key, error)


def finish(build: Builder, model: FileStatements) -> None:
    """Check a sample as a whole, and note what is wrong."""
    scene = build.scene
    numbers = (scene.position, scene.mass, scene.inertia, scene.velocity, scene.gravity)
    if not all(np.isfinite(x).all() for x in numbers):
        build.problems.say(0, "the structure has masses or lengths that are not finite")
    if build.problems:
        return
    for check, group in ((check_masses, "bodies"), (turns_of, "supports")):
        try:
            check(scene)
        except SceneError as error:
            _note(build, 0, f"{group}: {error.key}", error)
            return
    _check_rates(build, model)
    parts = [entry for entry in model.entries if entry.statement.group in PARTS]
    moving: set[str] = set()
    for entry in model.entries:
        if entry.statement.group == MOTIONS:
            moving |= entry.uses
    for entry in parts if len(parts) > 1 else ():
        particles = build.find("parts", entry.name).particles
        is_held = build.joints_of.keys() & particles.tolist() or scene.fixed[particles].any()
        if not (is_held or f"parts:{entry.name}" in moving):
            text = f"{entry.key}: nothing joins it to anything; allowed: parts with a joint, a "
            text += "cable, a strut, a support, a drive or initial_velocities"
            build.problems.say(entry.line, text)


def _check_rates(build: Builder, model: FileStatements) -> None:
    """Refuse rates of openings at the start that joints, motors, drives and supports forbid."""
    opening_rates = build.scene.opening_rates
    rates = turning_at_start(consistent_scene(build.scene), opening_rates) if opening_rates else []
    motion = build.scene.spin, build.scene.velocity / (build.size or 1.0)
    fastest = (float(np.abs(values).max(initial=0.0)) for values in motion)
    largest = max(*map(abs, [*opening_rates.values(), *rates]), *fastest)
    entries = [entry for entry in model.entries if entry.statement.group == "opening_rates"]
    for entry, (hinge, rate), actual in zip(entries, opening_rates.items(), rates, strict=True):
        if abs(actual - rate) > RATE_TOL * largest:
            allowed = _allowed_rate(build.scene, hinge)
            build.problems.refuse(entry.node.lines["rate"], f"{entry.key}.rate", rate, allowed)


def _allowed_rate(scene: Scene, number: int) -> str:
    """Say which rate at the start a joint may have, and what leaves it that."""
    for holder in Turn.find(scene):
        rate = holder.rate_at_start(scene) if holder.hinge == number else None
        if rate is not None:
            unit = unit_of(scene, number, "rad/s")
            place = next(i for i, e in enumerate(type(holder).find(scene)) if e is holder)
            name = scene.action_names.get((type(holder), place), scene.hinges[number].name)
            return f"{rate:.6g} {unit}, to which {holder.noun} {name} holds it"
    return (
        "a rate that joints, motors, drives, supports and the other `opening_rates` leave it: "
        "state that of one joint for each way to move, none where a motor or drive moves it"
    )


def _note(build: Builder, line: int, key: str, error: SceneError) -> None:
    """Turn an error into a problem of the file."""
    build.problems.refuse(line, key, error.value, error.allowed)


def share_parts(
    model: FileStatements, values: Mapping[str, float], parameters: Collection[str]
) -> Callable[[Mapping[str, float]], Scene | None]:
    """Return a function of the values of a sample (SI units, by name) that differ from `values`,
    those of a first one, in some `parameters` only. It returns the sample's scene, to the bits of
    `build_sample`, with arrays shared by all samples; None: build it on its own, as one that is
    refused, or has other elements."""
    dependents = model.names.dependents(parameters)
    numbers = [name for name in model.names.order if name in dependents]
    entries = _entries_of(model, dependents)
    if entries is None:
        return lambda values: None
    first = build_sample(model, values, first_problems := Problems(""))
    if first_problems:
        return lambda values: None
    for array in vars(first.scene).values():
        if isinstance(array, np.ndarray):
            array.flags.writeable = False
    is_moved = any(entry.statement.group == MOTIONS for entry in entries)

    def build(values: Mapping[str, float]) -> Scene | None:
        sample, scene, problems = copy(first), copy(first.scene), Problems("")
        sample.problems, sample.scene, sample.additions = problems, scene, {}
        sample.numbers, scene.doubts = dict(first.numbers), list(first.scene.doubts)
        kinds = {kind: list(elements) for kind, elements in first.scene.kinds.items()}
        if is_moved:
            scene.velocity, scene.spin = scene.velocity.copy(), scene.spin.copy()
        with np.errstate(all="ignore"):
            find_numbers(sample, model, values, numbers)
            for entry in entries:
                elements = first.additions[entry.statement.group, entry.name]
                counts: dict[type, int] = {}
                for kind, i in elements:
                    counts.setdefault(kind, i)
                # Without these, and those of their types that come later.
                scene.kinds = {k: x[: counts.get(k, len(x))] for k, x in kinds.items()}
                build_entry(sample, entry)
                if problems or sample.additions[entry.statement.group, entry.name] != elements:
                    return None
                for kind, i in elements:
                    kinds[kind][i] = scene.kinds[kind][i]
            scene.kinds = kinds
            if is_moved:
                finish(sample, model)
        return None if problems or scene.doubts != first.scene.doubts else scene

    return build


def _entries_of(model: FileStatements, numbers: set[str]) -> list[Entry] | None:
    """Return the entries that depend on numbers, by name, in the order in which they are built;
    None where one of them may not be built again."""
    points = {f"{name}.{axis}" for name in model.points for axis in "xyz"}
    points |= {f"point {name}" for name in model.points}
    has_rates = any(entry.statement.group == "opening_rates" for entry in model.entries)
    if "start" in model.overall.read or has_rates or not points.isdisjoint(numbers):
        return None
    entries, uses = [], set(numbers)
    for entry in sorted(model.entries, key=lambda entry: entry.statement.type == "release"):
        group = entry.statement.group
        if not entry.uses.isdisjoint(uses):
            if group not in (*LATE_GROUPS, MOTIONS) or entry.statement.type == "bearing":
                return None
            entries.append(entry)
            uses.add(f"{group}:{entry.name}")
    if not model.overall.uses.isdisjoint(uses):
        return None
    # Motions are built last, and all if one is: a later one replaces an earlier one of its part.
    actions = [entry for entry in entries if entry.statement.group != MOTIONS]
    motions = [entry for entry in model.entries if entry.statement.group == MOTIONS]
    return actions if len(actions) == len(entries) else actions + motions
