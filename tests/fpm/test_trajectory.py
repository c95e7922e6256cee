"""Responses and trajectory files."""

from dataclasses import replace

import numpy as np
import pytest
import xarray
from balances import TURN, blown, tumbling

import fpm
from deployable.campaign.config.sections import scene_type
from fpm.elements.kind import Series
from fpm.files.outcome import columns_of
from fpm.reading.variables import VARIABLES

BENNETT = scene_type("bennett")
DEFINITIONS = {
    "BD": {"distance": ["B", "D"]},
    "vBz": {"velocity": "B", "component": "z"},
    "speed": {"velocity": "B", "component": "norm"},
    "zA": {"position": "A", "component": "z"},
    "psi": {"opening": "A"},
    "T": {"energy": "kinetic"},
    "U": {"energy": "cable"},
}


@pytest.fixture(scope="module")
def outcome():
    return fpm.simulate(BENNETT.build(elements=2), duration=0.05, instants=11)[0]


@pytest.fixture
def contents(outcome):
    return fpm.trajectory.contents([outcome], {"campaign": "0123"})


def test_responses_are_what_they_say(outcome):
    dataset = outcome.dataset()
    apart = dataset.position.sel(point="B") - dataset.position.sel(point="D")
    responses = [fpm.responses.parse(n, d, BENNETT.sample) for n, d in DEFINITIONS.items()]
    values = {response.name: response.evaluate(outcome) for response in responses}
    np.testing.assert_allclose(values["BD"], np.sqrt((apart**2).sum("axis")), rtol=1e-14)
    assert np.array_equal(values["vBz"], dataset.velocity.sel(point="B", axis="z"))
    assert np.array_equal(values["zA"], dataset.position.sel(point="A", axis="z"))
    assert np.array_equal(values["psi"], dataset.opening.sel(hinge="A"))
    assert np.array_equal(values["T"], np.maximum(dataset.kinetic_energy, 0.0))
    assert not values["U"].any()
    assert [r.unit for r in responses] == ["m", "m s-1", "m s-1", "m", "rad", "J", "J"]


def test_energies_that_the_structure_lacks_are_zero_and_take_no_room(outcome):
    kept = {v.energy for v in outcome.dataset().values() if "energy" in v.attrs}
    assert kept == {"kinetic", "strain", "spring", "contact", "joint_loss", "balance"}
    assert kept == outcome.energies.keys() == set(BENNETT.energies)
    assert outcome.energies["cable"].tolist() == [0.0] * 11
    with pytest.raises(KeyError, match="dark"):
        outcome.energies["dark"]


@pytest.mark.parametrize(
    ("definition", "text"),
    [
        ({"distance": ["B", "X"]}, "one of A, B, C, D"),
        ({"velocity": "B", "component": "w"}, "one of x, y, z, norm"),
        ({"energy": "dark"}, "one of kinetic"),
        ({"stress": "link"}, "one of all, AB, BC"),
        ({"stress": "all", "component": "x"}, "stress alone"),
        ({"clearance": ["AB", "AB"]}, "two different bars"),
        ({"section_force": "AB", "at": 1.5, "component": "axial"}, "from 0 to 1"),
        ({"section_force": "AB", "at": 0.5}, "section_force and at, component"),
        ({"section_moment": "AB", "at": 0, "component": "axial"}, "one of torsion, bending_y"),
        ({"joint_moment": "A", "part": "latch"}, "one of spring, contact, sum"),
        ({"reaction_moment": "A", "component": "x"}, "(there is none)"),
        ({"reaction_force": "B", "component": "x"}, "one of A, C"),
        ({"loss": "friction"}, "one of all, damping, cables"),
        ({"acceleration": "B", "component": "w"}, "one of x, y, z, norm"),
        ({"angular_velocity": "Z", "component": "x"}, "one of A, B, C, D"),
        ({"constraint_force": "A"}, "constraint_force and component"),
        ({"opening_rate": "A", "component": "x"}, "opening_rate alone"),
    ],
)
def test_unknown_responses_are_refused(definition, text):
    with pytest.raises(fpm.SceneError, match=text):
        fpm.responses.parse("r", definition, BENNETT.sample)


def test_what_rigid_bodies_do_not_have_is_refused():
    scene = scene_type("latch").sample
    for definition, text in (({"stress": "panel"}, "only these have stress, and bodies are rigid"),
                             ({"clearance": ["a", "b"]}, r"\(there is none\)")):  # fmt: skip
        with pytest.raises(fpm.SceneError, match=text):
            fpm.responses.parse("r", definition, scene)


def test_a_file_comes_back_whole_and_tells_its_units(outcome, contents, tmp_path):
    path = tmp_path / "deep" / "run.nc"
    fpm.trajectory.write(contents, path)
    back = fpm.trajectory.read(path)
    assert back.attrs["campaign"] == "0123"
    alone = back.isel(run=0).drop_vars(["run", "event_run"])
    del alone.attrs["campaign"]
    assert alone.identical(outcome.dataset())
    for name, variable in back.variables.items():
        assert variable.attrs["long_name"], name
        # gates have the units of joints
        has_units = variable.dtype.kind not in "UO" and name != "event_gate"
        assert ("units" in variable.attrs) == has_units, name
    assert [p.name for p in path.parent.iterdir()] == ["run.nc"]


def test_runs_of_a_batch_are_one_dataset_with_their_names_and_parameters(tmp_path):
    scenes = [BENNETT.build(elements=2, a=a) for a in (0.035, 0.036)]
    outcomes = fpm.simulate(scenes, duration=0.4, instants=3)  # closes after about 0.33 s
    parameters = {"a": ([0.035, 0.036], "m")}
    contents = fpm.trajectory.contents(outcomes, {}, parameters, ["one", "two"])
    fpm.trajectory.write(contents, tmp_path / "both.nc")
    both = fpm.trajectory.read(tmp_path / "both.nc")
    assert both.parameter_a.sel(run="two") == 0.036 and both.parameter_a.units == "m"
    read = fpm.trajectory.read_curves(tmp_path / "both.nc")
    assert list(read) == ["one", "two"]
    assert list(fpm.trajectory.read_curves(tmp_path / "both.nc", runs=["two"])) == ["two"]
    for row, (name, outcome) in enumerate(zip(read, outcomes, strict=True)):
        events = np.flatnonzero(both.event_run == row)
        rest = both.isel(event=events).sel(run=name)
        rest = rest.drop_vars(["run", "event_run", "parameter_a"])
        xarray.testing.assert_equal(rest, outcome.dataset())
        np.testing.assert_array_equal(read[name].events, outcome.events)
        assert read[name].eventful == outcome.eventful
        assert len(outcome.events) and read[name].impacts().names == ["A", "B", "C", "D"]


def write(outcome, path):
    """Write one run to a file of a batch, and read it again."""
    fpm.trajectory.write(fpm.trajectory.contents([outcome]), path)
    return fpm.trajectory.read_curves(path)["0"]


@pytest.mark.parametrize("name", DEFINITIONS)
def test_responses_of_a_file_are_those_of_the_run_to_the_last_bit(outcome, tmp_path, name):
    response = fpm.responses.parse(name, DEFINITIONS[name], BENNETT.sample)
    found = response.evaluate(write(outcome, tmp_path / "run.nc"))
    assert found.astype(float).tobytes() == response.evaluate(outcome).astype(float).tobytes()


ASKED = {
    "stress": {"stress": "all"},
    "spin": {"angular_velocity": "B", "component": "norm"},
    "power": {"joint_power": "A", "part": "spring"},
    "moment": {"joint_moment": "A"},
    "bending": {"section_moment": "AB", "at": 0.5, "component": "bending"},
    "hinge": {"constraint_force": "A", "component": "z"},
    "loss": {"loss": "all"},
}


def test_columns_that_were_asked_come_back_and_make_up_their_responses(outcome, tmp_path):
    """With made-up columns: 1, 2, ... in the order of their names."""
    responses = {n: fpm.responses.parse(n, d, BENNETT.sample) for n, d in ASKED.items()}
    needs = sorted({need for response in responses.values() for need in response.needs})
    recorded = dict(outcome.records)
    for name in dict.fromkeys(variable for variable, _ in needs):
        unit, text = VARIABLES[name][:2]
        labels = tuple(label for variable, label in needs if variable == name)
        values = np.array([[needs.index((name, label)) + 1.0 for label in labels]] * 11)
        recorded[name] = Series(values, unit, text, f"{name}_of", labels)
    asked = replace(outcome, records=recorded, columns=columns_of(recorded))
    curves = write(asked, tmp_path / "run.nc")
    for i, need in enumerate(needs):
        assert curves.columns[need].tolist() == [i + 1.0] * 11
    found = {name: response.evaluate(curves) for name, response in responses.items()}
    column = {need: i + 1.0 for i, need in enumerate(needs)}
    spring, contact = (column["joint_moment", f"A {part}"] for part in ("spring", "contact"))
    spins = [column["angular_velocity", f"B {axis}"] for axis in "xyz"]
    bending = [column["section_moment", f"AB at 0.5 bending_{axis}"] for axis in "yz"]
    expected = {
        "stress": column["stress", "all"],
        "spin": np.linalg.norm(spins),
        "power": column["opening_rate", "A"] * spring,
        "moment": spring + contact,
        "bending": np.linalg.norm(bending),
        "hinge": column["constraint_force", "A z"],
        "loss": 0.0,
    }
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], value, rtol=1e-15, err_msg=name)
        assert responses[name].evaluate(asked).tolist() == found[name].tolist()
    back = fpm.trajectory.read(tmp_path / "run.nc")
    assert back["stress"].units == "Pa" and back["stress"].dims == ("run", "time", "stress_of")
    assert curves.columns.keys() == set(needs) | set(outcome.columns)


def test_a_run_without_what_a_response_needs_says_so(outcome):
    response = fpm.responses.parse("stress", ASKED["stress"], BENNETT.sample)
    with pytest.raises(KeyError, match="stress"):
        response.evaluate(outcome)


def test_a_value_that_is_not_finite_is_never_written(contents, tmp_path):
    contents.variables["position"].values[0, 3] = np.nan
    with pytest.raises(ValueError, match="position has values that are not finite"):
        fpm.trajectory.write(contents, tmp_path / "run.nc")
    assert not list(tmp_path.iterdir())


def test_an_unstable_run_has_no_dataset():
    scene = BENNETT.build(elements=2)
    step = 2 * fpm.find_stable_step(scene).step
    outcome = fpm.simulate(scene, duration=0.1, instants=11, step=step)[0]
    with pytest.raises(fpm.InstabilityError, match="use a step below"):
        outcome.dataset()


def test_scene_types_check_what_they_are_given():
    with pytest.raises(fpm.SceneError, match="one of bennett, boom"):
        scene_type("bennet")
    with pytest.raises(fpm.SceneError, match="bennett has no parameter mass"):
        BENNETT.build(mass=1.0)
    with pytest.raises(fpm.SceneError, match=r"E = -1\.0"):
        BENNETT.build(E=-1.0)
    with pytest.raises(fpm.SceneError, match="a whole number"):
        BENNETT.build(elements=2.5)


def test_losses_are_not_below_zero_but_in_wind():
    """Wind drives what it drags: the work against it can be negative, and is told as it is."""
    loss, work = {"loss": "all"}, {"energy": "damping_work"}
    assert fpm.responses.parse("l", loss, tumbling(**TURN)).least == 0.0
    responses = [fpm.responses.parse(n, d, blown()) for n, d in {"l": loss, "w": work}.items()]
    assert [response.least for response in responses] == [None, None]
    (run,) = fpm.simulate(blown(), duration=1.0, instants=101, record=())
    curves = [response.evaluate(run) for response in responses]
    assert min(map(np.min, curves)) < -1e-3
    np.testing.assert_allclose(*curves, atol=1e-12)
