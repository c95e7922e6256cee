"""The shipped examples of a hatch, a screw and a winch, with fewer runs: their bounds are those of
their equations of motion, with one or two degrees of freedom, which stand here in full."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from deployable import campaign
from deployable.campaign.config.loader import read_file

CONFIG = Path(__file__).parents[2] / "config"


def answers(name: str, results: Path) -> dict:
    """The quantities of a campaign by name, as its summary has them."""
    raw = read_file(CONFIG / f"{name}.yaml").data
    raw["scene"]["file"] = str(CONFIG / raw["scene"]["file"])
    raw |= {"held_out": 1, "verify": {"max_iterations": 1}}
    raw["design"]["order"] = 1
    campaign.run(raw, results, figures=False, notify=lambda text: None)
    rows = json.loads((results / name / "summary.json").read_text())["quantities"]
    return {row["name"]: row for row in rows}


def arrival(motion, start: list[float], level: float, **options) -> np.ndarray:
    """Time at which the first number of y' = motion(t, y) comes to a level, and all numbers."""

    def event(t, y):
        return y[0] - level

    event.terminal = True
    found = solve_ivp(motion, (0.0, 20.0), start, rtol=1e-8, atol=1e-10, events=event, **options)
    return np.array([found.t[-1], *found.y[:, -1]])


def check(row: dict, exact, tolerance: float) -> None:
    """Both ends of a quantity, and that its own places are where they are."""
    for end, place in (("lower", "argmin"), ("upper", "argmax")):
        assert row[end] == pytest.approx(exact(**row[place]), rel=tolerance), end


def hatch(push: float, calm: float, mu: float) -> np.ndarray:
    length, mass, ratio, g = 0.8, 8.0, 1.3, 9.81
    inertia = mass * (length**2 / 3 + 0.01**2 / 12)
    sill, stroke, whole = np.array([0.05, -0.35]), 0.24, 0.68

    def motion(t, y):
        q, rate = y
        out, across = np.array([np.cos(q), np.sin(q)]), np.array([-np.sin(q), np.cos(q)])
        strut = 0.4 * length * out - sill
        size = np.hypot(*strut)
        lever = 0.4 * length * across @ strut / size  # of the strut's length by the opening
        way = np.clip(whole - size, 0.0, stroke)
        force = 2 * (push / (1 - way * (1 - 1 / ratio) / stroke) - calm * lever * rate)
        alone = force * lever - mass * g * length / 2 * np.cos(q)
        turn = alone / inertia
        for _ in range(8):  # the friction depends on the acceleration by what the hinge bears
            path = mass * length / 2 * (turn * across - rate**2 * out)
            borne = path - force * strut / size + np.array([0.0, mass * g])
            turn = (alone - mu * 0.01 * np.hypot(*borne) * np.sign(rate)) / inertia
        return [rate, turn]

    return arrival(motion, [np.radians(5), 1e-9], np.radians(75))


@pytest.mark.slow
def test_a_hatch_latches_when_its_gas_struts_push_and_its_hinge_rubs(tmp_path):
    rows = answers("hatch", tmp_path)
    check(rows["t_latch"], lambda **x: hatch(**x)[0], 2e-4)
    check(rows["v_latch"], lambda **x: 0.8 * hatch(**x)[2], 2e-3)
    assert rows["t_latch"]["argmin"] == pytest.approx({"push": 100.7, "calm": 127.5, "mu": 0.08})


def spindle(backlash: float, gear: float, spring: float) -> float:
    travel, pitch, time, play = 0.1, 0.005, 4.0, np.radians(backlash)
    lead = pitch / (2 * np.pi)  # m/rad
    inertia, mass, calm, c = 2e-4, 5.0, 0.004, 20.0

    def moment(t, angle, rate):
        u = min(t / time, 1.0)
        target = travel / lead * u**3 * (10 - 15 * u + 6 * u**2)
        speed = travel / lead * 30 * u**2 * (1 - u) ** 2 / time
        error = target - angle
        if abs(error) < play / 2:
            return 0.0
        elastic = gear * (abs(error) - play / 2)
        damped = np.sign(error) * calm * (speed - rate)
        return np.sign(error) * max(elastic + damped, 0.0)  # teeth never pull

    def motion(t, y):
        angle, rate = y
        load = lead**2 * (spring * angle + c * rate)
        return [rate, (moment(t, angle, rate) - load) / (inertia + mass * lead**2)]

    return arrival(motion, [0.0, 0.0], 0.099 / lead, max_step=2e-3)[0]


@pytest.mark.slow
def test_a_nut_on_a_screw_lags_behind_its_motor_through_the_play_of_a_gear(tmp_path):
    check(answers("spindle", tmp_path)["t_out"], spindle, 1e-4)


def winch(tip: float, torque: float, no_load: float) -> np.ndarray:
    length, mass, radius, EA, g = 3.0, 10.0, 0.1, 2e4, 9.81
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

    return arrival(motion, [start, 0.0, 0.0, 0.0], np.radians(85))


@pytest.mark.slow
def test_a_winch_raises_its_mast_as_fast_as_its_torque_allows(tmp_path):
    rows = answers("winch", tmp_path)
    check(rows["t_latch"], lambda **x: winch(**x)[0], 1e-3)
    check(rows["v_latch"], lambda **x: 3 * winch(**x)[3], 5e-3)
    soft = {"tip": 2.2, "torque": 18.0, "no_load": 5.7}
    assert rows["t_latch"]["argmax"] == pytest.approx(soft)
