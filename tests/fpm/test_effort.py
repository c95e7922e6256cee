"""What a run costs, as it is foretold: every kind counts, and joints by how they are coupled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from flaps import bare
from jointed_scenes import chain, pairs, platform

from deployable.campaign.config.sections import scene_type
from fpm import structures
from fpm.elements import Damper, Joint
from fpm.elements.joints.joint_arrays import elimination, neighbours, pattern
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


@pytest.mark.parametrize("scene", [chain(6), pairs(), platform(5)])
def test_eliminations_are_counted_as_they_are_done(scene):
    joints = Joint.find(scene)
    on = sorted({p for joint in joints for p in joint.particles})
    slots = np.array([[on.index(p) for p in joint.particles] for joint in joints])
    movable = ~scene.fixed[on].all(axis=1)
    order, below = elimination(neighbours(slots, movable))
    found, _ = pattern([joints[j].conditions for j in order], slots[order], movable, below)
    count = found.count
    done = sum(n**3 / 6 for n in count)
    for j, n in enumerate(count):
        some = found.followers[found.below_start[j] : found.below_start[j + 1]]
        done += sum(n**2 * count[k] / 2 for k, _ in some)
        for i, k, *_ in found.updates[found.update_start[j] : found.update_start[j + 1]]:
            done += n * count[i] * count[k] * (0.5 if i == k else 1.0)
    assert Joint.elimination(scene) == (count.sum(), pytest.approx(done))


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
