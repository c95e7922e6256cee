"""Verification of the solver: reference solutions and the studies that compare with them."""
