"""The shipped examples of a hatch, a screw and a winch move as their equations of motion say.

Each has one or two degrees of freedom, whose equations stand here in full."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fpm
from fpm.structures import load

STRUCTURES = Path(__file__).parents[2] / "config/structures"


def simulated(name: str, **options) -> fpm.Outcome:
    scene = load(STRUCTURES / f"{name}.yaml").build()
    (outcome,) = fpm.simulate([scene], **options)
    return outcome


def solved(function, duration: float, start: list[float], level: float | None = None, **options):
    """The solution of y' = function(t, y) up to where its first number comes to a level."""

    def event(t, y):
        return 1.0 if level is None else y[0] - level

    event.terminal = True
    return solve_ivp(function, (0.0, duration), start, rtol=1e-9, atol=1e-11, events=event,
                     dense_output=True, **options)  # fmt: skip


def compare(outcome: fpm.Outcome, joint: str, exact, tolerance: float) -> None:
    """Opening up to the latch, and when that catches, to a share of the largest and of the time."""
    early = outcome.time < exact.t[-1]
    opening = exact.sol(outcome.time[early])[0]
    error = np.abs(outcome.openings[joint][early] - opening).max()
    assert error < tolerance * opening.max()
    assert outcome.events[0, 0] == pytest.approx(exact.t[-1], rel=tolerance)


@pytest.mark.slow
def test_a_hatch_opens_as_its_gas_struts_push_and_its_hinge_rubs():
    length, mass, push, ratio, calm, mu, g = 0.8, 8.0, 95.0, 1.3, 150.0, 0.12, 9.81
    inertia = mass * (length**2 / 3 + 0.01**2 / 12)
    sill, stroke, whole = np.array([0.05, -0.35]), 0.24, 0.68

    def acceleration(q, rate):
        out, across = np.array([np.cos(q), np.sin(q)]), np.array([-np.sin(q), np.cos(q)])
        strut = 0.4 * length * out - sill
        size = np.hypot(*strut)
        lever = 0.4 * length * across @ strut / size  # of the strut's length by the opening
        way = np.clip(whole - size, 0.0, stroke)
        force = 2 * (push / (1 - way * (1 - 1 / ratio) / stroke) - calm * lever * rate)
        alone = force * lever - mass * g * length / 2 * np.cos(q)
        turn = alone / inertia
        for _ in range(20):  # the friction depends on the acceleration by what the hinge bears
            motion = mass * length / 2 * (turn * across - rate**2 * out)
            borne = motion - force * strut / size + np.array([0.0, mass * g])
            turn = (alone - mu * 0.01 * np.hypot(*borne) * np.sign(rate)) / inertia
        return turn

    exact = solved(
        lambda t, y: [y[1], acceleration(*y)], 4.0, [np.radians(5), 1e-9], np.radians(75)
    )
    outcome = simulated("hatch", duration=4.0, instants=801)
    compare(outcome, "hinge", exact, 1e-4)


@pytest.mark.slow
def test_a_screw_lags_behind_its_motor_through_the_play_of_its_gear():
    travel, pitch, time, play = 0.1, 0.005, 4.0, np.radians(3)
    lead = pitch / (2 * np.pi)  # m/rad
    inertia, mass, gear, calm, spring, c = 2e-4, 5.0, 2.0, 0.004, 100.0, 20.0

    def moment(t, angle, rate):
        u = min(t / time, 1.0)
        target = travel / lead * u**3 * (10 - 15 * u + 6 * u**2)
        speed = travel / lead * 30 * u**2 * (1 - u) ** 2 / time
        error = target - angle
        if abs(error) < play / 2:
            return 0.0
        elastic = gear * (error - np.sign(error) * play / 2)
        damped = calm * (speed - rate)
        return elastic + np.clip(damped, -abs(elastic), abs(elastic))

    def motion(t, y):
        angle, rate = y
        load = lead**2 * (spring * angle + c * rate)
        return [rate, (moment(t, angle, rate) - load) / (inertia + mass * lead**2)]

    exact = solved(motion, 5.0, [0.0, 0.0], max_step=1e-3)
    outcome = simulated("spindle", duration=5.0, instants=1001)
    way = lead * exact.sol(outcome.time)[0]
    assert np.abs(outcome.openings["rail"] - way).max() < 1e-4 * travel


def test_a_winch_raises_its_mast_as_fast_as_its_torque_allows():
    length, mass, tip, torque, no_load, radius, EA, g = 3.0, 10.0, 2.0, 20.0, 6.0, 0.1, 2e4, 9.81
    inertia = (mass / 3 + tip) * length**2
    tower = np.array([-1.0, 2.0])

    def rope(q):
        out, across = np.array([np.cos(q), np.sin(q)]), np.array([-np.sin(q), np.cos(q)])
        stretch = length * out - tower
        size = np.hypot(*stretch)
        return size, length * across @ stretch / size

    start = np.radians(10)
    rest = rope(start)[0] / (1 + 10 / EA)

    def motion(t, y):
        q, psi, rate, spin = y
        size, lever = rope(q)
        strain = max(size / (rest - radius * psi) - 1, 0.0)
        weight = (mass / 2 + tip) * g * length * np.cos(q)
        # What is wound keeps no strain: the drum bears its energy, too (docs/mechanics.md).
        drum = torque * np.clip(1 - spin / no_load, 0, 1) - radius * EA * strain * (1 + strain / 2)
        return [rate, spin, (-EA * strain * lever - weight) / inertia, drum / 0.05]

    exact = solved(motion, 9.0, [start, 0.0, 0.0, 0.0], np.radians(85))
    outcome = simulated("winch", duration=9.0, instants=901)
    compare(outcome, "hinge", exact, 2e-3)
