"""Which forces mesh and step alone decide: told of just those responses, and true of them."""

import numpy as np
import pytest
from flaps import J, flap
from rigid_holds import bars

import fpm
from fpm.elements import Latch
from fpm.elements.bars.beam import Material, Section
from fpm.reading.responses import KINDS, Response
from fpm.reading.shocks import warn
from fpm.reading.variables import VARIABLES

FORCES = {kind for kind, known in KINDS.items() if known.shock}


def response(kind, *about) -> Response:
    return Response("x", kind, about or ("knee", "sum"), "", "N", "x")


def rod(curve=None, latch=False) -> fpm.Scene:
    """A bar that a force pulls at its end, from the start on or by a curve of (times, values)."""
    scene = fpm.Scene("rod")
    bar = scene.add_link(
        (0, 0, 0), (1, 0, 0), (0, 0, 1), Section.square(0.01), Material(70e9, 0.3, 2700), 10, "rod"
    )
    scene.fix(int(bar.particles[0]))
    at = scene.add_curve(*curve) if curve else -1
    scene.add_load(int(bar.particles[-1]), force=(1.0, 0, 0), curve=at)
    return scene


def test_an_exact_latch_is_told_with_every_force_and_nothing_else():
    scene = bars(latch=0.4, name="pin")
    for kind in FORCES:
        assert "latch pin without `stiffness`" in warn(scene, response(kind))
    assert {"stress", "joint_moment", "latch_moment", "reaction_force"} < FORCES
    for kind in set(KINDS) - FORCES:
        assert warn(scene, response(kind)) == ""
    for part, told in (("latch", True), ("spring", False), ("damper", False), ("stop", False)):
        assert bool(warn(scene, response("joint_moment", "knee", part))) == told
    assert not warn(flap(latch={"angle": 1, "stiffness": 5}), response("joint_moment"))


@pytest.mark.parametrize(
    ("curve", "sudden"),
    [
        (None, True),
        (([0.0, 1.0], [0.5, 1.0]), True),
        (([0.0, 1.0], [0.0, 1.0]), False),
        (([-1.0, 1.0], [0.0, 1.0]), True),
        (([0.5, 1.0], [0.0, 1.0]), False),
    ],
)
def test_a_load_that_begins_at_once_is_told_where_there_are_bars(curve, sudden):
    assert ("a load begins" in warn(rod(curve), response("stress", "all"))) == sudden
    assert warn(rod(curve), response("velocity", "tip")) == ""
    rigid = bars()
    rigid.add_load(1, force=(1.0, 0, 0))
    rigid.kinds = {kind: own for kind, own in rigid.kinds.items() if kind.__name__ == "Load"}
    assert warn(rigid, response("acceleration", "tip")) == ""


def _peak(scene, hinge, step) -> float:
    label = f"{scene.hinges[hinge].name} latch"
    assert label in VARIABLES["joint_moment"].labels(scene)
    (outcome,) = fpm.simulate(
        scene, duration=0.8, instants=round(0.8 / step) + 1, step=step,
        record=[("joint_moment", label)],
    )  # fmt: skip
    return float(np.abs(outcome.columns["joint_moment", label]).max())


@pytest.mark.slow
def test_the_peak_of_a_latch_with_stiffness_is_the_rate_times_the_root_of_stiffness_and_inertia():
    """As the docs say to choose it: w sqrt(k J), for pi sqrt(J / k), at any step that follows."""
    rate, stiffness = 2.0, 200.0
    for step in (1e-3, 5e-4):
        scene = flap(rate=rate, latch={"angle": 1.0, "stiffness": stiffness})
        assert Latch.find(scene)
        assert _peak(scene, 0, step) == pytest.approx(rate * np.sqrt(stiffness * J), rel=2e-3)
