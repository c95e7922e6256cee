"""Assembly: parts whose points do not meet are forced together, and lie in balance, at rest.

Among all positions in which every joint is closed, one is sought in which the strain energy of the
beams is least (search.py). Springs, cables, gravity and loads act from the start of a run, not
before.

`balance` finds the nearest stable equilibrium. Weight, loads at t = 0, springs, stops, struts,
cables, elastic motors and releases and the strain of bars are in balance then, by the elements' own
kernels; what holds openings exactly holds them. Friction and dampers give no force at rest; latches
have not caught."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from fpm.assembly.conditions import tilts
from fpm.assembly.element_forces import BalanceForces, ElementForces, acts
from fpm.assembly.search import MisfitError, RestSearch, Words
from fpm.elements import Drag, Journal, Load, Motor, Release, Stop, TorsionSpring, kinds_of


class Assembly(NamedTuple):
    """Result of `assemble`. energy: strain energy after it (J); joint, gap, tilt: of the joint most
    open before it, name, distance of points (m) and largest angle (rad); openings: joint
    coordinates of scene.hinges before (rad; m of slides)."""

    energy: float
    joint: str
    gap: float
    tilt: float
    openings: tuple[float, ...]


def assemble(scene, hold: Sequence[str] = ()) -> None:
    """Force a scene's parts (changed in place) together at its joints, in static balance, at rest.
    Beams keep lengths and axes without stress; points stated later refer to the scene before. hold:
    names of hinges whose joint coordinate stays as stated. MisfitError where no balance is
    found."""
    if not len(scene.position):
        return
    words = Words(
        "assembly",
        "parts that can be forced together",
        "parts that come to rest when forced together; a mechanism may need a joint that is held, "
        "a bar without stress that is bent far may need more elements",
        "`curvature` of the bar",
    )
    openings = {hinge.name: hinge.opening for hinge in scene.hinges}
    balance, targets = BalanceForces(scene, []), {name: openings.get(name, 0.0) for name in hold}
    search = RestSearch(scene, targets, balance, words)
    with np.errstate(over="ignore", invalid="ignore"):  # what grows beyond all numbers is refused
        poses = search.relax()
    flips = {name: angle for name, angle in tilts(scene, poses, hold).items() if angle > np.pi / 2}
    if flips:  # the residuals, cosines of right angles, are 0 there too
        allowed = "directions of both parts that agree; reverse that of one part"
        raise MisfitError(f"joint {min(flips)}", "opposite directions of its parts", allowed)
    if scene.unstrained is None:  # else it was assembled before
        scene.unstrained, scene.unstrained_position = scene.frame, scene.position
    scene.position, scene.frame = poses.position, poses.frame
    scene.hinges = search.reopen(poses)
    energy = balance.bars.energy(poses)
    scene.assembly = Assembly(energy, *search.open_before, tuple(openings.values()))


class Equilibrium(NamedTuple):
    """Result of `balance`. openings: joint coordinates of scene.hinges before (rad; m of slides);
    imbalance: largest force (N) or moment (N m) left on a particle; largest: that elements of one
    type give; energy: of bars (J); motion: farthest of a particle (m)."""

    openings: tuple[float, ...]
    imbalance: float
    largest: float
    energy: float
    motion: float


def balance(scene, hold: Mapping[str, float]) -> None:
    """Bring a scene (changed in place) into the nearest stable static equilibrium downhill in
    energy.

    Joints stay closed, beams keep lengths and axes without stress. hold: joint coordinates (rad; m)
    of hinges that are held, by name, to which they are led; what moves or keeps openings exactly
    has to be among them. MisfitError where nothing comes to rest, as a body that falls."""
    words = Words(
        "start",
        "equilibrium",
        "what comes to rest: by a support, joint, spring or other load against that",
        "a stated position to its side, or `curvature` of the bar,",
    )
    search = RestSearch(scene, hold, _forces_at_start(scene), words)
    with np.errstate(over="ignore", invalid="ignore"):
        poses = search.relax()
    openings = tuple(hinge.opening for hinge in scene.hinges)
    motion = float(np.linalg.norm(poses.position - scene.position, axis=1).max(initial=0.0))
    scene.equilibrium = Equilibrium(openings, *search.measure(poses), motion)
    if scene.unstrained is None:
        scene.unstrained, scene.unstrained_position = scene.frame, scene.position
    scene.position, scene.frame = poses.position, poses.frame
    scene.hinges = [
        replace(hinge, opening=hold.get(hinge.name, hinge.opening))
        for hinge in search.reopen(poses)
    ]


def _forces_at_start(scene) -> BalanceForces:
    """Collect the forces at a scene's start: bars, and all elements that store energy or load it,
    but friction and latches. Pins with play have no friction or damping."""
    elements: dict[type[Any], Any] = {
        kind: kind.sweep_elements(scene)
        for kind in kinds_of([scene])
        if acts(kind) and (kind.stores or kind.gives) and kind.resists_as not in ("", "FR")
    }
    for kind, springs in _springs_at_start(scene).items():
        elements[kind] = [*kind.find(scene), *springs]
    elements[Journal] = [replace(p, friction=0.0, restitution=1.0) for p in Journal.find(scene)]
    elements[Drag] = [drag for drag in Drag.find(scene) if np.any(drag.wind)]
    sources = []
    for kind, group in elements.items():
        turns = []  # degrees of freedom that change what acts at the ends of arms
        if kind in (Load, Drag):
            turns = [6 * element.particle + axis for element in group for axis in (3, 4, 5)]
        sources += [ElementForces(scene, group, turns)] if group else []
    return BalanceForces(scene, sources)


def _springs_at_start(scene) -> dict[type[Any], list]:
    """Return, by type, springs (with backlash, stops) in place of elastic motors and releases."""
    springs = [TorsionSpring(r.hinge, r.stiffness, r.hold) for r in Release.find(scene)]
    stops = []
    for motor in Motor.find(scene):
        factor = scene.curve(motor.curve).value(0.0)
        rest = motor.start + (0.0 if motor.by_rate else motor.turn * float(factor))
        if motor.backlash is None:
            springs.append(TorsionSpring(motor.hinge, motor.stiffness, rest))
        else:
            for side, sign in (("above", 0.5), ("below", -0.5)):
                limit = rest + sign * motor.backlash
                stops.append(Stop(motor.hinge, limit, side, motor.stiffness))
    return {TorsionSpring: springs, Stop: stops}
