"""Curves of time from CSV files: what they do, what is refused, and what is told apart by them."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fpm
from deployable.campaign.cli.new import CAMPAIGN, make_folder
from deployable.campaign.config.check import load_config
from fpm.structures import StructureError, load

ARM = """
parameters: {{inertia: {{value: 0.01, unit: kg m2, description: about the centre}}}}
gravity: [0, 0, -9.81]
points: {{O: [0, 0, 0], C: [0, 0, -0.1]}}
bodies: {{arm: {{mass: 1, centre: C, points: [O], inertia: [inertia, inertia, inertia]}}}}
joints: {{hinge: {{type: revolute, parts: [ground, arm], at: O, axis: y}}}}
curves:
  drive: {{{}}}
actions: {{motor: {{type: torque motor, joint: hinge, torque: 1 N m, curve: drive}}}}
record: {{centre: {{part: arm, at: C}}}}
"""
OF_FILE = "file: torques.csv, column: torque"
TIMES = np.linspace(0, 1.2, 1501)
TORQUES = 0.5 * np.sin(12 * TIMES + 0.3)


@pytest.fixture
def file(tmp_path):
    """A structure beside `torques.csv`, which has `TORQUES`."""
    write(tmp_path, "t [s],torque [N m]", TIMES, TORQUES)
    (tmp_path / "arm.yaml").write_text(ARM.format(OF_FILE))
    return tmp_path / "arm.yaml"


def write(folder, header, *columns):
    np.savetxt(folder / "torques.csv", np.transpose(columns), delimiter=",", header=header,
               comments="", encoding="utf-8")  # fmt: skip


def motion(file):
    (outcome,) = fpm.simulate(load(file).build(), duration=1.0, instants=101, step=2e-4)
    return outcome.openings["hinge"]


@pytest.mark.slow
def test_a_measured_torque_moves_a_joint_as_it_does_by_another_solver(file):
    def rates(time, state):
        moment = np.interp(time, TIMES, TORQUES) - 9.81 * 0.1 * np.sin(state[0])
        return [state[1], moment / 0.02]

    exact = solve_ivp(rates, (0, 1), [0, 0], t_eval=np.linspace(0, 1, 101), rtol=1e-9, atol=1e-11,
                      max_step=2e-3).y[0]  # fmt: skip
    found = motion(file)
    assert np.ptp(exact) > 1.0
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-5 * np.ptp(exact))
    write(file.parent, "t [ms],other [m],torque [N mm]", 1e3 * TIMES, TIMES, 1e3 * TORQUES)
    np.testing.assert_allclose(motion(file), found, rtol=0, atol=1e-10)


@pytest.mark.slow
def test_the_same_numbers_in_the_structure_give_the_same_bits(file):
    write(file.parent, "t [s],torque [N m]", TIMES[:900], TORQUES[:900])
    found = motion(file)
    values = f"times: {TIMES[:900].tolist()}, values: {TORQUES[:900].tolist()}"
    file.write_text(ARM.format(values))
    np.testing.assert_array_equal(motion(file), found)


def test_a_column_may_be_called_as_it_is_typed_elsewhere(file):
    write(file.parent, "t [s],µ ő [N m]", TIMES, TORQUES)
    for name in ("µ ő", "μ o\u030b"):
        file.write_text(ARM.format(f"file: torques.csv, column: {name}"))
        np.testing.assert_array_equal(load(file).build().curves[0].values, TORQUES)


def test_a_folder_of_ones_own_takes_the_file_along(file, tmp_path):
    make_folder(tmp_path / "made", str(file))
    made = load_config([tmp_path / "made" / CAMPAIGN])
    assert made.experiment.scene_type.digest == load(file).digest
    (tmp_path / "made/structures/torques.csv").unlink()
    with pytest.raises(Exception, match=r"line 8: curves\.drive\.file: .*torques.* No such"):
        load_config([tmp_path / "made" / CAMPAIGN])


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("file: absent.csv, column: torque", r"file: \S*/absent\.csv: No such file"),
        ("file: [torques.csv], column: torque", r"file: \['torques.csv'\] is not allowed; allowed"),
        ("file: /dev/zero, column: torque", "file: /dev/zero: it is not a plain file"),
        ("file: torques.csv, column: force", "column: 'force' is not allowed; .* torque$"),
        ("file: torques.csv, column: t", "column: 't' is not allowed"),
        ("file: torques.csv", "file: 'file' is not allowed; allowed: `times` and `values`, or"),
        (f"times: [0], values: [1], {OF_FILE}", "column: 'times, values, file, column' is not"),
        ("times: [0, 1]", "times: 'times' is not allowed"),
        ("", "times: missing"),
    ],
)
def test_keys_that_name_no_curve_are_told_with_line_and_what_is_allowed(file, keys, words):
    file.write_text(ARM.format(keys))
    with pytest.raises(StructureError, match=rf"(?m)^  line 8: curves\.drive\.{words}"):
        load(file)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (
            "t [s],torque [N m]\n0,1\n0,1\n",
            r"file: \S*csv, line 3: the time 0 s does not follow 0 s",
        ),
        ("t [s],torque [N m]\n0,nan\n", r"column: .*csv, line 2: 'nan' is not allowed"),
        (
            "t [s],torque [Mm]\n0,1\n",
            r"column: .*csv, line 1: torque: 'Mm' is not a un",
        ),
    ],
)
def test_a_file_that_is_no_curve_is_told_with_its_own_line(file, rows, words):
    (file.parent / "torques.csv").write_text(rows)
    with pytest.raises(StructureError, match=rf"line 8: curves\.drive\.{words}"):
        load(file)
