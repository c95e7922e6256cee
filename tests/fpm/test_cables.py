"""Cables against closed forms: slack and tight, running, reeled in; what they refuse."""

import numpy as np
import pytest

import fpm

pytestmark = pytest.mark.slow  # a time loop of its own

G, MASS, EA, REST = 9.81, 2.0, 4000.0, 1.0
RATE = np.sqrt(EA / REST / MASS)  # of a mass on the cable, rad/s


def hung(start=0.8, arm=0.0, **more) -> fpm.Scene:
    """A mass that is let go `start` m below the point from which a cable of 1 m hangs."""
    scene = fpm.Scene("hung", gravity=(0, 0, -G))
    top = int(scene.add_particles((0, 0, 0), 1.0, 1.0)[0])
    scene.fix(top)
    mass = int(scene.add_particles((0, 0, -start - arm), MASS, 1.0)[0])
    scene.add_cable("rope", [(top, None), (mass, (0, 0, -start))], EA, **(more or {"rest": REST}))
    scene.add_point("mass", mass)
    return scene


def test_the_stable_step_is_that_of_a_mass_on_a_spring_and_true():
    limit = fpm.find_stable_step(hung())
    assert limit.step == pytest.approx(2 / RATE, rel=1e-12)
    assert limit.element == "cable rope"
    tight = hung(1.0, preload=MASS * G)
    tight.velocity[1, 2] = 1e-3
    for share, fails in ((0.99, False), (1.01, True)):
        step = share * fpm.find_stable_step(tight).step
        outcome = fpm.simulate(tight, duration=1000 * step, instants=3, step=step)[0]
        assert (outcome.failure is not None) == fails
        if fails:
            assert outcome.failure.element == "cable rope"


def atwood(one=3.0, two=2.0, wheel=None, EA=1e6, start=0.0) -> fpm.Scene:
    """Two masses on a cable over a fixed point; or over one that a mass carries, itself hung."""
    scene = fpm.Scene("atwood", gravity=(0, 0, -G))
    places = [(0.0, 0, 0), (-1e-3, 0, -1.0), (1e-3, 0, -1.0)]
    masses = [wheel or 1.0, one, two]
    top, left, right = (int(p) for p in scene.add_particles(places, masses, np.ones((3, 3))))
    if wheel is None:
        scene.fix(top)
    else:
        hook = int(scene.add_particles((0, 0, 2.0), 1.0, 1.0)[0])
        scene.fix(hook)
        scene.add_cable("hanger", [(hook, None), (top, None)], EA, preload=0.0)
    scene.add_cable("rope", [(left, None), (top, None), (right, None)], EA, preload=start)
    for name, particle in (("left", left), ("right", right), ("top", top)):
        scene.add_point(name, particle)
    return scene


def true_square(places, masses, rest) -> float:
    """Square of the highest frequency of masses (n,) at places (n, 3) on a cable of EA = 1."""
    count = len(masses)
    chords = np.diff(places, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    units = chords / lengths[:, None]
    longer = max(lengths.sum() - rest, 0.0)
    slope, hessian = np.zeros((count, 3)), np.zeros((count, 3, count, 3))
    slope[:-1] -= units
    slope[1:] += units
    for i, (n, length) in enumerate(zip(units, lengths, strict=True)):
        across = (longer / rest / length) * (np.eye(3) - np.outer(n, n))
        for a, b, sign in ((i, i, 1), (i + 1, i + 1, 1), (i, i + 1, -1), (i + 1, i, -1)):
            hessian[a, :, b] += sign * across
    hessian += np.multiply.outer(slope, slope) / rest
    roots = np.repeat(masses, 3) ** -0.5
    return np.linalg.eigvalsh(hessian.reshape(3 * count, -1) * np.outer(roots, roots))[-1]


def test_the_stable_step_holds_wherever_a_running_cable_s_points_move_to():
    """The exact highest frequency is below, for points anywhere, as far as crowding allows."""
    random = np.random.default_rng(0)
    ratios = []
    for _ in range(300):
        count = random.integers(2, 6)
        masses, places = random.uniform(0.1, 3, count), random.standard_normal((count, 3))
        lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
        rest = lengths.sum() - random.uniform() * lengths.min()
        scene = fpm.Scene("anywhere")
        scene.add_particles(
            np.zeros((count, 3)) + np.arange(count)[:, None], masses, np.ones((count, 3))
        )
        scene.add_cable("rope", [(i, None) for i in range(count)], 1.0, rest=rest)
        square = fpm.find_stable_step(scene).frequency ** 2
        ratios.append(true_square(places, masses, rest) / square)
    assert max(ratios) <= 1 + 1e-9
    # There and back again in one line, it is the true one but for the short way between.
    back = np.array([[0.0, 0, 0], [1, 1e-6, 0], [0, 2e-6, 0]])
    scene = atwood(1.0, 1.0, 1.0)
    scene.cables = scene.cables[1:]
    rest = scene.cables[0].rest
    square = fpm.find_stable_step(scene).frequency ** 2
    assert 1e6 * true_square(rest / 2 * back, np.ones(3), rest) == pytest.approx(square, rel=1e-6)


def test_points_that_meet_under_tension_are_refused():
    scene = fpm.Scene("meeting", gravity=(0, 0, -1e-3))
    one, two = (int(p) for p in scene.add_particles([(0, 0, 0), (1, 0, 0)], 1.0, np.ones((2, 3))))
    scene.fix(one)
    middle = int(scene.add_particles((0.999, 0.0, 0), 1.0, 1.0)[0])
    scene.add_cable("rope", [(one, None), (middle, None), (two, None)], 1e3, preload=5.0)
    (outcome,) = fpm.simulate(scene, duration=0.1, instants=2, step=1e-4)
    assert outcome.failure.cause == "crowding"
    assert outcome.failure.element == "cable rope"
    assert "points that meet under tension" in str(outcome.failure)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"EA": 0.0}, "EA of cable rope2 = 0.0"),
        ({"rest": -1.0}, "unstrained length of cable rope2 = -1.0"),
        ({"rest": None}, "rest, preload of cable rope2"),
        ({"preload": 1.0}, "rest, preload of cable rope2"),
        ({"rest": None, "preload": -1.0}, "EA, preload of cable rope2"),
        ({"points": [(0, None)]}, "points of cable rope2"),
        ({"points": [(0, None), (0, (0, 0, 1))]}, "points of cable rope2"),
        ({"points": [(0, None), (7, None)]}, "points of cable rope2"),
        ({"name": "rope"}, "cable = 'rope'"),
        ({"reel": 0.1}, "reel of cable rope2"),
        ({"reel": 1.0, "curve": 0}, "unstrained length of cable rope2 = 0"),
        ({"curve": 1}, "curve of cable rope2"),
    ],
)
def test_what_is_refused(change, message):
    scene = hung()
    scene.add_curve([0, 1], [0, 1])
    good = {"name": "rope2", "points": [(0, None), (1, None)], "EA": 1.0, "rest": 1.0}
    with pytest.raises(fpm.SceneError, match=message):
        scene.add_cable(**good | change)
    assert len(scene.cables) == 1
