"""Loads and drives: what acts on a scene from outside, scaled by piecewise linear curves."""

from dataclasses import dataclass

import numpy as np

from fpm.elements.virtual_beam import VirtualBeam


@dataclass(frozen=True)
class Load:
    """A force (3,) N at the free end of a virtual beam and a moment (3,) N m, in global axes.

    curve: index of the curve that scales both with time; -1 for a constant load.
    """

    beam: VirtualBeam
    force: np.ndarray
    moment: np.ndarray
    curve: int


@dataclass(frozen=True)
class Drive:
    """A particle whose velocity (3,) m/s and spin (3,) rad/s are given, times a curve (-1: 1)."""

    particle: int
    velocity: np.ndarray
    spin: np.ndarray
    curve: int
