"""The scenes that are timed: the paper's linkage, and bars with and without each element kind."""

from collections.abc import Callable

import numpy as np

import fpm
from evidence.linkage.runs import build


def linkages(count: int, elements: int = 12) -> list[fpm.Scene]:
    """`count` samples of the paper's Bennett linkage, its section's side spread over ± 1 %."""
    sides = 0.035 * (1 + 0.01 * np.linspace(-1, 1, count)) if count > 1 else [0.035]
    return [build(elements_per_link=elements, a=float(a)) for a in sides]


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


def _gravity(scene, links):
    scene.gravity = np.array([0.0, 0.0, -9.81])


def _damping(scene, links):
    scene.damping = 0.5


def _frames(scene, links):
    """Elements whose axes are not the particles'."""
    tilt = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    scene.frame = np.einsum("nij,jk->nik", scene.frame, tilt)


def _loads(scene, links):
    """A force on the end of every bar."""
    for link in links:
        scene.add_load(int(link[-1]), force=(0.0, 0.0, 1.0))


def _supports(scene, links):
    """One direction held at the start of every bar."""
    for link in links:
        scene.fix(link[0], translations="z", rotations="")


def _points(scene, links):
    for k, link in enumerate(links):
        scene.add_point(f"P{k}", int(link[-1]))


def _hinges(scene, links):
    """Between bars 1 and 2, and 3 and 4."""
    for k in (0, 2):
        pair = (int(links[k][-1]), int(links[k + 1][0]))
        at = scene.position[pair[0]] + np.array([0, 0, 0.02])
        scene.add_hinge(f"H{k}", pair, at, (0, 1, 0))


def _springs(scene, links):
    for hinge in range(2):
        scene.add_torsion_spring(hinge, 0.1)


def _contacts(scene, links):
    for hinge in range(2):
        scene.add_contact(hinge, 10.0)


KINDS = {
    "gravity": _gravity,
    "damping": _damping,
    "frames": _frames,
    "loads": _loads,
    "supports": _supports,
    "points": _points,
    "hinges": _hinges,
    "springs": _springs,
    "contacts": _contacts,
}
"""What bars can have; springs and contacts are on the hinges."""
