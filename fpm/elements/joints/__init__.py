"""Hinges and joints: what keeps parts together, and what holds their openings exactly."""
