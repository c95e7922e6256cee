"""Laws that every scene must obey, on scenes and numbers drawn by hypothesis: a run can be reversed
and continued. That a scene moves alike where it is turned, mirrored, reordered or stated in other
units is in tests/attack.

The bounds are those of rounding, grown by the motion: hinges close to 2e-11 m and 2e-10 rad, and a
run of some hundred steps carries that on.
"""

from copy import copy
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import fpm
from evidence.linkage.runs import build

INSTANTS = 11
few = settings(
    max_examples=4,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
seeds = st.integers(0, 2**32 - 1)
# A start near closure brings the contacts into play within the run.
starts = st.sampled_from([2.0, 40.0, 119.0])


def linkage(start=40.0, supports="free", **more) -> fpm.Scene:
    """A soft Bennett linkage of eight elements, pushed into all its modes."""
    scene = build(start=start, supports=supports, elements=2, **{"E": 2e7, **more})
    scene.velocity += np.array([0.3, -0.2, 0.1])
    return scene


def loaded_bar(seed: int, **more) -> fpm.Scene:
    """A clamped flat bar with an end load off its axis and weight."""
    random = np.random.default_rng(seed)
    scene = fpm.Scene("bar", **{"gravity": random.normal(size=3) * 5, **more})
    axis, normal = Rotation.random(rng=random).as_matrix()[:2]
    bar = scene.add_link(
        (0, 0, 0), 0.8 * axis, normal, fpm.Section.rectangle(0.03, 0.01),
        fpm.Material(1e9, 0.3, 1000.0), 4,
    )  # fmt: skip
    scene.fix(bar.particles[0])
    scene.add_load(
        int(bar.particles[-1]), force=random.normal(size=3), moment=0.05 * random.normal(size=3),
        arm=0.05 * random.normal(size=3),
    )  # fmt: skip
    scene.add_point("tip", int(bar.particles[-1]))
    return scene


# The bar has time loops of its own, one with damping and one without.
both = pytest.mark.parametrize(
    "scenes",
    [
        lambda seed, start: [linkage(start), linkage(start, "plane")],
        pytest.param(lambda seed, start: [loaded_bar(seed)], marks=pytest.mark.slow),
    ],
    ids=["linkage", "bar"],
)


def run(*scenes: fpm.Scene, steps=400, step=None):
    """Outcomes of all scenes at one step: 0.5 of the smallest limit, or as given (s)."""
    step = step or 0.5 * min(fpm.find_stable_step(s).step for s in scenes)
    outcomes = fpm.simulate(scenes, duration=steps * step, instants=INSTANTS, step=step)
    for outcome in outcomes:
        assert outcome.failure is None
    return outcomes


def continued(scene: fpm.Scene, outcome: fpm.Outcome, direction: float) -> fpm.Scene:
    """The scene at the end of a run, moving on (direction 1) or back (-1)."""
    out, final = copy(scene), outcome.final
    out.unstrained = scene.frame if scene.unstrained is None else scene.unstrained
    out.position, out.frame = final.position, final.frame
    out.velocity, out.spin = direction * final.velocity, direction * final.spin
    openings = [float(opening[-1]) for opening in outcome.openings.values()]
    out.hinges = [replace(h, opening=x) for h, x in zip(scene.hinges, openings, strict=True)]
    return out


def largest(values) -> float:
    return max(float(np.abs(v).max()) for v in values)


@few
@given(seeds, starts)
@both
def test_time_can_be_reversed(scenes, seed, start):
    """Without damping a run with reversed velocities leads back to the start, moving backwards."""
    for scene in scenes(seed, start):
        scene.velocity[:, 2] = 0.0
        step = 0.8 * fpm.find_stable_step(scene).step
        (there,) = run(scene, step=step, steps=200)
        (back,) = run(continued(scene, there, -1.0), step=step, steps=200)
        assert largest([back.final.position - scene.position]) < 1e-8
        assert largest([back.final.frame - scene.frame]) < 1e-7
        for name, (x, v) in there.points.items():
            y, w = back.points[name]
            assert largest([x - y[::-1]]) < 1e-8
            assert largest([v + w[::-1]]) < 1e-5


@pytest.mark.slow
@few
@given(seeds)
def test_a_run_can_be_continued(seed):
    """Two runs of which one starts where the other ended are one run."""
    scene = loaded_bar(seed)
    step = 0.8 * fpm.find_stable_step(scene).step
    (whole,) = run(scene, step=step, steps=800)
    (first,) = run(scene, step=step, steps=400)
    (second,) = run(continued(scene, first, 1.0), step=step, steps=400)
    assert largest([whole.final.position - second.final.position]) < 1e-10
