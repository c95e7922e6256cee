"""The stable step that fpm.stable_step gives, against the true limit found by bisection."""

from collections.abc import Iterator

import numpy as np

import fpm
from evidence.extremes.true_limit import disturb, true_limit
from evidence.linkage.runs import build as bennett
from evidence.rows import Row
from fpm.elements.openings.stop import FINER

LOWEST, HIGHEST = 0.7, 1.0
"""Allowed ratio of the estimate to the true limit."""

RESOLUTION = 2e-4
"""Relative width to which the limit is bisected."""

SOURCE = "bisection on whether a run of 3000 steps breaks down"
MATERIAL = fpm.Material(1e9, 0.3, 800.0)

Case = tuple[str, fpm.Scene, fpm.Scene]
"""Name, the scene whose step is estimated, the disturbed scene whose limit is sought."""


def make_case(name: str, scene: fpm.Scene, speed: float) -> Case:
    return name, scene, disturb(scene, speed)


def bar(slenderness: float, elements: int, scale: float = 1.0) -> fpm.Scene:
    """A free square bar of elements of 1 m with the given l/r."""
    scene = fpm.Scene("bar")
    section = fpm.Section.square(np.sqrt(12) / slenderness)
    scene.add_link(
        (0, 0, 0), (elements, 0, 0), (0, 0, 1), section, MATERIAL, elements, "bar", scale
    )
    return scene


def bars(fast: bool) -> Iterator[Case]:
    for slenderness in (0.2, 5.0, 1000.0) if fast else (0.2, 1.0, 2.0, 5.0, 20.0, 100.0, 1000.0):
        for elements in (1, 4) if fast else (1, 2, 4, 16):
            name = f"free bar, l/r = {slenderness:g}, {elements} elements"
            yield make_case(name, bar(slenderness, elements), 1e-6)
    for scale in () if fast else (2.0, 3.0, 5.0, 8.0):
        for slenderness in (10.0, 100.0):
            name = f"free bar, l/r = {slenderness:g}, 8 elements, f = {scale:g}"
            yield make_case(name, bar(slenderness, 8, scale), 1e-6)


def linkages(fast: bool) -> Iterator[Case]:
    for elements in (2, 4, 8) if fast else (2, 4, 8, 16, 32, 64):
        name = f"Bennett linkage, {elements} elements a link"
        yield make_case(name, bennett(elements=elements), 1e-4)
    for scale in (3.0,) if fast else (2.0, 3.0, 5.0, 8.0):
        scene = bennett(elements=4, inertia=scale)
        yield make_case(f"Bennett linkage, 4 elements a link, f = {scale:g}", scene, 1e-4)


def contacts(fast: bool) -> Iterator[Case]:
    """Shut contacts: their limit is that of springs of the same stiffness that hold both ways.

    A contact itself opens when a growing motion lifts it off, which hides the growth. Its step is
    that of a spring FINER² times as stiff, for its impacts."""
    for stiffness in (1e5, 1e8) if fast else (1e4, 1e5, 1e6, 1e7, 1e8):
        for elements in (2, 4, 8) if fast else (2, 4, 8, 16):
            common = {"start": 120.0, "elements": elements}
            trial_scene = disturb(bennett(K_C=0.0, K_F=stiffness, **common), 1e-3)
            name = f"shut contact, K_C = {stiffness:g} N/rad, {elements} elements a link"
            soft = stiffness / FINER**2
            yield name, bennett(K_C=soft, K_F=0.0, **common), trial_scene


def arms(fast: bool) -> Iterator[Case]:
    """Virtual beams as short, stiff beam elements across the ends of two hinged bars."""
    for factor in (1e4,) if fast else (1.0, 100.0, 1e4):
        scene = fpm.Scene("stiff arms")
        section, stiff = fpm.Section.square(0.035), fpm.Material(1e9 * factor, 0.3, 800.0)
        tips = []
        for side in (-1.0, 1.0):
            start, stop = (0.01 * side, 0, 0), (0.46 * side, 0, 0)
            link = scene.add_link(start, stop, (0, 0, 1), section, MATERIAL, 4)
            mass, inertia = 0.02, np.full(3, 4e-6)
            tip = scene.add_particles((0.0, 0.0, 0.0175), mass, inertia, link.triad)
            scene.add_beams((int(link.particles[0]), int(tip[0])), section, stiff, (0, 1, 0), "arm")
            tips.append(int(tip[0]))
        scene.add_hinge("hinge", tips, (0, 0, 0.0175), (0, 1, 0))
        yield make_case(f"bars on arms {factor:g} times as stiff", scene, 1e-3)


def slides(fast: bool) -> Iterator[Case]:
    """Two oblong bars at an angle, the second on a slide or a cross of the first, with a spring."""
    cases = {"slide": (1e7,), "cross_axis": (1e3,)}
    if not fast:
        cases = {"slide": (1e4, 1e7, 1e9), "cross_axis": (1.0, 1e3, 1e6), "cross_other": (1e3, 1e6)}
    for kind, stiffnesses in cases.items():
        for stiffness in stiffnesses:
            scene, section = fpm.Scene(kind), fpm.Section.rectangle(0.02, 0.04)
            ends = [((0, 0, 0), (1, 0, 0)), ((1, 0, 0), (2, 0.3, 0.2))]
            first, second = (
                scene.add_link(*pair, (0, 0, 1), section, MATERIAL, 4, f"bar {k}")
                for k, pair in enumerate(ends)
            )
            pair = int(first.particles[-1]), int(second.particles[0])
            if kind == "slide":
                opening = scene.add_slide(kind, pair, (1, 0, 0), (1, 0, 0))
            else:
                opening = scene.add_universal("cross", pair, (1, 0, 0), (0, 1, 0), (0, 0, 1))
            scene.add_torsion_spring(opening + (kind == "cross_other"), stiffness)
            unit = "N/m" if kind == "slide" else "N m/rad"
            yield make_case(f"bars on a {kind}, spring of {stiffness:g} {unit}", scene, 1e-4)


def study(fast: bool = False) -> list[Row]:
    """Rows: ratio of the estimate to the true limit; allowed from 0.7 to 1 (and the resolution)."""
    rows = []
    for cases in (bars, linkages, contacts, arms, slides):
        for name, scene, trial_scene in cases(fast):
            stable = fpm.find_stable_step(scene)
            limit = true_limit(trial_scene, RESOLUTION)
            ratio = float(stable.step / limit)
            is_met = LOWEST <= ratio <= HIGHEST + 1.5 * RESOLUTION
            name, sense = f"stable step: {name}", f"{LOWEST} to"
            note = f"limit {limit:.4g} s, set by {stable.element}"
            rows.append(Row(name, ratio, "", sense, HIGHEST, None, is_met, SOURCE, note))
    return rows
