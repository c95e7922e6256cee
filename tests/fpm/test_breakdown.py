"""A run that breaks down says so, soon and clearly, and harms nobody."""

import re

import numpy as np
import pytest

import fpm
from evidence.extremes.stable_step import bennett

STEEL = fpm.Material(2.1e11, 0.3, 7850.0)
WOOD = fpm.Material(1e10, 0.3, 600.0)


def two_bars(steel=STEEL) -> fpm.Scene:
    """Two clamped bars side by side, plucked; the one of steel limits the step."""
    scene = fpm.Scene("two bars")
    section = fpm.Section.square(0.02)
    for y, material, name in ((0.0, WOOD, "wood"), (1.0, steel, "steel")):
        bar = scene.add_link((0, y, 0), (1, y, 0), (0, 0, 1), section, material, 4, name)
        scene.fix(bar.particles[0])
        scene.velocity[bar.particles[-1]] = (0.0, 0.0, 0.1)
    scene.add_point("tip", 4)
    return scene


def run(*scenes, factor=1.0, step=None, steps=2000, instants=3):
    step = step or factor * min(fpm.find_stable_step(s).step for s in scenes)
    return fpm.simulate(scenes, duration=steps * step, instants=instants, step=step)


def same(first: fpm.Outcome, second: fpm.Outcome) -> bool:
    """Whether two outcomes are equal bit for bit."""
    tracks = [(first.points[p][k], second.points[p][k]) for p in first.points for k in (0, 1)]
    tracks += [(first.energies[k], second.energies[k]) for k in first.energies]
    tracks += list(zip(first.final, second.final, strict=True))
    return all(np.array_equal(x, y) for x, y in tracks)


@pytest.mark.parametrize("factor", [1.02, 100.0])
def test_above_the_limit_a_run_stops_within_a_few_hundred_steps(factor):
    (outcome,) = run(two_bars(), factor=factor, steps=20_000)
    failure = outcome.failure
    assert isinstance(failure, fpm.InstabilityError)
    assert 0 < failure.time <= 400 * failure.step
    assert failure.element.startswith("steel[")
    limit = fpm.find_stable_step(two_bars()).step
    assert failure.limit == limit
    assert failure.step == pytest.approx(factor * limit, rel=1e-3)
    text = str(failure)
    for part in (
        f"t = {failure.time:.6g} s", failure.element, f"step {failure.step:.4g} s",
        f"limit {limit:.4g} s", f"use a step below {limit:.4g} s",
    ):  # fmt: skip
        assert part in text
    assert "nan" not in text


def test_a_contact_sets_a_step_that_its_impacts_need():
    """At 0.6 of the step that the links could take it fails, at the contact's own it does not.
    Where a step below the limit fails, another cure is told."""
    scene = bennett(K_C=1e7, K_F=55.0, start=60.0, elements=2)
    links = fpm.find_stable_step(bennett(K_C=50.0, K_F=55.0, start=60.0, elements=2)).step
    (failure,) = (outcome.failure for outcome in run(scene, step=0.6 * links, steps=2000))
    assert "use a step below" in str(failure)
    assert "halve solver.step" in str(fpm.InstabilityError(1.0, "AB", 1e-5, 2e-5, 1.0, 1.0))
    assert run(scene, factor=0.9, steps=24_000)[0].failure is None


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [50.0, 1.6e4, 5e6])
def test_what_strikes_a_contact_comes_back_as_fast_and_the_energy_balances(stiffness):
    """A body of 1/3 kg m² at 1 rad/s, at the default step and a campaign's tolerance."""
    scene = fpm.Scene("flap")
    spins = [(0, 0, 0), (0, 0, -1.0)]
    particles = scene.add_particles(np.zeros((2, 3)), 1.0, 1 / 3, spin=spins)
    ground, body = (int(p) for p in particles)
    scene.fix(ground)
    hinge = scene.add_hinge("A", (ground, body), (0, 0, 0), (0, 0, 1.0), opening=np.radians(10))
    scene.add(fpm.elements.Contact(hinge, stiffness))
    (outcome,) = fpm.simulate(scene, duration=0.6, instants=61, energy_tolerance=0.005, halvings=0)
    assert outcome.failure is None
    assert outcome.energies["kinetic"][-1] == pytest.approx(1 / 6, rel=0.01)


@pytest.mark.parametrize("moment", [0.0, 10.0])
@pytest.mark.parametrize("factor", [0.98, 1.005, 1.2])
def test_work_of_a_load_does_not_hide_an_instability_nor_fake_one(factor, moment):
    """A load, or its first rate, swings a body about a spring; the balance of both is exact."""
    scene = fpm.Scene("swing")
    spins = [(0, 0, 0), (0, 0, 0.0 if moment else 2.0)]
    particles = scene.add_particles(np.zeros((2, 3)), 1.0, 1.0, spin=spins)
    ground, body = (int(p) for p in particles)
    scene.fix(ground)
    hinge = scene.add_hinge("A", (ground, body), (0, 0, 0), (0, 0, 1.0))
    scene.add(fpm.elements.TorsionSpring(hinge, 100.0, 0.0))
    scene.add(fpm.elements.Load(scene.arm_to(body), np.zeros(3), np.array([0, 0, moment]), -1))
    (outcome,) = run(scene, factor=factor, steps=400)
    if factor > 1:
        assert outcome.failure.time <= 150 * outcome.step
    else:
        assert outcome.failure is None
        assert not moment or outcome.openings["A"].max() == pytest.approx(0.2, rel=0.05)


def test_a_mesh_too_coarse_for_the_bending_is_refused():
    """Links that springs bend double: the energy balances at a small step, on a wrong curve."""
    soft = {"E": 1e5, "start": 60.0}
    (coarse,) = run(bennett(elements=8, **soft), factor=0.1, steps=20_000)
    assert coarse.failure.largest["bend"] > 0.25
    assert coarse.failure.element[:2] in ("AB", "BC", "CD", "DA")
    assert abs(coarse.failure.balance) < 0.02 * coarse.failure.scale
    assert "refine the mesh" in str(coarse.failure)
    (fine,) = run(bennett(elements=64, **soft), factor=0.2, steps=20_000)
    assert fine.failure is None
    assert 0.01 < fine.largest["bend"] < 0.25
    assert 0.1 < fine.largest["strain"] < 0.5


@pytest.mark.parametrize(
    ("motion", "cause", "words"),
    [
        ({"velocity": (3.0, 0, 0)}, "strain", "no mesh or step helps"),
        ({"spin": (5.0, 0, 0)}, "bend", "refine the mesh"),
    ],
)
def test_stretch_and_twist_are_watched_as_bending_is(motion, cause, words):
    """A rubber bar of one element, torn or wrung at its end: its energy balances all the while."""
    scene = fpm.Scene("bar")
    rubber = fpm.Material(1e4, 0.3, 1000.0)
    bar = scene.add_link((0, 0, 0), (1, 0, 0), (0, 0, 1), fpm.Section.square(0.05), rubber, 1)
    scene.fix(bar.particles[0])
    for share, failed in ((1.0, True), (0.1, False)):
        for name, value in motion.items():
            getattr(scene, name)[bar.particles[1]] = share * np.array(value)
        (outcome,) = run(scene, factor=0.02)
        assert (outcome.failure is not None) == failed
        if failed:
            assert outcome.failure.cause == cause
            assert words in str(outcome.failure)
            assert abs(outcome.failure.balance) < 1e-3 * outcome.failure.scale


@pytest.mark.parametrize("parameters", [{"K_F": 0.0}, {"start": 120.0}])
def test_rounding_of_a_scene_at_rest_is_no_breakdown(parameters):
    """All its energy is rounding, and so is the imbalance; the balance is judged on more."""
    (outcome,) = run(bennett(**parameters), factor=0.9)
    assert outcome.failure is None
    assert max(np.abs(x - x[0]).max() for x, _ in outcome.points.values()) < 1e-12


def test_an_unstable_lane_does_not_harm_the_others():
    """Its neighbours are equal bit for bit to runs alone, it is reported as its own."""
    step = 0.9 * fpm.find_stable_step(two_bars()).step
    scenes = [two_bars(fpm.Material((1.0 + 0.01 * i) * 2.0e11, 0.3, 7850.0)) for i in range(8)]
    place, stiffer = 3, fpm.Material(8.4e11, 0.3, 7850.0)
    scenes[place] = two_bars(stiffer)
    outcomes = run(*scenes, step=step)
    assert [i for i, o in enumerate(outcomes) if o.failure is not None] == [place]
    assert not np.isfinite(outcomes[place].final.position).all()  # it really blew up
    assert outcomes[place].failure.limit == fpm.find_stable_step(two_bars(stiffer)).step
    for i in (1, 2, 6):
        assert same(outcomes[i], run(scenes[i], step=step)[0])


@pytest.mark.slow
def test_a_hinge_whose_particles_turn_too_far_in_a_step_is_refused():
    """No element limits the step of two rigid bodies; their hinge does."""
    scene = fpm.Scene("wheel")
    hub = scene.add_particles((0, 0, 0), 1.0, (1.0, 1.0, 1.0))
    wheel = scene.add_particles((0.3, 0, 0), 1.0, (0.1, 0.2, 0.25), spin=(0.0, 0.0, 40.0))
    scene.fix(int(hub[0]), "yz")
    scene.add_hinge("axle", (int(hub[0]), int(wheel[0])), (0, 0, 0), (0.0, 0.6, 0.8))
    fine = fpm.simulate(scene, duration=0.1, instants=5, step=1e-4)[0]
    assert fine.failure is None
    assert fine.records["hinge_gap"].values.max() < 1e-11
    coarse = fpm.simulate(scene, duration=1.0, instants=5, step=0.05)[0]
    words = r"hinge is open by .* rad in a step, at .* hinge axle; .* take a solver.step"
    with pytest.raises(fpm.InstabilityError, match=words):
        coarse.dataset()
    assert coarse.failure.largest["gap"] > 1e-6


@pytest.mark.parametrize("rate", [20.0, 100.0])
def test_the_programs_own_step_is_halved_until_joints_close(rate):
    """A wheel whose centre is 0.1 m off its pin, with 11 instants, turns by up to 10 rad between
    two. A stated step stays, and the message names the rate and a step that helps."""
    scene = fpm.Scene("wheel")
    spins, velocities = np.zeros((2, 2, 3))
    spins[1, 2], velocities[1, 1] = rate, 0.1 * rate
    places = [(0, 0, 0), (0.1, 0, 0)]
    particles = scene.add_particles(places, 1.0, (0.01, 0.01, 0.02), spin=spins)
    ends = tuple(map(int, particles))
    scene.velocity[ends[1]] = velocities[1]
    scene.fix(ends[0])
    scene.add_hinge("pin", ends, (0, 0, 0), (0, 0, 1.0))
    times = {"duration": 1.0, "instants": 11}
    (outcome,) = fpm.simulate(scene, **times)
    assert outcome.failure is None
    assert outcome.openings["pin"][-1] == pytest.approx(rate, rel=0.01)
    (stated,) = fpm.simulate(scene, step=2.0 / rate, **times)
    text = r"a body turns by 2.1 rad in a step, at (\d+) rad/s, .* a solver.step of at most (\S+) s"
    told, step = map(float, re.search(text, str(stated.failure)).groups())
    assert told == pytest.approx(rate, rel=0.1)
    assert step == pytest.approx(0.25 / rate, rel=0.1)
    assert fpm.simulate(scene, step=step, **times)[0].failure is None


@pytest.mark.slow
def test_axes_of_a_hinge_that_open_are_refused():
    """Two bodies about one point: only their axes can part."""
    scene = fpm.Scene("gimbal")
    spins = ((0.0, 0.0, 0.0), (5.0, 40.0, 10.0))
    ends = [int(scene.add_particles((0, 0, 0), 1.0, (0.1, 0.2, 0.25), spin=s)[0]) for s in spins]
    scene.fix(ends[0], "z", "")
    scene.add_hinge("pivot", ends, (0, 0, 0), (0.0, 0.0, 1.0))
    options = {"duration": 1.0, "instants": 5, "energy_tolerance": 1e6}
    assert fpm.simulate(scene, step=1e-3, **options)[0].failure is None
    failure = fpm.simulate(scene, step=0.05, **options)[0].failure
    assert "hinge pivot" in str(failure)
    assert failure.largest["tilt"] > 1e-5
