"""Pins with play: damping, friction, frames and refusals; more in evidence/verification/pins.py."""

import numpy as np
import pytest

import fpm
from fpm.errors import SceneError
from fpm.reading.responses import parse
from fpm.structures.text_file import loads

PIN = "clearance: 0.5 mm, load: 20 N, depth: 2 um, restitution: 0.5, friction: 0.3, radius: 20 mm"


def shaft(pin: str = PIN, parts: str = "[ground, shaft]", axes="z, x: x", start="", more="") -> str:
    return f"""
name: shaft
points: {{O: [0, 0, 0]}}
bodies: {{shaft: {{mass: 0.5, centre: O, inertia: [2e-4, 2e-4, 2e-4], points: [O]}}}}
joints:
  hole: {{type: pin with play, parts: {parts}, at: O, axis: {axes}, {pin}{start}}}
initial_velocities:
  throw: {{part: shaft, about: O, velocity: [0.2, 0.1, 0], spin: [0, 0, 60]}}
record: {{O: {{part: shaft, at: O}}}}
{more}
"""


def run(text: str, duration=0.03, step=2e-6, **options):
    scene = loads(text).build()
    (outcome,) = fpm.simulate(scene, duration=duration, instants=61, step=step, **options)
    assert not outcome.failure
    return outcome


@pytest.mark.slow
@pytest.mark.parametrize("law", ["hertz", "linear"])
def test_energy_balances_to_the_second_order_along_any_axes(law):
    pin = f"{PIN}, law: {law}"
    outcomes = [run(shaft(pin), step=step) for step in (2e-6, 1e-6)]
    errors = [np.abs(o.energies["balance"]).max() / o.energies["kinetic"][0] for o in outcomes]
    assert errors[1] < 2e-5 and errors[0] > 3 * errors[1]
    place, loss = outcomes[1].points["O"][0], outcomes[1].energies["joint_loss"]
    assert loss[-1] > 0.02 * outcomes[1].energies["kinetic"][0]
    assert np.hypot(*place[:, :2].T).max() < 0.55e-3
    other = run(shaft(pin, axes="-z"), step=1e-6)
    assert other.points["O"][0] == pytest.approx(place, abs=1e-9)
    assert other.energies["joint_loss"] == pytest.approx(loss, abs=1e-6 * loss[-1])
    force, distance = (outcomes[1].records[f"pin_{n}"].values for n in ("force", "eccentricity"))
    assert np.array_equal(force > 0, distance > 0.5e-3) and force.any()
    assert {int(event) for _, _, event in outcomes[1].events} == {0, 1}  # leaves, touches


@pytest.mark.slow
def test_it_is_the_same_whose_the_pin_is_where_nothing_rubs():
    first, second = (
        run(shaft(PIN.replace("0.3", "0"), parts=parts)).points["O"][0]
        for parts in ("[ground, shaft]", "[shaft, ground]")
    )
    assert first == pytest.approx(second, abs=1e-9)


@pytest.mark.parametrize(
    ("pin", "words"),
    [
        (PIN.replace("0.5, fr", "1.5, fr"), "above 0 and at most 1"),
        (PIN.replace("0.5, fr", "0, fr"), "above 0"),
        (PIN.replace(", radius: 20 mm", ""), "above 0 m, with friction"),
        (PIN.replace("0.5 mm", "-0.5 mm"), "of at least 0"),
        (PIN.replace("2 um", "0"), "above 0"),
        (PIN + ", law: cubic", "hertz, linear"),
        (PIN + ", opening_x: 0.4 mm, opening_y: 0.4 mm", "at most 0.000502 m from the axis"),
    ],
)
def test_what_is_refused(pin, words):
    with pytest.raises(SceneError, match=words):
        loads(shaft(pin)).build()


def test_what_has_no_answer_with_play_is_refused():
    bearing = "actions: {rub: {type: bearing, joint: hole_turn, mu: 0.1, radius: 20 mm}}"
    with pytest.raises(SceneError, match="its own `friction`"):
        loads(shaft(more=bearing)).build()
    scene = loads(shaft()).build()
    margin = {"margin": "hole_turn", "to": "1 rad", "standard": "ECSS"}
    with pytest.raises(SceneError, match="a structure without pin with play hole"):
        parse("m", margin, scene)
    with pytest.raises(SceneError, match="expected one of"):
        parse("f", {"constraint_force": "hole", "component": "x"}, scene)
    assert parse("p", {"pin_force": "hole"}, scene).unit == "N"
