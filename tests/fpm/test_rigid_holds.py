"""Openings that are held exactly: catching, letting go, energies, lanes, refusals."""

import numpy as np
import pytest
from rigid_holds import L, M, bars

import fpm
from fpm.elements import Hinge, Joint, Latch, Release, Turn

G = 9.81
RUN = {"duration": 2.0, "instants": 2001, "step": 5e-4}
CASES = {
    "caught": bars(rates=(0.3, 1.0), latch=0.4),
    "swings": bars(angles=(-1.2, -1.2), rates=(0.5, 2.5), gravity=G, latch=0.5),
    "missed": bars(rates=(0.3, 1.0), latch=0.4, max_capture_rate=0.5),
    "wrong side": bars(rates=(0.3, 1.0), latch=0.4, side="above"),
    "never": bars(rates=(0.3, 1.0)),
}


def run(cases: dict, **more) -> dict:
    outcomes = fpm.simulate(list(cases.values()), **{**RUN, **more})
    assert not any(outcome.failure for outcome in outcomes)
    return dict(zip(cases, outcomes, strict=True))


@pytest.fixture(scope="module")
def ran():
    return run(CASES)


def angles_of(outcome) -> np.ndarray:
    root, knee = outcome.openings["root"], outcome.openings["knee"]
    return np.array([root, root + knee])


@pytest.mark.slow
@pytest.mark.parametrize("reach", [0.0, 0.1])
def test_a_rigid_latch_at_whose_angle_a_run_starts_holds_from_the_start_on(reach):
    found = run({"at": bars(angles=(0.1, 0.1), gravity=G, latch=0.5 * reach, capture_range=reach)})
    assert np.ptp(found["at"].openings["knee"]) < 1e-9 < np.ptp(found["at"].openings["root"])
    assert found["at"].events[0, 0] == 0.0


@pytest.mark.slow
def test_a_rigid_latch_catches_the_same_openings_as_others(ran):
    """Too fast, or from the wrong side: the motion is that without it, to the last bit."""
    free = ran["never"]
    for name, noted in (("missed", [1.0]), ("wrong side", [])):
        assert ran[name].events[:, 2].tolist() == noted
        assert np.array_equal(angles_of(ran[name]), angles_of(free))
        assert not ran[name].energies["joint_loss"].any()
    assert ran["missed"].events[0, 0] == pytest.approx(ran["caught"].events[0, 0], abs=1e-12)


@pytest.mark.slow
def test_moments_that_hold_are_told_apart_and_reactions_know_them(ran):
    """The latch's moment and work; and, once all is one pendulum, the force of the root on it."""
    asked = [("joint_moment", "knee latch"), ("joint_work", "knee latch"),
             ("constraint_force", "root x"), ("constraint_force", "root y"),
             ("constraint_moment", "knee z")]  # fmt: skip
    (outcome,) = fpm.simulate(CASES["swings"], record=asked, **RUN)
    assert np.array_equal(angles_of(outcome), angles_of(ran["swings"]))
    moment, work, x, y, twist = (outcome.columns[column] for column in asked)
    np.testing.assert_array_equal(moment, outcome.records["latch_moment"].values[:, 0])
    np.testing.assert_allclose(work, -outcome.energies["joint_loss"], atol=1e-14)
    assert np.abs(twist).max() < 1e-9  # about its own axis the hinge itself has none
    late = slice(500, -1)
    angles, step = angles_of(outcome), outcome.time[1]
    way = np.cumsum(L * np.exp(1j * angles), axis=0) - L / 2 * np.exp(1j * angles)
    pulled = M @ np.diff(way, 2, axis=1) / step**2 + 1j * G * M.sum()
    assert np.abs((x + 1j * y)[late] - pulled[late.start - 1 :]).max() < 1e-3 * np.abs(pulled).max()


def test_rigid_holds_cost_no_step_and_make_joints_of_their_hinges():
    scene = bars(latch=0.4, hold={"time": 1.0})
    assert fpm.find_stable_step(scene).step == np.inf
    assert Hinge.find(scene) == []
    assert [joint.type for joint in Joint.find(scene)] == ["revolute"] * 3 + ["opening"] * 3
    assert len(Turn.find(scene)) == 3


@pytest.mark.parametrize(
    ("element", "message"),
    [
        (Latch(7, 1.0), "hinge of latch = 7"),
        (Latch(0, 1.0, capture_range=-1.0), "capture range of latch"),
        (Latch(0, 1.0, max_capture_rate=0.0), "largest capture rate of latch"),
        (Latch(0, np.nan), "angle of latch"),
        (Latch(1, 1.0), "no other latch"),
        (Latch(1, 1.0, 1.0), "no other latch"),
        (Release(0), "time of release root"),
        (Release(0, time=-1.0), "time of release root"),
        (Release(2, time=1.0), "one release on a joint"),
        (Release(2, 1.0, 0.0, 0.0, time=1.0), "one release on a joint"),
        (Release(0, watch=1, level=0.0), "level of release root"),
    ],
)
def test_what_rigid_holds_refuse(element, message):
    with pytest.raises(fpm.SceneError, match=message):
        bars().add(element)


def test_a_release_does_not_watch_an_opening_at_which_a_latch_holds():
    """Rounding alone would say whether the opening passes the level."""
    with pytest.raises(fpm.SceneError, match="no latch holds the other hinge; watch that latch"):
        bars(latch=0.4).add(Release(0, watch=1, level=0.4))
