"""Structures of the library from their files: a scissor mast, the interval of a latch's time."""

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


PROBLEMS = {"scissor mast": scissor_mast, "interval of a latch's time": interval_of_a_latch}
