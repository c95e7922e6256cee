"""MJCF and URDF become structures: the motions are MuJoCo's, and what is not taken is named."""

import mujoco
import numpy as np
import pytest

import fpm
from deployable.campaign.cli import main
from deployable.campaign.convert import convert
from deployable.campaign.errors import CampaignError
from evidence.benchmark.peers import mjcf
from fpm import structures
from fpm.elements import Damper, Friction, Strut, TorqueMotor, TorsionSpring
from fpm.structures import report

FREE = "<freejoint/>"
INERTIAL = '<inertial pos="0.1 0 0" mass="2" diaginertia="0.02 0.03 0.04"/>'


def model(body: str, rest: str = "", option: str = "") -> str:
    """MJCF of one body, with a site at its end, and more."""
    return f"""<mujoco><compiler angle="radian" autolimits="true"/>
      <option gravity="0 0 -9.81" timestep="1e-4" integrator="RK4" {option}/>
      <worldbody><site name="e1"/><site name="e2"/><site name="eye" pos="0 0 1"/>
      <body name="arm">{body}{INERTIAL}
      <site name="end" pos="0.3 0.05 0.1"/></body></worldbody>{rest}</mujoco>"""


@pytest.fixture
def made(tmp_path):
    """Function: notes, structure and model of an XML text."""

    def make(text: str, keyframe: str = "", suffix: str = "xml"):
        path, target = tmp_path / f"model.{suffix}", tmp_path / "structure.yaml"
        path.write_text(text, encoding="utf-8")
        target.unlink(missing_ok=True)
        notes = convert(path, target, keyframe)
        return notes, structures.load(target), mujoco.MjModel.from_xml_path(str(path))

    return make


WAYS = {
    "bricard": (1, 1), "cart_pendulum": (2, 0), "exported": (2, 1), "four_bar": (1, 1),
    "free_body": (6, 0), "sarrus": (1, 1), "scissor": (1, 2), "slider_crank": (1, 1),
    "solar_array": (9, 0), "tendon": (2, 0),
}  # fmt: skip
"""Ways to move, and redundant conditions, of each of the ten, counted by hand: a ball closes a loop
in a plane with one condition too many, and loops of Bricard and Sarrus have one by their shape."""


@pytest.mark.parametrize("name", WAYS)
def test_ten_mechanisms_have_their_ways_to_move(name, tmp_path):
    scene = mjcf.structure_of(mjcf.FOLDER / f"{name}.xml", tmp_path).build()
    mobility = report.mobility(scene)
    assert (mobility.degrees, mobility.redundant) == WAYS[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", mjcf.POINTS)
def test_ten_mechanisms_move_as_in_mujoco(name, tmp_path):
    """Loops and friction of MuJoCo are soft; the models state them so stiff that they differ from
    exact ones by less than the tolerance."""
    path, point = mjcf.FOLDER / f"{name}.xml", mjcf.POINTS[name]
    scene = mjcf.structure_of(path, tmp_path).build()
    theirs = mjcf.simulate(*mjcf.load(path))[point]
    assert mjcf.distance(mjcf.motion(scene, point, 1e-3), theirs) < mjcf.TOLERANCE


JOINTS = {
    "spherical": '<joint name="a" type="ball"/>',
    "limits": '<joint name="a" axis="0 1 0" range="-0.5 0.2" solreflimit="-4e3 -20" '
    'solimplimit="0.9999 0.9999 1e-3"/>',
    "limits by time and damping ratio": '<joint name="a" axis="0 1 0" range="-0.5 0.2" '
    'solreflimit="0.05 0.3" solimplimit="0.9999 0.9999 1e-3"/>',
    "friction of a slide": '<joint name="a" type="slide" axis="1 0 0.2" frictionloss="1.5" '
    'stiffness="50" springref="0.3" solreffriction="2e-4 1" solimpfriction="0.9999 0.9999 1e-3"/>',
    "class": '<joint name="a" class="k" axis="0 1 0.2" ref="0.7"/>',
    "spring between sites": FREE,
    "weld": '<joint name="a" axis="0 1 0"/>',
    "weld of places alone": '<joint name="a" axis="0 1 0"/>',
}
TIE = """<tendon><spatial name="tie" stiffness="200" springlength="0.9" damping="0.5">
<site site="eye"/><site site="end"/></spatial></tendon>"""


WELD = f"""<default><equality solref="2e-3 1" solimp="0.9999 0.9999 1e-3"/></default><worldbody>
<body name="bob" pos="0.5 0 0"><joint name="b" type="free"/>{INERTIAL}</body></worldbody><equality>
<weld name="glue" body1="arm" body2="bob" anchor="0.1 0 0"/></equality>"""
CLASS = """<default><default class="k"><joint stiffness="9" springref="0.2"/></default></default>"""
HIT = """<keyframe><key name="k" qvel="2"/></keyframe>"""


@pytest.mark.slow
@pytest.mark.parametrize("kind", JOINTS)
def test_other_joints_move_as_in_mujoco(kind, made):
    rest = {"spring between sites": TIE, "weld": WELD, "class": CLASS}.get(kind, "")
    rest = WELD.replace("anchor", 'torquescale="0" anchor') if "places" in kind else rest
    text, keyframe = model(JOINTS[kind], rest), ""
    if "limits" in kind:  # without weight, as the limit's own spring alone moves a body there
        text, keyframe = model(JOINTS[kind], HIT).replace("-9.81", "0"), "k"
    _, structure, theirs = made(text, keyframe)
    places = mjcf.simulate(theirs, keyframe)["end"]
    assert mjcf.distance(mjcf.motion(structure.build(), "end", 2e-4), places) < 1e-3


CONTACT = "contact of geoms is not taken: bodies pass through each other"
URDF = """<robot name="two"><mujoco><option gravity="0 0 -9.81"/></mujoco>
<link name="base"><collision><geometry><box size="1 1 1"/></geometry>
</collision></link>
<link name="maß-²"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0.001" ixz="0" iyz="0"/></inertial></link>
<link name="tool"><inertial><mass value="0.5"/>
<inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="fan"><inertial><mass value="0.1"/>
<inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shaft" type="continuous"><parent link="base"/><child link="fan"/><axis xyz="0 0 1"/>
<mimic joint="hinge" multiplier="2"/></joint>
<joint name="hinge" type="continuous"><parent link="base"/><child link="maß-²"/><axis xyz="0 1 0"/>
<dynamics damping="0.1" friction="0"/><limit effort="5" velocity="2"/></joint>
<joint name="weld" type="fixed"><parent link="maß-²"/><child link="tool"/><origin xyz="0.5 0 0"/>
</joint><transmission name="drive"/><gazebo reference="maß-²"/></robot>"""


def test_urdf_swings_by_its_closed_equation(made):
    """A plane pendulum of 1 kg at 0.2 m and 0.5 kg at 0.5 m, whose equation scipy solves."""
    from scipy.integrate import solve_ivp

    notes, structure, _ = made(URDF, suffix="urdf")
    scene = structure.build()
    assert scene.mass[scene.bodies["maß_2"]] == 1.5
    arm, inertia = 1 * 0.2 + 0.5 * 0.5, 0.02 + 0.2**2 + 0.001 + 0.5 * 0.5**2

    def swing(_, state):
        angle, rate = state
        return rate, (9.81 * arm * np.cos(angle) - 0.1 * rate) / inertia

    (outcome,) = fpm.simulate([scene], duration=1.0, instants=11, step=5e-4)
    exact = solve_ivp(swing, (0, 1), (0, 0), rtol=1e-10, atol=1e-12, t_eval=np.linspace(0, 1, 11))
    np.testing.assert_allclose(outcome.openings["hinge"], exact.y[0], atol=2e-5)
    assert "body tool is held rigidly on maß-²" in notes
    assert "maß-² is called maß_2 among bodies" in notes
    left = ["mimic shaft", "effort of limit hinge", "velocity of limit hinge", "transmission drive"]
    expected = [f"{name} is not taken: it has no equivalent" for name in (*left, "gazebo two")]
    assert sorted(note for note in notes if "not taken" in note) == sorted([*expected, CONTACT])


def test_a_free_body_falls_beside_others(made):
    """It falls from rest by g t^2 / 2, whatever swings beside it."""
    ball = f'<body name="ball" pos="2 0 0">{FREE}{INERTIAL}<site name="b"/></body>'
    _, structure, _ = made(
        model('<joint name="a" axis="0 1 0"/>', f"<worldbody>{ball}</worldbody>")
    )
    (outcome,) = fpm.simulate([structure.build()], duration=0.5, instants=3, step=1e-2)
    np.testing.assert_allclose(outcome.points["b"][0][-1], [2, 0, -9.81 * 0.5**2 / 2], atol=1e-9)


def test_meshes_that_give_no_mass_need_no_file(tmp_path):
    mesh = '<collision><geometry><mesh filename="package://none/arm.stl"/></geometry></collision>'
    text = URDF.replace("</link>\n<link", f"{mesh}</link>\n<link")
    (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    notes = convert(tmp_path / "arm.urdf", tmp_path / "arm.yaml")
    assert structures.load(tmp_path / "arm.yaml").build().mass.max() == 1.5
    assert CONTACT in notes


def test_parameters_of_what_acts_can_be_intervals(made):
    rest = '<actuator><position name="servo" joint="a" kp="7" kv="0.5" ctrlrange="-0.2 0.2"/>'
    rest += '</actuator><keyframe><key name="on" ctrl="0.3"/></keyframe>'  # beyond its range
    text = model('<joint name="a" stiffness="3" frictionloss="0.1"/>', rest)
    _, structure, _ = made(text, "on")
    scene = structure.build()
    given = {name: (p.default, p.unit) for name, p in structure.parameters.items()}
    assert given == {
        "a_stiffness": (3.0, "N m rad-1"), "a_friction": (0.1, "N m"),
        "servo_target": (0.2, "rad"), "servo_stiffness": (7.0, "N m rad-1"),
        "servo_damping": (0.5, "N m s rad-1"),
    }  # fmt: skip
    (spring, servo), (damper,) = (scene.kinds[kind] for kind in (TorsionSpring, Damper))
    assert (spring.stiffness, servo.stiffness, servo.rest) == (3.0, 7.0, 0.2)
    assert (damper.damping, scene.kinds[Friction][0].moment) == (0.5, 0.1)


def test_motors_on_one_joint_add(made):
    """1 * 1 - 2 * 0.2 of both motors, and 0.5 * 0.3 of a servo of the rate."""
    rest = '<actuator><motor name="m" joint="a"/><motor name="n" joint="a" gear="-2"/>'
    rest += '<velocity name="v" joint="a" kv="0.5"/></actuator>'
    rest += '<keyframe><key name="on" ctrl="1 0.2 0.3"/></keyframe>'
    _, structure, _ = made(model('<joint name="a"/>', rest), "on")
    (motor,) = structure.build().kinds[TorqueMotor]
    assert motor.torque == pytest.approx(0.75)


@pytest.mark.parametrize("lengths", ["0.9", "0.5 0.9"])
def test_parameters_of_a_tendon_can_be_intervals(made, lengths):
    _, structure, _ = made(model(FREE, TIE.replace("0.9", lengths)))
    scene = structure.build(tie_stiffness=300, tie_damping=0.7)
    *springs, damper = scene.kinds[Strut]
    assert len(springs) == len(lengths.split()) and damper.damping == 0.7
    assert {max(-slope for slope in spring.slopes) for spring in springs} == {300.0}


def test_a_motor_without_a_control_can_be_given_one(tmp_path):
    convert(mjcf.FOLDER / "slider_crank.xml", tmp_path / "crank.yaml")
    structure = structures.load(tmp_path / "crank.yaml")
    assert structure.parameters["engine_torque"].default == 0.0
    assert structure.build(engine_torque=1.5).kinds[TorqueMotor][0].torque == 1.5


LEFT = {  # XML of the body, the rest, and what is said of it
    "armature": ('<joint name="a" armature="0.1"/>', "", "armature of joint a"),
    "spring of higher order": (
        '<joint name="a" stiffness="1 2 0"/>', "", "nonlinear part of stiffness of joint a"
    ),
    "spring of a ball": (
        '<joint name="b" type="ball" stiffness="1" damping="2"/>', "",
        "stiffness of joint b",
    ),
    "spatial tendon around a geom": (
        '<joint name="a"/>', '<worldbody><geom name="drum" size="0.1"/></worldbody><tendon><spatial'
        ' name="t"><site site="eye"/><geom geom="drum"/><site site="end"/></spatial></tendon>',
        "tendon t",
    ),
    "damping of a free joint": ('<joint name="f" type="free" damping="2"/>', "",
                                "damping of joint f"),
    "coupled joints": (
        '<joint name="a"/>', '<equality><joint name="gear" joint1="a"/></equality>',
        "equality gear",
    ),
    "equality that is off": (
        FREE, '<equality><connect name="off" active="false" body1="arm" body2="world" '
        'anchor="0 0 0"/></equality>', "equality off",
    ),
    "fixed tendon": (
        '<joint name="a"/>', '<tendon><fixed name="belt"><joint joint="a" coef="1"/></fixed>'
        "</tendon>", "tendon belt",
    ),
    "muscle": ('<joint name="a"/>', '<actuator><muscle name="biceps" joint="a" lengthrange="0 1"/>'
               "</actuator>", "actuator biceps"),
    "sensor": ('<joint name="a"/>', '<sensor><jointpos name="encoder" joint="a"/></sensor>',
               "jointpos encoder"),
    "force limit": ('<joint name="a"/>', '<actuator><motor name="m" joint="a" forcerange="-1 1"/>'
                    "</actuator>", "forcerange of general m"),
    "keyframe": ('<joint name="a"/>', '<keyframe><key name="home" qpos="1"/></keyframe>',
                 "keyframe home"),
    "keyframe without a name": (FREE, '<keyframe><key qvel="1 0 0 0 0 0"/></keyframe>',
                                "keyframe key0"),
    "flag": (FREE, '<option><flag clampctrl="disable" island="disable"/></option>',
             "clampctrl of flag"),
    "wind": (FREE, '<option wind="1 0 0"/>', "wind of option"),
    "contact": (FREE + '<geom name="g" size="0.1"/>', '<worldbody><geom type="plane" size="1 1 1"/>'
                "</worldbody>", "contact of geoms"),
    "pair of geoms": (
        FREE + '<geom name="g" size="0.1" contype="0" conaffinity="0"/>', '<worldbody><geom name='
        '"f" type="plane" size="1 1 1" contype="0"/></worldbody><contact><pair geom1="f" geom2="g"'
        "/></contact>", "contact of geoms",
    ),
    "least length of a tendon": (
        FREE, '<tendon><spatial name="t" range="0.5 2"><site site="eye"/><site site="end"/>'
        "</spatial></tendon>", "range of spatial t",
    ),
    "tendon that is slack nowhere": (FREE, TIE.replace("0.9", "0"), "tendon tie"),
    "tendon between sites of one part": (FREE, TIE.replace('"end"', '"e1"'), "tendon tie"),
    "thruster": (FREE, '<actuator><general name="jet" site="end" gear="0 0 1 0 0 0"/></actuator>',
                 "actuator jet"),
    "range without a damping ratio": (
        '<joint name="a" range="-1 1" solreflimit="0.02 0"/>', "", "range of joint a",
    ),
    "actuator that is off": (
        '<joint name="a"/>', '<option actuatorgroupdisable="2"/><actuator><motor name="m" joint="a"'
        ' group="2"/></actuator>', "actuatorgroupdisable of option",
    ),
    "camera": (FREE, '<worldbody><camera name="view"/></worldbody>', "camera view"),
    "gravity compensation": ('<joint name="a"/><body name="balloon" gravcomp="1"><joint name="b"/>'
                             f"{INERTIAL}</body>", "", "gravcomp of body balloon"),
}  # fmt: skip


def test_a_weld_that_is_open_moves_a_free_body_there(made):
    """Its arm is 0.2 m from where the weld has it; a weld that is turned is not taken."""
    for turn, is_closed in (("1 0 0 0", True), ("1 0.1 0 0", False)):
        weld = f'<equality><weld name="w" body1="arm" relpose="0 0.2 0 {turn}"/></equality>'
        notes, structure, _ = made(model(FREE, weld))
        scene = structure.build()
        at = scene.points["end"]
        place = scene.position[at.particle] + scene.frame[at.particle] @ at.arm
        assert np.allclose(place, [0.3, 0.05 - 0.2 * is_closed, 0.1], atol=1e-9)
        assert any("closed before a run" in note for note in notes) == is_closed


@pytest.mark.parametrize("what", LEFT)
def test_what_is_not_taken_is_named(what, made, tmp_path):
    body, rest, said = LEFT[what]
    notes, _, _ = made(model(body, rest))
    assert any(note.startswith(f"{said}") and "is not taken" in note for note in notes), notes
    assert all(f"# {note}" in (tmp_path / "structure.yaml").read_text() for note in notes)


@pytest.mark.slow
def test_a_loop_that_is_open_at_the_start_is_closed_before_the_run(made):
    second = '<worldbody><body name="rod" pos="0.5 0 0"><joint name="h" axis="0 1 0"/>' + INERTIAL
    second += '<site name="tip" pos="-0.19 0.05 0.12"/></body></worldbody><equality><connect name='
    second += '"loop" site1="end" site2="tip"/></equality>'
    notes, structure, _ = made(model('<joint name="a" axis="0 1 0"/>', second))
    assert "equality loop is open at the start, and closed before a run" in notes
    (outcome,) = fpm.simulate([structure.build()], duration=0.1, instants=11, step=1e-3)
    gap = outcome.points["end"][0] - outcome.points["tip"][0]
    assert np.abs(gap).max() < 1e-6


def test_the_command_prints_what_is_not_taken(tmp_path, capsys):
    target = tmp_path / "array.yaml"
    command = ["convert", str(mjcf.FOLDER / "solar_array.xml"), "--to", str(target)]
    assert main(command) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(target)
    assert main(["structure", str(target), "--no-picture"]) == 0
    assert "mobility" in capsys.readouterr().out
    assert main(command) == 1
    assert "allowed: a .yaml file that does not exist yet" in capsys.readouterr().err
    for model_file in (target, "arm.urdf"):  # a YAML file, and none
        assert main(["convert", str(model_file), "--to", str(tmp_path / "new.yaml")]) == 1
        said = f"{model_file}; allowed: the file of a model, .xml (MJCF) or .urdf"
        assert said in capsys.readouterr().err


REFUSED = {
    "no model": ("<mujoco><worldbody>", "", "MuJoCo cannot read it: "),
    "no joint": (model(""), "", "has no body that moves"),
    "no keyframe": (model(FREE), "home", "allowed: .there is none."),
    "several joints of a body": (
        model('<joint name="a" axis="1 0 0"/><joint name="b" axis="0 1 0"/>'), "",
        "several joints of body arm; allowed: one for each body; put a light body ",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_read_is_refused(what, made):
    text, keyframe, said = REFUSED[what]
    with pytest.raises(CampaignError, match=said):
        made(text, keyframe)


def test_warnings_of_mujoco_go_to_the_log_and_leave_no_file(made, tmp_path, monkeypatch, caplog):
    monkeypatch.chdir(tmp_path)
    made(model(FREE).replace('<site name="e1"/>', '<site pos="0 0 NaN"/>'))
    assert "contains a 'NaN'" in caplog.text
    assert {path.name for path in tmp_path.iterdir()} == {"model.xml", "structure.yaml"}


def test_without_mujoco_the_message_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "mujoco", None)
    (tmp_path / "model.xml").touch()
    with pytest.raises(CampaignError, match=r"pip install 'deployable-intervals\[mjcf\]'"):
        convert(tmp_path / "model.xml", tmp_path / "structure.yaml")
