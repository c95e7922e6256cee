"""A structure of rigid bodies as MJCF, for MuJoCo; what has no equivalent there is refused.

Bodies hang on each other in a tree, each by one joint; joints left over close loops, by equalities.
The frame of every body lies in its centre, along the global axes at the start."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from deployable.campaign.convert import ACTIONS, JOINTS, load_mujoco
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_text
from fpm import elements as e
from fpm.elements.openings.opening import moving_at_start
from fpm.solver.start import consistent_scene
from fpm.structures.reading import commas

EMPTY = """<mujoco><compiler angle="radian" autolimits="true"/>
<option timestep="1e-4" integrator="RK4" tolerance="1e-14" iterations="200"/><default>
<joint solreffriction="2e-4 1" solimpfriction="0.9999 0.9999 1e-3" solimplimit="1e-4 1e-4 1e-3"/>
<equality solref="2e-3 1" solimp="0.9999 0.9999 1e-3"/></default>
<worldbody/><equality/><tendon/><actuator/><keyframe/></mujoco>"""
"""Loops and friction of MuJoCo are soft: by these numbers they differ little from exact ones. Loads
act on in a limit, as in a stop, by its least impedance."""

CLOSING = {"fixed": ["weld"], "spherical": ["connect"], "revolute": ["connect", "connect"]}
"""Equalities that close a loop, by the type of the joint there."""

KINDS = [row[0] for row in ACTIONS.values()]
CONDITIONS: dict = dict.fromkeys([*KINDS, e.Stop], lambda action: True) | {
    e.Gravity: lambda gravity: gravity.curve < 0,
    e.Damping: lambda damping: not damping.rate,
    e.Hinge: lambda hinge: hinge.type in JOINTS and not hinge.support,
    e.Joint: lambda joint: joint.type in ("spherical", "fixed"),
    e.Friction: lambda friction: friction.is_exact,
    e.TorqueMotor: lambda motor: motor.curve < 0 and np.isinf(motor.no_load),
    e.Cable: lambda cable: not cable.has_friction and cable.drum < 0 and cable.curve < 0,
    e.Strut: lambda strut: len(strut.lengths) == 1 and not strut.forces[0],
}
"""Kinds of element that have an equivalent, and when."""

ALLOWED = """rigid bodies in revolute, prismatic, spherical and fixed joints, with springs, dampers,
friction that sticks exactly, stops, constant torques, cables without pulleys that rub, drums or
winches, and struts that are springs or dampers"""


def write_mjcf(run: Any, folder: Path, frames: int) -> list[Path]:
    """Write the structure of a run at its start as `<run.name>.xml` into `folder`, with its motion
    there as the keyframe `start`; frames: not used. CampaignError without mujoco, and for what has
    no equivalent."""
    scene = consistent_scene(run.scene)
    pairs = [(kind, element) for kind, members in scene.kinds.items() for element in members]
    names = [_title(scene, x) for k, x in pairs if k not in CONDITIONS or not CONDITIONS[k](x)]
    is_held = np.any(scene.fixed, axis=1) & ~np.all(scene.fixed, axis=1)
    names += ["the body world, which has the name of the ground"] * ("world" in scene.bodies)
    names += [f"the support of {name}" for name, p in scene.bodies.items() if is_held[p]]
    _refuse(names, " ".join(ALLOWED.split()))
    tree = Tree(scene, run.name)
    try:
        tree.add_start(load_mujoco())
    except ValueError as error:
        raise CampaignError(f"MuJoCo does not take {run.name}: {error}") from None
    write_text(folder / f"{run.name}.xml", tree.text())
    return [folder / f"{run.name}.xml"]


def _refuse(names: list[str], allowed: str) -> None:
    """Raise CampaignError for what has no equivalent, if there is anything."""
    if names:
        text = f"MJCF has no equivalent of {commas(dict.fromkeys(names), 8)}; allowed: {allowed}"
        raise CampaignError(text)


def _title(scene: Any, element: Any) -> str:
    title = element.title(scene) if hasattr(element, "title") else ""
    noun = {"Beams": "bar", "Hinge": "joint"}.get(type(element).__name__, type(element).__name__)
    noun = "support" if getattr(element, "type", "") == "held" else noun
    curve = " that follows a curve" if getattr(element, "curve", -1) >= 0 else ""
    return (title or f"{noun.lower()} {getattr(element, 'name', '')}".strip()) + curve


def _put(element: Any, **keys: Any) -> Any:
    """Set attributes of an XML element, and return it: texts, or numbers with 15 digits."""
    for key, value in keys.items():
        is_text = isinstance(value, str)
        element.set(key, value if is_text else " ".join(f"{x + 0.0:.15g}" for x in np.ravel(value)))
    return element


def _add(parent: Any, tag: str, **keys: Any) -> Any:
    return _put(ElementTree.SubElement(parent, tag), **keys)


class Tree:
    """An MJCF file of a scene, to which `add_start` adds stops and the motion at the start. root:
    its XML element; names: of bodies that move, by particle; bodies, origins: by particle the XML
    elements, and the places (n, 3), m, of their frames; -1 is the world."""

    def __init__(self, scene: Any, name: str):
        is_ground = scene.fixed.all(axis=1)
        self.scene, self.root = scene, ElementTree.fromstring(EMPTY)
        self.root.set("model", name)
        _put(self.root.find("option"), gravity=scene.gravity)
        self.names = {p: name for name, p in scene.bodies.items() if not is_ground[p]}
        self.bodies = dict.fromkeys([-1, *np.flatnonzero(is_ground)], self.root.find("worldbody"))
        places = np.where(is_ground[:, None], 0.0, scene.position)
        self.origins = np.vstack([places, np.zeros(3)])
        self._add_loops(self._add_bodies())
        self._add_tendons()
        for name, beam in scene.points.items():
            self._add_site(name, beam)
        for i, motor in enumerate(e.TorqueMotor.find(scene)):
            joint = scene.hinges[motor.hinge].name
            _add(self.root.find("actuator"), "motor", name=f"{joint}_motor{i or ''}", joint=joint)

    def text(self) -> str:
        """Return the file's content."""
        ElementTree.indent(self.root)
        return ElementTree.tostring(self.root, encoding="unicode") + "\n"

    def add_start(self, mujoco: Any) -> None:
        """Add the motion and torques at the start as a keyframe, and stops as ranges of joints,
        with stiffness and damping in the terms of the soft limits of MuJoCo, which has the inverse
        weights of joints."""
        scene, model = self.scene, mujoco.MjModel.from_xml_string(self.text())
        for i, hinge in enumerate(scene.hinges):
            if stops := [stop for stop in e.Stop.find(scene) if stop.hinge == i]:
                values = {(stop.stiffness, stop.damping) for stop in stops}
                if len(values) > 1 or len({stop.side for stop in stops}) < len(stops):
                    allowed = "one at each end, of one stiffness and damping"
                    _refuse([f"the stops of {hinge.name}"], allowed)
                ends = {"below": -1e3, "above": 1e3} | {stop.side: stop.angle for stop in stops}
                soft = -model.dof_invweight0[model.joint(hinge.name).dofadr[0]] * np.array(
                    values.pop()
                )
                joint = self.root.find(f".//joint[@name='{hinge.name}']")
                _put(joint, range=[*ends.values()], solreflimit=soft)
        data, motion = mujoco.MjData(model), moving_at_start(scene)
        mujoco.mj_forward(model, data)
        jacobians = np.zeros((len(self.names), 2, 3, model.nv))
        for jacobian, name in zip(jacobians, self.names.values(), strict=True):
            mujoco.mj_jacBody(model, data, *jacobian, model.body(name).id)
        rates = np.stack([motion.velocity, motion.spin], axis=1)[[*self.names]]
        qvel = np.linalg.lstsq(jacobians.reshape(-1, model.nv), rates.ravel())[0]
        torques = [motor.torque for motor in e.TorqueMotor.find(scene)]
        _add(self.root.find("keyframe"), "key", name="start", qvel=qvel, ctrl=torques)

    def _end(self, beam: Any, p: int) -> np.ndarray:
        """Return the end (3,), m, of a rigid arm from the origin of the frame of particle p."""
        scene, particle = self.scene, beam.particle
        return scene.position[particle] + scene.frame[particle] @ beam.arm - self.origins[p]

    def _add_site(self, name: str, beam: Any) -> None:
        place = self._end(beam, beam.particle)
        _add(self.bodies[beam.particle], "site", name=name, pos=place, size="0.005")

    def _add_bodies(self) -> list:
        """Add all bodies, each on one that is there already, by a joint on which something acts if
        there is one, or free. Returns the joints that are left over, which close loops."""
        scene = self.scene
        acts = {x.hinge for kind in (*KINDS, e.Stop) for x in kind.find(scene)}
        joints = [*scene.hinges, *scene.kinds.get(e.Joint, [])]
        closing = [x for i, x in enumerate(joints) if i not in acts and x.type in CLOSING]
        joints.sort(key=lambda joint: joint in closing)
        while len(self.bodies) <= len(scene.mass):
            ready = (j for j in joints if sum(p in self.bodies for p in j.particles) == 1)
            if joint := next(ready, None):
                joints.remove(joint)
                sign = -1 if joint.particles[1] in self.bodies else 1
                parent, child = joint.particles[::sign]
                self._add_body(child, parent)
                self._add_joint(joint, child, sign)
            else:
                p = next(p for p in range(len(scene.mass)) if p not in self.bodies)
                self._add_body(p, -1)
                _add(self.bodies[p], "freejoint", name=f"{self.names[p]}_free")
        names = [f"the loop of {joint.joint}" for joint in joints if joint not in closing]
        _refuse(names, "loops with a revolute, spherical or fixed joint on which nothing acts")
        return joints

    def _add_body(self, p: int, parent: int) -> None:
        """Add the body of a particle to that of another; -1: to the world."""
        s, axes, place = self.scene, self.scene.frame[p].T[:2], self.scene.position[p]
        keys = {"name": self.names[p], "pos": place - self.origins[parent]}
        body = self.bodies[p] = _add(self.bodies[parent], "body", **keys)
        keys = {"mass": s.mass[p], "diaginertia": s.inertia[p], "xyaxes": axes}
        _add(body, "inertial", pos="0 0 0", **keys)

    def _add_joint(self, joint: Any, child: int, sign: int) -> None:
        """Add the joint by which a body hangs on another. sign: -1 if it is the first part."""
        scene, keys = self.scene, {}
        if joint.type not in JOINTS:  # fixed
            return
        if isinstance(joint, e.Hinge):
            keys = {"axis": sign * scene.frame[joint.particles[0]] @ joint.axes[0]}
            keys["ref"], moment = joint.opening, 0.0
            for word, (kind, words, _) in [*ACTIONS.items()][:3]:
                actions = [x for x in kind.find(scene) if scene.hinges[x.hinge] is joint]
                keys[word] = sum(getattr(x, words.split(", ")[1]) for x in actions)
                moment += sum(x.stiffness * x.rest for x in actions if word == "stiffness")
            keys["springref"] = moment / (keys["stiffness"] or 1.0)
        keys |= {"type": JOINTS[joint.type], "pos": self._end(joint.beams[1], child)}
        _add(self.bodies[child], "joint", name=joint.joint, **keys)

    def _add_loops(self, joints: list) -> None:
        scene, group = self.scene, self.root.find("equality")
        for joint in joints:
            first, second = (self.names.get(p, "world") for p in joint.particles)
            for i, tag in enumerate(CLOSING[joint.type]):
                axis = scene.frame[joint.particles[0]] @ joint.axes[0]
                anchor = self._end(joint.beams[0], joint.particles[0])
                anchor += 0.2 * i * np.ptp(scene.position) * axis
                keys = {} if tag == "weld" else {"anchor": anchor}
                _add(group, tag, name=joint.name + i * "_axis", body1=first, body2=second, **keys)

    def _add_tendons(self) -> None:
        """Add cables and struts, with the lengths between which each is slack."""
        tendons: list[tuple] = []
        for cable in e.Cable.find(self.scene):
            tendons.append((cable, cable.stiffness / cable.rest, [0.0, cable.rest], 0.0))
        for strut in e.Strut.find(self.scene):
            (push, pull), rest = strut.slopes, strut.lengths[0]
            slack = [rest if push or not pull else 0.0, rest if pull or not push else 1e6]
            tendons.append((strut, -min(push, pull), slack, strut.damping))
        for element, stiffness, slack, damping in tendons:
            keys = {"stiffness": stiffness, "springlength": slack, "damping": damping}
            tendon = _add(self.root.find("tendon"), "spatial", name=element.name, **keys)
            for i, beam in enumerate(element.beams):
                self._add_site(f"{element.name}_{i}", beam)
                _add(tendon, "site", site=f"{element.name}_{i}")
