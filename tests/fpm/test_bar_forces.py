"""Reactions, section forces and stresses of bars that move: against closed forms and balances."""

import numpy as np
import pytest
from asking import curves, vector, vectors

import fpm

pytestmark = pytest.mark.slow  # a time loop of its own

SECTION = fpm.Section.rectangle(0.04, 0.02)
MATERIAL = fpm.Material(1e9, 0.3, 1000.0)
LENGTH, ELEMENTS = 0.5, 4
FORCE, TORQUE = np.array([20.0, 0.4, -0.3]), 0.2
MASS = 1000.0 * SECTION.A * LENGTH


def cantilever(damping: float) -> fpm.Scene:
    """A bar along x, clamped at the origin, with a force and a torque at its end from the start."""
    scene = fpm.Scene("cantilever", damping=damping)
    bar = scene.add_link((0, 0, 0), (LENGTH, 0, 0), (0, 0, 1), SECTION, MATERIAL, ELEMENTS, "bar")
    scene.fix(bar.particles[0])
    scene.add_load(int(bar.particles[-1]), FORCE, (TORQUE, 0, 0))
    for k, particle in enumerate(bar.particles):
        scene.add_point(f"p{k}", int(particle))
    return scene


def sections(share: float) -> dict[str, dict]:
    found = {}
    for kind, names in (
        ("section_force", ("axial", "shear_y", "shear_z")),
        ("section_moment", ("torsion", "bending_y", "bending_z")),
    ):
        for name in names:
            found[f"{name} {share}"] = {kind: "bar", "at": share, "component": name}
    return found


SHARES = (0.0, 0.5, 0.9)
DEFINITIONS = {
    **{f"R {name}": d for name, d in vectors("reaction_force", "p0").items()},
    **{f"T {name}": d for name, d in vectors("reaction_moment", "p0").items()},
    **{n: d for share in SHARES for n, d in sections(share).items()},
    **{f"a {n}": d for n, d in vectors("acceleration", "p1", "p2", "p3", "p4").items()},
    "stress": {"stress": "bar"},
    "all": {"stress": "all"},
}


@pytest.mark.parametrize("damping", [0.0, 5.0])
def test_reaction_and_load_change_the_momentum_of_a_bar_at_every_instant(damping):
    """To rounding: what the clamp gives is what all forces on the bar lack. Of the first instant,
    where the bar is at rest, damping belongs to the half step after it."""
    damped = cantilever(damping or 1e-12)
    masses = damped.mass.copy()
    _, found, outcome = curves(damped, DEFINITIONS, duration=0.05, instants=101)
    change = sum(m * vector(found, f"a p{k}") for k, m in enumerate(masses) if k)
    moved = sum(m * outcome.points[f"p{k}"][1] for k, m in enumerate(masses))
    expected = change + damping * moved - FORCE
    np.testing.assert_allclose(vector(found, "R p0")[1:], expected[1:], atol=1e-7)


def test_a_vibrating_bar_bears_the_static_moment_in_the_mean():
    """The load comes at once and makes it swing about the static state: the mean over ten periods
    of the lowest mode is that of the load's moment about the clamp, to 2 %, as these periods are
    those of a bar that nothing stretches."""
    lowest = 1.875**2 * np.sqrt(MATERIAL.E * SECTION.Iy / (MASS / LENGTH)) / LENGTH**2
    period = 2 * np.pi / lowest
    _, found, outcome = curves(cantilever(1e-12), DEFINITIONS, duration=10 * period, instants=2001)
    mean = found["bending_y 0.0"].mean()
    load = np.cross(outcome.points["p4"][0], FORCE)[:, 1].mean()
    assert mean == pytest.approx(load, rel=0.02)
    assert found["bending_y 0.0"].max() > 1.8 * mean
