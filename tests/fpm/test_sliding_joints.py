"""Cylindrical and planar joints, screws and pins in slots: steps, sweeps, assembly, forces."""

import numpy as np
import pytest

import fpm
from evidence.verification.sliders import (
    ARM,
    AXIS,
    GRAVITY,
    INERTIA,
    JOINTS,
    LEAD,
    MASSES,
    OFFSET,
    START,
    X,
)
from fpm.assembly import assemble
from fpm.assembly.conditions import ParticlePoses, conditions_of
from fpm.elements.joints.joint_types import TYPES
from fpm.elements.openings.opening import opening_at
from fpm.scenes.timestep import find_stable_step
from fpm.travel import sweep


def pair_on(type: str, opening=None, apart=0.0) -> fpm.Scene:
    """The ground and a body on it by a joint; its points `apart` (m) along the axis."""
    scene = fpm.Scene("pair", GRAVITY)
    scene.add_particles([np.zeros(3), ARM + OFFSET + apart * AXIS], (1.0, MASSES[1]), INERTIA)
    scene.fix(0)
    x, lead = (None, LEAD) if type == "screw" else (X, 0.0)
    openings = START[: len(TYPES[type].openings)] if opening is None else [opening]
    points = [ARM, ARM + apart * AXIS]
    scene.add_sliding_joint("J", type, (0, 1), points, AXIS, openings, x, lead)
    return scene


@pytest.mark.parametrize("type", JOINTS)
def test_the_stable_step_holds_and_openings_start_where_they_are_stated(type):
    """The frequency of a spring on each opening, as all the conditions leave it, is not above."""
    scene = pair_on(type)
    assert [opening_at(scene, h) for h in scene.hinges] == pytest.approx(START[: len(scene.hinges)])
    conditions = conditions_of(scene, [hinge.name for hinge in scene.hinges])
    rows = conditions.jacobian(ParticlePoses(scene.position, scene.frame)).toarray()[:, 6:]
    count = len(scene.hinges)
    assert np.linalg.matrix_rank(rows) == len(rows) == 6
    flexibility = np.diag(1 / np.repeat([MASSES[1], 1.0], 3)) / np.append([1.0] * 3, INERTIA)
    modes = np.linalg.solve(rows @ flexibility @ rows.T, np.eye(6))[-count:, -count:]
    for k in range(count):
        sprung = pair_on(type)
        sprung.add_torsion_spring(k, 10.0)
        frequency = np.sqrt(10.0 * np.linalg.inv(modes)[k, k])
        bound = find_stable_step(sprung).frequency
        assert frequency <= 1.000001 * bound and bound < 20 * frequency


@pytest.mark.slow
def test_a_screw_is_led_over_many_turns_of_its_thread():
    scene = pair_on("screw", opening=12.0)
    scene.add_torsion_spring(0, 0.5, 20.0)
    found = sweep(scene, "J", 12.0, 40.0)
    assert found.work["torsion spring J"] == pytest.approx(0.5 * (20.0 - found.opening), abs=1e-9)
    weight = MASSES[1] * (LEAD * GRAVITY @ AXIS + GRAVITY @ np.cross(AXIS, OFFSET))
    assert found.work["weight 0"][0] == pytest.approx(weight, rel=1e-9)
    inertia = np.array(INERTIA) @ AXIS**2 + MASSES[1] * (
        LEAD**2 + OFFSET @ OFFSET - (OFFSET @ AXIS) ** 2
    )
    assert found.inertia == pytest.approx(inertia, rel=1e-9)


@pytest.mark.parametrize("apart", [0.01, 0.43, -2.0])
def test_parts_that_do_not_fit_are_screwed_onto_the_nearest_turn(apart):
    scene = pair_on("screw", opening=7.0, apart=apart)
    assemble(scene)
    turns = (scene.position[1] @ AXIS - (ARM + OFFSET) @ AXIS) / LEAD - (
        scene.hinges[0].opening - 7.0
    )
    assert turns / (2 * np.pi) == pytest.approx(round(turns / (2 * np.pi)), abs=1e-9)
    assert abs(scene.hinges[0].opening - 7.0) < np.pi
    slide = pair_on("cylindrical", apart=apart)
    assemble(slide)
    assert slide.hinges[1].opening == pytest.approx(START[1] + apart, abs=1e-9)
