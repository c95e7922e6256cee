"""Accurate, refused, or wrong: how the study of extremes judges a run.

A run of the default mesh and step is compared with a reference. If it is refused, that counts as
passed (the message must name a remedy), and the remedy is tried: the step is halved and the mesh
refined until the run goes through, and then it is compared like any other; or until the refusal is
one that no mesh or step helps against."""

import numpy as np

import fpm
from evidence.linkage import runs
from evidence.linkage.rigid import RigidBennett
from evidence.rows import Row, at_most, refusal

DEFAULT = (12, 0.9)
"""Elements a link and share of the stable step."""

REMEDIES = ((12, 0.45), (16, 0.2), (32, 0.2), (64, 0.2))
LINE_ACCURACY = (0.002, 0.05)
"""Accuracy of BD and of B's velocity, as shares of their ranges: links that stay nearly straight.

The velocity carries waves of all lengths, which the release of the springs starts, finer than any
mesh; BD is their integral over time."""

CURVE_ACCURACY = (0.005, 0.05)
"""The same where the springs bend the links by some degrees."""

WHIP = (0.05, 0.15)
"""The same where they bend them into hooks that whip through the whole run, closure and all."""

RATTLE = (0.15, 0.2)
"""The same after thin links have shut and sprung open several times: every impact multiplies what
the runs differ by, and finer meshes only put that off (docs/extremes.md)."""


def attempt(duration: float, mesh: tuple[int, float], parameters: dict, **options):
    """(outcome, None), or (None, the error that refuses the run)."""
    elements, safety = mesh
    try:
        outcome = runs.simulate(duration, safety=safety, elements=elements, **parameters, **options)
    except fpm.SceneError as error:
        return None, error
    return (None, outcome.failure) if outcome.failure else (outcome, None)


def rigid(parameters: dict, times: np.ndarray) -> tuple[dict[str, np.ndarray], float]:
    """Curves of the rigid linkage and the time of its first closure."""
    names = {"L": "length", "a": "side", "rho": "density", "K_F": "spring_stiffness",
             "K_C": "contact_stiffness"}  # fmt: skip
    p = runs.complete(parameters)
    model = RigidBennett(**{names[k]: p[k] for k in names})
    result = model.simulate(p["start"], times)
    closing = result["closings"][0] if len(result["closings"]) else np.inf
    return {"BD": result["BD"], "vBz": result["velocity_Bz"]}, float(closing)


def compare(name, outcome, expected, end, accuracy, source) -> list[Row]:
    """Judge BD and B's velocity of one outcome against curves up to a time (s)."""
    window = outcome.time <= end
    errors = runs.distance(runs.curves(outcome), expected, window)
    note = f"energy {runs.imbalance(outcome):.1g}, {outcome.steps} steps"
    return [
        at_most(f"{name}: {curve}", error, allowed, source, note)
        for curve, error, allowed in zip(("BD", "velocity of B"), errors, accuracy, strict=True)
    ]


def persist(name: str, duration: float, parameters: dict, **options):
    """Run a case at the default mesh, and at the remedies until one goes through.

    Returns the rows of its refusals, its name with what helped, the mesh, and the outcome or None.
    """
    rows, full = [], name
    for mesh in (DEFAULT, *REMEDIES):
        if mesh != DEFAULT:
            full = f"{name}, after the remedy ({mesh[0]} elements, {mesh[1]:g} of the limit)"
        outcome, error = attempt(duration, mesh, parameters, **options)
        if outcome is not None:
            return rows[:1], full, mesh, outcome
        rows.append(refusal(full, error))
        if isinstance(error, fpm.SceneError) or error.cause == "strain":
            break
    return list(dict.fromkeys((rows[0], rows[-1]))), full, mesh, None


def judge(
    name: str,
    parameters: dict,
    accuracy: tuple[float, float] = LINE_ACCURACY,
    *,
    reference: str = "finer",
    duration: float | None = None,
    is_whole_run: bool = False,
) -> list[Row]:
    """Rows of one case; value: errors of BD (largest) and of B's velocity (root mean square) up to
    the first closure, as shares of their ranges; accuracy: how large they may be.

    reference: "rigid" (the equation of motion of one degree of freedom) or "finer" (twice the
    elements, half the share of the step). is_whole_run: judge the whole run, impact and all."""
    duration = duration or (1.25 if is_whole_run else 1.0) * runs.closing_time(**parameters)
    rows, name, mesh, outcome = persist(name, duration, parameters)
    if outcome is None:
        return rows
    closing = runs.first_closing(outcome)
    if reference == "rigid":
        expected, expected_closing = rigid(parameters, outcome.time)
        source = "rigid linkage, evidence/linkage/rigid.py"
    else:
        finer, error = attempt(duration, (2 * mesh[0], mesh[1] / 2), parameters)
        if finer is None:
            return [*rows, Row(name, "no reference", passed=False, note=str(error))]
        expected, expected_closing = runs.curves(finer), runs.first_closing(finer)
        source = f"{2 * mesh[0]} elements, half the share of the limit"
    end = duration if is_whole_run else 0.98 * min(closing, expected_closing)
    return rows + compare(name, outcome, expected, end, accuracy, source)
