"""Does the cost of a structure grow with its size, and nothing else."""
