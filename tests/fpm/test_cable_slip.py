"""How a rubbing cable slips: the kernel's strains solve Eytelwein's law, whatever came before."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import njit

from fpm.elements.cables.cable_friction_kernels import (
    CLOSE,
    FREE_STRAIN,
    INVERSE,
    RATIO,
    SLIP_SIZE,
    START,
    find_free_strains,
    strain_before,
)
from fpm.elements.cables.cable_kernels import LENGTH, STRETCH
from fpm.kernels.lanes import load, store

LANES = 8
ROUNDING = 1e-13


class Chain(NamedTuple):
    stretches: np.ndarray
    slip: np.ndarray
    rest: np.ndarray


@njit(error_model="numpy")
def settle(part, found):
    last = found.shape[0]
    find_free_strains(part, 0, last, CLOSE * load(part.rest, 0, 0))
    strain = load(part.slip, last - 1, FREE_STRAIN)
    for j in range(last - 1, -1, -1):
        store(found, j, 0, strain)
        if j > 0:
            strain = strain_before(part, j, strain)


def strains(lengths, material, ratios) -> np.ndarray:
    """Of all stretches (stretches, lanes), once it has slipped; ratios (stretches - 1, lanes)."""
    count = len(lengths)
    part = Chain(*(np.zeros((count + 1, k, LANES)) for k in (STRETCH, SLIP_SIZE, 1)))
    part.stretches[:-1, LENGTH], part.slip[:-1, START] = lengths, material
    part.slip[1:-1, RATIO], part.slip[1:-1, INVERSE] = ratios, 1 / ratios
    part.rest[0, 0] = material.sum(0)
    found = np.zeros((count, 1, LANES))
    settle(part, found)
    return found[:, 0]


def holds(lengths, material, ratios, found) -> None:
    """The complementarity of slips and tensions, of lanes that are tight."""
    after = lengths / (1 + found)
    total = material.sum(0)
    np.testing.assert_allclose(after.sum(0), total, rtol=1e-11)
    into = np.cumsum((after - material)[::-1], 0)[-2::-1]
    tiny = 1e-10 * total
    up, down = found[1:] - ratios * found[:-1], found[:-1] - ratios * found[1:]
    assert (found > 0).all()
    allowed = ROUNDING * ratios * np.maximum(found[1:], found[:-1])
    assert (up <= allowed).all() and (down <= allowed).all(), "more tension than friction bears"
    assert (np.abs(up) <= allowed)[into > tiny].all(), "slips against its friction"
    assert (np.abs(down) <= allowed)[into < -tiny].all(), "slips against its friction"


def walk(rng, points: int, pace: float, friction: float, steps: int):
    """Lengths, unstrained lengths and ratios of a cable whose points move and turn back at will."""
    first = lengths = rng.uniform(0.1, 3.0, (points + 1, LANES))
    material = lengths / (1 + rng.uniform(1e-4, 0.02))
    angles = rng.uniform(0, np.pi, (points, LANES))
    drift = rng.normal(size=lengths.shape)
    for _ in range(steps):
        drift = np.where(rng.random(lengths.shape) < 0.1, -drift, drift)
        lengths = np.clip(lengths * np.exp(pace * drift), 0.8 * first, 1.2 * first)
        angles = np.clip(angles + pace * rng.normal(size=angles.shape), 0, np.pi)
        material[0] *= 1 + 0.1 * pace * rng.uniform(-1, 1, LANES)  # reeled
        ratios = np.exp(np.minimum(friction * angles, 30.0))
        found = strains(lengths, material, ratios)
        yield lengths, material, ratios, found
        # Where it turned slack, it begins anew, at any strains.
        anew = lengths / (1 + rng.uniform(1e-6, 0.1, lengths.shape))
        material = np.where(lengths.sum(0) > material.sum(0), lengths / (1 + found), anew)


@pytest.mark.parametrize("points", [1, 2, 3, 4, 12])
def test_every_slip_agrees_with_its_friction(points):
    rng = np.random.default_rng(points)
    slack = slips = 0
    for friction in (0.0, 0.02, 0.1, 0.5, 3.0):
        for pace in (1e-7, 1e-5, 1e-3, 0.03, 0.3):
            for lengths, material, ratios, found in walk(rng, points, pace, friction, 60):
                tight = lengths.sum(0) > material.sum(0) * (1 + 1e-12)
                holds(*(x[:, tight] for x in (lengths, material, ratios, found)))
                loose = lengths.sum(0) < material.sum(0) * (1 - 1e-12)
                assert (found[:, loose] == 0).all(), "a tension in a slack cable"
                slack, slips = slack + loose.sum(), slips + tight.sum()
    assert slack > 100 and slips > 8000
