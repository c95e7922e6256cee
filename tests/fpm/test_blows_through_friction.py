"""Blows through joints with friction that sticks exactly: it bears its moment, and no more.

A blow takes no time, so that friction has no share in it: however small its moment is, the motion
after a blow is nearly that without it, wherever, in whatever direction and when the blow comes.
"""

from itertools import pairwise

import numpy as np
import pytest

import fpm
from fpm.elements import Friction, Latch, Motor, Release

FAR = 1e6  # rad or s: not in a run
ASIS = np.eye(3)
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
TURN *= np.linalg.det(TURN)
WAYS = 1.3 * np.sin(2.1 * np.arange(9))  # of the arms of a chain, which all slip one by one
ENDS = {
    "chain": np.cumsum([(0.0, 0.0), *(np.column_stack([np.cos(WAYS), np.sin(WAYS)]) / 2)], axis=0),
    "loop": np.array([[0.0, 0.0], [0.0, 0.2], [0.6, 0.6], [0.6, 0.0]]),
}
STEP, LAST, J, CLOSED = 1e-3, 0.1, 0.03, 3e-6


def arms(
    kind="chain", moment=0.02, motor=0.0, start=0.0, latch=FAR, rate=0.0, place=ASIS
) -> fpm.Scene:
    """Arms in a plane, in a chain or as a four-bar loop, the first on a motor that turns with a
    rate (rad/s) from a start (s), the others on friction of up to a moment (N m). The last arm of a
    chain turns at a rate, and is latched at an angle (rad). place: turns or mirrors all of it.
    """
    z = np.linalg.det(place) * place[:, 2]  # about which angles count alike in a mirror
    ends = np.column_stack([ENDS[kind], np.zeros(len(ENDS[kind]))]) @ place.T
    scene = fpm.Scene(kind)
    middles = [(a + b) / 2 for a, b in pairwise(ends)]
    count = len(middles)
    inertias = [[1.0] * 3, *[[J] * 3] * count]
    parts = scene.add_particles(np.array([0 * z, *middles]), [1.0] * (count + 1), inertias)
    scene.fix(parts[0])
    if rate:
        scene.spin[parts[-1]] = rate * z
        scene.velocity[parts[-1]] = rate * np.cross(z, middles[-1] - ends[-2])
    for k in range(count):
        scene.add_hinge(f"joint {k}", (parts[k], parts[k + 1]), ends[k], z)
    if kind == "loop":
        scene.add_hinge(f"joint {count}", (parts[count], parts[0]), ends[count], z)
    spare, flies = scene.add_particles(np.array([5 * z, 6 * z]), [1.0] * 2, [[1.0] * 3] * 2)
    scene.add_load(spare, moment=0 * z)  # of the same kinds as the wheels
    scene.velocity[flies] = z  # so that there is energy before a blow
    scene.add_hinge("spare", (parts[0], spare), 5 * z, z)
    last = len(scene.hinges) - 2
    curve = scene.add_curve([start, start + 10.0], [0.0, 10.0])
    scene.add(Motor(0, None, 0.0, 0.0, motor, curve))
    scene.add(Release(last + 1, time=FAR))
    scene.add(Latch(last, latch))
    for hinge in range(1, last + 1):
        scene.add(Friction(hinge, moment * 0.1 ** (hinge % 3), None))
    return scene


def last_openings(scenes, duration=LAST, step=STEP) -> np.ndarray:
    """Openings (scenes, hinges, 2) in the middle of a run and at its end."""
    outcomes = fpm.simulate(scenes, duration=duration, instants=3, step=step)
    assert not any(outcome.failure for outcome in outcomes)
    return np.array([[psi[1:] for psi in o.openings.values()] for o in outcomes])


BLOWS = {
    "a motor that turns from the start": {"motor": 2.0},
    "a motor that turns from the start, in a loop": {"motor": 2.0, "kind": "loop"},
    "a motor that turns from later on": {"motor": 2.0, "start": 0.03},
    "a latch": {"rate": 4.0, "latch": 0.05},
    "both at once": {"motor": -2.0, "rate": 4.0, "latch": 0.001},
}


@pytest.mark.slow
@pytest.mark.parametrize("blow", BLOWS)
def test_next_to_no_friction_has_next_to_no_share_in_a_blow(blow):
    """What friction of M does in T is below 4 M T²/J for the least inertia J of a part.

    CLOSED: in a first step, friction that holds takes what closes the joints on curved ways.
    """
    moments = (1e-12, 1e-6, 1e-3)
    none, *some = last_openings([arms(**BLOWS[blow], moment=m) for m in moments])
    assert np.abs(none[1:-1]).max() > 0.03
    for moment, found in zip(moments[1:], some, strict=True):
        assert np.abs(found - none).max() < 4 * moment * LAST**2 / J + CLOSED


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["chain", "loop"])
def test_it_does_not_matter_when_a_motor_begins_to_turn(kind):
    """At the start of the run, or a whole number of steps later."""
    at_once = last_openings(arms(kind, motor=2.0))
    later = last_openings(arms(kind, motor=2.0, start=0.1), 0.2)
    assert np.abs(at_once[..., 1] - later[..., 1]).max() < 1e-12


ONE, TWO, BEARS, PUSH = 0.7, 1.3, 0.5, 0.2  # kg m² of two wheels; N m between them, on the second
BENDS, FAST, CATCH, END = (0.10171, 0.20337), 3.0, 0.31731, 0.4  # s, rad/s, rad, s


def wheels() -> fpm.Scene:
    """Two wheels on one axis with friction between them and a push on the second, of which the
    first turns by a motor at once, and at once back; and two such of which the first is latched."""
    scene = fpm.Scene("wheels")
    z = np.array([0.0, 0.0, 1.0])
    (ground,) = scene.add_particles(0 * z, 1.0, 1.0)
    scene.fix(ground)
    for k in range(2):
        at, moving = 5.0 * k * z, {"spin": FAST * z} if k else {}
        (one,) = scene.add_particles(at, 1.0, ONE, **moving)
        (two,) = scene.add_particles(at, 1.0, TWO, **moving)
        scene.add_hinge(f"first {k}", (ground, one), at, z)
        scene.add_hinge(f"second {k}", (one, two), at, z)
        scene.add(Friction(2 * k + 1, BEARS, None))
        scene.add_load(two, moment=PUSH * z)
    times, turns = [0.0, *BENDS, 1.0], [0.0, 0.0, 1.0, 1.0 - (1.0 - BENDS[1]) / np.diff(BENDS)[0]]
    scene.add(Motor(0, None, 0.0, 0.0, FAST * np.diff(BENDS)[0], scene.add_curve(times, turns)))
    (spare,) = scene.add_particles(20 * z, 1.0, 1.0)
    scene.add_hinge("spare", (ground, spare), 20 * z, z)
    scene.add(Release(4, time=FAR))
    scene.add(Latch(2, CATCH))
    return scene


def second_wheels() -> np.ndarray:
    """Their angles (rad) at the end: evenly accelerated between the blows."""
    (first, then), turned = BENDS, 0.0
    rate = (PUSH + BEARS) / TWO * (then - first)
    turned = (
        rate * (then - first) / 2
        + rate * (END - then)
        + (PUSH - BEARS) / TWO * (END - then) ** 2 / 2
    )
    faster = PUSH / (ONE + TWO)
    when = (np.sqrt(FAST**2 + 2 * faster * CATCH) - FAST) / faster
    left = END - when
    caught = CATCH + (FAST + faster * when) * left + (PUSH - BEARS) / TWO * left**2 / 2
    return np.array([turned, caught])


def wheels_off(step: float) -> np.ndarray:
    (outcome,) = fpm.simulate(wheels(), duration=END, instants=3, step=step)
    assert not outcome.failure
    psi = {name: found[-1] for name, found in outcome.openings.items()}
    found = np.array([psi[f"first {k}"] + psi[f"second {k}"] for k in range(2)])
    return np.abs(found - second_wheels())


@pytest.mark.slow
def test_a_blow_within_a_step_counts_from_its_own_time():
    """Friction bears its moment from the blow on, to the second order: bends of a motor's curve and
    a latch, wherever they come in steps of these lengths."""
    steps = 4e-3 / np.array([1.0, 1.3, 1.7, 2.2, 2.9, 4.0, 5.1])
    errors = np.array([wheels_off(END / np.ceil(END / step)) for step in steps])
    assert np.all(errors < 0.5 * steps[:, None] ** 2)
