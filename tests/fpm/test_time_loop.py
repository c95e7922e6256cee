"""The time loop: batches, energy bookkeeping, events, restarts at the level of one run."""

import numpy as np
import pytest

import fpm
from evidence.linkage.runs import build

WOOD = fpm.Material(1e9, 0.3, 800.0)


def linkage(**parameters) -> fpm.Scene:
    return build(elements=4, **parameters)


def equal(a: fpm.Outcome, b: fpm.Outcome) -> bool:
    """Whether two outcomes agree bit for bit in points and energies."""
    points = all(np.array_equal(a.points[p][k], b.points[p][k]) for p in a.points for k in (0, 1))
    return points and all(np.array_equal(a.energies[k], b.energies[k]) for k in a.energies)


@pytest.fixture(scope="module")
def batch():
    """Eleven linkages of different side, run together: one full register and three lanes."""
    sides = 0.035 * (1 + 0.01 * np.linspace(-1, 1, 11))
    scenes = [linkage(a=a) for a in sides]
    return scenes, fpm.simulate(scenes, duration=0.4, instants=81, step=4e-5)


def test_hinges_stay_closed_and_energy_balances(batch):
    _, together = batch
    for outcome in together:
        start = outcome.energies["spring"][0]
        assert outcome.records["hinge_gap"].values.max() < 1e-10
        assert outcome.records["hinge_axis_gap"].values.max() < 1e-9
        assert np.abs(outcome.energies["balance"]).max() < 0.005 * start
        assert outcome.energies["kinetic"].max() > 0.9 * start, "nothing moved"


def test_held_hinge_points_stay_where_they_are(batch):
    _, together = batch
    for outcome in together:
        for name in ("A", "C"):  # held in their plane
            height = outcome.points[name][0][:, 2]
            assert np.ptp(height) < 1e-10
            assert np.ptp(outcome.points[name][0][:, 0]) > 1e-3, "they slide"


def test_contacts_close_where_the_opening_crosses_zero(batch):
    _, together = batch
    outcome = together[0]
    assert len(outcome.events) >= 4
    assert outcome.dropped_events == 0
    time, contact, closing = outcome.events[0]
    opening = outcome.openings[outcome.scene.hinges[int(contact)].name]
    assert closing == 1
    before = opening[outcome.time < time]
    assert before[-1] > 0
    assert opening[outcome.time > time][0] < 0


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"duration": -1.0, "instants": 3}, "duration"),
        ({"duration": 1.0, "instants": 1}, "instants"),
        ({"duration": 1.0, "instants": 3, "step": 0.0}, "step"),
        ({"duration": "1 sec", "instants": 3}, r"duration = '1 sec' .* a positive number \(s\)"),
        ({"duration": 1.0, "instants": "3"}, "instants = '3' .* at least 2"),
        ({"duration": 1.0, "instants": 3, "safety": "1"}, "safety = '1' .* a positive number"),
        ({"scenes": "latch.yaml", "duration": 1.0, "instants": 3}, "scenes = .* a scene, as"),
    ],
)
def test_bad_arguments_are_refused(arguments, text):
    with pytest.raises(fpm.SceneError, match=text):
        fpm.simulate(arguments.pop("scenes", linkage()), **arguments)


def test_a_whole_number_as_tolerance_compiles_nothing_new():
    from fpm.kernels.compiled_loop import READY

    scene = build(elements=2)
    fpm.simulate(scene, duration=1e-3, instants=2)
    ready = READY.copy()
    fpm.simulate(scene, duration=1e-3, instants=2, energy_tolerance=1)
    assert ready == READY


def beam(**more) -> tuple[fpm.Scene, fpm.Link]:
    scene = fpm.Scene("beam", **more)
    bar = scene.add_link((0, 0, 0), (1, 0, 0), (0, 0, 1), fpm.Section.square(0.05), WOOD, 6, "bar")
    scene.add_point("tip", int(bar.particles[-1]))
    return scene, bar


@pytest.mark.slow
def test_a_point_beside_a_turning_drive_moves_with_it():
    """A disc that is spun up and pushed: its rim, and its motion at the end, start included."""
    scene, bar = beam()
    scene.fix(bar.particles, translations="z", rotations="")
    disc = int(scene.add_particles((0.0, 0.0, 0.0), 1.0, 1.0)[0])
    scene.add_point("rim", disc, (0.5, 0.0, 0.0))
    ramp = scene.add_curve([0.0, 1.0], [1.0, 3.0])
    scene.drive(disc, spin=(0, 0, 2.0), curve=ramp)
    scene.drive(disc, velocity=(0, 0, 1.0))
    outcome = fpm.simulate(scene, duration=1.0, instants=41, step=1e-4)[0]
    t = outcome.time
    angle, rate = 2 * t + 2 * t**2, 2 + 4 * t
    zero = np.zeros_like(t)
    expected = 0.5 * rate[:, None] * np.stack([-np.sin(angle), np.cos(angle), zero], 1) + [0, 0, 1]
    np.testing.assert_allclose(outcome.points["rim"][1], expected, atol=1e-6)
    np.testing.assert_allclose(outcome.final.spin[disc], [0, 0, 6.0], rtol=1e-12)
    np.testing.assert_allclose(outcome.final.velocity[disc], [0, 0, 1.0], rtol=1e-12)


def test_a_linkage_at_rest_at_closure_has_no_contact_events():
    """Its openings are zero to rounding, and cross it many times."""
    outcome = fpm.simulate(linkage(start=120.0), duration=0.02, instants=5)[0]
    assert len(outcome.events) == 0
    assert np.abs(np.array(list(outcome.openings.values()))).max() < 1e-9


def test_no_path_is_chosen_by_a_sample_beside():
    """Beams along their particles' axes take another path than those across them."""
    across = linkage()
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    across.frame = across.frame @ turn
    with pytest.raises(fpm.SceneError, match="along their particles' axes"):
        fpm.simulate([linkage(), across], duration=1e-3, instants=2)


def test_no_event_is_dropped_where_there_is_little_room(batch, monkeypatch):
    scenes, together = batch
    assert len(together[0].events) > 2
    monkeypatch.setattr(fpm.solver.pack, "MOST_EVENTS", 2)
    crowded = fpm.simulate(scenes[:3], duration=0.4, instants=81, step=4e-5)
    for one, other in zip(crowded, together, strict=False):
        np.testing.assert_array_equal(one.events, other.events)
        assert one.dropped_events == 0
        assert equal(one, other)
    monkeypatch.setattr(fpm.solver.pack, "MOST_ROOM", 3)
    (short,) = fpm.simulate(scenes[0], duration=0.4, instants=81, step=4e-5)
    assert len(short.events) == 3
    assert short.dropped_events == len(together[0].events) - 3
