"""Cables through points, with and without friction."""
