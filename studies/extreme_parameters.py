"""Extremes of the linkage's parameters: materials, sections, lengths, stiffnesses."""

import fpm
from studies.judge import REFUSED, judge, refusal
from studies.linkage import build
from studies.rows import Row


def materials() -> list[Row]:
    rows = []
    for modulus, against, tolerance in (
        (1e5, "finer", 0.1), (1e6, "finer", 0.05), (1e7, "finer", 0.01), (1e8, "finer", 0.005),
        (1e9, "finer", 0.002), (1e10, "finer", 0.002), (2.1e11, "rigid", 0.002),
    ):  # fmt: skip
        # Springs that bend a link double shut it long before the linkage closes.
        whole = modulus < 1e7
        name = f"E = {modulus:g} Pa"
        duration = None
        if modulus == 1e5:  # later the links whip about, and no two meshes agree
            name, duration = f"{name}, first 0.1 s", 0.1
        rows += judge(
            name, {"E": modulus}, tolerance, against=against, past_closure=whole, duration=duration
        )
    for density in (1.0, 2e4):
        rows += judge(f"rho = {density:g} kg/m³", {"rho": density}, 0.002)
    for nu in (-0.99, 0.0, 0.5):
        rows += judge(f"nu = {nu:g}", {"nu": nu}, 0.002)
    return rows


def sections() -> list[Row]:
    rows = []
    for side, against, tolerance in (
        (0.002, "finer", 0.1), (0.005, "finer", 0.05), (0.01, "finer", 0.01),
        (0.02, "finer", 0.005), (0.06, "finer", 0.002), (0.12, "finer", 0.002),
    ):  # fmt: skip
        whole = side < 0.01
        name = f"a = {1e3 * side:g} mm"
        rows += judge(name, {"a": side}, tolerance, against=against, past_closure=whole)
    steel = {"a": 0.12, "E": 2.1e11}
    return rows + judge("a = 120 mm, E = 2.1e11 Pa", steel, 0.002, against="rigid")


def lengths() -> list[Row]:
    """Long and short links, in size (all lengths scaled) and in slenderness (L alone)."""
    rows = []
    for length in (1e-3, 1e3):
        scale = length / 0.45
        parameters = {"L": length, "a": 0.035 * scale, "K_F": 5 * scale**2, "K_C": 1e4 * scale**2}
        rows += judge(f"L = {length:g} m, all scaled", parameters, 0.002)
    rows += judge("L = 4.5 m, a = 35 mm (L/a = 129)", {"L": 4.5}, 0.01)
    short = {"L": 0.1, "E": 2.1e11}
    rows += judge("L = 0.1 m, a = 35 mm (L/a = 2.9)", {"L": 0.1}, 0.002)
    return rows + judge("the same, E = 2.1e11 Pa", short, 0.002, against="rigid")


def stiffnesses() -> list[Row]:
    rows = []
    for contact in (0.0, 1.0, 100.0, 1e4):
        parameters = {"K_C": contact}
        rows += judge(
            f"K_C = {contact:g} N/rad, through the impact", parameters, 0.01, past_closure=True
        )
    for contact in (1e6, 1e8):
        rows += judge(
            f"K_C = {contact:g} N/rad, through the impact", {"K_C": contact}, 0.02,
            past_closure=True, duration=0.36,
        )  # fmt: skip
    rows += judge("K_F = 0.1 N/rad", {"K_F": 0.1}, 0.002)
    for spring, tolerance in ((50.0, 0.01), (1e3, 0.05), (1e4, 0.1)):
        whole = spring > 100
        rows += judge(f"K_F = {spring:g} N/rad", {"K_F": spring}, tolerance, past_closure=whole)
    return rows


def refusals() -> list[Row]:
    """Values that make no structure: refused when the scene is built."""
    rows = []
    for parameters in (
        {"nu": -1.0}, {"nu": 0.51}, {"E": 0.0}, {"E": -1e9}, {"rho": 0.0}, {"a": 0.0},
        {"K_C": -1.0}, {"K_F": float("nan")}, {"E": float("inf")}, {"elements_per_link": 0},
        {"start_deg": 121.0}, {"inertia_scale": 0.5}, {"inertia_scale": 1e3}, {"a": 0.6},
        {"damping": -1.0}, {"omega_deg": 30.0, "mu_deg": 45.0},
    ):  # fmt: skip
        name = ", ".join(f"{k} = {v:g}" for k, v in parameters.items())
        try:
            build(**parameters)
        except fpm.SceneError as error:
            rows.append(refusal(name, error))
        else:
            rows.append(Row(name, "built", REFUSED, "", False, "fpm.SceneError"))
    return rows
