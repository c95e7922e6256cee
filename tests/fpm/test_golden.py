"""Numbers of two small runs, kept.

The bounds are wide enough for other processors and for the hinges' tolerance, and too narrow for a
changed formula (lumping, element, integration, geometry).
"""

import numpy as np
import pytest

import fpm
from deployable.campaign.config.sections import scene_type

LINKAGE = {
    "B": [1.91036422792e-16, 0.315781328041, -3.75104596371e-05],
    "D": [-1.91036422792e-16, -0.315781328041, -3.75104596371e-05],
    "velocity of B": [0.0, 0.301901659773, 0.0176949631661],
    "openings": [0.163731082205, 0.155126612242, 0.163731082205, 0.155126612242],
    "energies": [0.0552521714768, 0.00625360444814, 0.0119937864427],
    "first events": [0.181827186595, 0.181827186595],
}

BEAM = {
    "tip": [0.6749563517154837, 0.27527104838192534, 0.008890624960191896],
    "velocity": [0.5450605860968785, -1.166926785920052, -0.2861332062377006],
    "energies": [
        0.05600451408552223,
        0.029637437814729897,
        0.12301428588467403,
        0.039382594899158095,
    ],
}


def linkage() -> dict[str, np.ndarray]:
    """The paper's linkage through its first closure, at a coarse mesh."""
    scene = scene_type("bennett").build(start=100.0, elements=8)
    (outcome,) = fpm.simulate(scene, duration=0.24, instants=4, step=2.5e-5)
    return {
        "B": outcome.points["B"][0][-1],
        "D": outcome.points["D"][0][-1],
        "velocity of B": outcome.points["B"][1][-1],
        "openings": np.array([x[-1] for x in outcome.openings.values()]),
        "energies": np.array([outcome.energies[k][-1] for k in ("kinetic", "strain", "spring")]),
        "first events": outcome.events[:2, 0],
    }


def beam() -> dict[str, np.ndarray]:
    """A bar of unequal sides, driven at its root, under weight, load, damping, in odd frames."""
    scene = fpm.Scene("bar", gravity=(0.0, 1.0, -9.81), damping=3.0)
    section, material = fpm.Section.rectangle(0.03, 0.01), fpm.Material(1e9, 0.3, 1000.0)
    bar = scene.add_link((0, 0, 0), (0.6, 0, 0), (0, 0, 1), section, material, 8, "bar", 2.0)
    tip = int(bar.particles[-1])
    extra = scene.add_particles((0.6, 0.2, 0), 0.05, (1e-5, 2e-5, 3e-5), spin=(20.0, 1.0, 0.0))
    scene.add_beams((tip, int(extra[0])), section, material, (0, 0, 1), "arm")
    pulse = scene.add_curve([0.0, 0.02, 0.05], [0.0, 1.0, 0.2])
    scene.drive(int(bar.particles[0]), velocity=(0, 0.2, 0), spin=(0, 0, 2.0), curve=pulse)
    scene.add_load(tip, force=(1, 2, 3), moment=(0.1, 0, 0), arm=(0, 0.01, 0), curve=pulse)
    scene.add_point("tip", int(extra[0]), (0.7, 0.2, 0.0))
    (outcome,) = fpm.simulate(scene, duration=0.1, instants=4, step=2e-5)
    return {
        "tip": outcome.points["tip"][0][-1],
        "velocity": outcome.points["tip"][1][-1],
        "energies": np.array([outcome.energies[k][-1] for k in
                              ("kinetic", "strain", "load_work", "damping_work")]),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("run", "known", "tolerance"),
    [(linkage, LINKAGE, 1e-6), pytest.param(beam, BEAM, 1e-9, marks=pytest.mark.slow)],
)
def test_the_same_scene_gives_the_numbers_that_were_kept(run, known, tolerance):
    found = run()
    assert found.keys() == known.keys()
    off = [
        f"{name}: {found[name].tolist()}, known {value}"
        for name, value in known.items()
        if not np.allclose(found[name], value, rtol=0, atol=tolerance * np.abs(value).max())
    ]
    assert not off, "numbers changed; if that is meant, keep the new ones: " + "; ".join(off)
