"""Moments on openings by who acts, their power and what they lose: against closed forms."""

import numpy as np
import pytest
from asking import curves
from flaps import FAR, J, flap

import fpm

PARTS = ("spring", "latch", "damper", "friction", "stop")
LOSING = ("latch", "damper", "friction", "stop")
DEFINITIONS = {
    "rate": {"opening_rate": "hinge"},
    "opening": {"opening": "hinge"},
    "sum": {"joint_moment": "hinge"},
    "power": {"joint_power": "hinge"},
    "all": {"loss": "all"},
    "account": {"energy": "joint_loss"},
    **{f"M {part}": {"joint_moment": "hinge", "part": part} for part in PARTS},
    **{f"lost {part}": {"loss": part} for part in LOSING},
}
TIMES = {"duration": 1.0, "instants": 501, "step": 2e-4}


@pytest.mark.slow  # a time loop of its own
def test_latch_and_stop_lose_what_the_account_of_all_has():
    """A flap that flies into a latch and, held by it, against a stop: by part and in sum, to 1e-4
    of the energy at first, which edges of springs between two steps leave."""
    scene = flap(
        rate=2.0, damper=0.02, friction={"moment": 0.05},
        latch={"angle": 0.5, "stiffness": 40.0, "damping": 0.3},
        stop={"angle": 0.55, "side": "above", "stiffness": 200.0, "damping": 0.5},
    )  # fmt: skip
    time, found, outcome = curves(scene, DEFINITIONS, **TIMES)
    energy = 0.5 * J * 2.0**2
    assert outcome.dropped_events == 0 and len(outcome.events) > 1
    lost = {part: found[f"lost {part}"] for part in LOSING}
    np.testing.assert_allclose(sum(lost.values()), found["account"], atol=1e-4 * energy)
    np.testing.assert_array_equal(found["all"], found["account"])
    for part, values in lost.items():
        assert np.diff(values).min() > -1e-4 * energy, part
        assert values[-1] > 1e-3 * energy, part
    before = found["opening"] < 0.499
    before &= time < 0.3
    assert not found["M latch"][before].any() and not found["M stop"][before].any()
    assert found["M stop"].min() < -1.0 and found["M stop"].max() <= 0.0
    np.testing.assert_allclose(
        found["M latch"], outcome.records["latch_moment"].values[:, 0], atol=1e-12
    )
    np.testing.assert_allclose(found["sum"], sum(found[f"M {part}"] for part in PARTS), atol=1e-12)
    # What turns the flap is the sum: J ψ'' at the instants, J from the energy of the flap.
    np.testing.assert_allclose(found["power"], found["sum"] * found["rate"], atol=1e-12)


def test_what_does_not_act_on_a_hinge_is_refused_by_name():
    scene = flap(latch={"angle": FAR, "stiffness": 0.0})
    with pytest.raises(fpm.SceneError, match="one of spring, latch, damper, friction, stop, sum"):
        curves(scene, {"m": {"joint_moment": "hinge", "part": "motor"}}, **TIMES)
    with pytest.raises(fpm.SceneError, match="one of all, damper, friction, stop, latch, damping"):
        curves(scene, {"m": {"loss": "motor"}}, **TIMES)
