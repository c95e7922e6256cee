"""Structures of the library from their files: a scissor mast, the interval of a latch's time,
bounds of curves through a stop."""

from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import xarray
from scipy.integrate import quad

from evidence.verification.bench import Bench
from fpm import structures

CONFIG = Path(__file__).parents[2] / "config"
START, END = np.radians([85, 30])


def scissor(units, k=1.0, gyration=0.0):
    """Time (s) and rate (rad/s) of a rigid planar scissor mast from 85 to 30 degrees to its axis.

    Bars of 1 m and 1 kg; gyration (m): radius of gyration of a bar's section, which turns with it.
    """

    def mass(q):
        inertia = units / 12 + np.sin(q) ** 2 * units * (4 * units**2 - 1) / 12
        return 2 * (inertia + units * gyration**2)

    def rate(q):
        return np.sqrt(4 * units * k * (START**2 - q**2) / mass(q))

    # With q = START - u², the integrand stays finite where the mast starts from rest.
    def slowness(u):
        q = START - u * u
        return 2 * u / rate(q) if u else 2 / np.sqrt(8 * units * k * START / mass(START))

    return quad(slowness, 0, np.sqrt(START - END), epsabs=1e-13)[0], float(rate(END))


def crossing(time, values, level):
    """The first time (s) at which values (t,) pass a level, and their rate there.

    A cubic through the four instants around it."""
    index = int(np.argmax((values[1:] - level) * (values[0] - level) <= 0)) + 1
    window = slice(max(index - 2, 0), max(index - 2, 0) + 4)
    cubic = np.polynomial.Polynomial.fit(time[window], values[window] - level, 3)
    root = min(cubic.roots().real, key=lambda t: abs(t - time[index]))
    return float(root), float(cubic.deriv()(root))


def scissor_mast(bench: Bench) -> None:
    """Masts of 1 and 3 units of elastic bars: the time to open tends to the rigid one as 1/E."""
    mast = structures.load(CONFIG / "structures/scissor.yaml")
    for units in (1, 3):
        exact, _ = scissor(units, gyration=0.02 / np.sqrt(12))
        errors = []
        for modulus in (10, 100):  # GPa
            scene = mast.build(n=units, E=modulus, elements=2)
            (outcome,) = bench.simulate(scene, duration=0.5 * units**0.95, instants=2001)
            root, end = (outcome.points[name][0][:, 0] for name in ("root", "end"))
            time, _ = crossing(outcome.time, end - root, units * np.cos(END))
            errors.append(time / exact - 1)
        bench.check(f"n = {units}, E = 100 GPa: time to 30° (s)", time, exact, 1e-4,
                    "∫ √(M/(2 (V(0) - V))) dq: rigid bars")  # fmt: skip
        bench.check(f"n = {units}: error at 100 GPa over that at 10", errors[1] / errors[0], 0.1,
                    0.5, "it falls as 1/E")  # fmt: skip


def interval_of_a_latch(bench: Bench) -> None:
    """The shipped campaign of a panel with a latch: t = √(J/k) arccos((ψ - θ)/ψ) over the box."""
    from deployable import campaign

    with TemporaryDirectory() as folder, bench.time_solver():
        campaign.run(CONFIG / "latch.yaml", folder, figures=False, notify=lambda text: None)
        with xarray.open_dataset(Path(folder, "latch", "quantities.nc")) as file:
            row = file.sel(quantity="t_latch").load()
    times = [
        np.sqrt(1 / (3 * k)) * np.arccos((180 - angle) / 180)
        for k, angle in product((0.09, 0.11), (89, 91))
    ]
    for end, exact in (("lower", min(times)), ("upper", max(times))):
        bench.check(f"{end} end of the time (s)", float(row[end]), exact, 1e-6, "closed form")


CART = """
name: cart
description: A cart that runs against a stop
parameters:
  v: {value: 2, unit: m/s, range: [1, 3], description: speed at the start}
  L: {value: 1, unit: m, range: [0.5, 2], description: place of the stop}
points: {start: [0, 0, 0]}
bodies: {cart: {mass: 1, centre: start, box: [0.1 m, 0.1 m, 0.1 m]}}
joints: {rail: {type: prismatic, parts: [ground, cart], at: start, axis: x, opening: 0}}
actions: {stop: {type: stop, joint: rail, upper: L, stiffness: 1e6}}
opening_rates: {go: {joint: rail, rate: v}}
"""


def bounds_through_a_stop(bench: Bench) -> None:
    """A cart meets a stop at its own time in each run: 13 runs, against x = v t and v cos ωt."""
    from deployable import campaign

    config = {
        "campaign": "stop",
        "scene": {"file": "cart.yaml"},
        "solver": {"duration": 1.0, "instants": 1001},
        "intervals": {"v": {"absolute": 0.2}, "L": {"absolute": 0.1}},
        "design": {"method": "tensor_lobatto", "order": 2},
        "responses": {"place": {"opening": "rail"}, "rate": {"opening_rate": "rail"}},
    }
    with TemporaryDirectory() as folder, bench.time_solver():
        Path(folder, "cart.yaml").write_text(CART, encoding="utf-8")
        config["scene"] = {"file": str(Path(folder, "cart.yaml"))}
        campaign.run(config, folder, figures=False, notify=lambda text: None)
        with xarray.open_dataset(Path(folder, "stop", "bounds.nc")) as file:
            bounds = file.load()
    time, omega = bounds["time"].values, 1e3
    low, high = np.full((2, 2, len(time)), [[[np.inf]], [[-np.inf]]])
    for v, length in product(np.linspace(1.8, 2.2, 201), np.linspace(0.9, 1.1, 201)):
        lapse = time - length / v
        angle = np.clip(omega * lapse, 0.0, np.pi)
        rebound = np.maximum(lapse - np.pi / omega, 0.0)
        place = np.where(lapse < 0, v * time, length + v / omega * np.sin(angle) - v * rebound)
        curves = np.array([place, v * np.cos(angle)])
        low, high = np.minimum(low, curves), np.maximum(high, curves)
    for i, name in enumerate(("place", "rate")):
        row = bounds.sel(response=name)
        lower, upper, error = (row[key].values for key in ("lower", "upper", "error"))
        width = high[i] - low[i]
        distance = np.maximum(np.abs(lower - low[i]), np.abs(upper - high[i]))
        share = distance.sum() / width.sum()
        bench.check_small(f"{name}: error of the bounds", share, 0.01, "closed form", "the width")
        slack = error + 1e-3 * width.max()
        is_inside = (low[i] >= lower - slack) & (high[i] <= upper + slack)
        text = f"{name}: share of the instants within bounds and error"
        bench.check_at_least(text, float(is_inside.mean()), 0.95, "closed form")


PROBLEMS = {
    "scissor mast": scissor_mast,
    "interval of a latch's time": interval_of_a_latch,
    "bounds of curves through a stop": bounds_through_a_stop,
}
