"""Structures from text do what closed forms, and the same structures in Python, do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from structures_for_tests import FOLDER, SMALL, changed, structure

import fpm
from evidence.verification.deployables import scissor
from fpm.elements.particles.drive import Drive
from fpm.structures import StructureError, load, loads
from fpm.structures.plausible import warnings


def run(scene, duration, instants):
    outcome = fpm.simulate(scene, duration=duration, instants=instants)[0]
    assert outcome.failure is None
    return outcome


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_structure_of_the_library_is_a_scene_type(path):
    found = load(path)
    assert found.name == path.stem
    assert found.description
    assert all(parameter.text for parameter in found.parameters.values())
    assert len(found.digest) == 16
    scene = found.build()
    assert warnings(scene) == []
    assert tuple(scene.points) == found.points
    assert tuple(hinge.name for hinge in scene.hinges) == found.hinges
    if scene.beams:
        assert found.parameters[found.mesh].is_whole
        finer = found.build(**{found.mesh: 2 * found.parameters[found.mesh].default})
        assert len(finer.position) > len(scene.position)
    else:  # rigid bodies have no mesh
        assert found.mesh is None


def test_the_exact_scissor_has_the_published_times():
    assert scissor(1)[0] == pytest.approx(0.449682123, abs=1e-9)
    assert scissor(3) == pytest.approx((1.302061615, 2.177764658), abs=1e-9)


# -- parts of the language ------------------------------------------------------------------------


def test_bars_through_points_have_the_mass_and_inertia_of_their_stretches():
    bent = changed(
        SMALL, ("[A, B], sec", "[A, M, B], sec"), ("points:", "points:\n  M: [half, 0.1, 0]")
    )
    scene = loads(bent.split("joints:")[0]).build(stow=0.0)
    count = len(scene.position)
    points = np.array([[0, 0, 0], [0.5, 0.1, 0], [1, 0, 0]])
    stretches = [loads(SMALL).build(stow=0.0, L=np.hypot(0.5, 0.1)).mass[1:].sum()] * 2
    assert count == 5
    assert scene.mass.sum() == pytest.approx(sum(stretches), rel=1e-13)
    np.testing.assert_allclose(scene.position[[0, 2, 4]], points, atol=1e-15)
    # The tensor at the knee is the sum of the two ends', in whatever axes it is written.
    axes = [np.stack([d, [-d[1], d[0], 0], [0, 0, 1]], 1)
            for d in (np.diff(points, axis=0) / np.hypot(0.5, 0.1))]  # fmt: skip
    ends = sum(a * scene.inertia[0] @ a.T for a in axes)
    knee = scene.frame[2] * scene.inertia[2] @ scene.frame[2].T
    np.testing.assert_allclose(knee, ends, atol=1e-15)


def test_a_straight_bar_through_a_point_moves_as_without_it():
    point = ("points:", "points:\n  M: [B.x/2, B.y/2, B.z/2]")
    middle = changed(SMALL, ("[A, B], section", "[A, M, B], section"), point)
    through = run(loads(middle).build(n=4), 0.5, 51)
    straight = run(loads(SMALL).build(n=8), 0.5, 51)
    tips = [outcome.points["tip"][0] for outcome in (through, straight)]
    np.testing.assert_allclose(*tips, atol=2e-5)


def test_loads_drives_supports_curves_and_motions():
    more = """
curves:
  ramp: {times: [0, 1], values: [0, 2]}
loads:
  push: {part: arm, at: B, force: [1 N, 0, 0], moment: [0, 2 N m, 0], curve: ramp}
  gust: {part: arm, at: B, force: [0, 0, 1 kN]}
initial_velocities:
  swing: {part: arm, about: A, spin: [0, -3 rad/s, 0]}
supports:
  guide: {part: arm, at: B, translations: y, rotations: none}
gravity: [0, 0, -9.81]
damping: 0.5 /s
record:"""
    scene = loads(changed(SMALL, ("record:", more))).build(stow=0.0)
    tip = scene.points["tip"].particle
    push, gust = scene.loads
    assert (push.curve, gust.curve, push.beam.particle) == (0, -1, tip)
    np.testing.assert_array_equal(gust.force, [0, 0, 1000])
    np.testing.assert_array_equal(push.moment, [0, 2, 0])
    np.testing.assert_array_equal(scene.curves[0].values, [0, 2])
    np.testing.assert_allclose(scene.velocity[tip], [0, 0, 3.0])
    np.testing.assert_array_equal(scene.fixed[tip], [False, True, False, False, False, False])
    np.testing.assert_array_equal(scene.gravity, [0, 0, -9.81])
    assert scene.damping == 0.5
    driven = "drives: {motor: {part: arm, at: A, spin: [0, 1 rad/s, 0]}}\n"
    particles, _, spins = Drive.motion(loads(SMALL.split("joints:")[0] + driven).build(), 0.0)
    np.testing.assert_array_equal(particles, [0])
    np.testing.assert_array_equal(spins, [[0, 1, 0]])


@given(st.data())
@settings(max_examples=20, deadline=None)
def test_any_allowed_values_give_a_scene_or_are_refused(data):
    found = structure(data.draw(st.sampled_from(["bennett", "zfold", "scissor", "panel"])))
    values = {}
    for name, parameter in found.parameters.items():
        low = max(parameter.least, -1e3)
        high = max(low, min(parameter.most, 1e3))
        if parameter.is_whole:
            values[name] = data.draw(st.integers(int(low), int(min(high, 4))))
        else:
            values[name] = data.draw(st.floats(low, high))
    try:
        scene = found.build(**values)
    except fpm.SceneError as error:
        assert str(error)
    else:
        assert np.isfinite(scene.position).all()
        assert np.isfinite(scene.inertia).all()


def test_sections():
    text = changed(SMALL, ("tube, diameter: 35 mm, thickness: 2 mm", "circle, diameter: 35 mm"))
    solid, tube = loads(text).build(), loads(SMALL).build()
    rod, hole = (fpm.Section.circle(radius) for radius in (0.0175, 0.0155))
    assert solid.beams[0].section == rod
    for name in ("A", "Iy", "Iz", "J"):
        value = getattr(tube.beams[0].section, name)
        assert value == pytest.approx(getattr(rod, name) - getattr(hole, name), rel=1e-12)
    flat = text.replace("{type: circle, diameter: 35 mm}", "{type: rectangle, width: 3, height: 1}")
    with pytest.raises(fpm.SceneError, match="the direction in which the section's height points"):
        loads(flat)
    assert loads(flat.replace("elements: n", "elements: n, up: y")).build()


def test_the_digest_follows_what_a_file_says():
    base, spaced = loads(SMALL).digest, changed(SMALL, ("  half: L/2", "  half:   L/2  # half"))
    assert loads("# a remark\n" + spaced).digest == base
    assert loads(changed(SMALL, ("3 N m/rad", "4 N m/rad"))).digest != base


# -- files that are no texts -----------------------------------------------------------------------


def test_a_python_file_is_refused_and_not_run(tmp_path):
    path = tmp_path / "mast.py"
    path.write_text("import pathlib\npathlib.Path(__file__).with_suffix('.run').touch()\n")
    with pytest.raises(StructureError, match=r"this is a Python file; allowed: a `\.yaml` file"):
        load(path)
    assert not path.with_suffix(".run").exists()


# -- names -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["../../x", "/tmp/x", "a/b", "..", "a\\b", "x" * 65])
def test_a_name_that_is_a_path_is_refused(name):
    with pytest.raises(fpm.SceneError, match=r"name: .* is not allowed; allowed: up to 64 letters"):
        loads(f"name: {name!r}\n" + SMALL)


def test_a_description_is_one_line_whatever_it_holds():
    found = loads('description: "a mast\\ncampaign: other\\x1b"\n' + SMALL)
    assert found.description == "a mast campaign: other"
