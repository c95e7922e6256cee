"""Accurate, refused, or wrong: how the study of extremes judges a run.

A run of the default mesh and step is compared with a reference. If it is refused, that counts as
passed (the message must name a remedy), and the remedy is tried: the step is halved and the mesh
refined until the run goes through, and then it is compared like any other.
"""

import numpy as np

import fpm
from studies.linkage import (
    closing_time,
    complete,
    curves,
    distance,
    first_closing,
    imbalance,
    simulate,
)
from studies.rows import Row
from verification.rigid_bennett import RigidBennett

DEFAULT = (12, 0.9)
"""Elements a link and share of the stable step."""

REMEDIES = ((12, 0.45), (16, 0.2), (32, 0.2), (64, 0.2))
VELOCITY = 0.05
"""The root mean square error of B's velocity may be this share of its range, or four times the
tolerance of BD if that is more."""

REFUSED = "a clear refusal"


def refusal(name: str, error: Exception) -> Row:
    """A passed row: the case was refused by name."""
    return Row(name, f"refused: {error}", REFUSED, "", True, "the error's message")


def attempt(duration: float, mesh: tuple[int, float], parameters: dict, **more):
    """(outcome, None), or (None, the error that refuses the run)."""
    elements, safety = mesh
    try:
        outcome = simulate(
            duration, safety=safety, elements_per_link=elements, **parameters, **more
        )
    except fpm.SceneError as error:
        return None, error
    return (None, outcome.failure) if outcome.failure else (outcome, None)


def rigid(parameters: dict, times: np.ndarray) -> tuple[dict[str, np.ndarray], float]:
    """Curves of the rigid linkage and the time of its first closure."""
    names = {"L": "length", "a": "side", "rho": "density", "K_F": "spring_stiffness",
             "K_C": "contact_stiffness"}  # fmt: skip
    p = complete(parameters)
    model = RigidBennett(**{names[k]: p[k] for k in names})
    found = model.simulate(p["start_deg"], times)
    closing = found["closings"][0] if len(found["closings"]) else np.inf
    return {"BD": found["BD"], "vBz": found["velocity_Bz"]}, float(closing)


def compare(name, outcome, expected, until, tolerance, source, note="") -> Row:
    """Judge one outcome against curves up to a time (s)."""
    inside = outcome.time <= until
    position, velocity = distance(curves(outcome), expected, inside)
    off = imbalance(outcome)
    return Row(
        name=name,
        value=position,
        reference=0.0,
        tolerance=tolerance,
        passed=bool(position <= tolerance and velocity <= max(VELOCITY, 4 * tolerance)),
        source=source,
        note=f"velocity of B {velocity:.2g}, energy {off:.1g}, {outcome.steps} steps{note}",
    )


def judge(
    name: str,
    parameters: dict,
    tolerance: float,
    *,
    against: str = "finer",
    duration: float | None = None,
    past_closure: bool = False,
) -> list[Row]:
    """Rows of one case; value: largest error of BD up to the first closure, as share of its range.

    against: "rigid" (the one-degree-of-freedom equation of motion) or "finer" (twice the elements,
    half the share of the step). past_closure: judge the whole run, impact and all.
    """
    duration = duration or (1.25 if past_closure else 1.0) * closing_time(**parameters)
    rows, mesh = [], DEFAULT
    outcome, error = attempt(duration, mesh, parameters)
    if error is not None:
        rows.append(refusal(name, error))
        if isinstance(error, fpm.SceneError):
            return rows
        for mesh in REMEDIES:
            outcome, error = attempt(duration, mesh, parameters)
            if outcome is not None:
                break
        name += f", after the remedy ({mesh[0]} elements, {mesh[1]:g} of the limit)"
        if outcome is None:
            return [*rows, refusal(name, error)]
    closing = first_closing(outcome)
    if against == "rigid":
        expected, other = rigid(parameters, outcome.time)
        source = "rigid linkage, verification/rigid_bennett.py"
    else:
        finer, error = attempt(duration, (2 * mesh[0], mesh[1] / 2), parameters)
        if finer is None:
            return [*rows, Row(name, "no reference", 0.0, tolerance, False, str(error))]
        expected, other = curves(finer), first_closing(finer)
        source = f"{2 * mesh[0]} elements, half the share of the limit"
    until = duration if past_closure else 0.98 * min(closing, other)
    rows.append(compare(name, outcome, expected, until, tolerance, source))
    return rows
