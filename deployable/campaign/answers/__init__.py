"""The answers engineers ask for: intervals of numbers, with ends that were simulated, requirements
and choices. `bench` makes the further runs that they take, through the same store as all others."""
