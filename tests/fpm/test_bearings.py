"""Friction by the force that a joint itself bears, moving, against closed forms."""

from itertools import permutations

import numpy as np
import pytest
from hinged import hinged

import fpm
from fpm.elements import Friction, Hinge, Joint
from fpm.solver.pack import pack
from fpm.structures import StructureError, loads
from fpm.structures.plausible import warnings
from fpm.travel import sweep
from fpm.travel.components import component_classes

SPUN = """
name: spun
parameters:
  rate: {value: 3, unit: rad/s, range: [-9, 9]}
  mu: {value: 0.2, range: [0, 1]}
points: {a: [0, 0, 0], b: [1, 0, 0]}
bodies:
  sheet: {mass: 1 kg, centre: b, inertia: [0.1, 0.1, 0.1], points: [a]}
joints:
  h: {type: revolute, parts: [ground, sheet], at: a, axis: z}
actions:
  rub: {type: bearing, joint: h, mu: mu, radius: 50 mm, load: 9 N}
initial_velocities:
  go: {part: sheet, about: a, spin: [0, 0, rate]}
record:
  a: {part: sheet, at: a}
"""
BOTH = SPUN.replace(
    "joints:", "  lump: {mass: 2 kg, centre: b, inertia: [0.1, 0.1, 0.1]}\njoints:\n"
    "  weld: {type: fixed, parts: [sheet, lump], at: b}"
).replace("record:", "  too: {part: lump, about: a, spin: [0, 0, rate]}\nrecord:")  # fmt: skip
CROSS = SPUN.replace("revolute", "universal").replace("axis: z", "axis: y, other: z")
CROSS = CROSS.replace("joint: h,", "joint: h_other,")  # about the second angle of a universal joint
RAIL = """
name: rail
gravity: [0, 0, -9.81 m/s2]
parameters:
  mu: {value: 0.3, range: [0, 1]}
points: {a: [0, 0, 0]}
bodies:
  cart: {mass: 2 kg, centre: a, inertia: [1, 1, 1]}
joints:
  h: {type: prismatic, parts: [ground, cart], at: a, axis: x}
actions:
  rub: {type: bearing, joint: h, mu: mu, load: 30 N}
initial_velocities:
  go: {part: cart, about: a, velocity: [2 m/s, 0, 0]}
record:
  a: {part: cart, at: a}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "mass", "inertia"), [(SPUN, 1.0, 1.1), (BOTH, 3.0, 3.2), (CROSS, 1.0, 1.1)]
)
def test_a_sheet_that_spins_is_braked_by_its_own_pull(text, mass, inertia):
    """Its hinge, alone or among others, bears m r w², so that w falls as 1/(1 + c w t), c being mu
    times the radius times m r/J. From rest of the bristle it slips after 1 mrad, its bend."""
    made = loads(text)
    several = [made.build(), made.build(rate=-3.0), made.build(mu=0.0)]
    falls = 0.2 * 0.05 * mass / inertia
    balance = []
    for step in (2e-3, 1e-3):
        runs = fpm.simulate(several, duration=20.0, instants=201, step=step)
        exact = np.log(1 + falls * 3.0 * runs[0].time) / falls
        for run, way in zip(runs[:2], (1, -1), strict=True):
            assert run.failure is None
            opening = run.records["opening"].values[:, -1]
            assert opening == pytest.approx(way * exact, abs=2e-3)
        balance.append(np.abs(runs[0].energies["balance"]).max())
        assert runs[2].records["opening"].values[-1, -1] == pytest.approx(60.0, abs=2e-3)
    assert balance[1] < 2e-5 * mass * 9
    assert balance[1] < 0.6 * balance[0]  # the force is that of the step before


@pytest.mark.parametrize("text", [SPUN, RAIL])
def test_in_margins_it_is_one_part_with_a_load_or_without(text):
    with_load = loads(text).build()
    without = loads(text.replace(", load: 9 N", "").replace(", load: 30 N", "")).build()
    assert {component_classes(scene)["bearing h"] for scene in (with_load, without)} == {"FR"}
    first, second = (sweep(s, "h", 0.0, 0.5, positions=5).work for s in (with_load, without))
    assert first.keys() == second.keys()
    assert first["bearing h"] == pytest.approx(second["bearing h"], rel=1e-9, abs=1e-9)
    assert not any("bearing" in told for told in warnings(with_load))
    assert any("counts in margins only" in told for told in warnings(without))


@pytest.mark.parametrize(("text", "joined"), [(SPUN, Hinge), (BOTH, Joint)])
def test_only_a_motion_with_a_load_pays_for_it(text, joined):
    """Impulses are summed over each step where something reads them."""
    for given, counted in ((text, True), (text.replace(", load: 9 N", ""), False)):
        batch = pack([loads(given).build()], 2)
        assert (batch.part(joined).sums is not None) == counted


@pytest.mark.parametrize("more", [{"load": 0.0}, {"load": 1.0, "angles": (0, 1), "shares": (1, 1)}])
def test_a_load_that_cannot_be_is_refused(more):
    with pytest.raises(fpm.SceneError, match="above 0, without a table"):
        hinged(0.0).add(Friction(0, 0.1, **more))


PIN = """
name: pin
points: {O: [0, 0, 0], t: [1, 0, 0], u: [0, 1, 0]}
bodies:
  a: {mass: 1, centre: t, points: [O], inertia: [0.01, 0.01, 0.01]}
  b: {mass: 3, centre: u, points: [O], inertia: [0.01, 0.01, 0.01]}
joints:
JOINTS
actions:
  rub: {type: bearing, joint: pin, mu: 0.1, radius: 100 mm}
loads:
  l: {part: b, at: u, force: [0, -20 N, 0]}
  m: {part: a, at: t, force: [3 N, 2 N, 0]}
record:
  t: {part: a, at: t}
"""


def pinned(**joints: list[str]) -> str:
    """The two bodies on joints at one point, by the parts of each."""
    lines = [
        f"  {name}: {{type: revolute, parts: [{', '.join(parts)}], at: O, axis: z}}"
        for name, parts in joints.items()
    ]
    return PIN.replace("JOINTS", "\n".join(lines))


@pytest.mark.parametrize("parts", list(permutations(["ground", "a", "b"])))
@pytest.mark.parametrize("load", ["", ", load: 20 N"])
def test_on_a_pin_of_three_parts_it_is_refused(parts, load):
    """Its force would be that between the first two parts that are stated."""
    text = pinned(pin=list(parts)).replace("100 mm", f"100 mm{load}")
    with pytest.raises(StructureError, match=r"of 3 parts.*a joint of two parts: state the pin as"):
        loads(text)


CRANK = """
name: crank
parameters:
  start: {value: 30, unit: deg, range: [1, 89]}
  mu: {value: 0.5, range: [0, 5]}
  rise: {value: 0.44, unit: m, range: [-2, 2]}
  pull: {value: 20, unit: N, range: [0, 100]}
points:
  a: [0, 0, sin(start)*(1 m)]
  b: [cos(start)*(1 m), 0, 0]
  m: [cos(start)*(0.5 m), 0, sin(start)*(0.5 m)]
bodies:
  A: {mass: 1, centre: a, points: [a], inertia: [0.1, 0.1, 0.1]}
  B: {mass: 0.1, centre: b, points: [b], inertia: [0.1, 0.1, 0.1]}
  rod: {mass: 0.01, centre: m, points: [a, b], inertia: [0.001, 0.001, 0.001]}
joints:
  lift: {type: prismatic, parts: [ground, A], at: a, axis: z}
  slide: {type: prismatic, parts: [ground, B], at: b, axis: x}
  top: {type: universal, parts: [A, rod], at: a, axis: y, other: {from: a, to: b}}
  foot: {type: spherical, parts: [rod, B], at: b}
curves:
  up: {times: [0, 2], values: [0, 1]}
actions:
  lead: {type: motor, joint: lift, travel: rise, curve: up}
  rub: {type: bearing, joint: slide, mu: mu, load: 20 N}
loads:
  p: {part: B, at: b, force: [pull, 0, 0]}
record:
  b: {part: B, at: b}
"""


@pytest.mark.slow
def test_what_is_led_into_self_locking_fails_there():
    """A rod at the angle t pulls a slide by F, against P and mu F sin t: F = P/(cos t - mu sin t),
    and locks from tan t = 1/mu on, 63.43 deg. It is led up to 70.05 deg, where tan t is 2.754."""
    made = loads(CRANK)
    cases = [
        {},
        {"mu": 0.36},
        {"mu": 0.1},
        {"start": 70, "rise": 0.04},
        {"start": 70, "rise": -0.4},
        {"start": 70, "rise": -0.4, "mu": 0.4},
        {"start": 80, "rise": -0.5},
    ]
    asked = [("joint_force", "slide friction")]
    runs = fpm.simulate(
        [made.build(**case) for case in cases], duration=2.0, instants=201, step=5e-4, record=asked
    )
    locked, nearly, free, at_once, *out = runs
    for run, start, rise in ((locked, 30, 0.44), (at_once, 70, 0.04)):
        assert run.failure.cause == "lock"
        assert "at t = " in str(run.failure) and "bearing slide" in str(run.failure)
        assert "less `mu`" in str(run.failure)
        angle = np.arcsin(np.sin(np.radians(start)) + rise * run.failure.time / 2)
        assert np.degrees(angle) == pytest.approx(max(start, 63.43), abs=0.5)
    for run, mu in ((nearly, 0.36), (free, 0.1)):
        assert run.failure is None
        # Nearer to the lock the step, by which the force is late, counts more: 1/(1 - mu tan t).
        angle = np.arcsin(0.5 + 0.44 * run.time / 2)
        chosen = (mu * np.tan(angle) < 0.7) & (run.time > 0.2) & (run.time < 1.95)
        angle = angle[chosen]
        expected = mu * 20 * np.sin(angle) / (np.cos(angle) - mu * np.sin(angle))
        assert run.columns[asked[0]][chosen] == pytest.approx(expected, rel=0.01)
    # Led out of it, friction relieves the joint: F = P/(cos t + mu sin t), within the inertias.
    for run, case in zip(out, cases[4:], strict=True):
        assert run.failure is None
        mu = case.get("mu", 0.5)
        angle = np.arcsin(np.sin(np.radians(case["start"])) + case["rise"] * run.time / 2)
        expected = -mu * 20 * np.sin(angle) / (np.cos(angle) + mu * np.sin(angle))
        chosen = (run.time > 0.2) & (run.time < 1.95)
        assert run.columns[asked[0]][chosen] == pytest.approx(expected[chosen], rel=0.01)
    (jumps,) = fpm.simulate(
        [made.build(start=85, rise=-0.6, pull=100)], duration=2.0, instants=201, step=5e-4
    )
    assert "outside of self-locking" in str(jumps.failure) or jumps.failure.cause == "lock"
