"""Structures of rigid bodies as MJCF: MuJoCo moves them as we do, and they come back."""

import mujoco
import numpy as np
import pytest

import fpm
from deployable.campaign.cli import main
from deployable.campaign.convert import convert
from deployable.campaign.errors import CampaignError
from deployable.campaign.export import choose, export
from evidence.benchmark.peers import mjcf
from fpm import structures
from fpm.elements import Stop

ZOO = """
name: zoo
gravity: [0, 0, -9.81]
points:
  A: [0, 0, 0]
  B: [0.3, 0, 0]
  C: [0.3, 0.3, 0]
  D: [0.6, 0.3, 0.1]
  E: [0, 1, 0]
  F: [0.2, 1, 0.1]
  G: [0, -1, 0]
  H: [0.3, -1, 0.1]
  I: [1, 0, 0]
  K: [1.3, 0.1, -0.2]
  L: [2, 0, 0]
  M: [2.2, 0.1, 0.3]
  N: [3.1, 0.2, 0.3]
  T: [0, 0, 1]
bodies:
  arm: {mass: 1, centre: B, points: [A, C], inertia: [0.01, 0.02, 0.025], x: [1, 1, 0]}
  bob: {mass: 0.7, centre: D, points: [C], inertia: [0.004, 0.005, 0.006]}
  sleeve: {mass: 1, centre: F, points: [E], inertia: [0.01, 0.02, 0.025]}
  plate: {mass: 0.5, centre: H, points: [G, I], inertia: [0.01, 0.012, 0.013]}
  slotted: {mass: 0.5, centre: L, points: [I, K], inertia: [0.01, 0.012, 0.013]}
  pinned: {mass: 0.5, centre: M, points: [K], inertia: [0.01, 0.012, 0.013]}
  hung: {mass: 0.5, centre: N, inertia: [0.01, 0.012, 0.013]}
joints:
  turn: {type: revolute, parts: [arm, ground], at: A, axis: [0, 1, 1], opening: 10 deg}
  ball: {type: spherical, parts: [bob, arm], at: C}
  tube: {type: prismatic, parts: [sleeve, ground], at: E, axis: [1, 0, 1], opening: 0.1}
  lift: {type: prismatic, parts: [ground, plate], at: G, axis: [1, 0, 1], opening: -0.1}
  lever: {type: revolute, parts: [plate, slotted], at: I, axis: y, opening: 20 deg}
  plug: {type: fixed, parts: [pinned, slotted], at: K}
actions:
  a: {type: torsion spring, joint: turn, stiffness: 3, rest: 20 deg}
  b: {type: torsion spring, joint: turn, stiffness: 2, rest: -20 deg}
  c: {type: damper, joint: turn, damping: 0.05}
  d: {type: spring, joint: tube, stiffness: 100, rest: 0.1}
  f: {type: spring, joint: lift, stiffness: 50, rest: 0.1}
  h: {type: torsion spring, joint: lever, stiffness: 2, rest: 0.3 rad}
  motor: {type: torque motor, joint: turn, torque: 0.5}
struts:
  tie: {type: spring, between: [{part: ground, at: T}, D], stiffness: 40, rest: 0.7, damping: 0.2}
  push: {type: spring, between: [{part: ground, at: T}, F], stiffness: 30, rest: 1.5, acts: push}
cables:
  rope: {through: [{part: ground, at: T}, {part: hung, at: N}], EA: 300, rest: 3}
opening_rates:
  turn: {joint: turn, rate: 1 rad/s}
  lever: {joint: lever, rate: -2 rad/s}
  tube: {joint: tube, rate: 0.5 m/s}
initial_velocities:
  hung: {part: hung, about: N, velocity: [0.1, 0.2, 3], spin: [3, 0.5, 1]}
  bob: {part: bob, about: D, velocity: [0.1, 0.2, 0], spin: [3, 0.5, 1]}
record:
  arm: {part: arm, at: C}
  bob: {part: bob, at: D}
  sleeve: {part: sleeve, at: F}
  plate: {part: plate, at: H}
  slotted: {part: slotted, at: L}
  pinned: {part: pinned, at: M}
  hung: {part: hung, at: N}
"""
"""Each type of joint, from either side, with what may act, in motion at the start."""

FLAP = """
name: flap
points: {A: [0, 0, 0], B: [1, 0, 0], C: [1, 0, 1]}
bodies:
  lid: {type: rod, from: A, to: B, mass: 1, diameter: 0.1}
joints:
  hinge: {type: revolute, parts: [ground, lid], at: A, axis: y}
"""


def _run(path, step=5e-4) -> fpm.Outcome:
    scene = structures.load(path).build()
    step = min(step, 0.9 * fpm.find_stable_step(scene).step)
    return fpm.simulate([scene], duration=0.5, instants=101, step=step)[0]


@pytest.mark.slow
def test_all_types_of_joints_move_as_in_mujoco_and_come_back(tmp_path):
    source, back = tmp_path / "zoo.yaml", tmp_path / "back.yaml"
    source.write_text(ZOO)
    (path,) = export(choose(str(source)), "mjcf", tmp_path)
    places = mjcf.simulate(mujoco.MjModel.from_xml_path(str(path)), "start", 0.5)
    convert(path, back, "start")
    ours, again = _run(source).points, _run(back).points
    for name in ours:
        assert mjcf.distance(ours[name][0], places[name]) < 5e-5, name  # of steps of 0.5 ms
        assert mjcf.distance(again[name][0], ours[name][0]) < 1e-8, name


STRUCK = """opening_rates: {r: {joint: hinge, rate: 2 rad/s}}
record: {tip: {part: lid, at: B}}
actions:
  s: {type: stop, joint: hinge, upper: 20 deg, lower: -10 deg, stiffness: 100, damping: 1}
"""


@pytest.mark.parametrize("gravity", [0, -9.81])
def test_stops_push_as_in_mujoco_and_come_back(gravity, tmp_path):
    source, back = tmp_path / "flap.yaml", tmp_path / "back.yaml"
    source.write_text(f"gravity: [0, 0, {gravity}]{FLAP}{STRUCK}")
    (path,) = export(choose(str(source)), "mjcf", tmp_path)
    places = mjcf.simulate(mujoco.MjModel.from_xml_path(str(path)), "start", 0.5)["tip"]
    assert mjcf.distance(_run(source, 1e-4).points["tip"][0], places) < 1e-3
    convert(path, back, "start")
    stops = [s.kinds[Stop] for s in (structures.load(f).build() for f in (source, back))]
    for one, other in zip(*(sorted(pair, key=lambda s: s.side) for pair in stops), strict=True):
        assert (other.stiffness, other.damping) == pytest.approx((one.stiffness, one.damping))
        assert (other.angle, other.side) == (pytest.approx(one.angle), one.side)


@pytest.mark.slow
def test_servos_and_joints_with_dampers_move_the_same_after_a_round_trip(tmp_path):
    """Where two dampers of a joint come back as one; what has the same numbers moves alike."""
    name = "exported"
    mjcf.structure_of(mjcf.FOLDER / f"{name}.xml", tmp_path)
    source, back = tmp_path / f"{name}.yaml", tmp_path / "back.yaml"
    (path,) = export(choose(str(source)), "mjcf", tmp_path)
    convert(path, back, "start")
    ours, again = (_run(file).points[mjcf.POINTS[name]][0] for file in (source, back))
    assert mjcf.distance(again, ours) < 5e-4  # sticking friction jumps; others below 1e-12


@pytest.mark.parametrize("name", mjcf.POINTS)
def test_ten_mechanisms_come_back_with_their_numbers(name, tmp_path):
    source = mjcf.structure_of(mjcf.FOLDER / f"{name}.xml", tmp_path).build()
    (path,) = export(choose(str(tmp_path / f"{name}.yaml")), "mjcf", tmp_path)
    convert(path, tmp_path / "back.yaml", "start")
    scene = structures.load(tmp_path / "back.yaml").build()
    assert scene.bodies.keys() == source.bodies.keys()
    for body, p in source.bodies.items():
        q = scene.bodies[body]
        tensors = [s.frame[i] * s.inertia[i] @ s.frame[i].T for s, i in ((source, p), (scene, q))]
        np.testing.assert_allclose(tensors[1], tensors[0], atol=1e-11)
        np.testing.assert_allclose(scene.position[q], source.position[p], atol=1e-11)
        np.testing.assert_allclose(scene.velocity[q], source.velocity[p], atol=1e-11)
        assert scene.mass[q] == pytest.approx(source.mass[p])
    openings = [
        {h.name: h.opening for h in s.hinges if h.name in "rail bore"} for s in (source, scene)
    ]
    assert openings[0] == openings[1]
    one, other = numbers_of(source), numbers_of(scene)
    if name == "exported":  # where servos and joints have dampers of their own
        assert len(one.pop("Damper")) > len(other.pop("Damper"))
    assert one.keys() == other.keys()
    for kind, numbers in one.items():
        np.testing.assert_allclose(other[kind], numbers, rtol=1e-9, atol=1e-11, err_msg=kind)


def numbers_of(scene: fpm.Scene) -> dict[str, list]:
    """All numbers of the elements of each kind, in an order that no names decide."""
    rows = {
        kind.__name__: [[v for v in vars(one).values() if isinstance(v, float)] for one in elements]
        for kind, elements in scene.kinds.items()
        if elements
    }
    return {kind: sorted(elements) for kind, elements in rows.items()}


HINGED = "actions:\n  x: {type: %s}\n"
FOREIGN = {  # what is added to a flap, and what is said of it
    "latch": (HINGED % "latch, joint: hinge, angle: 90 deg", "latch x"),
    "bearing": (HINGED % "bearing, joint: hinge, mu: 0.1, radius: 0.01, load: 10", "bearing hinge"),
    "contact": (HINGED % "contact, joint: hinge, stiffness: 10", "contact hinge"),
    "curve": (HINGED % "torque motor, joint: hinge, torque: 1, curve: c" +
              "curves:\n  c: {times: [0, 1], values: [0, 1]}\n", "torque motor hinge"),
    "gas spring": ("struts:\n  gas: {type: gas spring, between: [{part: ground, at: C}, B], "
                   "force: 1, length: 1.2, stroke: 0.5, ratio: 1.3}\n", "strut gas"),
    "bristle": (HINGED % "friction, joint: hinge, moment: 1", "friction hinge"),
    "load": ("loads:\n  push: {part: lid, at: B, force: [0, 0, 1]}\n", "load"),
    "damping": ("damping: 0.1 /s\n", "damping"),
    "support": ("supports:\n  guide: {part: lid, at: B, translations: y, rotations: none}\n",
                "support guide"),
    "two stops": (
        HINGED % "stop, joint: hinge, lower: -1 rad, stiffness: 10"
        + "  y: {type: stop, joint: hinge, upper: 1 rad, stiffness: 20}\n", "the stops of hinge",
    ),
    "bars": ("materials: {steel: {E: 210 GPa, rho: 7850}}\nsections: {wire: {type: circle, "
             "diameter: 4 mm}}\nbars:\n  rod: {through: [B, C], section: wire, material: steel, "
             "elements: 2}\nsupports:\n  rod: {part: rod, at: C}\n", "bar rod"),
}  # fmt: skip


@pytest.mark.parametrize("what", FOREIGN)
def test_what_has_no_equivalent_is_refused_by_name(what, tmp_path):
    text, said = FOREIGN[what]
    (tmp_path / "flap.yaml").write_text(FLAP + text)
    run = choose(str(tmp_path / "flap.yaml"))
    with pytest.raises(CampaignError, match=f"^MJCF has no equivalent of .*{said}.*; allowed: "):
        export(run, "mjcf", tmp_path)
    assert not (tmp_path / "flap.xml").exists()


def test_a_body_with_the_name_of_the_ground_is_refused(tmp_path):
    (tmp_path / "flap.yaml").write_text(FLAP.replace("lid", "world"))
    with pytest.raises(CampaignError, match=r"MuJoCo does not take flap: .*'world'"):
        export(choose(str(tmp_path / "flap.yaml")), "mjcf", tmp_path)


def test_a_loop_in_which_all_joints_are_acted_on_is_refused(tmp_path):
    mjcf.structure_of(mjcf.FOLDER / "four_bar.xml", tmp_path)
    path = tmp_path / "four_bar.yaml"
    text = path.read_text().replace(
        "type: spherical", "type: revolute, axis: y".replace(", ", "\n    ")
    )
    dampers = (
        f"  {j}: {{type: damper, joint: {j}, damping: 1}}\n" for j in ("drive", "knee", "loop")
    )
    path.write_text(text.replace("actions:\n", "actions:\n" + "".join(dampers)))
    with pytest.raises(CampaignError, match="no equivalent of the loop of loop; allowed: "):
        export(choose(str(path)), "mjcf", tmp_path)


CAMPAIGN = """
campaign: opens
scene: {file: flap.yaml}
solver: {duration: 0.1, instants: 11}
intervals: {k: {nominal: 3, relative: 0.1}}
responses: {angle: {opening: hinge}}
"""


def test_the_command_writes_the_nominal_run_of_a_campaign(tmp_path, capsys):
    spring = "actions:\n  s: {type: torsion spring, joint: hinge, stiffness: k}\n"
    parameters = "parameters: {k: {value: 2, unit: N m/rad}}\n"
    (tmp_path / "flap.yaml").write_text(FLAP + spring + parameters)
    (tmp_path / "campaign.yaml").write_text(CAMPAIGN)
    command = ["export", str(tmp_path / "campaign.yaml"), "--to", "mjcf", "--output", str(tmp_path)]
    assert main(command) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'opens.xml'}\n"
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "opens.xml")).jnt_stiffness == [3.0]
