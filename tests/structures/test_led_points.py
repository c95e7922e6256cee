"""Points that are led along some global axes, and free along and about others."""

from contextlib import nullcontext

import pytest

import fpm
from fpm.structures import loads

TEXT = """
name: led
materials: {wood: {E: 10 GPa, rho: 600 kg/m3}}
sections: {square: {type: square, side: 20 mm}}
points: {a: [0, 0, 0], b: [0.6 m, 0, 0.3 m], c: [0.6 m, 0.1 m, 0.5 m]}
bars: {rod: {through: [a, b], section: square, material: wood, elements: 2}}
bodies: {bob: {mass: 0.3, centre: c, points: [b], box: [0.1, 0.2, 0.05]}}
joints: {wrist: {type: spherical, parts: [rod, bob], at: b}}
curves: {ramp: {times: [0, 0.1, 0.2, 0.3], values: [0, 1, -1, 0.5]}}
gravity: [0, 0, -9.81]
record: {tip: {part: rod, at: b}, c: {part: bob, at: c}}
"""


@pytest.mark.parametrize("group", ["supports", "drives"])
def test_an_axis_that_something_else_holds_is_refused(group):
    for axes, is_wrong in (("x", True), ("y", False)):
        lead = "drives: {lead: {part: rod, at: a, translations: xz, rotations: none}"
        other = f"other: {{part: rod, at: a, translations: {axes}, rotations: none}}"
        text = f"{lead}, {other}}}" if group == "drives" else f"{lead}}}\nsupports: {{{other}}}"
        with (
            pytest.raises(fpm.SceneError, match="nothing else holds") if is_wrong else nullcontext()
        ):
            loads(f"{TEXT}{text}\n").build()


@pytest.mark.parametrize(
    "keys, problem",
    [
        ("translations: x, velocity: [1, 0, 0]", "lead: `rotations`"),
        ("rotations: yz, velocity: [1, 0, 0]", "drives.lead.rotations"),
        ("translations: none, rotations: none", "drives.lead.translations"),
        ("translations: x, rotations: none, velocity: [1, 0, 2]", "drives.lead.velocity"),
        ("rotations: none, velocity: [1, 0, 2], spin: [0, 1, 0]", "drives.lead.spin"),
        ("translations: xx, rotations: none", "drives.lead.translations"),
    ],
)
def test_what_does_not_fit_is_refused(keys, problem):
    with pytest.raises(fpm.SceneError, match=problem):
        loads(TEXT + f"drives: {{lead: {{part: rod, at: a, {keys}}}}}\n").build()


DRIVEN = """
name: driven
points: {o: [0, 0, 0]}
bodies: {b: {mass: 1.4, centre: o, inertia: [0.01, 0.02, 0.03], x: [1, 0, 1], up: [-1, 0, 1]}}
curves: {up: {times: [0, 1], values: [0, 1]}, down: {times: [0, 1], values: [1, 0]}}
record: {o: {part: b, at: o}}
drives:
"""
MOVES = "  move: {part: b, at: o, velocity: [1, 0, 0]CURVE}\n"
SPINS = "  spin: {part: b, at: o, spin: [0, 0, 10], curve: up}\n"
SLOWS = "  slow: {part: b, at: o, velocity: [2, 0, 0], curve: down}\n"


@pytest.mark.parametrize(
    ("drives", "energy"),
    [
        (MOVES.replace("CURVE", ""), lambda t: 0.7 + 0 * t),
        (MOVES.replace("CURVE", ", curve: up") + SPINS, lambda t: (0.7 + 50 * 0.02) * t**2),
        (MOVES.replace("CURVE", ", curve: up") + SLOWS, lambda t: 0.7 * (2 - t) ** 2),
    ],
)
def test_what_drives_lead_has_the_kinetic_energy_that_they_gave_it(drives, energy):
    """m v²/2 + w·Jw/2, J about z being the mean of two principal ones; several drives add up."""
    (outcome,) = fpm.simulate(loads(DRIVEN + drives).build(), duration=1, instants=11, step=0.1)
    exact = energy(outcome.time)
    assert outcome.energies["kinetic"] == pytest.approx(exact, abs=1e-9)
    assert outcome.energies["load_work"] == pytest.approx(exact - exact[0], abs=1e-9)
