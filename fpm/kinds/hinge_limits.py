"""From which gaps a hinge counts as open."""

MOST_GAP = 1e-6
"""Gap (m) of a hinge point from which a hinge counts as open; it is below 1e-11 m as a rule, and
1e-7 m in single precision. It gapes when its particles turn too far in a step for its rounds.
"""

MOST_TILT = 1e-5
"""The same for the angle between its axes (rad)."""
