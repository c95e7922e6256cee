"""A structure of rigid bodies as MJCF, for MuJoCo; what has no equivalent there is refused.

Bodies hang on each other in a tree, by as many joints as there are; those left over close loops, by
equalities. The frame of every body lies in its centre, along the global axes at the start."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from deployable.campaign.convert import ACTIONS, JOINTS, load_mujoco
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_text
from fpm import elements as e
from fpm.elements.openings.opening import moving_at_start, rate_at
from fpm.solver.start import consistent_scene
from fpm.structures.reading import commas

OPTION = {"timestep": "1e-4", "integrator": "RK4", "tolerance": "1e-14", "iterations": "200"}
LOOPS = {"solref": "2e-3 1", "solimp": "0.9999 0.9999 1e-3"}
FRICTION = {"solreffriction": "2e-4 1", "solimpfriction": "0.9999 0.9999 1e-3"}
"""Loops and friction of MuJoCo are soft: by these they differ little from exact ones."""

IMPEDANCE = 0.9999  # of limits, with which `solref` says a stop's stiffness and damping
CLOSING = {"fixed": ["weld"], "spherical": ["connect"], "revolute": ["connect", "connect"]}
"""Equalities that close a loop, by the type of the joint there."""

TYPES = {"h": "hinge", "s": "slide", "b": "ball"}
KINDS = [row[0] for row in ACTIONS.values()]
CONDITIONS: dict = dict.fromkeys([*KINDS, e.Stop], lambda action: True) | {
    e.Gravity: lambda gravity: gravity.curve < 0,
    e.Damping: lambda damping: not damping.rate,
    e.Hinge: lambda hinge: hinge.type in JOINTS and not hinge.support,
    e.Joint: lambda joint: joint.type in JOINTS,
    e.Friction: lambda friction: not friction.angles and friction.load is None,
    e.TorqueMotor: lambda motor: motor.curve < 0 and np.isinf(motor.no_load),
    e.Cable: lambda cable: not cable.has_friction and cable.drum < 0 and cable.curve < 0,
    e.Strut: lambda strut: len(strut.lengths) == 1 and not strut.forces[0],
}
"""Kinds of element that have an equivalent, and when."""


def write_mjcf(run: Any, folder: Path, frames: int) -> list[Path]:
    """Write the structure of a run at its start as `<run.name>.xml` into `folder`, with its motion
    there as the keyframe `start`; frames: not used. CampaignError without mujoco, and for what has
    no equivalent."""
    scene = consistent_scene(run.scene)
    pairs = [(kind, element) for kind, members in scene.kinds.items() for element in members]
    names = [_title(scene, x) for k, x in pairs if k not in CONDITIONS or not CONDITIONS[k](x)]
    is_held = np.any(scene.fixed, axis=1) & ~np.all(scene.fixed, axis=1)
    names += [f"the support of {name}" for name, p in scene.bodies.items() if is_held[p]]
    if names:
        raise CampaignError(
            f"MJCF has no equivalent of {commas(dict.fromkeys(names), 8)}; allowed: rigid bodies "
            "in joints, with springs, dampers, constant friction, stops, constant torques, cables "
            "without pulleys that rub, drums or winches, and struts that are springs or dampers"
        )
    tree = Tree(scene, run.name)
    try:
        tree.add_stops(load_mujoco().MjModel.from_xml_string(tree.text()))
    except ValueError as error:
        raise CampaignError(f"MuJoCo does not take {run.name}: {error}") from None
    write_text(folder / f"{run.name}.xml", tree.text())
    return [folder / f"{run.name}.xml"]


def _title(scene: Any, element: Any) -> str:
    title = element.title(scene) if hasattr(element, "title") else ""
    kind = {"Beams": "bar", "Hinge": "joint"}.get(type(element).__name__, type(element).__name__)
    curve = " that follows a curve" if getattr(element, "curve", -1) >= 0 else ""
    return (title or f"{kind.lower()} {getattr(element, 'name', '')}".strip()) + curve


def _put(element: Any, **keys: Any) -> Any:
    """Set attributes of an XML element, and return it: texts, or numbers, of which 15 digits are
    written; a number 0 and an empty list are left out."""
    for key, value in keys.items():
        if isinstance(value, str):
            element.set(key, value)
        elif np.size(value) and (np.ndim(value) or value):
            element.set(key, " ".join(f"{x + 0.0:.15g}" for x in np.ravel(value)))
    return element


def _add(parent: Any, tag: str, **keys: Any) -> Any:
    return _put(ElementTree.SubElement(parent, tag), **keys)


class Tree:
    """An MJCF file of a scene, to which `add_stops` adds the stops."""

    def __init__(self, scene: Any, name: str):
        self.scene, self.names = scene, {p: n for n, p in scene.bodies.items()}
        self.motion, is_ground = moving_at_start(scene), scene.fixed.all(axis=1)
        self.root = ElementTree.Element("mujoco", model=name)
        _add(self.root, "compiler", angle="radian", autolimits="true")
        _add(self.root, "option", gravity=scene.gravity, **OPTION)
        default = _add(self.root, "default")
        _add(default, "joint", **FRICTION)
        _add(default, "equality", **LOOPS)
        self.world = _add(self.root, "worldbody")
        self.bodies = {int(p): self.world for p in np.flatnonzero(is_ground)}
        self.origins = np.where(is_ground[:, None], 0.0, scene.position)  # of bodies' frames
        self.rates: dict[str, Any] = {}  # of joints by name, at the start
        self._add_bodies()
        self._add_tendons()
        motors, group = e.TorqueMotor.find(scene), _add(self.root, "actuator")
        for i, motor in enumerate(motors):
            joint = scene.hinges[motor.hinge].name
            _add(group, "motor", name=f"{joint}_motor{i or ''}", joint=joint)
        joints = (x for x in self.world.iter() if x.tag in ("joint", "freejoint"))
        qvel = np.concatenate([self.rates[x.get("name")] for x in joints])
        torques, keys = [motor.torque for motor in motors], _add(self.root, "keyframe")
        _add(keys, "key", name="start", qvel=qvel, ctrl=torques)

    def text(self) -> str:
        """Return the file's content."""
        ElementTree.indent(self.root)
        return ElementTree.tostring(self.root, encoding="unicode") + "\n"

    def add_stops(self, model: Any) -> None:
        """Add stops as ranges of joints, with stiffness and damping in the terms of the soft limits
        of MuJoCo, whose MjModel `model` has the inverse weights of joints."""
        stops: dict[str, list] = {}
        for stop in e.Stop.find(self.scene):
            stops.setdefault(self.scene.hinges[stop.hinge].name, []).append(stop)
        for name, pair in stops.items():
            values = {(stop.stiffness, stop.damping) for stop in pair}
            if len(values) > 1 or len({stop.side for stop in pair}) < len(pair):
                raise CampaignError(
                    f"MJCF has no equivalent of the stops of {name}; allowed: one at each end, of "
                    "one stiffness and damping"
                )
            ends = {"below": -1e3, "above": 1e3} | {stop.side: stop.angle for stop in pair}
            k, c = values.pop()
            mobility = model.dof_invweight0[model.joint(name).dofadr[0]]
            keys = {"solreflimit": [-mobility * IMPEDANCE * k, -mobility * c]}
            keys |= {"solimplimit": [IMPEDANCE, IMPEDANCE, 1e-3], "range": [*ends.values()]}
            _put(self.world.find(f".//joint[@name='{name}']"), **keys)

    def _end(self, beam: Any) -> np.ndarray:
        """End (3,), m, of a rigid arm, from the origin of its particle."""
        p = beam.particle
        return self.scene.position[p] + self.scene.frame[p] @ beam.arm - self.origins[p]

    def _add_site(self, name: str, beam: Any) -> None:
        _add(self.bodies[beam.particle], "site", name=name, pos=self._end(beam), size="0.005")

    def _add_bodies(self) -> None:
        """Add all bodies, each on one that is there already or free, and equalities for loops."""
        scene = self.scene
        branches, loops = self._branches()
        while len(self.bodies) < len(scene.mass):
            ready = (j for j in branches if sum(p in self.bodies for p in j.particles) == 1)
            if joint := next(ready, None):
                sign = -1 if joint.particles[1] in self.bodies else 1
                parent, child = joint.particles[::sign]
                self._add_body(child, self.bodies[parent], self.origins[parent])
                self._add_joints(joint, parent, child, sign)
            else:
                p = next(p for p in range(len(scene.mass)) if p not in self.bodies)
                self._add_body(p, self.world, np.zeros(3))
                name = _add(self.bodies[p], "freejoint", name=f"{self.names[p]}_free").get("name")
                self.rates[name] = [*self.motion.velocity[p], *self.motion.spin[p]]
        for name, beam in scene.points.items():
            self._add_site(name, beam)
        self._add_loops(loops)

    def _add_loops(self, loops: list) -> None:
        """Add equalities, which close loops at joints on which nothing acts."""
        if names := [joint.joint for joint in loops if joint.joint in self.busy]:
            raise CampaignError(
                f"MJCF has no equivalent of the loop of {', '.join(names)}; allowed: loops with a "
                "revolute, spherical or fixed joint on which nothing acts"
            )
        scene, group = self.scene, _add(self.root, "equality")
        for joint in loops:
            first, second = (self.names.get(p, "world") for p in joint.particles)
            for i, tag in enumerate(CLOSING[joint.type]):
                point: Any = [] if tag == "weld" else self._end(joint.beams[0])
                if i:
                    axis = scene.frame[joint.particles[0]] @ joint.axes[0]
                    point = point + 0.2 * np.ptp(scene.position) * axis
                name = joint.name + i * "_axis"
                _add(group, tag, name=name, body1=first, body2=second, anchor=point)

    def _branches(self) -> tuple[list, list]:
        """Joints of a tree of the bodies, with all that something acts on, and joints of loops."""
        scene = self.scene
        joints = [h for h in scene.hinges if not h.number] + list(scene.kinds.get(e.Joint, []))
        acts = (x for kind in (*KINDS, e.Stop) for x in kind.find(scene))
        self.busy = {scene.hinges[x.hinge].joint for x in acts}
        self.busy |= {j.joint for j in joints if j.type not in CLOSING}
        root = {p: -1 if p in self.bodies else p for p in range(len(scene.mass))}
        sorts: tuple[list, list] = [], []
        for joint in sorted(joints, key=lambda j: j.joint not in self.busy):
            first, second = (root[p] for p in joint.particles)
            sorts[first == second].append(joint)
            root = {p: first if r == second else r for p, r in root.items()}
        return sorts

    def _add_body(self, particle: int, parent: Any, origin: np.ndarray) -> None:
        s, name = self.scene, self.names[particle]
        mass, inertia, axes = s.mass[particle], s.inertia[particle], s.frame[particle].T[:2]
        body = _add(parent, "body", name=name, pos=s.position[particle] - origin)
        _add(body, "inertial", pos="0 0 0", mass=mass, diaginertia=inertia, xyaxes=axes)
        edges = np.sqrt(np.maximum(6 / mass * (inertia.sum() - 2 * inertia), 0))
        size = np.maximum(edges, 0.01 * edges.max()) / 2  # of a box with this inertia, to be seen
        _add(body, "geom", type="box", size=size, xyaxes=axes, contype="0", conaffinity="0")
        self.bodies[particle] = body

    def _add_joints(self, joint: Any, parent: int, child: int, sign: int) -> None:
        """Add the elementary joints by which a body hangs on another. sign: -1 seen from the second
        part, in the opposite order about opposite axes; else 1."""
        s, beam = self.scene, joint.beams[1]
        point = self._end(beam) + self.origins[beam.particle] - self.origins[child]
        letters, _, suffixes = JOINTS[joint.type]
        for letter, suffix in list(zip(letters, suffixes, strict=True))[::sign]:
            name = joint.joint + suffix
            keys: dict[str, Any] = {"name": name, "type": TYPES[letter], "pos": point}
            self.rates[name] = self.motion.spin[child] - self.motion.spin[parent]
            if letter != "b":
                number, hinge = next((i, h) for i, h in enumerate(s.hinges) if h.name == name)
                self.rates[name] = [rate_at(s, hinge, self.motion)]
                turn = sign if hinge.particles == joint.particles else -sign  # universal's second
                keys["axis"] = turn * s.frame[hinge.particles[0]] @ hinge.axes[0]
                keys["ref"], moment = hinge.opening, 0.0
                for word, (kind, words, _) in list(ACTIONS.items())[:3]:
                    actions = [x for x in kind.find(s) if x.hinge == number]
                    keys[word] = sum(getattr(x, words.split(", ")[1]) for x in actions)
                    moment += sum(x.stiffness * x.rest for x in actions if word == "stiffness")
                keys["springref"] = moment / (keys["stiffness"] or 1.0)
            _add(self.bodies[child], "joint", **keys)

    def _add_tendons(self) -> None:
        """Add cables and struts, with the lengths between which each is slack."""
        rows: list[tuple] = []
        for cable in e.Cable.find(self.scene):
            keys = {"stiffness": cable.stiffness / cable.rest, "springlength": [0.0, cable.rest]}
            rows.append((cable, keys))
        for strut in e.Strut.find(self.scene):
            (push, pull), rest = strut.slopes, strut.lengths[0]
            slack = [rest if push or not pull else 0.0, rest if pull or not push else 1e6]
            keys = {"stiffness": -min(push, pull), "springlength": slack, "damping": strut.damping}
            rows.append((strut, keys))
        group = _add(self.root, "tendon")
        for element, keys in rows:
            tendon = _add(group, "spatial", name=element.name, **keys)
            for i, beam in enumerate(element.beams):
                self._add_site(f"{element.name}_{i}", beam)
                _add(tendon, "site", site=f"{element.name}_{i}")
