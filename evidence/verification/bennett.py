"""The flexible Bennett linkage against the rigid one: closed-form kinematics, and its motion."""

import numpy as np

import fpm
from evidence.linkage.rigid import RigidBennett
from evidence.linkage.runs import build
from evidence.verification.bench import Bench

# (lambda, mu) in degrees, with supports in the plane; each closes between 0.26 and 0.39 s.
ANGLES = ((45.0, 45.0), (30.0, 60.0), (45.0, 22.5), (65.0, 35.0))
STIFF = 1e12  # Pa: bending is negligible
SOURCE = "rigid linkage (evidence/linkage/rigid.py)"


def linkage(angles, supports="plane", modulus=STIFF) -> fpm.Scene:
    """The linkage in the stiff limit, 5° short of the folded bundle."""
    return build(supports, E=modulus, roll=angles[0], mu=angles[1], start=5.0, K_F=5.0, elements=2)


def curves(outcome: fpm.Outcome) -> dict[str, np.ndarray]:
    """BD, AC, height of B over A (t,) m, z-velocity of B (t,) m/s and openings (t,) rad."""
    a, b, c, d = (outcome.points[name] for name in "ABCD")
    return {
        "BD": np.linalg.norm(b[0] - d[0], axis=1),
        "AC": np.linalg.norm(a[0] - c[0], axis=1),
        "height": b[0][:, 2] - a[0][:, 2],
        "velocity_Bz": b[1][:, 2],
        "opening_a": outcome.openings["A"],
        "opening_b": outcome.openings["B"],
    }


def rigid_linkage(bench: Bench) -> None:
    """Stiff links move as rigid ones: kinematics at any opening, motion up to the first closure."""
    times = np.linspace(0.0, 0.4, 401)
    angles = ANGLES[:1] if bench.quick else ANGLES
    scenes = [linkage(pair) for pair in angles]
    outcomes = bench.simulate(scenes, duration=times[-1], instants=times.size)
    for pair, outcome in zip(angles, outcomes, strict=True):
        name = f"λ = {pair[0]:g}°, μ = {pair[1]:g}°"
        rigid = RigidBennett(lambda_deg=pair[0], mu_deg=pair[1])
        expected, result = rigid.simulate(5.0, times), curves(outcome)
        closing = expected["closings"][0]
        bench.check(f"{name}: first closure (s)", outcome.events[0, 0], closing, 2e-3, SOURCE)
        is_before = times < min(closing, outcome.events[0, 0])
        for key in ("BD", "velocity_Bz"):
            reach = np.ptp(expected[key][is_before])
            worst = np.abs(result[key] - expected[key])[is_before].max() / reach
            bench.check_small(f"{name}: {key} before closure", worst, 0.005, SOURCE, "its range")
        # Kinematics alone: at each instant, the rigid linkage that is open as much at B.
        rows = [rigid.motion(rigid.beta_at(x)) for x in result["opening_b"][is_before][::20]]
        shape = {
            "BD": [2 * abs(m["B"][0, 1]) for m in rows],
            "AC": [2 * abs(m["A"][0, 0]) for m in rows],
            "height": [m["B"][0, 2] - m["A"][0, 2] for m in rows],
            "opening_a": [m["opening_a"][0] for m in rows],
        }
        worst = max(
            np.abs(result[key][is_before][::20] - values).max() / np.ptp(values)
            for key, values in shape.items()
        )
        bench.check_small(f"{name}: shape at the same opening", worst, 0.005,
                          "sin β sin γ = const", "their ranges")  # fmt: skip


def flexibility(bench: Bench) -> None:
    """The difference to the rigid linkage is bending: it falls with 1 / E."""
    times = np.linspace(0.0, 0.3, 301)
    rigid = RigidBennett().simulate(5.0, times)
    moduli = np.array([1e10, 1e11, 1e12])
    errors = []
    for modulus in moduli:
        scene = linkage(ANGLES[0], modulus=modulus)
        (outcome,) = bench.simulate(scene, duration=times[-1], instants=times.size)
        result = curves(outcome)
        errors.append(
            [np.abs(result[k] - rigid[k]).max() / np.ptp(rigid[k]) for k in ("BD", "velocity_Bz")]
        )
    errors = np.array(errors)
    # The release sets off bending vibration; its velocity is deflection times frequency.
    expected = (
        ("BD", 5.0, "bending goes with 1 / E: 10"),
        ("velocity_Bz", 3.0, "velocity of the bending vibration goes with 1 / √E: 3.16"),
    )
    for column, (key, least, source) in enumerate(expected):
        ratio = errors[-2, column] / errors[-1, column]
        bench.check_at_least(f"{key}: error ratio from E = 1e11 to 1e12 Pa", ratio, least, source)


PROBLEMS = {"rigid Bennett linkage": rigid_linkage, "flexible Bennett linkage": flexibility}
