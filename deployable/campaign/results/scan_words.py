"""What the extremes of a plain scan may miss, in words that nobody can take for a guarantee."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

IS_SCAN = "least"
"""How the kind of a plain scan's bounds begins."""

KEYS = ("drawn_runs", "share_outside", "share_outside_95")


def scan_facts(bounds: Any) -> dict[str, float]:
    """What the open `bounds.nc` of a scan tells; nothing of other bounds."""
    if "growth_quarter" not in bounds.variables:
        return {}
    return {key: bounds.getncattr(key).item() for key in KEYS}


def known_error(kind: str, error: float) -> float | None:
    """An estimated error of bounds of that kind; None where it tells nothing: bounds of a scan that
    did not grow with the second half of its runs."""
    return None if kind.startswith(IS_SCAN) and not error else error


def scan_text(scan: Mapping[str, float], grown: Sequence[str] = ()) -> str:
    """A paragraph; grown: by how much the last quarter of the runs widened bounds, by response."""
    text = (
        f"What a scan may miss: had its {scan['drawn_runs']} runs inside the box been drawn at "
        f"random, runs in {_share(scan['share_outside'])} of the box would lie outside the bounds "
        f"at any one instant, on average (in less than {_share(scan['share_outside_95'])}, in 95 "
        "of 100 scans). That tells neither how far outside, nor anything of all instants together, "
        "and runs that fill the box evenly are not drawn at random: it is no guarantee."
    )
    if grown:
        text += f" The last quarter of the runs widened the bounds by at most {', '.join(grown)}."
    return text


def _share(share: float) -> str:
    """`2 %`, `0.0002 %`."""
    text = f"{100 * share:.2g}"
    return f"{text if 'e' not in text else f'{100 * share:.9f}'.rstrip('0')} %"
