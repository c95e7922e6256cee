"""Units as people write them."""

from __future__ import annotations

import re


def pretty(units: str) -> str:
    """`m s-1` as `m/s`, `kg m2 s-2` as `kg m²/s²`; a unit of 1 as 1."""
    above, below = [], []
    for name, power in re.findall(r"([A-Za-z%]+)(-?\d+)?", units):
        exponent = abs(int(power or 1))
        text = name + ("" if exponent == 1 else "²" if exponent == 2 else f"^{exponent}")
        (below if (power or "").startswith("-") else above).append(text)
    return (" ".join(above) or "1") + ("/" + "/".join(below) if below else "")
