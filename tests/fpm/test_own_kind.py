"""A kind that the mechanics has never heard of: two files beside this one, added by `Scene.add`."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pytest
from ground_spring import GroundSpring

import fpm
from fpm.elements.kind import ElementType, Energy
from fpm.scenes.scene_type import SceneType

pytestmark = pytest.mark.slow  # a time loop of its own

MASS, STIFFNESS, REST = 2.0, 50.0, 0.4
RATE = np.sqrt(STIFFNESS / MASS)  # of its oscillation, rad/s


def body(start=0.7, sideways=0.0, **more) -> fpm.Scene:
    """A body on a spring along x that starts from rest, stretched by 0.3 m."""
    scene = fpm.Scene("body", **more)
    particle = int(scene.add_particles((start, 0, 0), MASS, 1.0, velocity=(0, sideways, 0))[0])
    scene.add(GroundSpring(particle, (0.0, 0.0, 0.0), STIFFNESS, REST))
    scene.add_point("body", particle)
    return scene


@pytest.fixture(scope="module")
def outcome():
    return fpm.simulate(body(), duration=2.0, instants=101, step=1e-3)[0]


def test_it_moves_as_it_should(outcome):
    x = outcome.points["body"][0][:, 0]
    np.testing.assert_allclose(x, REST + 0.3 * np.cos(RATE * outcome.time), atol=1e-4)


def test_it_has_a_stable_step():
    limit = fpm.find_stable_step(body())
    assert limit.step == pytest.approx(2 / RATE, rel=1e-12)
    assert limit.element == "ground spring 0"
    stable, unstable = (
        fpm.simulate(body(), duration=1000 * step, instants=3, step=step, energy_tolerance=0.5)[0]
        for step in (0.99 * limit.step, 1.01 * limit.step)
    )
    assert stable.failure is None
    assert unstable.failure.element == "ground spring 0"
    assert "use a step below" in str(unstable.failure)


def test_its_events_and_what_it_records_are_in_the_file(outcome, tmp_path):
    passes = (0.5 + np.arange(3)) * np.pi / RATE
    np.testing.assert_allclose(outcome.events[:, 0], passes, atol=1e-5)
    assert outcome.events[:, 2].tolist() == [1, 0, 1]  # slackens first
    assert outcome.eventful == (("ground spring 0", ("stretches", "slackens"), "", None),)
    fpm.trajectory.write(fpm.trajectory.contents([outcome]), tmp_path / "runs.nc")
    back = fpm.trajectory.read(tmp_path / "runs.nc").isel(run=0)
    assert np.array_equal(back.event_time, outcome.events[:, 0])
    assert back.event_names.values.tolist() == ["stretches slackens"]
    lengths = back.spring_length.sel(ground_spring="ground spring 0")
    np.testing.assert_allclose(lengths, back.position.sel(point="body", axis="x"), atol=1e-12)
    assert back.spring_length.units == "m"
    assert np.array_equal(back.ground_energy, outcome.energies["ground"])
    curves = fpm.trajectory.read_curves(tmp_path / "runs.nc")["0"]
    assert np.array_equal(curves.energies["ground"], outcome.energies["ground"])


def test_what_it_refuses_and_its_topology():
    for wrong, message in (
        ((0, (0, 0, 0), -1.0, 1.0), r"ground spring stiffness = -1.0 .* of at least 0 \(N/m\)"),
        ((0, (0, 0, 0), 1.0, np.nan), "length at rest of ground spring = nan"),
        ((0, (0, 0), 1.0, 1.0), "anchor of ground spring .*3 finite numbers"),
        ((1, (0, 0, 0), 1.0, 1.0), "particle of ground spring = 1 .*0 to 0"),
    ):
        with pytest.raises(fpm.SceneError, match=message):
            body().add(GroundSpring(*wrong))
    other = body()
    other.add(GroundSpring(0, (1, 0, 0), 1.0, 1.0))
    with pytest.raises(fpm.SceneError, match="topology of scene 1"):
        fpm.simulate([body(), other], duration=0.1, instants=2)


def test_its_energy_can_be_a_response(outcome):
    scene = SceneType("body", "a body on a spring", {}, ("body",), (), body)
    assert scene.energies[0] == "kinetic" and scene.energies[-1] == "balance"
    response = fpm.responses.parse("U", {"energy": "ground"}, scene.sample)
    assert np.array_equal(response.evaluate(outcome), outcome.energies["ground"])
    with pytest.raises(fpm.SceneError, match="ground"):
        fpm.responses.parse("U", {"energy": "heat"}, scene.sample)


class NoArrays(NamedTuple):
    rows: np.ndarray


@dataclass(frozen=True)
class Boast(ElementType):
    """Says that it stores energy, and has no kernel for it."""

    stores = Energy("boast", "boast_energy", "energy that nobody computes")

    @classmethod
    def pack(cls, batch):
        return NoArrays(batch.rows_of(cls))


def test_a_kind_that_stores_energy_has_a_kernel_for_it():
    scene = fpm.Scene()
    scene.add_particles((0, 0, 0), 1.0, 1.0)
    scene.add(Boast())
    with pytest.raises(TypeError, match="kind Boast has `stores` and not a kernel"):
        fpm.simulate(scene, duration=1e-3, instants=2, step=1e-3)


def test_hooks_that_do_not_exist_are_refused():
    from ground_spring_kernels import GroundSprings

    from fpm.kernels.hooks import hook

    with pytest.raises(ValueError, match="forcse is not a hook; expected one of forces"):
        hook(GroundSprings, "forcse")(lambda part, world, timing: None)


def test_a_kernel_is_not_replaced_in_silence():
    from ground_spring_kernels import GroundSprings

    from fpm.kernels.hooks import hook

    with pytest.raises(ValueError, match="GroundSprings has a kernel for forces already"):
        hook(GroundSprings, "forces")(lambda part, world, timing: None)
