"""Starts in static equilibrium: a rod that sags by its weight, one let go from its bent shape."""

import numpy as np
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from evidence.verification.bench import Bench, observed_orders
from fpm.structures import loads

MODULUS, DENSITY, DIAMETER, LENGTH, GRAVITY, PULL = 210e9, 7850.0, 4e-3, 2.0, 9.81, 0.02
MASS, STIFFNESS = DENSITY * np.pi * DIAMETER**2 / 4, MODULUS * np.pi * DIAMETER**4 / 64
ROD = f"""
start: equilibrium
parameters:
  elements: {{value: 16, whole: true}}
  weight: {{value: 0, unit: m/s2}}
  pull: {{value: 0, unit: N}}
gravity: [0, 0, -weight]
points: {{root: [0, 0, 0], tip: [{LENGTH}, 0, 0]}}
materials: {{steel: {{E: {MODULUS}, nu: 0.3, rho: {DENSITY}}}}}
sections: {{wire: {{type: circle, diameter: {DIAMETER}}}}}
bars: {{rod: {{through: [root, tip], section: wire, material: steel, elements: elements}}}}
supports: {{root: {{part: rod, at: root}}}}
curves: {{cut: {{times: [0, 1e-9], values: [1, 0]}}}}
loads: {{pull: {{part: rod, at: tip, force: [0, 0, -pull], curve: cut}}}}
record: {{tip: {{part: rod, at: tip}}}}
"""


def sag(bench: Bench) -> None:
    """A clamped rod that sags by a third of its length: E I turn'' = -w (L - s) cos turn."""
    places = np.linspace(0, LENGTH, 201)
    ratio = MASS * GRAVITY / STIFFNESS

    def slopes(s, y):
        turn = y[0]
        return np.array([y[1], -ratio * (LENGTH - s) * np.cos(turn), np.cos(turn), -np.sin(turn)])

    def ends(first, last):
        return np.array([first[0], last[1], first[2], first[3]])

    guess = np.array([0 * places, 0 * places, places, 0 * places])
    exact = solve_bvp(slopes, ends, places, guess, tol=1e-10, max_nodes=100_000).y[2:, -1]
    meshes, errors = (8, 16, 32), []
    for elements in meshes:
        scene = loads(ROD).build(elements=elements, weight=GRAVITY)
        errors.append(np.linalg.norm(scene.position[-1, [0, 2]] - exact) / LENGTH)
    (outcome,) = bench.simulate([scene], duration=0.01, instants=11)
    source = "elastica by collocation (solve_bvp)"
    bench.check_small("end of the rod, 32 elements", errors[-1], 1e-4, source, "L")
    for coarse, fine, order in zip(meshes, meshes[1:], observed_orders(errors), strict=False):
        bench.check(f"order from {coarse} to {fine} elements", order, 2.0, 0.05, "order 2")
    speed = np.sqrt(2 * outcome.energies["kinetic"].max() / scene.mass.sum())
    bench.check_small("mean speed after 10 ms", speed / (GRAVITY * 0.01), 1e-8, "at rest", "g t")


def let_go(bench: Bench) -> None:
    """A clamped rod that a force at its end bends, and that is cut: the sum of its modes."""
    betas = [
        brentq(lambda b: np.cos(b) + 1 / np.cosh(b), np.pi * (k + 0.2), np.pi * (k + 0.8))
        for k in range(8)
    ]
    rates = np.array(betas) ** 2 * np.sqrt(STIFFNESS / (MASS * LENGTH**4))
    parts = 4 * PULL / (MASS * LENGTH * rates**2)
    period = 2 * np.pi / rates[0]
    scene = loads(ROD).build(elements=32, pull=PULL)
    (outcome,) = bench.simulate([scene], duration=2 * period, instants=401)
    height = outcome.points["tip"][0][:, 2]
    source = "Euler-Bernoulli: sum over the modes of a clamped rod"
    bench.check("deflection at the start (mm)", -1e3 * height[0], 1e3 * PULL * LENGTH**3
                / (3 * STIFFNESS), 1e-3, "P L³ / (3 E I)")  # fmt: skip
    waves = np.array([np.cos(rates[0] * outcome.time), np.sin(rates[0] * outcome.time)])
    share = np.linalg.lstsq(waves.T, -height, rcond=None)[0]
    bench.check("amplitude of the first mode (mm)", 1e3 * share[0], 1e3 * parts[0], 2e-3, source)
    expected = -parts @ np.cos(np.outer(rates, outcome.time))
    bench.check_small(
        "end of the rod over two periods", np.abs(height - expected).max() / parts[0], 1e-2,
        f"{source}, β₁ L = {betas[0]:.4f}", "amplitude",
    )  # fmt: skip


PROBLEMS = {"sag of a rod from the start": sag, "rod let go from its bent shape": let_go}
