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

if TYPE_CHECKING:
    from deployable.campaign.export.selection import SelectedRun

OPTION = {"timestep": "1e-4", "integrator": "RK4", "tolerance": "1e-14", "iterations": "200"}
STIFF = {"solref": "2e-3 1", "solimp": "0.9999 0.9999 1e-3"}
STICKS = {"solreffriction": "2e-4 1", "solimpfriction": "0.9999 0.9999 1e-3"}
"""Loops and friction of MuJoCo are soft: by these they differ little from exact ones."""

IMPEDANCE = 0.95  # of limits, by default, with which `solref` says a stop's stiffness and damping
CHAINS = {  # elementary joints from the first part to the second, and which opening each is
    "revolute": [("hinge", 0)], "prismatic": [("slide", 0)], "spherical": [("ball", 0)],
    "fixed": [], "universal": [("hinge", 0), ("hinge", 1)],
    "cylindrical": [("slide", 1), ("hinge", 0)], "pin in slot": [("slide", 1), ("hinge", 0)],
    "planar": [("slide", 1), ("slide", 2), ("hinge", 0)],
}  # fmt: skip
KINDS = {  # kinds of element that have an equivalent, and when
    e.Gravity: lambda g: g.curve < 0,
    e.Damping: lambda d: not d.rate,
    e.Hinge: lambda h: h.type in CHAINS and not h.support,
    e.Joint: lambda j: j.type in CHAINS,
    e.TorsionSpring: lambda s: True,
    e.Damper: lambda d: True,
    e.Friction: lambda f: not f.angles and f.load is None,
    e.Stop: lambda s: True,
    e.TorqueMotor: lambda m: m.curve < 0 and np.isinf(m.no_load),
    e.Cable: lambda c: not c.has_friction and c.drum < 0 and c.curve < 0,
    e.Strut: lambda s: len(s.lengths) == 1 and not s.forces[0],
}
ACTING = (e.TorsionSpring, e.Damper, e.Friction, e.Stop, e.TorqueMotor)


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
    foreign = [_title(scene, x) for kind, x in pairs if not (kind in KINDS and KINDS[kind](x))]
    held = np.any(scene.fixed, axis=1) & ~np.all(scene.fixed, axis=1)
    foreign += [f"the support of {name}" for name, p in scene.bodies.items() if held[p]]
    if foreign:
        raise CampaignError(
            f"MJCF has no equivalent of {', '.join(dict.fromkeys(foreign))}; allowed: rigid bodies "
            "in joints, with springs, dampers, constant friction, stops, constant torques, cables "
            "without pulleys that rub, drums or winches, and struts that are springs or dampers"
        )
    tree = Tree(scene, run.name)
    try:
        model = mujoco.MjModel.from_xml_string(tree.text())
    except ValueError as error:
        raise CampaignError(f"MuJoCo does not take {run.name}: {error}") from None
    tree.add_stops(lambda name: float(model.dof_invweight0[model.joint(name).dofadr[0]]))
    path = folder / f"{run.name}.xml"
    write_text(path, tree.text())
    return [path]


def _title(scene: Any, element: Any) -> str:
    title = getattr(element, "title", None)
    name = getattr(element, "name", "")
    return title(scene) if title else f"{type(element).__name__.lower()} {name}".strip()


class Tree:
    """An MJCF file of a scene: its text."""

    def __init__(self, scene: Any, name: str):
        self.scene, self.names = scene, {p: n for n, p in scene.bodies.items()}
        self.motion = moving_at_start(scene)
        self.root = ElementTree.Element("mujoco", model=name)
        self.add(self.root, "compiler", angle="radian", autolimits="true")
        self.add(self.root, "option", gravity=scene.gravity, **OPTION)
        default = self.add(self.root, "default")
        self.add(default, "joint", **STICKS)
        self.add(default, "equality", **STIFF)
        self.world = self.add(self.root, "worldbody")
        self.bodies = {int(p): self.world for p in np.flatnonzero(scene.fixed.all(axis=1))}
        self.joints: dict[str, Any] = {}  # XML elements, by name
        self.rates: dict[str, Any] = {}  # by name of a joint
        self.loops = [*self._hang()]
        for point, beam in scene.points.items():
            self._site(point, beam)
        self._close()
        self._add_tendons()
        self._add_start()

    @staticmethod
    def add(parent: Any, tag: str, **keys: Any) -> Any:
        """Add an XML element to another."""
        return Tree.put(ElementTree.SubElement(parent, tag), **keys)

    @staticmethod
    def put(element: Any, **keys: Any) -> Any:
        """Set attributes of an XML element: texts, or numbers, of which 15 digits are written; a
        number 0 and an empty list are left out."""
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

    def _place(self, particle: int) -> np.ndarray:
        """Origin (3,), m, of the frame in which points of a particle are stated."""
        on_world = self.bodies[particle] is self.world
        return np.zeros(3) if on_world else self.scene.position[particle]

    def _end(self, beam: Any) -> np.ndarray:
        return self.scene.position[beam.particle] + self.scene.frame[beam.particle] @ beam.arm

    def _site(self, name: str, beam: Any) -> None:
        place = self._end(beam) - self._place(beam.particle)
        self.add(self.bodies[beam.particle], "site", name=name, pos=place, size="0.005")

    def _hang(self) -> list:
        """Add all bodies, each on one that is there already; returns the joints left over."""
        scene = self.scene
        joints = [h for h in scene.hinges if not h.number] + list(scene.kinds.get(e.Joint, []))
        busy = {scene.hinges[x.hinge].joint for kind in ACTING for x in kind.find(scene)}
        busy |= {j.joint for j in joints if j.type not in ("revolute", "spherical", "fixed")}
        root = {p: -1 if p in self.bodies else p for p in range(len(scene.mass))}
        tree: list = []
        loops: list = []
        for joint in sorted(joints, key=lambda j: j.joint not in busy):
            first, second = (root[p] for p in joint.particles)
            (loops if first == second else tree).append(joint)
            root = {p: first if r == second else r for p, r in root.items()}
        if tied := [j.joint for j in loops if j.joint in busy]:
            raise CampaignError(
                f"MJCF has no equivalent of the loop that {', '.join(tied)} closes; allowed: loops "
                "with a revolute, spherical or fixed joint on which nothing acts"
            )
        while len(self.bodies) < len(scene.mass):
            ready = [j for j in tree if sum(p in self.bodies for p in j.particles) == 1]
            for joint in ready:
                way = -1 if joint.particles[1] in self.bodies else 1
                parent, child = joint.particles[::way]
                self._add_body(child, self.bodies[parent], self._place(parent))
                self._add_joints(joint, parent, child, way)
            if not ready:
                free = next(p for p in root if p not in self.bodies)
                body, name = (
                    self._add_body(free, self.world, np.zeros(3)),
                    f"{self.names[free]}_free",
                )
                self.add(body, "freejoint", name=name)
                self.rates[name] = [self.motion.velocity[free], self.motion.spin[free]]
        return loops

    def _add_body(self, particle: int, outer: Any, origin: np.ndarray) -> Any:
        s = self.scene
        mass, inertia, axes = s.mass[particle], s.inertia[particle], s.frame[particle].T[:2]
        place = s.position[particle] - origin
        body = self.add(outer, "body", name=self.names[particle], pos=place)
        self.add(body, "inertial", pos="0 0 0", mass=mass, diaginertia=inertia, xyaxes=axes)
        edges = np.sqrt(np.maximum(6 / mass * (inertia.sum() - 2 * inertia), 0))
        size = np.maximum(edges, 0.01 * edges.max()) / 2  # of a box with this inertia, to be seen
        self.add(body, "geom", type="box", size=size, xyaxes=axes, contype="0", conaffinity="0")
        self.bodies[particle] = body
        return body

    def _add_joints(self, joint: Any, parent: int, child: int, way: int) -> None:
        """Add the elementary joints by which a body hangs on another. way: -1 seen from the second
        part, in the opposite order about opposite axes; else 1."""
        s = self.scene
        first = next((i for i, h in enumerate(s.hinges) if h is joint), 0)
        point = self._end(joint.beams[1]) - s.position[child]
        for kind, number in CHAINS[joint.type][::way]:
            hinge = joint if kind == "ball" else s.hinges[first + number]
            keys: dict[str, Any] = {"name": hinge.name, "type": kind, "pos": point}
            if kind == "ball":
                self.rates[hinge.name] = self.motion.spin[child] - self.motion.spin[parent]
            else:
                self.rates[hinge.name] = rate_at(s, hinge, self.motion)
                turn = way if hinge.particles == joint.particles else -way  # universal's second
                keys["axis"] = turn * s.frame[hinge.particles[0]] @ hinge.axes[0]
                keys["ref"] = hinge.opening
                acting = [[x for x in k.find(s) if x.hinge == first + number] for k in ACTING]
                springs, dampers, frictions, *_ = acting
                keys["stiffness"] = sum(spring.stiffness for spring in springs)
                moment = sum(spring.stiffness * spring.rest for spring in springs)
                keys["springref"] = moment / (keys["stiffness"] or 1.0)
                keys["damping"] = sum(damper.damping for damper in dampers)
                keys["frictionloss"] = sum(friction.moment for friction in frictions)
            self.joints[hinge.name] = self.add(self.bodies[child], "joint", **keys)

    def add_stops(self, mobility: Callable[[str], float]) -> None:
        """Add stops as ranges of joints, whose solref says stiffness and damping by the mobility of
        a joint (MuJoCo's documentation, Computation): the acceleration by a unit moment."""
        stops: dict[str, list] = {}
        for stop in e.Stop.find(self.scene):
            stops.setdefault(self.scene.hinges[stop.hinge].name, []).append(stop)
        for name, pair in stops.items():
            ends = {"below": -1e3, "above": 1e3} | {stop.side: stop.angle for stop in pair}
            if (
                len(pair) > len({stop.side for stop in pair})
                or len({(stop.stiffness, stop.damping) for stop in pair}) > 1
            ):
                allowed = "one at each end, of one stiffness and damping"
                raise CampaignError(
                    f"MJCF has no equivalent of the stops of {name}; allowed: {allowed}"
                )
            k, c = IMPEDANCE * pair[0].stiffness * mobility(name), pair[0].damping * mobility(name)
            self.put(self.joints[name], range=[ends["below"], ends["above"]], solreflimit=[-k, -c])

    def _close(self) -> None:
        group = self.add(self.root, "equality")
        for joint in self.loops:
            first, bodies = (
                joint.particles[0],
                [self.names.get(p, "world") for p in joint.particles],
            )
            keys = dict(zip(("body1", "body2"), bodies, strict=True))
            point = self._end(joint.beams[0]) - self._place(first)
            if joint.type == "fixed":
                self.add(group, "weld", name=joint.name, **keys)
                continue
            self.add(group, "connect", name=joint.name, anchor=point, **keys)
            if joint.type == "revolute":
                size = np.ptp(self.scene.position, axis=0).max()
                point = point + 0.2 * size * self.scene.frame[first] @ joint.axes[0]
                self.add(group, "connect", name=f"{joint.name}_axis", anchor=point, **keys)

    def _add_tendons(self) -> None:
        tendons = []
        for cable in e.Cable.find(self.scene):
            tendons.append((cable, cable.stiffness / cable.rest, [0.0, cable.rest], 0.0))
        for strut in e.Strut.find(self.scene):
            (push, pull), rest = strut.slopes, strut.lengths[0]
            length = [rest if push or not pull else 0.0, rest if pull or not push else 1e6]
            tendons.append((strut, -min(push, pull), length, strut.damping))
        group = self.add(self.root, "tendon")
        for element, k, length, c in tendons:
            keys = {"stiffness": k, "springlength": length, "damping": c}
            tendon = self.add(group, "spatial", name=element.name, **keys)
            for i, beam in enumerate(element.beams):
                self._site(f"{element.name}_{i}", beam)
                self.add(tendon, "site", site=f"{element.name}_{i}")

    def _add_start(self) -> None:
        """Add torques, and the keyframe with these and the rates at the start."""
        motors, group = e.TorqueMotor.find(self.scene), self.add(self.root, "actuator")
        for i, motor in enumerate(motors):
            joint = self.scene.hinges[motor.hinge].name
            self.add(group, "motor", name=f"{joint}_motor{i or ''}", joint=joint)
        order = [
            x.get("name")
            for x in self.world.iter()
            if x.get("name") in self.rates and "joint" in x.tag
        ]
        rates = np.concatenate([np.ravel(self.rates[name]) for name in order])
        key = self.add(self.root, "keyframe")
        self.add(key, "key", name="start", qvel=rates, ctrl=[motor.torque for motor in motors])
