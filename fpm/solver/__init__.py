"""Time integration: scenes to arrays of lanes, the start, the run, and back to each sample."""
