"""Assembly: parts whose points do not meet are forced together, and lie in balance, at rest.

Among all positions in which every joint is closed, one is sought in which the strain energy of the
beams is least (search.py). Springs, cables, gravity and loads act from the start of a run, not
before."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fpm.assembly.conditions import tilts
from fpm.assembly.element_forces import BalanceForces
from fpm.assembly.search import MisfitError, RestSearch, Words


class Assembly(NamedTuple):
    """Result of `assemble`. energy: strain energy after it (J); joint, gap, tilt: of the joint most
    open before it, name, distance of points (m) and largest angle (rad); rounds: of Newton steps;
    openings: joint coordinates of scene.hinges before (rad; m of slides)."""

    energy: float
    joint: str
    gap: float
    tilt: float
    rounds: int
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
        poses, rounds = search.relax()
    flips = {name: angle for name, angle in tilts(scene, poses, hold).items() if angle > np.pi / 2}
    if flips:  # the residuals, cosines of right angles, are 0 there too
        allowed = "directions of both parts that agree; reverse that of one part"
        raise MisfitError(f"joint {min(flips)}", "opposite directions of its parts", allowed)
    if scene.unstrained is None:  # else it was assembled before
        scene.unstrained, scene.unstrained_position = scene.frame, scene.position
    scene.position, scene.frame = poses.position, poses.frame
    scene.hinges = search.reopen(poses)
    scene.assembly = Assembly(
        balance.bars.energy(poses), *search.open_before, rounds, tuple(openings.values())
    )
