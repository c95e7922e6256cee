"""Extremes of the linkage's parameters: materials, sections, lengths, stiffnesses."""

from evidence.extremes.judge import CURVE_ACCURACY, RATTLE, WHIP, judge
from evidence.rows import Row


def materials() -> list[Row]:
    rows = []
    # Springs that bend a link double shut it long before the linkage closes.
    for modulus in (1e5, 3e5, 1e6):
        rows += judge(f"E = {modulus:g} Pa", {"E": modulus}, WHIP, is_whole_run=True)
    rows += judge("E = 1e+07 Pa", {"E": 1e7}, CURVE_ACCURACY)
    for modulus in (1e8, 1e9, 1e10):
        rows += judge(f"E = {modulus:g} Pa", {"E": modulus})
    rows += judge("E = 2.1e+11 Pa", {"E": 2.1e11}, reference="rigid")
    for density in (1.0, 2e4):
        rows += judge(f"rho = {density:g} kg/m³", {"rho": density})
    for nu in (-0.99, 0.0, 0.5):
        rows += judge(f"nu = {nu:g}", {"nu": nu})
    return rows


def sections() -> list[Row]:
    rows = judge("a = 2 mm", {"a": 0.002}, RATTLE, is_whole_run=True)
    rows += judge("a = 5 mm", {"a": 0.005}, WHIP, is_whole_run=True)
    rows += judge("a = 10 mm", {"a": 0.01}, CURVE_ACCURACY)
    for side in (0.02, 0.06, 0.12):
        rows += judge(f"a = {1e3 * side:g} mm", {"a": side})
    return rows + judge("a = 120 mm, E = 2.1e11 Pa", {"a": 0.12, "E": 2.1e11}, reference="rigid")


def lengths() -> list[Row]:
    """Long and short links, in size (all lengths scaled) and in slenderness (L alone)."""
    rows = []
    for length in (1e-3, 1e3):
        scale = length / 0.45
        parameters = {"L": length, "a": 0.035 * scale, "K_F": 5 * scale**2, "K_C": 1e4 * scale**2}
        rows += judge(f"L = {length:g} m, all scaled", parameters)
    rows += judge("L = 4.5 m, a = 35 mm (L/a = 129)", {"L": 4.5})
    short = {"L": 0.1, "E": 2.1e11}
    rows += judge("L = 0.1 m, a = 35 mm (L/a = 2.9)", {"L": 0.1})
    return rows + judge("the same, E = 2.1e11 Pa", short, reference="rigid")


def stiffnesses() -> list[Row]:
    rows = []
    for contact in (0.0, 1.0, 100.0, 1e4):
        name = f"K_C = {contact:g} N/rad, through the impact"
        rows += judge(name, {"K_C": contact}, is_whole_run=True)
    for contact in (1e6, 1e8):
        name = f"K_C = {contact:g} N/rad, through the impact"
        rows += judge(name, {"K_C": contact}, is_whole_run=True, duration=0.36)
    for spring in (0.1, 50.0):
        rows += judge(f"K_F = {spring:g} N/rad", {"K_F": spring})
    rows += judge("K_F = 1000 N/rad", {"K_F": 1e3}, CURVE_ACCURACY, is_whole_run=True)
    return rows + judge("K_F = 10000 N/rad", {"K_F": 1e4}, WHIP, is_whole_run=True)
