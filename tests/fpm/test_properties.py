"""Laws that every scene must obey, on scenes and numbers drawn by hypothesis.

The bounds are those of rounding, grown by the motion: hinges close to 2e-11 m and 2e-10 rad, and a
run of some hundred steps carries that on.
"""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from transforms import continued

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


def largest(values) -> float:
    return max(float(np.abs(v).max()) for v in values)


@few
@given(
    st.floats(0.1, 10.0), st.floats(1e-3, 1e3), st.floats(1e-2, 1e2), starts,
    st.sampled_from(["plane", "free"]),
)  # fmt: skip
def test_dimensional_analysis_scales_the_curves(length, modulus, density, start, supports):
    """Lengths by s, E by e, rho by r: times by s sqrt(r/e), torsion springs per length by e s²."""
    plain = {"L": 0.45, "a": 0.035, "E": 2e7, "rho": 800.0, "K_F": 5.0, "K_C": 1e4}
    factors = {
        "L": length, "a": length, "E": modulus, "rho": density,
        "K_F": modulus * length**2, "K_C": modulus * length**2,
    }  # fmt: skip
    common = {"start": start, "supports": supports, "elements": 2}
    first_scene = build(**plain, **common)
    second_scene = build(**{k: v * factors[k] for k, v in plain.items()}, **common)
    time = length * np.sqrt(density / modulus)
    limits = [fpm.find_stable_step(s).step for s in (first_scene, second_scene)]
    assert limits[1] == pytest.approx(time * limits[0], rel=1e-7)
    (first,), (second,) = (
        run(s, step=0.8 * limits[0] * f) for s, f in ((first_scene, 1.0), (second_scene, time))
    )
    for name, (x, v) in first.points.items():
        y, w = second.points[name]
        assert largest([x - y / length]) < 1e-7
        assert largest([v - w / length * time]) < 1e-4


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
