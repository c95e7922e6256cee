"""Damping in proportion to mass: of free particles and of those that hinges move, counted once."""

import numpy as np
import pytest

import fpm

pytestmark = pytest.mark.slow  # a time loop of its own

RATE, G, TIME = 5.0, 9.81, 0.4
VELOCITY, SPIN, TUMBLE = np.array([1.0, 2.0, 3.0]), 20.0, np.array([20.0, 5.0, -10.0])


def flight(damping: float, opening: float = 0.0) -> fpm.Scene:
    """Two hinged bars along x that fly, turning about x, and open (rad/s); beside them a lone body
    of unlike inertias that tumbles."""
    scene = fpm.Scene("flight", gravity=(0, 0, -G), damping=damping)
    section, material = fpm.Section.square(0.05), fpm.Material(1e9, 0.3, 1000.0)
    bars = [
        scene.add_link((0.5 * k, 0, 0), (0.5 * k + 0.5, 0, 0), (0, 0, 1), section, material, 2)
        for k in (0, 1)
    ]
    ends = int(bars[0].particles[-1]), int(bars[1].particles[0])
    scene.add_hinge("H", ends, (0.5, 0, 0), (0, 1, 0))
    body = scene.add_particles((0.0, 1.0, 0.0), 0.5, (1e-3, 2e-3, 4e-3))
    scene.velocity[:], scene.spin[:, 0] = VELOCITY, SPIN
    scene.spin[body] = TUMBLE
    on = bars[1].particles
    scene.spin[on] += (0.0, opening, 0.0)
    scene.velocity[on] += np.cross((0.0, opening, 0.0), scene.position[on] - (0.5, 0, 0))
    scene.add_point("tip", int(on[-1]))
    return scene


def run(*scenes: fpm.Scene) -> list[fpm.Outcome]:
    outcomes = fpm.simulate(scenes, duration=TIME, instants=5, step=1e-4)
    assert all(outcome.failure is None for outcome in outcomes)
    return outcomes


def test_momenta_of_all_particles_die_out_as_in_closed_form():
    """v' = g - c v and p' = -c p, and what is lost of the energy; 1e-6 of the largest of each."""
    scene = flight(RATE)
    (outcome,) = run(scene)
    left = np.exp(-RATE * TIME)
    weight, limit = np.array([0, 0, -G]), np.array([0, 0, -G / RATE])
    velocity = limit + (VELOCITY - limit) * left
    fallen = limit * TIME + (VELOCITY - limit) * (1 - left) / RATE
    final = outcome.final
    np.testing.assert_allclose(final.velocity, np.tile(velocity, (len(scene.mass), 1)), atol=3e-6)
    np.testing.assert_allclose(final.position - scene.position - fallen, 0.0, atol=1e-6)
    np.testing.assert_allclose(final.spin[:-1, 0], SPIN * left, rtol=1e-6)
    momentum = scene.frame[-1] @ (scene.inertia[-1] * (scene.frame[-1].T @ TUMBLE))
    found = final.frame[-1] @ (scene.inertia[-1] * (final.frame[-1].T @ final.spin[-1]))
    np.testing.assert_allclose(found, left * momentum, atol=1e-6 * np.abs(momentum).max())
    # Damped, a body tumbles as a free one does, ever slower: its energy falls as its momentum².
    turning = 0.5 * (SPIN**2 * scene.inertia[:-1, 0].sum() + momentum @ TUMBLE)
    mass = scene.mass.sum()
    lost = 0.5 * mass * (VELOCITY @ VELOCITY - velocity @ velocity) + mass * weight @ fallen
    lost += turning * (1 - left**2)
    assert outcome.energies["damping_work"][-1] == pytest.approx(lost, rel=1e-6)
