"""The answers engineers ask for: intervals of numbers, with ends that were simulated, requirements
and choices. `evaluations` makes the further runs that they take, through the same store."""
