"""Error of the bounds against their cost, and what `accuracy` comes to."""
