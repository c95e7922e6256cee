"""What a run costs, as it is foretold: every kind counts, and joints by how they are coupled."""

from __future__ import annotations

from pathlib import Path

import pytest
from flaps import bare
from jointed_scenes import chain, platform

from deployable.campaign.config.sections import scene_type
from fpm import structures
from fpm.elements import Damper
from fpm.scenes import timestep

STRUCTURES = Path(__file__).parents[2] / "config" / "structures"


class Dear(Damper):
    cost = 1e4


def test_a_kind_states_its_cost():
    scenes = [bare(), bare(), bare()]
    scenes[1].add(Damper(0, 1.0))
    scenes[2].add(Dear(0, 1.0))
    without, damped, dear = map(timestep.step_seconds, scenes)
    assert damped - without == pytest.approx(1e-9 * Damper.cost)
    assert dear - without == pytest.approx(1e-5)


def test_joints_on_one_body_cost_more_than_those_of_a_chain():
    row, cranks = chain(61), platform(30)
    assert len(row.hinges) == len(cranks.hinges) == 60
    assert timestep.step_seconds(cranks) > 5 * timestep.step_seconds(row)


def test_a_step_costs_what_is_in_it():
    def seconds(file, **parameters):
        scene = structures.load(STRUCTURES / f"{file}.yaml").build(**parameters)
        return timestep.step_seconds(scene)

    assert seconds("scissor", n=20) == pytest.approx(2 * seconds("scissor", n=10), rel=0.1)
    assert seconds("ring_truss") > 5 * seconds("scissor")  # 24 joints that share bodies
    assert seconds("panel", elements=40) > 3 * seconds("panel", elements=4)


def test_a_run_costs_its_steps_its_instants_and_its_packing():
    scene = scene_type("pendulum").build()
    one = timestep.run_seconds(scene, 1000, 11)
    assert one > timestep.PER_SCENE
    assert timestep.run_seconds(scene, 2000, 11) - one == pytest.approx(
        1000 * timestep.step_seconds(scene) / 8
    )
    assert timestep.run_seconds(scene, 1000, 1011) - one == pytest.approx(
        timestep.INSTANT * 1e-6 / 8
    )
    assert 0.1 < timestep.machine() <= 2.0
