"""From which gaps a hinge or joint gets another round, and counts as open.

Those in lengths are shares of the scene's size, World.size (m).
"""

MOST_GAP = 1e-6
"""Gap of a hinge point from which a hinge counts as open; it is below 1e-11 as a rule, and
1e-7 in single precision. It gapes when its particles turn too far in a step for its rounds.
"""

MOST_TILT = 1e-5
"""The same for the angle between its axes (rad)."""

ROUNDS = 4
"""Most rounds in a step; smooth motion takes one, a fast impact two."""

COARSE_GAP = 5e-9
"""Gap of the hinge point above which a sample gets another round, as a share of the scene's size,
of a metre at most: more than that on light bodies grows from step to step."""

COARSE_TILT = 5e-8
"""The same for the angle between the axes (rad)."""
