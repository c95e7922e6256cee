"""How far to trust the page, in words that nobody can take for a promise about a structure."""

from __future__ import annotations

from collections.abc import Mapping

from deployable.campaign.report.data import PageData
from deployable.campaign.results.scan_words import scan_text


def trust(data: PageData) -> list[tuple[str, str]]:
    """Titles with a paragraph each."""
    kind = data.bounds_kind
    return [
        *([("What the intervals of quantities are", _QUANTITIES)] if data.answers else []),
        ("What the bounds are", f"{kind[:1].upper()}{kind[1:]}. {_bounds(kind, data.scan)}"),
        ("What the error estimate is", _error(data)),
        ("What the model is", _MODEL),
        ("What follows for a structure", _STRUCTURE),
    ]


_QUANTITIES = (
    "The least and the largest value of the simulated runs, or what a surrogate fitted to them "
    "foretells where that is more. Where both ends are simulated runs, the model really does that; "
    "whether it does more somewhere else is estimated by the error of the surrogate, not excluded."
)

_MODEL = (
    "Rigid bodies and slender elastic bars with the joints, springs, dampers, contacts, latches "
    "and cables that the structure is said to have, moved by a time integration that is stopped "
    "when its energy does not balance. What is not said of the structure (often friction, play in "
    "the hinges, damage, tolerances that are not among the parameters) is not in these numbers."
)

_STRUCTURE = (
    "Nothing on this page is a safety margin, and nothing here promises that a real structure "
    "stays within the bounds. The page shows how the simulated model answers when its parameters "
    "lie anywhere within the stated intervals. It says nothing about how likely any of these "
    "values is, nor about parameters outside."
)


def _bounds(kind: str, scan: Mapping) -> str:
    if kind.startswith("enclosed"):
        return (
            "A polynomial was fitted to the runs at every instant; its least and largest values "
            "over the intervals are enclosed by computation. How far the polynomial is from the "
            "simulated model is not enclosed: it is estimated."
        )
    if kind.startswith("attained"):
        return (
            "They are values that a curve fitted to the runs takes somewhere within the intervals. "
            "Values beyond them are possible, of the fitted curve and of the simulated model."
        )
    return (
        "They are the least and the largest value among the runs that were made. Runs that were "
        "not made may lie outside." + (f" {scan_text(scan)}" if scan else "")
    )


def _error(data: PageData) -> str:
    if all(response.error is None for response in data.responses):
        return "There is none."
    if data.bounds_kind.startswith("enclosed"):
        count = len(data.unfitted)
        source = f"the misfit at {count} run{'s' if count != 1 else ''} that the fit has not seen, "
        source += "and the decay of its coefficients"
    elif data.bounds_kind.startswith("attained"):
        source = "how much the fit misses each run by when that run is left out"
    else:
        source = "how much the bounds grew from the first half of the runs to all of them"
    further = (
        "; it knows nothing of mesh and time step"
        if not any(response.errors for response in data.responses)
        else ". To it is added what half the time step, and a mesh twice as fine, change in runs "
        "one after the other at places where the bounds are attained, continued to what all "
        "further halvings would change by the order at which that falls"
    )
    return (
        f"An estimate of how far the drawn bounds may be from those of the simulated model, made "
        f"from {source}{further}. It is often too large and sometimes too small; it proves nothing."
    )
