"""MJCF and URDF models as structures' files: what is not taken is listed."""

import logging
import math
import re
from collections import defaultdict
from pathlib import Path
from typing import Any
from unicodedata import normalize
from xml.etree import ElementTree

import numpy as np

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_text
from fpm import elements as e
from fpm.structures.names import Names
from fpm.structures.reading import Problems
from fpm.structures.structure import Structure

OPEN = 1e-7  # gap of a loop at the start, as a share of the model's size, that counts as open
JOINTS = {"spherical": "ball", "prismatic": "slide", "revolute": "hinge"}
"""Our joints, in the order of MuJoCo's types from 1 on, which are called otherwise."""

ACTIONS: dict[str, tuple] = {
    "stiffness": (e.TorsionSpring, "torsion spring, stiffness, N m/rad", "spring, stiffness, N/m"),
    "damping": (e.Damper, "damper, damping, N m s/rad", "damper, damping, N s/m"),
    "frictionloss": (e.Friction, "friction, moment, N m", "friction, force, N"),
    "motor": (e.TorqueMotor, "torque motor, torque, N m", "torque motor, force, N"),
}
"""What acts on a joint, by MuJoCo's word: element; type, key and unit on an angle, and on a slide.
"""

GROUPS = "gravity parameters points bodies joints actions cables struts initial_velocities record"
FLAGS = "spring damper frictionloss limit equality clampctrl actuation constraint"
SKIPPED = """asset axis child collision color compiler connect contact equality fixed flag geom
inertial keyframe material mesh origin parent site size statistic visual weld"""
INNER = "actuator custom default deformable extension frame link mujoco sensor tendon worldbody"
SOLVER = "|class|name|group|user|sol.*"
EQUIVALENTS = dict.fromkeys(INNER.split(), ".*") | {
    "body": f"childclass|pos|quat|mocap{SOLVER}",
    "dynamics": "damping|friction",
    "general": f"joint.*|site|tendon|body|c.*|gear|input|(gain|bias|dyn)(prm|type){SOLVER}",
    "joint": f"type|pos|axis|ref|range|limited|stiffness|springref|damping|frictionloss{SOLVER}",
    "limit": "lower|upper",
    "option": "(?!wind|density|viscosity|actuatorgroupdisable).*",
    "spatial": f"stiffness|springlength|damping|width|material|rgba{SOLVER}",
}
"""Attributes of elements of MJCF and URDF that are taken, or without effect on a motion. Others are
noted by name, but for what is in elements that are `SKIPPED`: looks, and what `Draft` notes."""


def load_mujoco() -> Any:
    """Return the library, whose warnings go to the log instead of a file in the working folder.
    Raises `CampaignError` where it is not installed."""
    try:
        import mujoco
    except ImportError:
        text = "MJCF and URDF need mujoco: pip install 'deployable-intervals[mjcf]'"
        raise CampaignError(text) from None
    mujoco.set_mju_user_warning(logging.getLogger("deployable").warning)
    return mujoco


def with_unit(value: float, unit: str) -> str:
    """Return a value with its unit; an angle in degrees."""
    return f"{math.degrees(value):.14g} deg" if unit == "rad" else f"{value:.12g} {unit}"


def digits(values: Any) -> Any:
    """Return numbers with 12 digits, and 0 for those that are rounding beside the largest."""
    least = 1e-13 * np.abs(values).max()
    numbers = [float(f"{x:.12g}") if abs(x) > least else 0.0 for x in np.ravel(values)]
    return numbers if np.ndim(values) else numbers[0]


class Draft:
    """A structure made of the model in a file at a keyframe. mj: the module `mujoco`; m, d: MjModel
    and MjData at the start; xml: the model's elements; table: of the structure's file; notes: what
    is not taken, or not as it is; parts: names by body, of those welded together the same;
    openings: name and unit, by hinge or slide of the model; size: of the model (m)."""

    def __init__(self, path: Path, keyframe: str):
        self.mj, self.notes = (mj := load_mujoco()), list[str]()
        try:
            spec = mj.MjSpec.from_file(str(path))
            spec.compiler.fusestatic = False
            self._leave_meshes(spec)
            self.m = m = spec.compile()
            xml = ElementTree.parse(path).getroot()
            self.xml = xml if xml.tag == "robot" else ElementTree.fromstring(spec.to_xml())
        except (ValueError, OSError, ElementTree.ParseError) as error:
            remedy = "; allowed: bodies with `inertial`" * ("mass and inertia" in str(error))
            raise CampaignError(f"{path}: MuJoCo cannot read it: {error}{remedy}") from None
        keys = [m.key(i).name for i in range(m.nkey)]
        if keyframe and keyframe not in keys:
            allowed = ", ".join(keys) or "none, as the model has no keyframe"
            raise CampaignError(f"--keyframe {keyframe} is not in {path}; allowed: {allowed}")
        bits = mj.mjtDisableBit.__members__.items()
        flags = {name[7:].lower() for name, bit in bits if m.opt.disableflags & bit}  # mjDSBL_
        if words := " ".join(f'{flag}="disable"' for flag in sorted(flags & {*FLAGS.split()})):
            raise CampaignError(f"{path} has <flag {words}/>; remove it, and what it disables")
        for key in sorted({*keys} - {keyframe}):
            self.leave_out(f"keyframe {key}", f"the structure starts there by --keyframe {key}")
        contacts = np.any(m.geom_contype[:, None] & m.geom_conaffinity) or m.npair
        if contacts and "contact" not in flags:
            self.leave_out("contact of geoms", "bodies pass through each other")
        self.d = mj.MjData(m)
        if keyframe:
            mj.mj_resetDataKeyframe(m, self.d, keys.index(keyframe))
        mj.mj_forward(m, self.d)
        self.table: dict[str, Any] = {group: {} for group in GROUPS.split()}
        if "gravity" not in flags and m.opt.gravity.any():
            self.table["gravity"] = digits(m.opt.gravity)
        self.parts = ["ground"] * m.nbody
        self.openings: dict[int, tuple[str, str]] = {}
        self.size = float(np.abs(self.d.xpos).max(initial=0.0) + m.stat.extent)
        self.sites: list[dict] = []
        self._names = Names(Problems(""), {})

    def _leave_meshes(self, spec: Any) -> None:
        """Make spheres of meshes whose mass does not count, as their files are often elsewhere."""
        is_all = spec.compiler.inertiafromgeom == self.mj.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
        for geom in (geom for geom in spec.geoms if geom.meshname):
            body = geom.parent
            while body.name != "world" and not body.joints:
                body = body.parent
            if body.name == "world" or (geom.parent.explicitinertial and not is_all):
                geom.type, geom.meshname = self.mj.mjtGeom.mjGEOM_SPHERE, ""
                geom.size = [1e-3, 0, 0]
        for mesh in [*spec.meshes]:
            if all(geom.meshname != mesh.name for geom in spec.geoms):
                spec.delete(mesh)

    def name_of(self, kind: str, index: Any) -> str:
        """Return the name of a "body", "joint", ... of the model; as "body3" if it has none."""
        return getattr(self.m, kind)(int(index)).name or f"{kind}{index}"

    def leave_out(self, subject: str, reason: str = "it has no equivalent") -> None:
        """Note that something is not taken."""
        self.notes.append(f"{subject} is not taken: {reason}")

    def add(self, group: str, text: str, **keys: Any) -> str:
        """Add an entry under the allowed name that is nearest to `text`, and return that name."""
        name, entries = re.sub(r"\W", "_", normalize("NFKC", text)), self.table[group]
        name, room = name if name[:1].isalpha() else f"n{name}", group.replace("parameters", "let")
        while name in entries or not self._names.allows(name, "", 0, room):
            name += "_"
        if name != text and group in ("bodies", "joints", "record"):
            self.notes.append(f"{text} is called {name} among {group}")
        entries[name] = keys.get("place", keys)  # of a point
        return name

    def parameter(self, text: str, value: float, unit: str, owner: str) -> str:
        """Add a parameter with a value of something of the model, and return its name."""
        keys = {"value": digits(value), "unit": unit, "description": f"of {owner}"}
        return self.add("parameters", text, **keys)

    def act(self, joint: int, owner: str, word: str, value: float, **keys: Any) -> None:
        """Add what acts on the opening of a joint, with a parameter for its value."""
        opening, unit = self.openings[joint]
        type_, key, value_unit = ACTIONS[word][2 if unit == "m" else 1].split(", ")
        name = f"{owner}_{'friction' if word == 'frictionloss' else key}"
        keys |= {"type": type_, key: self.parameter(name, value, value_unit, owner)}
        self.add("actions", f"{owner}_{type_.split()[-1]}", joint=opening, **keys)

    def point(self, text: str, place: np.ndarray, parts: Any) -> str:
        """Add a point (3,), m, of some parts, and return its name."""
        name = self.add("points", text, place=digits(place))
        for part in {*parts} - {"ground"}:
            self.table["bodies"][part].setdefault("points", []).append(name)
        return name

    def add_bodies(self) -> None:
        """Add a body for each that moves, with the mass and inertia of all that is welded to it,
        and points of all sites."""
        m, groups = self.m, defaultdict(list)
        for body in range(1, m.nbody):
            groups[m.body_weldid[body]].append(body)
        for part, bodies in groups.items():
            names = [self.name_of("body", body) for body in bodies]
            if part == 0 or m.body_mocapid[part] >= 0:
                self.notes += [f"body {name} is fixed to the ground" for name in names]
            else:
                self.notes += [f"body {name} is held rigidly on {names[0]}" for name in names[1:]]
                self._add_body(names[0], bodies)
        for i in range(m.nsite):
            part, name = self.parts[m.site_bodyid[i]], self.name_of("site", i)
            self.sites.append({"part": part, "at": self.point(name, self.d.site_xpos[i], [part])})
            if m.site(i).name:
                self.add("record", name, **self.sites[i])

    def _add_body(self, name: str, bodies: list[int]) -> None:
        m, d, masses = self.m, self.d, self.m.body_mass[bodies]
        centre = masses @ d.xipos[bodies] / masses.sum()
        axes, arms = d.ximat[bodies].reshape(-1, 3, 3), d.xipos[bodies] - centre
        tensor = np.einsum("bij,bj,bkj", axes, m.body_inertia[bodies], axes)
        tensor += np.sum(masses @ arms**2) * np.eye(3) - (masses * arms.T) @ arms
        values, turn = np.diagonal(tensor), {}
        if np.abs(tensor - np.diag(values)).max() > 1e-10 * values.max():
            values, (x, y, _) = (pair := np.linalg.eigh(tensor))[0], pair[1].T
            turn = {"x": digits(x), "up": digits(np.cross(x, y))}
        point = self.point(f"{name}_centre", centre, [])
        keys = {"centre": point, "mass": digits(masses.sum()), "inertia": digits(values)}
        name = self.add("bodies", name, **keys, **turn)
        for body in bodies:
            self.parts[body] = name
        jacobians = np.zeros((2, 3, m.nv))
        self.mj.mj_jac(m, d, *jacobians, centre, bodies[0])
        velocity, spin = jacobians @ d.qvel
        if velocity.any() or spin.any() or m.jnt_type[m.body_jntadr[bodies[0]]] == 0:  # free
            keys = {"about": point, "velocity": digits(velocity), "spin": digits(spin)}
            self.add("initial_velocities", name, part=name, **keys)

    def add_joints(self) -> None:
        """Add joints of the tree with what acts on them. CampaignError if a body has several."""
        m, d = self.m, self.d
        if names := [self.name_of("body", i) for i in np.flatnonzero(m.body_jntnum > 1)]:
            allowed = "one for each body; put a light body with mass and inertia between two joints"
            raise CampaignError(f"several joints of body {', '.join(names)}; allowed: {allowed}")
        for i in range(m.njnt):
            joint, body, name = m.joint(i), m.jnt_bodyid[i], self.name_of("joint", i)
            parts, type_ = [self.parts[m.body_parentid[body]], self.parts[body]], joint.type[0]
            if type_ > 0:
                point, text = self.point(name, d.xanchor[i], parts), [*JOINTS][type_ - 1]
                name = self.add("joints", name, type=text, parts=parts, at=point)
            if type_ > 1:
                self.openings[i] = name, (unit := "m" if type_ == 2 else "rad")
                place = with_unit(d.qpos[joint.qposadr[0]], unit)
                self.table["joints"][name] |= {"axis": digits(d.xaxis[i]), "opening": place}
                self._add_joint_forces(i, joint)
                continue
            for word in ("stiffness", "damping", "frictionloss", "limited"):
                if np.any(getattr(joint, word)):
                    self.leave_out(f"{word} of ball or free joint {name}")

    def _add_joint_forces(self, i: int, joint: Any) -> None:
        """Add what acts on a hinge or slide. Its limit becomes a stop with the stiffness and
        damping of MuJoCo's beyond its width (its documentation, Computation)."""
        name, unit = self.openings[i]
        rest = with_unit(joint.qpos_spring[0], unit)
        keys: dict[str, Any] = {"stiffness": {"rest": rest}, "frictionloss": {"sticks": "exactly"}}
        for word in ("stiffness", "damping", "frictionloss"):
            if value := getattr(joint, word)[0]:
                self.act(i, name, word, value, **keys.get(word, {}))
        a, b = joint.solref
        if joint.limited[0] and b == 0 < a:
            text = "MuJoCo's limit has no finite stiffness; add a stop with that of the real one"
            self.leave_out(f"range of {name}", text)
        elif joint.limited[0]:
            self.notes.append(f"range of {name} is a stop about as soft as MuJoCo's limit")
            soft = np.array([1 / (a * b) ** 2, 2 / a] if a > 0 else [-a, -b])
            stiffness, damping = digits(soft / joint.invweight0[0])
            lower, upper = (with_unit(x, unit) for x in joint.range)
            keys = {"lower": lower, "upper": upper, "stiffness": stiffness, "damping": damping}
            self.add("actions", f"{name}_range", type="stop", joint=name, **keys)

    def add_loops(self) -> None:
        """Add joints for equalities: `weld` is fixed, `connect` spherical, two of the same parts a
        revolute joint about the line through their points. Loops that are open are assembled."""
        m, d, mj = self.m, self.d, self.mj
        connects: dict[frozenset, tuple] = {}
        for i in range(m.neq):
            name, bodies = self.name_of("equality", i), [m.eq_obj1id[i], m.eq_obj2id[i]]
            is_connect, is_weld = (m.eq_type[i] == mj.mjtEq(k) for k in (0, 1))
            rows = (d.efc_type == mj.mjtConstraint.mjCNSTR_EQUALITY) & (d.efc_id == i)
            gaps = np.abs(d.efc_pos[rows])  # three places; of a weld also three angles
            is_turned = gaps[3:].max(initial=0.0) >= OPEN
            if not m.eq_active0[i] or is_turned or not (is_connect or is_weld):
                text = "allowed: connect and weld, active at the start, where no weld is turned"
                self.leave_out(f"equality {name}", text)
                continue
            if m.eq_objtype[i] == mj.mjtObj.mjOBJ_SITE:
                bodies, places = m.site_bodyid[bodies], d.site_xpos[bodies]
            else:
                arms = m.eq_data[i, :6].reshape(2, 3, 1)[:: 1 if is_connect else -1]
                places = d.xpos[bodies] + (d.xmat[bodies].reshape(2, 3, 3) @ arms)[:, :, 0]
            first, second = parts = [self.parts[body] for body in bodies]
            if first == second:
                self.leave_out(f"equality {name}", "its bodies are one part, or both the ground")
                continue
            is_open, pair = gaps.max(initial=0.0) >= OPEN * self.size, frozenset(parts)
            joint, place = connects.pop(pair, ("", places[0]))
            length = np.linalg.norm(line := places[0] - place)
            if is_connect and not is_open and length > 1e-4 * self.size:
                self.table["joints"][joint].update(type="revolute", axis=digits(line / length))
                self.notes.append(f"{joint} and {name} are one revolute joint")
                continue
            if is_open:
                ends = zip(parts, places, strict=True)
                point: Any = {part: self.point(f"{name}_{part}", x, [part]) for part, x in ends}
                self.table["assemble"] = "true"
                self.notes.append(f"equality {name} is open at the start, and closed before a run")
            else:
                point = self.point(name, places[0], parts)
            type_ = "fixed" if is_weld and m.eq_data[i, 10] else "spherical"  # torquescale
            joint = self.add("joints", name, type=type_, parts=parts, at=point)
            if is_connect and not is_open:
                connects[pair] = joint, places[0]

    def add_tendons(self) -> None:
        """Add spatial tendons through sites as cables, or as struts if they push as well."""
        m = self.m
        for i in range(m.ntendon):
            name, rows = self.name_of("tendon", i), m.tendon_adr[i] + np.arange(m.tendon_num[i])
            stiffness, damping = m.tendon_stiffness[i], m.tendon_damping[i]
            low, high = digits(m.tendon_lengthspring[i])  # between which the spring is slack
            is_rope = np.all(m.wrap_type[rows] == self.mj.mjtWrap.mjWRAP_SITE)
            if not is_rope or (len(rows) > 2 and (damping or (stiffness and low))):
                allowed = 'two sites, or springlength="0 L" without damping through more sites'
                self.leave_out(f"tendon {name}", f"allowed: spatial tendons through {allowed}")
                continue
            ends = [self.sites[site] for site in m.wrap_objid[rows]]
            if stiffness and low:
                sides = {"both ways": high} if low == high else {"push": low, "pull": high}
                keys = {"type": "spring", "between": ends}
                keys["stiffness"] = self.parameter(f"{name}_stiffness", stiffness, "N/m", name)
                for side, rest in sides.items():
                    self.add("struts", name, **keys, rest=rest, acts=side)
            elif stiffness:
                EA = self.parameter(f"{name}_EA", stiffness * high, "N", name)
                self.add("cables", name, through=ends, EA=EA, rest=high)
            if damping:
                number = self.parameter(f"{name}_damping", damping, "N s/m", name)
                self.add("struts", f"{name}_damper", type="damper", between=ends, damping=number)

    def add_actuators(self) -> None:
        """Add actuators on joints at a constant control: what stays of their force is a torque
        motor; what falls with the position is a spring, with the rate a damper."""
        motors: dict[int, dict] = {}  # their parameters, by joint, which has one motor at most
        for i in range(self.m.nactuator):
            a, name = self.m.actuator(i), self.name_of("actuator", i)
            bias, joint = a.biasprm[:3] * a.biastype[0], int(a.trnid[0])
            # on a joint or in its parent, with no bias or an affine one
            is_plain = a.trntype[0] <= 1 and a.biastype[0] <= 1 and joint in self.openings
            if not is_plain or a.gaintype[0] or a.dyntype[0] or bias[1:].max() > 0:
                self.leave_out(f"actuator {name}", "allowed: motors and servos of a hinge or slide")
                continue
            control = self.d.ctrl[self.m.actuator_ctrladr[i]]
            control = np.clip(control, *a.ctrlrange) if a.ctrllimited[0] else control
            force = a.gear[0] * (a.gainprm[0] * control + bias[0])
            stiffness, damping = -(a.gear[0] ** 2) * bias[1:]
            if stiffness:
                unit = self.openings[joint][1]
                rest = self.parameter(f"{name}_target", force / stiffness, unit, name)
                self.act(joint, name, "stiffness", stiffness, rest=rest)
            elif joint in motors:
                motors[joint]["value"] = digits(motors[joint]["value"] + force)
                self.notes.append(f"actuator {name} is part of the torque motor on its joint")
            else:
                self.act(joint, name, "motor", force)
                motors[joint] = [*self.table["parameters"].values()][-1]
            if damping:
                self.act(joint, name, "damping", damping)
            self.notes.append(f"actuator {name} has the control {control:g} all the time")

    def note_others(self, parent: ElementTree.Element) -> None:
        """Note what is in an element of the model and not in the table of what is `EQUIVALENTS`."""
        for element in (child for child in parent if child.tag not in SKIPPED.split()):
            name = f"{element.tag} {element.get('name') or parent.get('name', '')}".strip()
            if element.tag not in EQUIVALENTS:
                self.leave_out(name)
                continue
            for key, text in element.attrib.items():
                is_poly = key in ("stiffness", "damping") and any(map(float, text.split()[1:]))
                if is_poly or not re.fullmatch(EQUIVALENTS[element.tag], key):
                    self.leave_out(f"{key} of {name}")
            self.note_others(element)


def convert(path: Path, target: Path, keyframe: str = "") -> list[str]:
    """Write the model in a file, MJCF or URDF, as the file of a structure; returns notes on what is
    not taken, or not as it is. CampaignError without `mujoco`, for a model that it cannot read, and
    for joints without an equivalent. target: file to make (.yaml); keyframe: at which the structure
    starts; "": where the model's file has its bodies."""
    if target.exists() or target.suffix not in (".yaml", ".yml"):
        raise CampaignError(f"--to {target}; allowed: a .yaml file that does not exist yet")
    if not path.is_file() or path.suffix in (".yaml", ".yml"):
        fault = "it is a YAML file, no model" if path.is_file() else "there is no such file"
        raise CampaignError(f"{path}: {fault}; allowed: a model, .xml (MJCF) or .urdf")
    if path.suffix in (".xacro", ".sdf"):
        raise CampaignError(f"{path}; allowed: a model, .xml (MJCF) or .urdf, as `xacro` makes one")
    draft = Draft(path, keyframe)
    draft.add_bodies()
    draft.add_joints()
    draft.add_loops()
    draft.add_tendons()
    draft.add_actuators()
    if not draft.table["bodies"]:
        raise CampaignError(f"{path} has no body that moves; allowed: a model with joints")
    draft.note_others(draft.xml)
    structure = Structure(path.stem, **{key: x for key, x in draft.table.items() if x})
    structure.build()
    lines = [f"Made from {path.name} by MuJoCo {draft.mj.__version__}.", *draft.notes]
    write_text(target, "".join(f"# {line}\n" for line in lines) + structure.text())
    return draft.notes
