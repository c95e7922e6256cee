"""Friction that sticks exactly and motors that prescribe exactly: closed forms, energy, lanes."""

import numpy as np
import pytest
from flaps import J

import fpm
from fpm.elements import Motor, RigidFriction, RigidMotor

RUN = {"duration": 3.0, "instants": 3001, "step": 1e-3}
TIMES, VALUES = [0.0, 0.5003, 1.2, 2.0], [0.0, 0.4, 0.1, 0.1]
G = 9.81


def flap(rate=0.0, moment=0.0, load=0.0, ramp=0.0, gravity=1e-300, turn=0.0, angle=0.0):
    """A flap on friction, under a moment (N m) and one that grows (N m/s), and one on a motor.

    Both have their mass 0.5 m from their hinges, weight along -y, and start at an angle to x.
    """
    scene = fpm.Scene("flaps", gravity=(0.0, -gravity, 0.0))
    arm = 0.5 * np.array([np.cos(angle), np.sin(angle), 0.0])
    aside = np.array([0.0, 0.0, 5.0])
    inertias = [[1.0] * 3, *[[0.1, J - 0.25, J - 0.25]] * 2]
    ground, one, two = (
        int(p) for p in scene.add_particles([0 * arm, arm, aside + arm], 1.0, inertias)
    )
    scene.fix(ground)
    z = np.array([0.0, 0.0, 1.0])
    scene.spin[one], scene.velocity[one] = rate * z, rate * np.cross(z, arm)
    scene.add_hinge("hinge", (ground, one), 0 * arm, z, opening=angle)
    scene.add_hinge("driven", (ground, two), aside, z, opening=angle)
    growing = scene.add_curve([0.0, 10.0], [0.0, 10.0])
    scene.add_load(one, moment=load * z)
    scene.add_load(one, moment=ramp * z, curve=growing)
    scene.add(RigidMotor(1, angle, turn, scene.add_curve(TIMES, VALUES)))
    scene.add(RigidFriction(0, moment))
    return scene


CASES = {
    "stops": flap(rate=1.0, moment=0.2),
    "stops late": flap(rate=-0.7, moment=0.05),
    "stops at once": flap(rate=1.0, moment=1e3),
    "sticks": flap(moment=0.2, load=0.2 * 0.999),
    "slips": flap(moment=0.2, load=0.22),
    "begins to slip": flap(moment=0.2, ramp=0.31),
    "swings": flap(moment=0.4, gravity=G, angle=0.3),
    "driven": flap(turn=1.0, gravity=G),
}


def run(cases: dict, **more) -> dict:
    outcomes = fpm.simulate(list(cases.values()), **{**RUN, **more})
    assert not any(outcome.failure for outcome in outcomes)
    return dict(zip(cases, outcomes, strict=True))


@pytest.fixture(scope="module")
def ran():
    return run(CASES)


def opening(outcome) -> np.ndarray:
    return outcome.openings["hinge"]


@pytest.mark.slow
def test_friction_stops_at_the_exact_angle_and_stays(ran):
    for name, rate, moment in (("stops", 1.0, 0.2), ("stops late", -0.7, 0.05)):
        time, psi, end = ran[name].time, opening(ran[name]), abs(rate) * J / moment
        exact = np.sign(rate) * J * rate**2 / (2 * moment)
        sliding = np.minimum(time, end)
        path = rate * sliding - np.sign(rate) * moment / (2 * J) * sliding**2
        assert np.abs(psi - path).max() < 1e-6  # a step's share of the last way, J d²/(8 M)
        if end < time[-1]:
            late = psi[time > end + 2e-3]
            # Leapfrog's own error of the way, of which (w h)²/24 in a turn about a pin.
            assert np.abs(late - exact).max() < 1e-7 * abs(exact)
            assert np.ptp(late) < 1e-12
            lost = ran[name].energies["joint_loss"][-1]
            assert lost == pytest.approx(J * rate**2 / 2, rel=1e-6)
    at_once = opening(ran["stops at once"])
    assert np.abs(at_once[2:] - at_once[2]).max() < 1e-12
    assert at_once[2] < 1e-3


@pytest.mark.slow
def test_friction_holds_to_the_last_hair_and_slips_where_it_should(ran):
    assert np.abs(opening(ran["sticks"])).max() < 1e-13
    time = ran["slips"].time
    assert np.abs(opening(ran["slips"]) - 0.02 / J * time**2 / 2).max() < 1e-6
    begun = np.maximum(time - 0.2 / 0.31, 0.0)
    exact = 0.31 * begun**3 / (6 * J)
    assert np.abs(opening(ran["begins to slip"]) - exact).max() < 2e-3 * exact[-1]
    assert np.abs(opening(ran["begins to slip"])[begun == 0.0][:-1]).max() < 1e-13


@pytest.mark.slow
def test_each_swing_against_friction_loses_what_its_way_costs(ran):
    """m g d (sin a - sin b) = M |a - b| between turns a and b; it ends where M bears the weight."""
    psi, moment, weight = opening(ran["swings"]), 0.4, G * 0.5
    way = np.sign(np.diff(psi))
    turns = psi[1:-1][(way[1:] != way[:-1]) & (np.abs(psi[1:-1] - psi[-1]) > 1e-3)]
    assert len(turns) >= 2
    for a, b in zip([0.3, *turns[:-1]], turns, strict=True):
        assert weight * (np.sin(a) - np.sin(b)) == pytest.approx(moment * abs(a - b), abs=2e-4)


@pytest.mark.slow
def test_a_rigid_motor_is_where_its_curve_is_and_its_work_is_told(ran):
    outcome, psi = ran["driven"], ran["driven"].openings["driven"]
    assert np.abs(psi - np.interp(outcome.time, TIMES, VALUES)).max() < 1e-12
    # The blow with which it begins comes before; that at each bend is its work.
    rate = VALUES[1] / TIMES[1]
    work = outcome.energies["motor_work"][-1]
    assert work == pytest.approx(0.5 * G * np.sin(psi[-1]) - J / 2 * rate**2, abs=2e-4)
    moment = outcome.records["motor_moment"].values[outcome.time > 2.1, 0]
    np.testing.assert_allclose(moment, 0.5 * G * np.cos(0.1), rtol=1e-9)


@pytest.mark.slow
def test_the_energy_of_rigid_motors_and_friction_balances(ran):
    for name, outcome in ran.items():
        scale = max(outcome.energies["kinetic"].max(), outcome.energies["joint_loss"].max(), 0.05)
        assert np.abs(outcome.energies["balance"]).max() < 1e-4 * scale, name


@pytest.mark.slow
def test_rigid_motors_and_friction_alone_and_in_a_batch_are_the_same_bits(ran):
    for name in ("stops", "begins to slip", "swings", "driven"):
        (alone,) = fpm.simulate(CASES[name], **RUN)
        assert np.array_equal(opening(alone), opening(ran[name]))
        for energy, values in alone.energies.items():
            assert np.array_equal(values, ran[name].energies[energy]), (name, energy)


@pytest.mark.parametrize(
    ("element", "message"),
    [
        (RigidFriction(5, 1.0), "hinge of friction"),
        (RigidFriction(0, -1.0), "moment of friction"),
        (RigidMotor(1, 0.0, 1.0, 0), "a hinge without a motor"),
        (Motor(1, 1.0, 0.0, 0.0, 1.0, 0), "a hinge without a motor"),
        (RigidMotor(0, 0.1, 1.0, 0), "opening of motor hinge at the start"),
        (RigidMotor(0, 0.0, np.inf, 0), "opening of motor hinge"),
        (RigidMotor(0, 0.0, 1.0, 7), "curve of motor hinge"),
    ],
)
def test_what_rigid_motors_and_friction_refuse(element, message):
    with pytest.raises(fpm.SceneError, match=message):
        flap().add(element)
