"""Scenes moved, mirrored, scaled, reordered and turned back in time, for the property tests."""

from copy import copy
from dataclasses import replace

import fpm
from fpm.elements import Friction, Latch, Release, RigidFriction, RigidLatch, RigidRelease


def continued(scene: fpm.Scene, outcome: fpm.Outcome, direction: float) -> fpm.Scene:
    """The scene at the end of a run, moving on (direction 1) or back (-1).

    For kinds whose elements are where their particles are: a latch that caught, the foot of a
    bristle, or a cable's material that slipped is nothing that a scene can state.
    """
    remembering = {Friction, Latch, Release, RigidFriction, RigidLatch, RigidRelease}
    remembering &= scene.kinds.keys()
    assert not remembering and not any(cable.has_friction for cable in scene.cables), remembering
    out, final = copy(scene), outcome.final
    out.unstrained = scene.frame if scene.unstrained is None else scene.unstrained
    out.position, out.frame = final.position, final.frame
    out.velocity, out.spin = direction * final.velocity, direction * final.spin
    openings = [float(opening[-1]) for opening in outcome.openings.values()]
    out.hinges = [replace(h, opening=x) for h, x in zip(scene.hinges, openings, strict=True)]
    return out
