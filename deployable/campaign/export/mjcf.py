"""A structure of rigid bodies as MJCF, for MuJoCo; what has no equivalent there is refused.

Bodies hang on each other in a tree, by as many joints as there are; those left over close loops, by
equalities. The frame of every body lies in its centre, along the global axes at the start."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_text
from fpm import elements as e
from fpm.elements.openings.opening import moving_at_start, rate_at
from fpm.solver.start import consistent_scene
from fpm.structures.reading import commas

if TYPE_CHECKING:
    from deployable.campaign.export.selection import SelectedRun

OPTION = {"timestep": "1e-4", "integrator": "RK4", "tolerance": "1e-14", "iterations": "200"}
LOOPS = {"solref": "2e-3 1", "solimp": "0.9999 0.9999 1e-3"}
FRICTION = {"solreffriction": "2e-4 1", "solimpfriction": "0.9999 0.9999 1e-3"}
"""Loops and friction of MuJoCo are soft: by these they differ little from exact ones."""

IMPEDANCE = 0.9999  # of limits, with which `solref` says a stop's stiffness and damping
CHAINS = {  # elementary joints from the first part to the second, and which opening each is
    "revolute": [("hinge", 0)], "prismatic": [("slide", 0)], "spherical": [("ball", 0)],
    "fixed": [], "universal": [("hinge", 0), ("hinge", 1)],
    "cylindrical": [("slide", 1), ("hinge", 0)], "pin in slot": [("slide", 1), ("hinge", 0)],
    "planar": [("slide", 1), ("slide", 2), ("hinge", 0)],
}  # fmt: skip
ACTIONS = (e.TorsionSpring, e.Damper, e.Friction, e.Stop, e.TorqueMotor)
CONDITIONS: dict = dict.fromkeys(ACTIONS, lambda action: True) | {
    e.Gravity: lambda gravity: gravity.curve < 0,
    e.Damping: lambda damping: not damping.rate,
    e.Hinge: lambda hinge: hinge.type in CHAINS and not hinge.support,
    e.Joint: lambda joint: joint.type in CHAINS,
    e.Friction: lambda friction: not friction.angles and friction.load is None,
    e.TorqueMotor: lambda motor: motor.curve < 0 and np.isinf(motor.no_load),
    e.Cable: lambda cable: not cable.has_friction and cable.drum < 0 and cable.curve < 0,
    e.Strut: lambda strut: len(strut.lengths) == 1 and not strut.forces[0],
}
"""Kinds of element that have an equivalent, and when."""


def write_mjcf(run: SelectedRun, folder: Path, frames: int) -> list[Path]:
    """Write the structure of a run at its start as `<run.name>.xml` into `folder`, with its motion
    there as the keyframe `start`; frames: not used. CampaignError without mujoco, and for what has
    no equivalent."""
    try:
        import mujoco
    except ImportError:
        text = "MJCF needs mujoco: pip install 'deployable-intervals[mjcf]'"
        raise CampaignError(text) from None
    scene = consistent_scene(run.scene)
    pairs = [(kind, element) for kind, members in scene.kinds.items() for element in members]
    names = [_title(scene, x) for kind, x in pairs if not CONDITIONS.get(kind, lambda _: False)(x)]
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
        model = mujoco.MjModel.from_xml_string(tree.text())
    except ValueError as error:
        raise CampaignError(f"MuJoCo does not take {run.name}: {error}") from None
    tree.add_stops(lambda name: float(model.dof_invweight0[model.joint(name).dofadr[0]]))
    write_text(folder / f"{run.name}.xml", tree.text())
    return [folder / f"{run.name}.xml"]


def _title(scene: Any, element: Any) -> str:
    title = element.title(scene) if hasattr(element, "title") else ""
    kind = {"Beams": "bar", "Hinge": "joint"}.get(type(element).__name__, type(element).__name__)
    curve = " that follows a curve" if getattr(element, "curve", -1) >= 0 else ""
    return (title or f"{kind.lower()} {getattr(element, 'name', '')}".strip()) + curve


class Tree:
    """An MJCF file of a scene, to which `add_stops` adds the stops."""

    def __init__(self, scene: Any, name: str):
        self.scene, self.names = scene, {p: n for n, p in scene.bodies.items()}
        self.motion = moving_at_start(scene)
        self.root = ElementTree.Element("mujoco", model=name)
        self.add(self.root, "compiler", angle="radian", autolimits="true")
        self.add(self.root, "option", gravity=scene.gravity, **OPTION)
        default = self.add(self.root, "default")
        self.add(default, "joint", **FRICTION)
        self.add(default, "equality", **LOOPS)
        self.world = self.add(self.root, "worldbody")
        self.bodies = {int(p): self.world for p in np.flatnonzero(scene.fixed.all(axis=1))}
        self.joints: dict[str, Any] = {}  # elements by name, in the order of the file
        self.rates: dict[str, Any] = {}  # and their rates at the start
        self._add_bodies()
        self._add_tendons()
        motors = e.TorqueMotor.find(scene)
        group = self.add(self.root, "actuator")
        for i, motor in enumerate(motors):
            joint = scene.hinges[motor.hinge].name
            self.add(group, "motor", name=f"{joint}_motor{i or ''}", joint=joint)
        rates = [self.rates[x.get("name")] for x in self.world.iter() if x in self.joints.values()]
        torques = [motor.torque for motor in motors]
        keys = self.add(self.root, "keyframe")
        self.add(keys, "key", name="start", qvel=np.concatenate(rates), ctrl=torques)

    @staticmethod
    def add(parent: Any, tag: str, **keys: Any) -> Any:
        """Add an XML element to another, and return it."""
        return Tree.put(ElementTree.SubElement(parent, tag), **keys)

    @staticmethod
    def put(element: Any, **keys: Any) -> Any:
        """Set attributes of an XML element, and return it: texts, or numbers, of which 15 digits
        are written; a number 0 and an empty list are left out."""
        for key, value in keys.items():
            if isinstance(value, str):
                element.set(key, value)
            elif np.size(value) and (np.ndim(value) or value):
                element.set(key, " ".join(f"{x + 0.0:.15g}" for x in np.ravel(value)))
        return element

    def text(self) -> str:
        """Return the file's content."""
        ElementTree.indent(self.root)
        return ElementTree.tostring(self.root, encoding="unicode") + "\n"

    def add_stops(self, mobility: Callable[[str], float]) -> None:
        """Add stops as ranges of joints, with stiffness and damping in the terms of MuJoCo's soft
        limits. mobility: acceleration of a joint by a unit moment (its documentation, Computation).
        """
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
            ((k, c),) = values
            limit = -mobility(name) * np.array([IMPEDANCE * k, c])
            keys = {"solreflimit": limit, "solimplimit": [IMPEDANCE, IMPEDANCE, 1e-3]}
            self.put(self.joints[name], range=[ends["below"], ends["above"]], **keys)

    def _origin(self, particle: int) -> np.ndarray:
        """Origin (3,), m, of the frame in which points of a particle are stated."""
        is_ground = self.bodies[particle] is self.world
        return np.zeros(3) if is_ground else self.scene.position[particle]

    def _end(self, beam: Any) -> np.ndarray:
        """End (3,), m, of a rigid arm, from the origin of its particle."""
        place = self.scene.position[beam.particle] + self.scene.frame[beam.particle] @ beam.arm
        return place - self._origin(beam.particle)

    def _add_site(self, name: str, beam: Any) -> None:
        self.add(self.bodies[beam.particle], "site", name=name, pos=self._end(beam), size="0.005")

    def _add_bodies(self) -> None:
        """Add all bodies, each on one that is there already, and equalities that close loops."""
        scene = self.scene
        joints = [h for h in scene.hinges if not h.number] + list(scene.kinds.get(e.Joint, []))
        busy = {scene.hinges[x.hinge].joint for kind in ACTIONS for x in kind.find(scene)}
        busy |= {j.joint for j in joints if j.type not in ("revolute", "spherical", "fixed")}
        root = {p: -1 if p in self.bodies else p for p in range(len(scene.mass))}
        branches: list = []
        loops: list = []
        for joint in sorted(joints, key=lambda j: j.joint not in busy):
            first, second = (root[p] for p in joint.particles)
            (loops if first == second else branches).append(joint)
            root = {p: first if r == second else r for p, r in root.items()}
        if names := [j.joint for j in loops if j.joint in busy]:
            raise CampaignError(
                f"MJCF has no equivalent of the loop of {', '.join(names)}; allowed: loops with a "
                "revolute, spherical or fixed joint on which nothing acts"
            )
        while len(self.bodies) < len(scene.mass):
            ready = [j for j in branches if sum(p in self.bodies for p in j.particles) == 1]
            for joint in ready:
                sign = -1 if joint.particles[1] in self.bodies else 1
                parent, child = joint.particles[::sign]
                self._add_body(child, self.bodies[parent], self._origin(parent))
                self._add_joints(joint, parent, child, sign)
            if not ready:
                p = next(p for p in root if p not in self.bodies)
                self._add_body(p, self.world, np.zeros(3))
                name = f"{self.names[p]}_free"
                self.joints[name] = self.add(self.bodies[p], "freejoint", name=name)
                self.rates[name] = [*self.motion.velocity[p], *self.motion.spin[p]]
        for name, beam in scene.points.items():
            self._add_site(name, beam)
        group = self.add(self.root, "equality")
        for joint in loops:
            bodies = zip(("body1", "body2"), joint.particles, strict=True)
            keys = {"name": joint.name} | {k: self.names.get(p, "world") for k, p in bodies}
            if joint.type == "fixed":
                self.add(group, "weld", **keys)
                continue
            point, frame = self._end(joint.beams[0]), scene.frame[joint.particles[0]]
            self.add(group, "connect", anchor=point, **keys)
            if joint.type == "revolute":
                point = point + 0.2 * np.ptp(scene.position) * frame @ joint.axes[0]
                self.add(group, "connect", anchor=point, **keys | {"name": f"{joint.name}_axis"})

    def _add_body(self, particle: int, parent: Any, origin: np.ndarray) -> None:
        s, name = self.scene, self.names[particle]
        mass, inertia, axes = s.mass[particle], s.inertia[particle], s.frame[particle].T[:2]
        body = self.add(parent, "body", name=name, pos=s.position[particle] - origin)
        self.add(body, "inertial", pos="0 0 0", mass=mass, diaginertia=inertia, xyaxes=axes)
        edges = np.sqrt(np.maximum(6 / mass * (inertia.sum() - 2 * inertia), 0))
        size = np.maximum(edges, 0.01 * edges.max()) / 2  # of a box with this inertia, to be seen
        self.add(body, "geom", type="box", size=size, xyaxes=axes, contype="0", conaffinity="0")
        self.bodies[particle] = body

    def _add_joints(self, joint: Any, parent: int, child: int, sign: int) -> None:
        """Add the elementary joints by which a body hangs on another. sign: -1 seen from the second
        part, in the opposite order about opposite axes; else 1."""
        s, beam = self.scene, joint.beams[1]
        number = next((i for i, h in enumerate(s.hinges) if h is joint), 0)
        point = s.position[beam.particle] + s.frame[beam.particle] @ beam.arm - s.position[child]
        for type_, place in CHAINS[joint.type][::sign]:
            hinge = joint if type_ == "ball" else s.hinges[number + place]
            keys: dict[str, Any] = {"name": hinge.name, "type": type_, "pos": point}
            self.rates[hinge.name] = self.motion.spin[child] - self.motion.spin[parent]
            if type_ != "ball":
                self.rates[hinge.name] = [rate_at(s, hinge, self.motion)]
                turn = sign if hinge.particles == joint.particles else -sign  # universal's second
                keys["axis"] = turn * s.frame[hinge.particles[0]] @ hinge.axes[0]
                springs, dampers, frictions = (
                    [x for x in kind.find(s) if x.hinge == number + place] for kind in ACTIONS[:3]
                )
                stiffness = sum(spring.stiffness for spring in springs)
                moment = sum(spring.stiffness * spring.rest for spring in springs)
                keys |= {"ref": hinge.opening, "stiffness": stiffness}
                keys |= {"springref": moment / (stiffness or 1.0)}
                keys |= {"damping": sum(damper.damping for damper in dampers)}
                keys |= {"frictionloss": sum(friction.moment for friction in frictions)}
            self.joints[hinge.name] = self.add(self.bodies[child], "joint", **keys)

    def _add_tendons(self) -> None:
        rows: list[tuple] = []  # element, stiffness, lengths between which it is slack, damping
        for cable in e.Cable.find(self.scene):
            rows.append((cable, cable.stiffness / cable.rest, [0.0, cable.rest], 0.0))
        for strut in e.Strut.find(self.scene):
            (push, pull), rest = strut.slopes, strut.lengths[0]
            lengths = [rest if push or not pull else 0.0, rest if pull or not push else 1e6]
            rows.append((strut, -min(push, pull), lengths, strut.damping))
        group = self.add(self.root, "tendon")
        for element, k, lengths, c in rows:
            keys = {"name": element.name, "springlength": lengths, "stiffness": k, "damping": c}
            tendon = self.add(group, "spatial", **keys)
            for i, beam in enumerate(element.beams):
                self._add_site(f"{element.name}_{i}", beam)
                self.add(tendon, "site", site=f"{element.name}_{i}")
