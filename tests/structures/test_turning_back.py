"""Latches on a joint that turns back within a step, in closed form for even accelerations."""

import numpy as np
import pytest

import fpm
from fpm.reading.responses import parse
from fpm.structures import loads

CART = """
points: {o: [0, 0, 0]}
bodies: {cart: {mass: 1, centre: o, inertia: [1, 1, 1]}}
joints: {h: {type: prismatic, parts: [ground, cart], at: o, axis: x}}
loads: {push: {part: cart, at: o, force: [FORCE, 0, 0]}}
opening_rates: {r: {joint: h, rate: RATE m/s}}
actions:
  pin: {type: latch, joint: h, LATCH}
record: {o: {part: cart, at: o}}
"""
DRY = "  dry: {type: friction, joint: h, force: FRICTION, sticks: exactly}\nrecord"
AHEAD, BACK, REST = (0.2 - 0.02**0.5) / 100, (0.2 + 0.02**0.5) / 100, 0.02**0.5 / 100
FAR = (0.2 + 0.06**0.5) / 100
CASES = {  # rate, force, friction, latch; time, place and rate of the catch, None: none
    "on the way out": (0.2, -100, 0, "position: 1e-4", (AHEAD, 1e-4, 0.02**0.5)),
    "on the way back": (0.2, -100, 0, "position: 1e-4, side: above", (BACK, 1e-4, -(0.02**0.5))),
    "behind the start": (0.2, -100, 0, "position: -1e-4", (FAR, -1e-4, -(0.06**0.5))),
    "from rest": (0.0, -100, 0, "position: -1e-4", (REST, -1e-4, -(0.02**0.5))),
    "slow enough before it turns": (
        0.2, -100, 0, "position: 2e-4, capture_range: 1e-4, max_capture_rate: 0.1",
        (1e-3, 1.5e-4, 0.1),
    ),
    "where it turns": (
        0.2, -100, 0, "position: 2e-4, capture_range: 5e-5, side: above", (2e-3, 2e-4, 0.0),
    ),
    "in a later step": (0.2, -1, 0, "position: 0.019998", (0.198, 0.019998, 0.002)),
    "too fast both ways": (0.2, -100, 0, "position: 1e-4, max_capture_rate: 0.1", None),
    "friction and load": (
        0.2, -100, 40, "position: 1e-4", ((0.2 - 0.012**0.5) / 140, 1e-4, 0.012**0.5),
    ),
    "friction alone, later": (2.0, 0, 8, "position: 0.2", ((2 - 0.8**0.5) / 8, 0.2, 0.8**0.5)),
    "friction that holds": (0.2, -100, 120, "position: -1e-5", None),
    "friction that holds before it": (0.2, -100, 120, "position: 1e-4", None),
    "friction that holds within the range": (
        -0.2, 100, 120, "position: -1e-4, capture_range: 1e-4, side: below",
        (0.2 / 220, -0.02 / 220, 0.0),
    ),
    "a second latch at rest beside a load": (
        0.2, -100, 40, "position: 1e-4}\n  end: {type: latch, joint: h, position: 1.1e-4, "
        "capture_range: 2e-5, max_capture_rate: 0.01", ((0.2 - 0.012**0.5) / 140, 1e-4, 0.012**0.5),
    ),
    "a second latch at rest": (
        2.0, 0, 8, "position: 0.2}\n  end: {type: latch, joint: h, position: 0.21, "
        "capture_range: 0.02, max_capture_rate: 0.1", ((2 - 0.8**0.5) / 8, 0.2, 0.8**0.5),
    ),
}  # fmt: skip


def cart(rate, force, friction, latch) -> str:
    text = CART.replace("FORCE", str(force)).replace("RATE", str(rate)).replace("LATCH", latch)
    return text.replace("record", DRY.replace("FRICTION", str(friction))) if friction else text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "stiffness"),
    [*((case, "") for case in CASES), *((case, ", stiffness: 40") for case in [*CASES][:-2])],
)
def test_a_latch_catches_a_joint_that_turns_back_within_a_step(case, stiffness):
    """Time, place, rate; of an exact one the impact, and in the first step all of the energy."""
    *motion, latch, exact = CASES[case]
    scene = loads(cart(*motion, latch + stiffness)).build()
    for step in (0.025, 0.0125, 0.005, 0.004, BACK, *((0.001,) if exact is None else ())):
        (outcome,) = fpm.simulate(scene, duration=80 * step, instants=17, step=step)
        events = outcome.events[outcome.events[:, 2] == 0]
        assert outcome.energies["kinetic"][0] == pytest.approx(motion[0] ** 2 / 2, abs=1e-12)
        if exact is None:
            assert len(events) == 0
            continue
        time, place, rate = exact
        assert np.unique(events[:, 0].round(12)) == pytest.approx([time], abs=1e-9)
        assert outcome.records["slide_latch_rate"].values[-1, 0] == pytest.approx(rate, abs=1e-9)
        if stiffness:
            continue
        assert outcome.openings["h"][-1] == pytest.approx(place, abs=1e-9)
        for name, impact in {"pin": rate, "end": 0.0}.items():
            if name == "pin" or f"{name}:" in latch:
                words = {"latch_impact": name, "component": "signed"}
                found = parse("p", words, outcome.scene).evaluate(outcome)
                assert found[-1] == pytest.approx(-impact, abs=1e-9)
                assert np.abs(found[found != 0] + impact).max(initial=0) < 1e-9
        if time < step:
            loss = motion[0] ** 2 / 2 + motion[1] * place
            assert outcome.energies["joint_loss"][-1] == pytest.approx(loss, abs=1e-9)
            assert np.abs(outcome.energies["balance"]).max() < 1e-9
