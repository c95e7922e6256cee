"""Numba kernels: plain arrays in, plain arrays out; sample lanes along the last axis (lanes.py)."""
