"""Error of the bounds against their cost, and what the presets rest on."""
