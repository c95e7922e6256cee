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

NORMAL = 1e-6  # cosine up to which directions are normal to each other, as in structures' files
OPEN = 1e-7  # gap of a loop at the start, as a share of the model's size, that counts as open

JOINTS: dict[str, tuple[str, str, list[str], list[str]]] = {
    "fixed": ("", "", [], []), "spherical": ("b", "", [], []),
    "revolute": ("h", "", [""], ["axis"]), "prismatic": ("s", "", [""], ["axis"]),
    "universal": ("hh", "n", ["_axis", "_other"], ["axis", "other"]),
    "cylindrical": ("sh", "p", ["_slide", "_turn"], ["", "axis"]),
    "pin in slot": ("sh", "n", ["_slide", "_turn"], ["x", "axis"]),
    "planar": ("ssh", "nnn", ["_x", "_y", "_turn"], ["x", "", "axis"]),
}  # fmt: skip
"""Joints by type: the balls, hinges and slides from the first part to the second, their axes that
are normal (n) or parallel (p), pair by pair, suffixes of their openings, and keys of their axes."""

ACTIONS: dict[str, tuple] = {
    "stiffness": (e.TorsionSpring, "torsion spring, stiffness, N m/rad", "spring, stiffness, N/m"),
    "damping": (e.Damper, "damper, damping, N m s/rad", "damper, damping, N s/m"),
    "frictionloss": (e.Friction, "friction, moment, N m", "friction, force, N"),
    "motor": (e.TorqueMotor, "torque motor, torque, N m", "torque motor, force, N"),
}
"""What acts on a joint, by MuJoCo's word: element; type, key and unit on an angle, and on a slide.
"""

GROUPS = "gravity parameters points bodies joints actions cables struts initial_velocities record"
URDF = (
    "robot link inertial origin mass inertia visual collision geometry box cylinder sphere capsule "
    "mesh material color texture joint parent child axis limit dynamics mimic mujoco compiler "
    "option size"
)
"""Elements of URDF that MuJoCo reads, or that only say how things look."""

FLAGS = {
    "SPRING": "jnt_stiffness tendon_stiffness", "DAMPER": "dof_damping tendon_damping",
    "FRICTIONLOSS": "dof_frictionloss tendon_frictionloss", "LIMIT": "jnt_limited tendon_limited",
    "EQUALITY": "eq_active0", "CLAMPCTRL": "actuator_ctrllimited", "ACTUATION": "",
    "CONSTRAINT": "dof_frictionloss tendon_frictionloss jnt_limited tendon_limited eq_active0",
}  # fmt: skip
OBJECTS = "flex plugin sensor cam light skin numeric text tuple"
FIELDS = {
    "joint": "jnt_stiffnesspoly jnt_springyield jnt_margin dof_armature dof_dampingpoly",
    "ball or free joint": "jnt_stiffness jnt_limited dof_damping dof_frictionloss",
    "tendon": "tendon_frictionloss tendon_armature tendon_springyield tendon_stiffnesspoly "
    "tendon_dampingpoly tendon_margin",
    "actuator": "actuator_armature actuator_damping actuator_delay",
    "body": "body_gravcomp",
}
"""Not taken are fields that a flag of `FLAGS` disables, `OBJECTS`, and `FIELDS` that are not 0."""


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


def digits(values: Any, size: float = 0.0) -> Any:
    """Return numbers with 12 digits, and 0 for those that are rounding beside `size`."""
    if np.ndim(values):
        return [digits(x, size) for x in values]
    return float(f"{values:.12g}") if abs(values) > 1e-13 * size else 0.0


class Draft:
    """A structure made of the model in a file at a keyframe. mj: the module `mujoco`; m, d: MjModel
    without what its flags disable, MjData at the start; table: of the structure's file; notes: what
    is not taken, or not as it is; parts: names by body, of those welded together the same;
    openings: of a hinge or slide of the model: name, whether it counts up (1.0) or down (-1.0),
    unit; size: of the model (m); flags: names of those that disable something, as "GRAVITY"."""

    def __init__(self, path: Path, keyframe: str):
        self.mj, self.notes = (mj := load_mujoco()), list[str]()
        try:
            spec = mj.MjSpec.from_file(str(path))
            spec.compiler.fusestatic = False
            self._leave_meshes(spec)
            self.m = m = spec.compile()
        except (ValueError, OSError) as error:
            raise CampaignError(f"{path}: MuJoCo cannot read it: {error}") from None
        keys = [m.key(i).name for i in range(m.nkey)]
        if keyframe and keyframe not in keys:
            allowed = ", ".join(keys) or "none, as the model has no keyframe"
            raise CampaignError(f"--keyframe {keyframe} is not in {path}; allowed: {allowed}")
        bits = mj.mjtDisableBit.__members__
        self.flags = {x.removeprefix("mjDSBL_") for x in bits if m.opt.disableflags & bits[x]}
        for flag in sorted(self.flags & {*FLAGS}):
            self.leave_out(f"what the flag {flag.lower()}=disable disables", "it does not act")
            for field in FLAGS[flag].split():
                getattr(m, field)[:] = 0
        for key in sorted({*keys} - {keyframe}):
            self.leave_out(f"keyframe {key}", f"the structure starts there by --keyframe {key}")
        self.d = mj.MjData(m)
        if keyframe:
            mj.mj_resetDataKeyframe(m, self.d, keys.index(keyframe))
        mj.mj_forward(m, self.d)
        self.table: dict[str, Any] = {group: {} for group in GROUPS.split()}
        if "GRAVITY" not in self.flags and m.opt.gravity.any():
            self.table["gravity"] = digits(m.opt.gravity)
        self.parts = ["ground"] * m.nbody
        self.openings: dict[int, tuple[str, float, str]] = {}
        self.size = float(np.abs(self.d.xpos).max(initial=0.0) + m.stat.extent)
        self._sites: dict[int, dict] = {}
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

    def name_of(self, kind: str, index: int) -> str:
        """Return the name of a "body", "joint", ... of the model; as "body3" if it has none."""
        code = getattr(self.mj.mjtObj, f"mjOBJ_{kind.upper()}")
        return self.mj.mj_id2name(self.m, int(code), int(index)) or f"{kind}{index}"

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
        """Add what acts on the opening of a joint, with a parameter for its value: a motor, or
        what is not 0."""
        opening, _, unit = self.openings[joint]
        type_, key, value_unit = ACTIONS[word][2 if unit == "m" else 1].split(", ")
        if value or word == "motor":
            name = f"{owner}_{'friction' if word == 'frictionloss' else key}"
            keys[key] = self.parameter(name, value, value_unit, owner)
            self.add("actions", f"{owner}_{type_.split()[-1]}", type=type_, joint=opening, **keys)

    def point(self, text: str, place: np.ndarray, parts: Any) -> str:
        """Add a point (3,), m, of some parts, and return its name."""
        name = self.add("points", text, place=digits(place, self.size))
        for part in {*parts} - {"ground"}:
            self.table["bodies"][part].setdefault("points", []).append(name)
        return name

    def site(self, index: int) -> dict:
        """Return the part of a site and its point there, which is added once."""
        if index not in self._sites:
            part = self.parts[self.m.site_bodyid[index]]
            point = self.point(self.name_of("site", index), self.d.site_xpos[index], [part])
            self._sites[index] = {"part": part, "at": point}
        return self._sites[index]

    def add_parts(self) -> None:
        """Add a body for each that moves, with the mass and inertia of all that is welded to it."""
        m, d, groups = self.m, self.d, defaultdict(list)
        for body in range(1, m.nbody):
            groups[m.body_weldid[body]].append(body)
        for part, bodies in groups.items():
            names = [self.name_of("body", body) for body in bodies]
            if part == 0 or m.body_mocapid[part] >= 0:
                self.notes += [f"body {name} is fixed to the ground" for name in names]
                continue
            self.notes += [f"body {name} is held rigidly on {names[0]}" for name in names[1:]]
            masses = m.body_mass[bodies]
            centre = masses @ d.xipos[bodies] / masses.sum()
            axes, arms = d.ximat[bodies].reshape(-1, 3, 3), d.xipos[bodies] - centre
            tensor = np.einsum("bij,bj,bkj", axes, m.body_inertia[bodies], axes)
            tensor += np.sum(masses @ arms**2) * np.eye(3) - (masses * arms.T) @ arms
            values, turn = np.diagonal(tensor), {}
            if np.abs(tensor - np.diag(values)).max() > 1e-10 * values.max():
                values, (x, y, _) = (pair := np.linalg.eigh(tensor))[0], pair[1].T
                turn = {"x": digits(x, 1), "up": digits(np.cross(x, y), 1)}
            keys = {"mass": digits(masses.sum()), "inertia": digits(values), **turn}
            point = self.point(f"{names[0]}_centre", centre, [])
            name = self.add("bodies", names[0], centre=point, **keys)
            for body in bodies:
                self.parts[body] = name
            jacobians = np.zeros((2, 3, m.nv))
            self.mj.mj_jac(m, d, *jacobians, centre, part)
            motion, is_free = jacobians @ d.qvel, m.jnt_type[m.body_jntadr[part]] == 0
            if motion.any() or is_free:
                velocity, spin = digits(motion, np.abs(motion).max())
                keys = {"part": name, "about": point, "velocity": velocity, "spin": spin}
                self.add("initial_velocities", name, **keys)

    def add_joints(self) -> None:
        """Add the joints of the tree; CampaignError where those of one body have no equivalent."""
        m, d, problems = self.m, self.d, []
        for body in np.flatnonzero(m.body_jntnum):
            joints = list(range(m.body_jntadr[body], m.body_jntadr[body] + m.body_jntnum[body]))
            kinds = "".join("fbsh"[m.jnt_type[joint]] for joint in joints)
            if kinds == "f":
                continue
            names = [self.name_of("joint", joint) for joint in joints]
            parts, turn = [self.parts[m.body_parentid[body]], self.parts[body]], 1
            text = names[0] if len(names) == 1 else f"{parts[1]}_joint"
            if kinds in ("hs", "hss"):  # seen from the second part, slides come first
                joints, kinds, parts, turn = joints[::-1], kinds[::-1], parts[::-1], -1
            places, axes = d.xanchor[joints], turn * d.xaxis[joints]
            cosines = (axes @ axes.T)[np.triu_indices(len(axes), 1)]
            is_normal, is_parallel = abs(cosines) < NORMAL, abs(cosines) > 1 - NORMAL**2
            pattern = kinds, "".join(np.select([is_normal, is_parallel], ["n", "p"], "-"))
            type_ = next((type_ for type_, row in JOINTS.items() if row[:2] == pattern), "")
            if not type_ or (kinds == "hh" and np.ptp(places, axis=0).max() > OPEN * self.size):
                problems.append(f"body {self.parts[body]} has the joints {', '.join(names)}")
                continue
            _, _, suffixes, words = JOINTS[type_]
            pairs = zip(words, axes, strict=False)
            keys: dict[str, Any] = {key: digits(x, 1) for key, x in pairs if key}
            keys |= {"type": type_, "parts": parts, "at": self.point(text, places[-1], parts)}
            name, signs = self.add("joints", text, **keys), [1.0, 1.0, 1.0]
            if type_ == "cylindrical":
                signs[0] = float(np.sign(cosines[0]))
            elif type_ == "planar":
                signs[1] = float(np.sign(np.linalg.det(axes)))
            values: dict[str, Any] = {}
            for joint, kind, suffix, sign in zip(joints, kinds, suffixes, signs, strict=False):
                opening = self.openings[joint] = name + suffix, sign, "rad" if kind == "h" else "m"
                place = sign * d.qpos[m.jnt_qposadr[joint]]
                values[f"opening{suffix}"] = with_unit(place, opening[2])
                if suffix:
                    text = self.name_of("joint", joint)
                    self.notes.append(f"joint {text} is the opening {opening[0]}")
            values = {"openings": [*values.values()]} if type_ == "universal" else values
            self.table["joints"][name] |= values
        if problems:
            raise CampaignError(
                f"{'; '.join(problems)}; allowed for several joints of one body: two hinges that "
                "meet at right angles, a hinge along or normal to a slide, or one normal to two "
                "slides that are normal to each other; put a body with mass between others"
            )

    def add_loops(self) -> None:
        """Add joints for equalities: `weld` is fixed, `connect` spherical, two of the same parts a
        revolute joint about the line through their points. Loops that are open are assembled."""
        m, d, mj = self.m, self.d, self.mj
        connect, weld = int(mj.mjtEq.mjEQ_CONNECT), int(mj.mjtEq.mjEQ_WELD)
        loops: dict[Any, list] = defaultdict(list)
        for i in range(m.neq):
            name, bodies, parts = self.name_of("equality", i), [m.eq_obj1id[i], m.eq_obj2id[i]], []
            if (type_ := m.eq_type[i]) in (connect, weld) and m.eq_active0[i]:
                if m.eq_objtype[i] == mj.mjtObj.mjOBJ_SITE:
                    bodies, places = m.site_bodyid[bodies], d.site_xpos[bodies]
                else:
                    arms = m.eq_data[i, :6].reshape(2, 3, 1)[:: 1 if type_ == connect else -1]
                    places = d.xpos[bodies] + (d.xmat[bodies].reshape(2, 3, 3) @ arms)[:, :, 0]
                parts = [self.parts[body] for body in bodies]
            if len({*parts}) == 2:  # a weld without a torquescale holds places alone
                keys = {"type": "fixed" if type_ == weld and m.eq_data[i, 10] else "spherical"}
                key = i if type_ == weld else frozenset(parts)
                loops[key].append((i, name, places, keys | {"parts": parts}))
            else:
                allowed = "allowed: connect and weld of two bodies, active at the start"
                self.leave_out(f"equality {name}", allowed)
        for ends in loops.values():
            line = ends[-1][2][0] - ends[0][2][0]
            if len(ends) == 2 and (length := np.linalg.norm(line)) > 1e-4 * self.size:
                self.notes.append(f"{ends[0][1]} and {ends.pop()[1]} are one revolute joint")
                ends[0][3].update(type="revolute", axis=digits(line / length, 1))
            for end in ends:
                self._close(*end)

    def _close(self, i: int, name: str, places: np.ndarray, keys: dict) -> None:
        """Add a joint in which an equality closes a loop, which is assembled where it is open."""
        is_row = self.d.efc_type == self.mj.mjtConstraint.mjCNSTR_EQUALITY
        gaps = np.abs(self.d.efc_pos[is_row & (self.d.efc_id == i)])  # three places, three angles
        gap, is_turned = gaps.max(initial=0.0), gaps[3:].max(initial=0.0) >= OPEN
        is_open, remedy = gap >= OPEN * self.size, "kept as it is"
        if is_open and not is_turned:
            pairs = zip(keys["parts"], places, strict=True)
            keys["at"] = {part: self.point(f"{name}_{part}", x, [part]) for part, x in pairs}
            self.table["assemble"], remedy = "true", "closed before the run"
        else:
            keys["at"] = self.point(name, places[0], keys["parts"])
        if is_open:
            self.notes.append(f"equality {name} is off by {gap:.3g} at the start, and {remedy}")
        self.add("joints", name, **keys)

    def _limit(self, name: str, stop: str, soft: list) -> dict[str, Any]:
        """Return stiffness and damping of MuJoCo's soft limit beyond its width (its documentation,
        Computation), or nothing where they are not finite. name, stop: of what has the limit, and
        of what it becomes; soft: solref, and the acceleration by a unit force."""
        (a, b), inverse = soft
        if inverse <= 1e-12 * self.m.body_invweight0.max() or b == 0 < a:
            text = f"MuJoCo's limit has no finite stiffness; add a {stop} with that of the real one"
            self.leave_out(f"range of {name}", text)
            return {}
        self.notes.append(f"range of {name} is a {stop} about as soft as MuJoCo's limit")
        values = (1 / (a**2 * b**2), 2 / a) if a > 0 else (-a, -b)
        return {"stiffness": digits(values[0] / inverse), "damping": digits(values[1] / inverse)}

    def add_joint_forces(self) -> None:
        """Add what acts on joints."""
        for joint, (opening, sign, unit) in self.openings.items():
            j = self.m.joint(joint)
            rest = with_unit(sign * j.qpos_spring[0], unit)
            self.act(joint, opening, "stiffness", j.stiffness[0], rest=rest)
            self.act(joint, opening, "damping", j.damping[0])
            self.act(joint, opening, "frictionloss", j.frictionloss[0], sticks="exactly")
            soft = [j.solref, j.invweight0[0]]
            if j.limited[0] and (keys := self._limit(opening, "stop", soft)):
                lower, upper = (with_unit(x, unit) for x in sorted(sign * j.range))
                keys |= {"type": "stop", "joint": opening, "lower": lower, "upper": upper}
                self.add("actions", f"{opening}_range", **keys)

    def add_tendons(self) -> None:
        """Add spatial tendons through sites as cables, or as struts if they push as well."""
        m = self.m
        for i in range(m.ntendon):
            name, rows = self.name_of("tendon", i), m.tendon_adr[i] + np.arange(m.tendon_num[i])
            if np.any(m.wrap_type[rows] != self.mj.mjtWrap.mjWRAP_SITE):
                self.leave_out(f"tendon {name}", "allowed: spatial tendons through sites only")
                continue
            ends = [self.site(int(site)) for site in m.wrap_objid[rows]]
            stiffness, damping = digits([m.tendon_stiffness[i], m.tendon_damping[i]])
            low, high = digits(m.tendon_lengthspring[i])  # between which the spring is slack
            if stiffness and low and len(ends) == 2:
                sides = {"both ways": high} if low == high else {"push": low, "pull": high}
                keys = {"type": "spring", "between": ends}
                keys["stiffness"] = self.parameter(f"{name}_stiffness", stiffness, "N/m", name)
                for side, rest in sides.items():
                    self.add("struts", name, **keys, rest=rest, acts=side)
            elif stiffness:
                EA = self.parameter(f"{name}_EA", stiffness * high, "N", name)
                self.add("cables", name, through=ends, EA=EA, rest=high)
                if low:
                    self.leave_out(f"what tendon {name} pushes with below {low:.6g} m")
            if damping and len(ends) == 2:
                number = self.parameter(f"{name}_damping", damping, "N s/m", name)
                self.add("struts", f"{name}_damper", type="damper", between=ends, damping=number)
            elif damping:
                self.leave_out(f"damping of tendon {name}")
            if m.tendon_limited[i]:
                soft = [m.tendon_solref_lim[i], m.tendon_invweight0[i]]
                low, rest = digits(m.tendon_range[i])
                if keys := self._limit(name, "cable", soft):
                    text, EA = f"{name}_range" if stiffness else name, rest * keys["stiffness"]
                    self.add("cables", text, through=ends, EA=EA, rest=rest)
                if low > 0:
                    self.leave_out(f"limit of tendon {name} at {low:.6g} m", "cables do not push")

    def add_actuators(self) -> None:
        """Add actuators on joints at a constant control: what stays of their force is one torque
        motor on each joint; what falls with the position is a spring, with the rate a damper."""
        m, motors = self.m, dict[int, dict]()
        for i in range(m.nactuator):
            a, name, joint = m.actuator(i), self.name_of("actuator", i), int(m.actuator_trnid[i, 0])
            bias = a.biasprm[:3] * a.biastype[0]
            group = int(np.clip(a.group[0], -1, 31) % 32)
            is_off = "ACTUATION" in self.flags or m.opt.disableactuator >> group & 1
            # on a joint or in its parent, with no bias or an affine one
            is_plain = a.trntype[0] <= 1 and a.biastype[0] <= 1 and joint in self.openings
            is_plain &= a.gaintype[0] == a.dyntype[0] == 0 and bias[1:].max() <= 0
            if is_off or not is_plain:
                text = "motors and servos of a hinge or slide, in a group that is not disabled"
                self.leave_out(f"actuator {name}", f"allowed: {text}")
                continue
            control, (_, sign, unit) = self.d.ctrl[m.actuator_ctrladr[i]], self.openings[joint]
            control = np.clip(control, *a.ctrlrange) if a.ctrllimited[0] else control
            force = sign * a.gear[0] * (a.gainprm[0] * control + bias[0])
            stiffness, damping = -(a.gear[0] ** 2) * bias[1:]
            if stiffness:
                rest = self.parameter(f"{name}_target", force / stiffness, unit, name)
                self.act(joint, name, "stiffness", stiffness, rest=rest)
            elif joint in motors:
                motors[joint]["value"] = digits(motors[joint]["value"] + force)
                self.notes.append(f"actuator {name} is part of the torque motor on its joint")
            else:
                self.act(joint, name, "motor", force)
                motors[joint] = [*self.table["parameters"].values()][-1]
            self.act(joint, name, "damping", damping)
            self.notes.append(f"actuator {name} has the control {control:g} all the time")
            if a.forcelimited[0] or m.jnt_actfrclimited[joint]:
                self.leave_out(f"limit of the force of actuator {name}")

    def note_objects(self) -> None:
        """Note which objects, properties and options have no part in the structure."""
        m = self.m
        for count in OBJECTS.split():
            kind = count.replace("cam", "camera")
            for i in range(getattr(m, f"n{count}")):
                self.leave_out(f"{kind} {self.name_of(kind, i)}")
        bodies = sorted(self.name_of("body", body) for body in self._bodies_in_contact())
        if bodies and not self.flags & {"CONTACT", "CONSTRAINT"}:
            self.leave_out(f"contact of {', '.join(bodies)}", "bodies pass through each other")
        for kind, field in ((kind, field) for kind, row in FIELDS.items() for field in row.split()):
            rows = np.flatnonzero(np.any(np.atleast_2d(getattr(m, field).T), axis=0)).tolist()
            rows = m.dof_jntid[rows].tolist() if field.startswith("dof") else rows
            for i in sorted({*rows} - {*(self.openings if kind.startswith("ball") else ())}):
                name = self.name_of(kind.split()[-1], i)
                self.leave_out(f"{field.partition('_')[2]} of {kind} {name}")
        for key in filter(
            lambda key: np.any(getattr(m.opt, key)), ("wind", "density", "viscosity")
        ):
            self.leave_out(f"option {key}")

    def _bodies_in_contact(self) -> set[int]:
        """Return the bodies of geoms that MuJoCo lets touch each other: its documentation,
        Computation, Collision, Selection."""
        m = self.m
        kinds = m.geom_contype[:, None] & m.geom_conaffinity
        body, part = m.geom_bodyid, m.body_weldid[m.geom_bodyid]
        parent = m.body_weldid[m.body_parentid[part]]
        is_child = (
            (part[:, None] == parent) & (part[:, None] > 0) & ("FILTERPARENT" not in self.flags)
        )
        may_touch = ((kinds | kinds.T) > 0) & (part[:, None] != part) & ~(is_child | is_child.T)
        for first, second in zip(*divmod(m.exclude_signature, 1 << 16), strict=True):
            is_pair = (body[:, None] == first) & (body == second)
            may_touch &= ~(is_pair | is_pair.T)
        geoms = np.concatenate([*np.nonzero(may_touch), m.pair_geom1, m.pair_geom2])
        return {*body[geoms].tolist()}

    def note_urdf(self, path: Path) -> None:
        """Note which elements and limits of a file in URDF have no part in the structure."""
        is_urdf, limits = b"<robot" in path.read_bytes(), defaultdict(list)
        for element in ElementTree.parse(path).getroot().iter() if is_urdf else ():
            tags, name = [child.tag for child in element], element.get("name", "")
            for tag in sorted({*tags} - {*URDF.split()}, key=tags.index):
                self.leave_out(f"<{tag}> of <{element.tag}> {name}".rstrip())
            for key in {key for child in element if child.tag == "limit" for key in child.attrib}:
                limits[key].append(name)
            if "collision" in tags and "inertial" not in tags:
                self.notes.append(f"link {name} has the mass of its shapes at 1000 kg/m3")
        for key in sorted({*limits} - {"lower", "upper"}):
            self.leave_out(f"limit of {key} of joints {', '.join(limits[key])}")


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
    draft = Draft(path, keyframe)
    draft.add_parts()
    draft.add_joints()
    draft.add_loops()
    draft.add_joint_forces()
    draft.add_tendons()
    draft.add_actuators()
    for site in filter(lambda i: draft.m.site(i).name, range(draft.m.nsite)):
        draft.add("record", draft.m.site(site).name, **draft.site(site))
    if not draft.table["bodies"]:
        raise CampaignError(f"{path} has no body that moves; allowed: a model with joints")
    draft.note_objects()
    draft.note_urdf(path)
    structure = Structure(path.stem, **{key: x for key, x in draft.table.items() if x})
    structure.build()
    lines = [f"Made from {path.name} by MuJoCo {draft.mj.__version__}.", *draft.notes]
    write_text(target, "".join(f"# {line}\n" for line in lines) + structure.text())
    return draft.notes
