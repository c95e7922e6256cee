"""Andrews' squeezer: seven rigid bodies, three loops, a spring between two points, a torque.

Schiehlen (ed.), Multibody Systems Handbook (1990); Hairer & Wanner, Solving Ordinary Differential
Equations II, VII.7. The mechanism is written as a structure's file, and again as the equations of
the handbook in its seven angles, which DOP853 solves in their index-1 form."""

import numpy as np
from scipy.integrate import solve_ivp

from evidence.verification.bench import Bench, observed_orders
from fpm.structures import loads

DURATION, TORQUE = 0.03, 0.033
START = {
    "beta": -0.0617138900142764496, "Theta": 0.0, "gamma": 0.455279819163070380,
    "Phi": 0.222668390165885885, "delta": 0.487364979543842551, "Omega": -0.222668390165885885,
    "epsilon": 1.23054744454982119,
}  # fmt: skip
END = {  # at 0.03 s, as published
    "beta": 15.81077119629904, "Theta": -15.75637105984298, "gamma": 0.04082224013073101,
    "Phi": -0.5347301163226948, "delta": 0.5244099658805304, "Omega": 0.5347301163226948,
    "epsilon": 1.048080741042263,
}  # fmt: skip
HINGES = dict(zip(START, ("O", "F", "B", "G", "A", "H", "A_K7"), strict=True))

TEXT = f"""
name: squeezer
let:
  beta: {START["beta"]} rad
  gamma: {START["gamma"]} rad
  delta: {START["delta"]} rad
  epsilon: {START["epsilon"]} rad
points:
  O: [0, 0, 0]
  A: [-69.34 mm, -2.27 mm, 0]
  B: [-36.35 mm, 32.73 mm, 0]
  C: [14 mm, 72 mm, 0]
  F: rotate([7 mm, 0, 0], z, beta)
  E: -3*F
  G: A + rotate([40 mm, 0, 0], z, delta)
  H: A + rotate([0, -40 mm, 0], z, epsilon)
  D: B + rotate([20 mm, -18 mm, 0], z, gamma)
  c1: (0.92/7)*F
  c2: F + (11.5/28)*(E - F)
  c3: B + rotate([18.74 mm, -10.43 mm, 0], z, gamma)
  c4: G + (5.79/20)*(E - G)
  c5: A + rotate([23.08 mm, 9.16 mm, 0], z, delta)
  c6: H + (5.79/20)*(E - H)
  c7: A + rotate([-4.49 mm, -12.28 mm, 0], z, epsilon)
bodies:
  K1: {{mass: 0.04325, centre: c1, points: [O, F], inertia: [1.097e-6, 1.097e-6, 2.194e-6]}}
  K2: {{mass: 0.00365, centre: c2, points: [F, E], inertia: [2.205e-7, 2.205e-7, 4.41e-7]}}
  K3: {{mass: 0.02373, centre: c3, points: [B, E, D], inertia: [2.6275e-6, 2.6275e-6, 5.255e-6]}}
  K4: {{mass: 0.00706, centre: c4, points: [G, E], inertia: [2.8335e-7, 2.8335e-7, 5.667e-7]}}
  K5: {{mass: 0.07050, centre: c5, points: [A, G], inertia: [5.845e-6, 5.845e-6, 1.169e-5]}}
  K6: {{mass: 0.00706, centre: c6, points: [H, E], inertia: [2.8335e-7, 2.8335e-7, 5.667e-7]}}
  K7: {{mass: 0.05498, centre: c7, points: [A, H], inertia: [9.56e-6, 9.56e-6, 1.912e-5]}}
joints:
  O: {{type: revolute, parts: [ground, K1], at: O, axis: z}}
  F: {{type: revolute, parts: [K1, K2], at: F, axis: z}}
  E: {{type: revolute, parts: [K2, K3, K4, K6], at: E, axis: z}}
  B: {{type: revolute, parts: [ground, K3], at: B, axis: z}}
  A: {{type: revolute, parts: [ground, K5, K7], at: A, axis: z}}
  G: {{type: revolute, parts: [K5, K4], at: G, axis: z}}
  H: {{type: revolute, parts: [K7, K6], at: H, axis: z}}
actions:
  drive: {{type: torque motor, joint: O, torque: {TORQUE} N m}}
struts:
  spring:
    {{type: spring, between: [{{part: ground, at: C}}, D], stiffness: 4530 N/m, rest: 77.85 mm}}
record:
  E: {{part: K3, at: E}}
"""


def slopes(_, state: np.ndarray) -> np.ndarray:
    """Return rates (14,) of the seven angles (rad, in the order of START) and their rates, by the
    handbook's equations: M q'' + G' l = f, G q'' = -(G q')' of the three closed loops."""
    (be, th, ga, ph, de, om, ep), rates = state[:7], state[7:]
    bet, tht, gat, pht, det, omt, ept = rates
    m1, m2, m3, m4, m5, m6, m7 = 0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498
    i1, i2, i3, i4, i5, i6, i7 = (
        2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5
    )  # fmt: skip
    rr, ra, d, da, e, ea, zf, fa = 7e-3, 0.92e-3, 28e-3, 11.5e-3, 20e-3, 14.21e-3, 20e-3, 14.21e-3
    zt, ta, tb, u, ua, ub = 40e-3, 23.08e-3, 9.16e-3, 40e-3, 12.28e-3, 4.49e-3
    ss, sa, sb, sc, sd = 35e-3, 18.74e-3, 10.43e-3, 18e-3, 20e-3
    M = np.zeros((7, 7))
    M[0, 0] = m1 * ra**2 + m2 * (rr**2 - 2 * da * rr * np.cos(th) + da**2) + i1 + i2
    M[1, 0] = M[0, 1] = m2 * (da**2 - da * rr * np.cos(th)) + i2
    M[1, 1] = m2 * da**2 + i2
    M[2, 2] = m3 * (sa**2 + sb**2) + i3
    M[3, 3] = m4 * (e - ea) ** 2 + i4
    M[4, 3] = M[3, 4] = m4 * ((e - ea) ** 2 + zt * (e - ea) * np.sin(ph)) + i4
    M[4, 4] = m4 * (zt**2 + 2 * zt * (e - ea) * np.sin(ph) + (e - ea) ** 2)
    M[4, 4] += m5 * (ta**2 + tb**2) + i4 + i5
    M[5, 5] = m6 * (zf - fa) ** 2 + i6
    M[6, 5] = M[5, 6] = m6 * ((zf - fa) ** 2 - u * (zf - fa) * np.sin(om)) + i6
    M[6, 6] = m6 * ((zf - fa) ** 2 - 2 * u * (zf - fa) * np.sin(om) + u**2)
    M[6, 6] += m7 * (ua**2 + ub**2) + i6 + i7

    x, y = sd * np.cos(ga) + sc * np.sin(ga), sd * np.sin(ga) - sc * np.cos(ga)
    gap = np.array([x - 0.03635 - 0.014, y + 0.03273 - 0.072])
    length = np.hypot(*gap)
    pull = -4530 * (length - 0.07785) / length * gap
    f = np.zeros(7)
    f[0] = TORQUE - m2 * da * rr * tht * (tht + 2 * bet) * np.sin(th)
    f[1] = m2 * da * rr * bet**2 * np.sin(th)
    f[2] = pull @ (-y, x)
    f[3] = m4 * zt * (e - ea) * det**2 * np.cos(ph)
    f[4] = -m4 * zt * (e - ea) * pht * (pht + 2 * det) * np.cos(ph)
    f[5] = -m6 * u * (zf - fa) * ept**2 * np.cos(om)
    f[6] = m6 * u * (zf - fa) * omt * (omt + 2 * ept) * np.cos(om)

    # E by four chains, as lengths at angles: that by the crank less each of the others is 0.
    chains = (
        ((rr, be, bet, (0,)), (-d, be + th, bet + tht, (0, 1))),
        ((ss, ga - np.pi / 2, gat, (2,)),),
        ((e, ph + de - np.pi / 2, pht + det, (3, 4)), (zt, de, det, (4,))),
        ((zf, om + ep, omt + ept, (5, 6)), (u, ep - np.pi / 2, ept, (6,))),
    )
    jacobians, accelerations = np.zeros((4, 2, 7)), np.zeros((4, 2))
    for k, chain in enumerate(chains):
        for size, angle, rate, columns in chain:
            arm = size * np.array([np.cos(angle), np.sin(angle)])
            jacobians[k][:, columns] += np.array([-arm[1], arm[0]])[:, None]
            accelerations[k] -= rate**2 * arm
    G = (jacobians[:1] - jacobians[1:]).reshape(6, 7)
    rest = (accelerations[:1] - accelerations[1:]).ravel()
    matrix = np.block([[M, G.T], [G, np.zeros((6, 6))]])
    return np.concatenate([rates, np.linalg.solve(matrix, np.concatenate([f, -rest]))[:7]])


def squeezer(bench: Bench) -> None:
    """Andrews' squeezer under a constant torque, over two turns and a half of its crank."""
    scene, instants = loads(TEXT).build(), 151
    times = np.linspace(0, DURATION, instants)
    start = [*START.values(), *np.zeros(7)]
    exact = solve_ivp(slopes, (0, DURATION), start, "DOP853", times, rtol=1e-12, atol=1e-12).y[:7]
    steps = [DURATION / (150 * n) for n in (10, 20, 40)]
    outcomes = [
        bench.simulate([scene], duration=DURATION, instants=instants, step=step)[0]
        for step in steps
    ]
    errors = []
    for outcome in outcomes:
        angles = [START[name] + outcome.openings[HINGES[name]] for name in START]
        errors.append(np.abs(np.array(angles) - exact).max())
    source = "Schiehlen 1990; Hairer & Wanner II"
    for name, angle in zip(START, exact, strict=True):
        bench.check(f"equations alone: {name} at 30 ms (rad)", angle[-1], END[name], 5e-9, source,
                    measure="absolute")  # fmt: skip
    fine = outcomes[-1]
    for name, hinge in HINGES.items():
        value = START[name] + fine.openings[hinge][-1]
        bench.check(f"{name} at 30 ms (rad)", value, END[name], 3e-5, source, measure="absolute")
    bench.check_small("all angles at 5 us (rad)", errors[-1], 3e-5, "DOP853 of the equations", "1")
    bench.check_at_least("order of the angles", observed_orders(errors).min(), 1.9, source)
    worst = np.abs(fine.energies["balance"]).max() / np.ptp(fine.energies["kinetic"])
    bench.check_small("energy balance", worst, 1e-4, "torque and spring", "energy")


PROBLEMS = {"Andrews' squeezer": squeezer}
