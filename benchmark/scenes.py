"""The scenes that are timed: the paper's linkage, and bars with and without each element kind."""

from collections.abc import Callable

import numpy as np

import fpm


def linkages(count: int, elements: int = 12) -> list[fpm.Scene]:
    """`count` samples of the paper's Bennett linkage, its section's side spread over ± 1 %."""
    build = fpm.scenes.get("bennett").build
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
    """Four bars in a row of `elements` elements each, moving across at 1 m/s, with some more.

    kinds: gravity, damping, frames (elements whose axes are not the particles'), loads (a force on
    the end of every bar), supports (one direction held at the start of every bar), points (four
    named points), hinges (bars 1 and 2, 3 and 4), springs and contacts (on these hinges).
    """
    gravity = (0.0, 0.0, -9.81) if "gravity" in kinds else (0.0, 0.0, 0.0)
    scene = fpm.Scene("bars", gravity=gravity, damping=0.5 if "damping" in kinds else 0.0)
    section, material = fpm.Section.square(0.035), fpm.Material(1e9, 0.3, 800.0)
    links = []
    for k in range(4):
        start, end = np.array([0.45 * k, 0.0, 0.0]), np.array([0.45 * (k + 1), 0.0, 0.0])
        link = scene.add_link(start, end, (0, 0, 1), section, material, elements, f"bar {k}")
        if "loads" in kinds:
            scene.add_load(int(link.particles[-1]), force=(0.0, 0.0, 1.0))
        if "points" in kinds:
            scene.add_point(f"P{k}", int(link.particles[-1]))
        links.append(link)
    if "frames" in kinds:
        tilt = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
        scene.frame = np.einsum("nij,jk->nik", scene.frame, tilt)
    if "supports" in kinds:
        for link in links:
            scene.fix(link.particles[0], translations="z", rotations="")
    scene.velocity[:] = 0.0, 1.0, 0.0
    if "hinges" in kinds:
        for k in (0, 2):
            pair = (int(links[k].particles[-1]), int(links[k + 1].particles[0]))
            at = scene.position[pair[0]]
            hinge = scene.add_hinge(f"H{k}", pair, at + np.array([0, 0, 0.02]), (0, 1, 0))
            if "springs" in kinds:
                scene.add_torsion_spring(hinge, 0.1)
            if "contacts" in kinds:
                scene.add_contact(hinge, 10.0)
    return scene
