"""The scenes that are timed: the paper's linkage, and bars with and without each element kind."""

from collections.abc import Callable

import numpy as np

import fpm
from evidence.linkage.runs import build


def linkages(count: int, elements: int = 12) -> list[fpm.Scene]:
    """`count` samples of the paper's Bennett linkage, its section's side spread over ± 1 %."""
    sides = 0.035 * (1 + 0.01 * np.linspace(-1, 1, count)) if count > 1 else [0.035]
    return [build(elements=elements, a=float(a)) for a in sides]


def beam_count(scene: fpm.Scene) -> int:
    """Number of beam elements; the linkage's eight virtual beams are arms, and not counted."""
    return sum(len(beams.length) for beams in scene.beams)


def runner(scenes: list[fpm.Scene], steps: int, step: float, instants: int = 2) -> Callable:
    """A run of `steps` steps through the public interface, packing and recording included."""

    def run():
        for outcome in fpm.simulate(scenes, duration=steps * step, instants=instants, step=step):
            if outcome.failure is not None:
                raise outcome.failure

    return run


def bars(elements: int, *kinds: str) -> fpm.Scene:
    """Four bars in a row of so many elements each, moving across at 1 m/s, with some of KINDS."""
    scene = fpm.Scene("bars")
    section, material = fpm.Section.square(0.035), fpm.Material(1e9, 0.3, 800.0)
    links = []
    for k in range(4):
        start, end = np.array([0.45 * k, 0.0, 0.0]), np.array([0.45 * (k + 1), 0.0, 0.0])
        link = scene.add_link(start, end, (0, 0, 1), section, material, elements, f"bar {k}")
        links.append(link.particles)
    for kind in kinds:
        KINDS[kind](scene, links)
    scene.velocity[:] = 0.0, 1.0, 0.0
    return scene


def _turn_frames(scene: fpm.Scene) -> None:
    """Elements whose axes are not the particles'."""
    tilt = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    scene.frame = np.einsum("nij,jk->nik", scene.frame, tilt)


def _add_hinge(scene: fpm.Scene, first: np.ndarray, second: np.ndarray) -> None:
    pair = (int(first[-1]), int(second[0]))
    place = scene.position[pair[0]] + np.array([0, 0, 0.02])
    scene.add_hinge(f"H{len(scene.hinges)}", pair, place, (0, 1, 0))


KINDS: dict[str, Callable] = {
    "gravity": lambda scene, links: setattr(scene, "gravity", np.array([0.0, 0.0, -9.81])),
    "damping": lambda scene, links: setattr(scene, "damping", 0.5),
    "frames": lambda scene, links: _turn_frames(scene),
    "loads": lambda scene, links: [scene.add_load(x[-1], force=(0.0, 0.0, 1.0)) for x in links],
    "supports": lambda scene, links: [scene.fix(x[0], "z", "") for x in links],
    "points": lambda scene, links: [scene.add_point(f"P{x[-1]}", int(x[-1])) for x in links],
    "hinges": lambda scene, links: [_add_hinge(scene, *links[k : k + 2]) for k in (0, 2)],
    "springs": lambda scene, links: [scene.add_torsion_spring(k, 0.1) for k in (0, 1)],
    "contacts": lambda scene, links: [scene.add_contact(k, 10.0) for k in (0, 1)],
}
"""What bars can have, given their particles link by link: a force on the end of every bar, one
direction held at its start, four points, two hinges, and springs and contacts on these."""
