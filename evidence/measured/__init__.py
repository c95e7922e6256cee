"""Measured curves: hidden values by an independent solver, and a real arm."""
