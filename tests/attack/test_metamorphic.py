"""A structure in other words moves as it did: random ones, of all kinds."""

from __future__ import annotations

import random
from collections import Counter

import numpy as np
import pytest

import fpm
from evidence.attack.metamorphic import families
from evidence.attack.metamorphic.attack import ALL, verdicts
from evidence.attack.metamorphic.families import delay, is_quiet
from evidence.attack.metamorphic.image import Image, scale
from evidence.attack.metamorphic.pairs import Trial
from evidence.attack.metamorphic.runs import draw_structure, scene_of
from evidence.attack.metamorphic.space import rotate
from evidence.attack.metamorphic.structure_text import map_numbers

PENDULUM = {
    "points": {"p0": [0.0, 0.0, 0.0], "t0": [0.6, 0.1, 0.2]},
    "materials": {"foam": {"E": 1e6, "rho": 100.0}},
    "sections": {"round": {"type": "tube", "diameter": 0.2, "thickness": 0.02}},
    "bars": {
        "b0": {"through": ["p0", "t0"], "section": "round", "material": "foam", "elements": 2}
    },
    "joints": {
        "j0": {
            "type": "revolute", "parts": ["ground", "b0"], "at": "p0", "axis": [0.1, 1.0, -0.2],
            "opening": 0.3,
        }
    },
    "gravity": [0.5, 1.0, -9.0],
    "record": {"t0": {"part": "b0", "at": "t0"}},
}  # fmt: skip


def outcomes(names):
    """What families come to for the pendulum, whose loop other quick tests need as well."""
    return {one.family: one.outcome for one in Trial(PENDULUM, 0.02, "0").verdicts(names)}


def test_a_pair_that_is_alike_is_right_and_any_other_wrong(monkeypatch):
    def without_gravity(structure, rng):
        image = rotate(structure, rng)
        return Image(
            {**image.structure, "gravity": structure["gravity"]}, image.matrix, image.shift
        )

    def nearly(structure, rng):
        gravity = [(1.0 + 1e-4) * x for x in structure["gravity"]]
        return Image({**structure, "gravity": gravity}, np.eye(3))

    monkeypatch.setitem(families.FAMILIES, "without gravity", without_gravity)
    monkeypatch.setitem(families.FAMILIES, "nearly", nearly)
    right = ["rotated", "mirrored", "in vectors", "reordered", "in other units",
             "parts of joints swapped"]  # fmt: skip
    found = outcomes([*right, "without gravity", "nearly"])
    assert found == dict.fromkeys(right, "right") | {"without gravity": "wrong", "nearly": "wrong"}


@pytest.mark.slow
def test_random_structures_move_alike_in_other_words():
    """Some of it; `python -m evidence attack --only pairs` does more."""
    found = [one for seed in range(16) for one in verdicts(str(seed), 5)]
    count = Counter(one.outcome for one in found)
    assert not count["wrong"], [one for one in found if one.outcome == "wrong"]
    assert {one.family for one in found if one.outcome == "right"} == set(ALL)
    assert count["right"] > 2 * (count["sensitive"] + count["failed"])


@pytest.mark.slow
def test_structures_at_rest_are_never_refused():
    """Random ones, in units a million times larger or smaller, before anything moves them, and
    some in which something does from an instant on: that they move by rounding is not a failure."""
    seeds = ("500071", "500378", "500709", "500756", *map(str, range(800000, 800014)))
    drawn = [(seed, *draw_structure(seed)) for seed in seeds]
    quiet = [(seed, *one) for seed, *one in drawn if is_quiet(one[0])]
    assert len(quiet) > 8
    for seed, structure, duration in quiet:
        rng = random.Random(seed)
        for wait in (0.25, 9.0) if seed.startswith("5") else (9.0,):
            units = tuple(rng.choice([1e-6, 1.0, 1e6]) for _ in range(3))
            image = delay(structure, rng, wait * duration).structure
            scene = scene_of(map_numbers(image, lambda x, unit, u=units: x * scale(u, unit)))
            (outcome,) = fpm.simulate(
                scene, duration=1.25 * duration * units[2], instants=11,
                step=duration * units[2] / 40, energy_tolerance=0.02 if wait > 1.0 else 1.0,
            )  # fmt: skip
            assert outcome.failure is None, (seed, wait, units)
    structure, duration = draw_structure("h15")  # all driven, under loads that nothing feels
    (outcome,) = fpm.simulate(
        scene_of(structure), duration=duration, instants=11, step=duration / 40
    )
    assert outcome.failure is None


@pytest.mark.slow
def test_size_mass_and_pace_do_not_matter(monkeypatch):
    """Random structures in units up to 2**30 times as large or small: no length, mass or time is
    large or small but against others of the structure."""

    def in_far_units(structure, rng):
        units = tuple(2.0 ** rng.randint(-30, 30) for _ in range(3))
        return Image(map_numbers(structure, lambda x, unit: x * scale(units, unit)), units=units)

    monkeypatch.setitem(families.FAMILIES, "in far units", in_far_units)
    found = [
        one
        for seed in map(str, range(900000, 900014))
        for one in Trial(*draw_structure(seed), seed).verdicts(["in far units"])
    ]
    assert not [one for one in found if one.outcome == "wrong"]
    assert sum(one.outcome == "right" for one in found) > 8
