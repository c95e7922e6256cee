"""Scenes moved, mirrored, scaled, reordered and turned back in time, for the property tests."""

from copy import copy
from dataclasses import replace

import numpy as np

import fpm
from fpm.elements import Friction, Latch, Release
from fpm.elements.joints.hinge import Hinge
from fpm.elements.kind import VirtualBeam


def moved(scene: fpm.Scene, rotation: np.ndarray, shift: np.ndarray) -> fpm.Scene:
    """The scene turned by a rotation (3, 3), then moved by a shift (3,) m.

    What a scene keeps in global axes is supports, loads and weight; supports along some axes only
    can be turned onto global axes only, by a rotation that permutes them.
    """
    out = copy(scene)
    out.position = scene.position @ rotation.T + shift
    out.frame = rotation @ scene.frame
    out.velocity = scene.velocity @ rotation.T
    out.spin = scene.spin @ rotation.T
    out.gravity = rotation @ scene.gravity
    out.beams = [replace(b, triad=rotation @ b.triad) for b in scene.beams]
    out.hinges = [replace(h, support=turned_axes(h.support, rotation)) for h in scene.hinges]
    out.loads = [
        replace(x, force=rotation @ x.force, moment=rotation @ x.moment) for x in scene.loads
    ]
    return out


def turned_axes(support: str, rotation: np.ndarray) -> str:
    """Names of the global axes onto which a rotation takes the global axes in `support`."""
    if support in ("", "xyz"):
        return support
    images = [np.abs(rotation[:, "xyz".index(axis)]) for axis in support]
    assert all(image.max() > 1 - 1e-12 for image in images), "not an axis of the grid"
    return "".join(sorted("xyz"[int(image.argmax())] for image in images))


def mirrored(scene: fpm.Scene, normal: int) -> fpm.Scene:
    """The mirror image in the plane through the origin that is normal to a global axis (0, 1, 2).

    Axes of particles and elements stay right-handed: their third axis is turned round. Spins,
    moments and hinge axes change sign once more than vectors do.
    """
    world, own = np.eye(3), np.diag([1.0, 1.0, -1.0])
    world[normal, normal] = -1.0
    out = copy(scene)
    out.position = scene.position @ world
    out.frame = world @ scene.frame @ own
    out.velocity = scene.velocity @ world
    out.spin = -scene.spin @ world
    out.gravity = world @ scene.gravity
    out.beams = [replace(b, triad=world @ b.triad @ own) for b in scene.beams]
    out.hinges = [
        replace(
            h,
            beams=tuple(VirtualBeam(b.particle, own @ b.arm) for b in h.beams),
            axes=-h.axes @ own,
            references=h.references @ own,
        )
        for h in scene.hinges
    ]
    out.loads = [
        replace(
            x,
            beam=VirtualBeam(x.beam.particle, own @ x.beam.arm),
            force=world @ x.force,
            moment=-world @ x.moment,
        )
        for x in scene.loads
    ]
    out.points = {k: VirtualBeam(p.particle, own @ p.arm) for k, p in scene.points.items()}
    return out


def continued(scene: fpm.Scene, outcome: fpm.Outcome, direction: float) -> fpm.Scene:
    """The scene at the end of a run, moving on (direction 1) or back (-1).

    For kinds whose elements are where their particles are: a latch that caught, the foot of a
    bristle, or a cable's material that slipped is nothing that a scene can state.
    """
    remembering = {Friction, Latch, Release}
    remembering &= scene.kinds.keys()
    assert not remembering and not any(cable.has_friction for cable in scene.cables), remembering
    out, final = copy(scene), outcome.final
    out.unstrained = scene.frame if scene.unstrained is None else scene.unstrained
    out.position, out.frame = final.position, final.frame
    out.velocity, out.spin = direction * final.velocity, direction * final.spin
    openings = [float(opening[-1]) for opening in outcome.openings.values()]
    out.hinges = [replace(h, opening=x) for h, x in zip(scene.hinges, openings, strict=True)]
    return out


def reordered(scene: fpm.Scene, random: np.random.Generator) -> fpm.Scene:
    """The same structure with its particles, elements and hinges in another order."""
    n = len(scene.mass)
    old = random.permutation(n)  # old index of each new particle
    new = np.argsort(old)
    out = copy(scene)
    for name in ("position", "frame", "velocity", "spin", "mass", "inertia", "fixed"):
        setattr(out, name, getattr(scene, name)[old])

    def arm(beam: VirtualBeam) -> VirtualBeam:
        return VirtualBeam(int(new[beam.particle]), beam.arm)

    def hinge(h: Hinge) -> Hinge:
        return replace(h, beams=tuple(arm(b) for b in h.beams))

    out.beams = []
    for i in random.permutation(len(scene.beams)):
        b = scene.beams[i]
        rows = random.permutation(len(b.length))
        out.beams.append(
            replace(b, nodes=new[b.nodes[rows]], length=b.length[rows], triad=b.triad[rows])
        )
    order = random.permutation(len(scene.hinges))
    place = np.argsort(order)
    out.hinges = [hinge(scene.hinges[i]) for i in order]
    out.springs = [replace(s, hinge=int(place[s.hinge])) for s in scene.springs]
    out.contacts = [replace(c, hinge=int(place[c.hinge])) for c in scene.contacts]
    out.loads = [replace(x, beam=arm(x.beam)) for x in scene.loads]
    out.points = {k: arm(p) for k, p in scene.points.items()}
    return out
