"""The largest stress in the sections of bars: of normal force, bending and torsion (von Mises).

Theory: docs/responses.md (Timoshenko, Strength of Materials II, § 83). Round sections are exact at
any point; rectangles at corners, and the middles of the sides with the exact series of Timoshenko
and Goodier, Theory of Elasticity, § 109; others by the rectangle with the same radii of gyration,
an estimate that is mostly too large."""

from collections.abc import Iterable

import numpy as np

from fpm.elements.bars.beam import Beams, Section
from fpm.reading.bars import half_sizes, sections
from fpm.scenes.scene import Scene


def torsion_stresses(width: float, height: float, J: float) -> tuple[float, float]:
    """Return the two largest shear stresses per torque (Pa/(N m)) of a solid rectangular section:
    at its mid-sides y = ±width/2, and z = ±height/2. width, height: m; J: torsion constant (m⁴)."""
    a, b = sorted((width / 2, height / 2))
    n = np.arange(1, 60, 2)
    argument = np.minimum(n * np.pi * b / (2 * a), 500.0)  # beyond, cosh overflows
    at_long = 2 * a * (1 - 8 / np.pi**2 * np.sum(1 / (n**2 * np.cosh(argument))))
    signs = (-1.0) ** ((n - 1) // 2)
    at_short = 16 * a / np.pi**2 * np.sum(signs * np.tanh(argument) / n**2)
    # The long sides are a away from the middle.
    stresses = (at_long, at_short) if width <= height else (at_short, at_long)
    return stresses[0] / J, stresses[1] / J


def equivalent(section: Section, force: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Return the largest equivalent stress (...), Pa (von Mises), of force and moment (..., 3), N
    and N m, in a section's axes: on the contour of round ones, corners and mid-sides of rectangles,
    else corners of the rectangle of `half_sizes`; transverse forces are left out."""
    normal = np.abs(force[..., 0]) / section.A
    torque, about_y, about_z = np.abs(np.moveaxis(moment, -1, 0))
    y, z = half_sizes(section)
    if section.outline == "round":
        bending = y * np.hypot(about_y / section.Iy, about_z / section.Iz)
        return von_mises(normal + bending, torque * y / section.J)
    by_y, by_z = about_y * z / section.Iy, about_z * y / section.Iz
    corner = normal + by_y + by_z
    if not section.outline:
        return von_mises(corner, torque * np.hypot(y, z) / section.J)
    at_y, at_z = torsion_stresses(section.width, section.height, section.J)
    sides = von_mises(normal + by_z, torque * at_y), von_mises(normal + by_y, torque * at_z)
    return np.maximum(corner, np.maximum(*sides))


def von_mises(normal: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Return the equivalent stress (Pa) by von Mises of normal and shear stress (...), Pa."""
    return np.sqrt(normal**2 + 3.0 * shear**2)


def element_stress(scene: Scene, groups: Iterable[Beams], place, axes) -> np.ndarray:
    """Return the largest equivalent stress (t, m) Pa (von Mises) at either end of all groups' m
    beam elements, in order; place(i), axes(i): positions (t, 3), frames (t, 3, 3) of particle i."""
    stresses = []
    for beams in groups:
        force, moment = sections(scene, beams, place, axes)
        stresses.append(equivalent(beams.section, force, moment).max(axis=2))
    return np.concatenate(stresses, axis=1)
