"""Beams, and what a bar is made of."""
