"""Colours that colour-blind people can tell apart (Okabe and Ito)."""

from __future__ import annotations

BARS = ("#E69F00", "#56B4E9", "#009E73", "#CC79A7", "#F0E442", "#0072B2", "#D55E00")
"""Of bars, in their order; repeated where there are more."""

BODY = "#999999"
"""Of rigid bodies, where bars have the colours of their stress."""

CABLE = "#0072B2"

PIN = "#1D2327"
"""Of the axes of hinges."""


def rgb(colour: str) -> tuple[float, float, float]:
    """`#E69F00` as shares of red, green and blue."""
    return tuple(int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5))
