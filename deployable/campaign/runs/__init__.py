"""Runs: simulated in batches, kept under names that follow from their content."""
