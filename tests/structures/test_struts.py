"""Struts: a hatch on each kind of them against its equation of motion, solved by itself."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fpm.elements import Strut
from fpm.errors import SceneError
from fpm.scenes.timestep import find_stable_step
from fpm.solver.simulate import simulate
from fpm.structures.text_file import loads

MASS, INERTIA, GRAVITY = 5.0, 0.45, 9.81
GROUND, LID = np.array([0.1, -0.3]), np.array([0.4, 0.1])  # x and z, of the lid at an opening of 0
DAMPING = 40.0
KINDS = {
    "spring": "stiffness: 900 N/m, preload: 250 N",
    "push": "stiffness: 900 N/m, rest: 550 mm, acts: push",
    "pull": "stiffness: 900 N/m, rest: 450 mm, acts: pull",
    "table": "lengths: [0.4 m, 0.55 m, 0.6 m], forces: [300 N, 260 N, -100 N]",
    "gas": "force: 260 N, length: 0.7 m, stroke: 0.3 m, ratio: 1.6, exponent: 1.2",
    "constant": "force: 180 N",
    "damped": f"force: 180 N, damping: {DAMPING} N s/m",
}
TYPES = {"push": "spring", "pull": "spring", "table": "tabulated spring", "gas": "gas spring",
         "constant": "constant force", "damped": "constant force"}  # fmt: skip


def hatch(kind: str, strut: str = "") -> str:
    text = f"type: {TYPES.get(kind, kind)}, between: [{{part: ground, at: A}}, B], "
    return f"""
name: hatch
gravity: [0, 0, -{GRAVITY} m/s2]
points:
  O: [0, 0, 0]
  C: [0.5, 0, 0]
  A: [{GROUND[0]}, 0.02, {GROUND[1]}]
  B: [{LID[0]}, 0.02, {LID[1]}]
bodies:
  lid: {{mass: {MASS}, centre: C, inertia: [0.01, {INERTIA}, {INERTIA}], points: [O, B]}}
joints:
  hinge: {{type: revolute, parts: [ground, lid], at: O, axis: -y}}
struts:
  arm: {{{text}{strut or KINDS[kind]}}}
"""


def law(kind: str):
    """Force of each kind over the length (N), > 0 where it pushes, as its definition says."""
    start = np.linalg.norm(LID - GROUND)
    rest = start + 250 / 900
    shrink = 1 - 1.6 ** (-1 / 1.2)
    return {
        "spring": lambda length: 900 * (rest - length),
        "push": lambda length: max(900 * (0.55 - length), 0.0),
        "pull": lambda length: min(900 * (0.45 - length), 0.0),
        "table": lambda length: float(np.interp(length, [0.4, 0.55, 0.6], [300, 260, -100])),
        "gas": lambda x: 260 * (1 - np.clip((0.7 - x) / 0.3, 0, 1) * shrink) ** -1.2,
        "constant": lambda length: 180.0,
        "damped": lambda length: 180.0,
    }[kind]


def reference(kind: str, times: np.ndarray) -> np.ndarray:
    """Openings of the hatch at some times, from its equation of motion."""
    force, damping = law(kind), DAMPING if kind == "damped" else 0.0

    def slope(_, state):
        psi, rate = state
        turn = np.array([[np.cos(psi), -np.sin(psi)], [np.sin(psi), np.cos(psi)]])
        point = turn @ LID
        chord = point - GROUND
        length = np.linalg.norm(chord)
        lever = (chord[1] * point[0] - chord[0] * point[1]) / length  # dL/dpsi
        push = force(length) - damping * lever * rate
        weight = -MASS * GRAVITY * 0.5 * np.cos(psi)
        return rate, (weight + push * lever) / (INERTIA + MASS * 0.25)

    result = solve_ivp(
        slope, (0, times[-1]), [0, 0], t_eval=times, rtol=1e-9, atol=1e-11, max_step=5e-3
    )
    return result.y[0]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_hatch_moves_as_its_equation_of_motion_says(kind):
    errors = []
    for step in (2e-3, 1e-3):
        scene = loads(hatch(kind)).build()
        (outcome,) = simulate(scene, duration=0.8, instants=41, step=step)
        assert not outcome.failure
        opening = outcome.records["opening"].values[:, 0]
        errors.append(np.abs(opening - reference(kind, outcome.time)).max())
        force, length = (
            outcome.records[f"strut_{name}"].values[:, 0] for name in ("force", "length")
        )
        if kind != "damped":
            exact = [law(kind)(x) for x in length]
            assert force == pytest.approx(exact, rel=1e-4, abs=0.5)
    span = np.ptp(opening)
    assert errors[1] < 2e-4 * span and errors[1] < 0.35 * errors[0] + 2e-5 * span
    energies = dict(outcome.energies)
    assert np.abs(energies["balance"]).max() < 1e-3 * np.abs(energies["strut"]).max()


def test_the_stored_energy_is_least_at_zero_and_the_integral_of_the_force():
    lengths = np.linspace(0.2, 0.9, 2801)
    for kind in ("spring", "push", "pull", "table", "gas"):
        (strut,) = Strut.find(loads(hatch(kind)).build())
        first, slope, lift, _ = strut.numbers
        reach, bends = lengths - strut.lengths[0], np.diff(strut.all_slopes)
        ramps = np.maximum(lengths[:, None] - np.array(strut.lengths), 0.0)
        energy = lift - (first + slope * reach / 2) * reach - ramps**2 @ bends / 2
        force = np.array([strut.force(x) for x in lengths])
        assert -np.gradient(energy, lengths)[1:-1] == pytest.approx(force[1:-1], abs=0.5)
        inside = (
            energy if kind in ("spring", "push", "pull") else energy[lengths <= strut.lengths[-1]]
        )
        assert inside.min() == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize(
    ("strut", "words"),
    [
        ("stiffness: 1 N/m", "either `rest` or `preload`"),
        ("stiffness: 0 N/m, preload: 1 N", "above 0, with a `preload`"),
        ("stiffness: 1 N/m, preload: -9 N", "length without force above 0 m"),
        ("stiffness: 1 N/m, rest: 1 m, acts: pull, damping: 1 N s/m", "a damper of its own"),
        ("stiffness: 1 N m/rad, rest: 1 m", "a value in N/m"),
        ("stiffness: 1 N/m, rest: 1 m, acts: out", "both ways, push, pull"),
    ],
)
def test_what_is_refused_of_a_spring(strut, words):
    with pytest.raises(SceneError, match=words):
        loads(hatch("spring", strut)).build()


def test_what_is_refused_of_others():
    with pytest.raises(SceneError, match="below the length"):
        loads(hatch("gas", KINDS["gas"].replace("0.3 m", "0.8 m"))).build()
    with pytest.raises(SceneError, match="at increasing lengths above 0 m"):
        loads(hatch("table", KINDS["table"].replace("0.55 m", "0.35 m"))).build()


LINE = """
name: line
gravity: [0, 0, -9.81]
points: {o: [0, 0, 0], e: [0.6, 0, -0.8], f: [0.3, 0.5, 0.2]}
bodies: {r: {type: rod, from: o, to: e, mass: 2DIAMETER}}
joints: {ball: {type: spherical, parts: [ground, r], at: o}}
struts:
  s: {type: spring, between: [{part: ground, at: f}, {part: r, at: e}], stiffness: 500, rest: 0.5 m}
record: {e: {part: r, at: e}}
"""


def test_a_strut_at_the_end_of_a_thin_rod_does_not_shorten_the_step():
    """It has no moment about the rod's axis, so the step is that of a thicker rod."""
    line, thick = (LINE.replace("DIAMETER", text) for text in ("", ", diameter: 5 mm"))
    steps = [find_stable_step(loads(text).build()).step for text in (line, thick)]
    assert steps[0] == pytest.approx(steps[1], rel=1e-3)
