"""Releases that watch a latch let go when it catches, whichever of both is rigid."""

import numpy as np
import pytest

from fpm.errors import SceneError
from fpm.solver.simulate import simulate
from fpm.structures.text_file import loads

START, ANGLE, RATE, STIFFNESS, INERTIA, BOLT = 0.3, 0.7, 2.0, 0.5, 0.05, 20.0
PAIRS = {
    "rr": ("", ""),
    "rs": ("", ", stiffness: 50 N m/rad"),
    "sr": (f", stiffness: {BOLT}", ""),
    "ss": (f", stiffness: {BOLT}", ", stiffness: 50 N m/rad"),
}


def wheels_and_arms(release="watch: catch_NAME", pairs=("rr",)):
    """A structure, for each pair a wheel that turns into a latch, which frees a sprung arm."""
    groups = {
        "points": "AN: [0, 0, 0], BN: [0, 0, 0]",
        "bodies": "wheel_N: {mass: 1, centre: AN, inertia: [0.1, 0.1, 0.1], points: [AN]}, "
        f"arm_N: {{mass: 1, centre: BN, inertia: [0.1, 0.1, {INERTIA}], points: [BN]}}",
        "joints": "root_N: {type: revolute, parts: [ground, wheel_N], at: AN, axis: z}, "
        "tip_N: {type: revolute, parts: [ground, arm_N], at: BN, axis: z, opening: "
        f"{START} rad}}",
        "actions": f"bolt_N: {{type: release, joint: tip_N, {release} RELEASE}}, "
        f"spring_N: {{type: torsion spring, joint: tip_N, stiffness: {STIFFNESS}}}, "
        f"catch_N: {{type: latch, joint: root_N, angle: {ANGLE} rad, side: below LATCH}}",
        "initial_velocities": f"wheel_N: {{part: wheel_N, spin: [0, 0, {RATE}], about: AN}}",
    }
    lines = ["name: wheels"]
    for group, entries in groups.items():
        texts = []
        for name in pairs:
            bolt, latch = PAIRS[name]
            text = entries.replace("RELEASE", bolt).replace("LATCH", latch)
            texts.append(
                text.replace("NAME", name)
                .replace("AN", f"A{name}")
                .replace("BN", f"B{name}")
                .replace("_N", f"_{name}")
            )
        lines.append(f"{group}: {{{', '.join(texts)}}}")
    return "\n".join(lines)


def run(step, **structure):
    (outcome,) = simulate(
        loads(wheels_and_arms(**structure)).build(), duration=1.3, instants=14, step=step
    )
    names = [outcome.eventful[int(element)].name for element in outcome.events[:, 1]]
    times = outcome.events[[name.startswith("release") for name in names], 0]
    return outcome, times


def swing(time, stiffness):
    """Opening of an arm that a spring of this stiffness (inf: rigid) holds until the catch."""
    caught, free = ANGLE / RATE, np.sqrt(STIFFNESS / INERTIA)
    rest, rate = START, 0.0
    if stiffness < np.inf:
        rest = START * stiffness / (stiffness + STIFFNESS)
        rate = np.sqrt((stiffness + STIFFNESS) / INERTIA)
    held = rest + (START - rest) * np.cos(rate * np.minimum(time, caught))
    speed = -(START - rest) * rate * np.sin(rate * caught)
    later = np.maximum(time - caught, 0.0)
    return held * np.cos(free * later) + speed / free * np.sin(free * later)


@pytest.mark.slow
def test_a_release_lets_go_when_the_latch_catches_to_the_second_order():
    errors = []
    for step in (4e-3, 2e-3):
        outcome, times = run(step, pairs=[*PAIRS])
        assert times == pytest.approx(np.full(4, ANGLE / RATE), abs=1e-9)
        arms = outcome.records["opening"].values[:, 1::2]
        exact = [swing(outcome.time, BOLT if name[0] == "s" else np.inf) for name in PAIRS]
        errors.append(np.abs(arms - np.array(exact).T).max(axis=0))
    assert np.all(errors[1] < 0.3 * errors[0] + 1e-6) and np.all(errors[1] < 1e-3 * START)


@pytest.mark.slow
def test_the_earlier_of_time_and_catch_counts():
    times = run(2e-3, release="watch: catch_NAME, time: 0.2 s", pairs=[*PAIRS])[1]
    assert times == pytest.approx([0.2] * 4)


@pytest.mark.parametrize(
    ("release", "words"),
    [
        ("watch: catch_rr, level: 1 rad", "allowed: none, as it watches the latch catch_rr"),
        ("watch: spring_rr", "watch: 'spring_rr' is not allowed; allowed: a joint, or a latch: c"),
        ("watch: cath_rr", "there is no joint or latch 'cath_rr' .did you mean catch_rr"),
        ("watch: root_rr", "allowed: an opening, with a joint to `watch`"),
    ],
)
def test_what_a_release_may_watch(release, words):
    with pytest.raises(SceneError, match=words):
        loads(wheels_and_arms(release)).build()
