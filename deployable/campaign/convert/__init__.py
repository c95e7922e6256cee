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

UNITS = {"h": "rad", "s": "m"}  # of openings of hinges and slides
NORMAL = 1e-6  # cosine up to which directions are normal to each other, as in structures' files
OPEN = 1e-7  # gap of a loop at the start, as a share of the model's size, that counts as open

JOINTS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "fixed": ("", "", ()), "spherical": ("b", "", ("",)), "revolute": ("h", "", ("",)),
    "prismatic": ("s", "", ("",)), "universal": ("hh", "n", ("_axis", "_other")),
    "cylindrical": ("sh", "p", ("_slide", "_turn")),
    "pin in slot": ("sh", "n", ("_slide", "_turn")),
    "planar": ("ssh", "nnn", ("_x", "_y", "_turn")),
}  # fmt: skip
"""Joints by type: the balls, hinges and slides from the first part to the second, their axes that
are normal (n) or parallel (p), pair by pair, and the suffixes of their openings."""

ACTIONS: dict[str, tuple] = {
    "stiffness": (e.TorsionSpring, "torsion spring, stiffness, N m/rad", "spring, stiffness, N/m"),
    "damping": (e.Damper, "damper, damping, N m s/rad", "damper, damping, N s/m"),
    "frictionloss": (e.Friction, "friction, moment, N m", "friction, force, N"),
    "motor": (e.TorqueMotor, "torque motor, torque, N m", "torque motor, force, N"),
}
"""What acts on a joint, by MuJoCo's word: element; type, key and unit on an angle, and on a slide.
"""

GROUPS = "parameters points bodies joints actions cables struts initial_velocities record"

FIELDS_BY_FLAG = {
    "SPRING": "jnt_stiffness tendon_stiffness", "DAMPER": "dof_damping tendon_damping",
    "FRICTIONLOSS": "dof_frictionloss tendon_frictionloss", "LIMIT": "jnt_limited tendon_limited",
    "EQUALITY": "eq_active0", "CLAMPCTRL": "actuator_ctrllimited", "ACTUATION": "",
    "CONSTRAINT": "dof_frictionloss tendon_frictionloss jnt_limited tendon_limited eq_active0",
}  # fmt: skip
"""Fields of a model that do not act, by the flag that disables them."""

URDF = (
    "robot link inertial origin mass inertia visual collision geometry box cylinder sphere capsule "
    "mesh material color texture joint parent child axis limit dynamics mimic mujoco compiler"
)
"""Elements of URDF that MuJoCo reads, or that only say how things look."""

OBJECTS = "flex plugin sensor cam light skin numeric text tuple"
FIELDS = {
    "joint": "jnt_stiffnesspoly jnt_springyield jnt_margin dof_armature dof_dampingpoly",
    "ball or free joint": "jnt_stiffness jnt_limited dof_damping dof_frictionloss",
    "tendon": "tendon_frictionloss tendon_armature tendon_springyield tendon_stiffnesspoly "
    "tendon_dampingpoly tendon_margin",
    "actuator": "actuator_armature actuator_damping actuator_delay",
    "body": "body_gravcomp",
}
"""`OBJECTS` are not taken, nor are these fields of others where they are not 0."""


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


def digits(values: Any, size: float = 1.0) -> list[float]:
    """Return numbers with 12 digits, and 0 for those that are rounding beside `size`."""
    return [float(f"{x:.12g}") if abs(x) > 1e-13 * size else 0.0 for x in values]


class Draft:
    """A structure of a compiled model, at a keyframe by its number. A part is the index of the body
    to which others are welded; 0 is the ground. library: the module `mujoco`; model, data: MjModel
    without what its flags disable, MjData at the start; table: of the structure's file; notes: what
    is not taken, or not as it is; parts: names of parts; openings: of a hinge or slide of the
    model: name, whether it counts up (1.0) or down (-1.0), unit; size: of the model (m)."""

    def __init__(self, library: Any, model: Any, keyframe: int | None):
        self.library, self.model, self.notes = library, model, list[str]()
        for flag in filter(self.is_disabled, FIELDS_BY_FLAG):
            self.leave_out(f"what the flag {flag.lower()}=disable disables", "it does not act")
            for field in FIELDS_BY_FLAG[flag].split():
                getattr(model, field)[:] = 0
        self.data = library.MjData(model)
        if keyframe is not None:
            library.mj_resetDataKeyframe(model, self.data, keyframe)
        library.mj_forward(model, self.data)
        is_free = self.is_disabled("GRAVITY") or not model.opt.gravity.any()
        self.table: dict[str, Any] = {"gravity": None if is_free else digits(model.opt.gravity)}
        self.table |= {group: {} for group in GROUPS.split()}
        self.parts = {0: "ground"}
        self.openings: dict[int, tuple[str, float, str]] = {}
        self.size = float(np.abs(self.data.xpos).max(initial=0.0) + model.stat.extent)
        self._sites: dict[int, dict] = {}
        self._names = Names(Problems(""), {})

    def is_disabled(self, flag: str) -> bool:
        """Return whether a flag of the model's options, as "GRAVITY", is `disable`."""
        bit = getattr(self.library.mjtDisableBit, f"mjDSBL_{flag}")
        return bool(self.model.opt.disableflags & int(bit))

    def name_of(self, kind: str, index: int) -> str:
        """Return the name of a "body", "joint", ... of the model; as "body3" if it has none."""
        code = getattr(self.library.mjtObj, f"mjOBJ_{kind.upper()}")
        return self.library.mj_id2name(self.model, int(code), int(index)) or f"{kind}{index}"

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
        keys = {"value": digits([value])[0], "unit": unit, "description": f"of {owner}"}
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
        for part in filter(None, parts):
            self.table["bodies"][self.parts[part]].setdefault("points", []).append(name)
        return name

    def part(self, body: int) -> int:
        """Return the part to which a body belongs."""
        part = int(self.model.body_weldid[body])
        return 0 if self.model.body_mocapid[part] >= 0 else part

    def site(self, index: int) -> dict:
        """Return the part of a site and its point there, which is added once."""
        if index not in self._sites:
            part, place = self.part(self.model.site_bodyid[index]), self.data.site_xpos[index]
            point = self.point(self.name_of("site", index), place, [part])
            self._sites[index] = {"part": self.parts[part], "at": point}
        return self._sites[index]

    def leave_out(self, subject: str, reason: str = "it has no equivalent") -> None:
        """Note that something is not taken."""
        self.notes.append(f"{subject} is not taken: {reason}")


def add_parts(draft: Draft) -> None:
    """Add each part as a body, with the mass and inertia of all that is welded to it."""
    m, d, members = draft.model, draft.data, defaultdict(list)
    for body in range(1, m.nbody):
        members[draft.part(body)].append(body)
    fixed = [draft.name_of("body", body) for body in members.pop(0, ())]
    draft.notes += [f"body {name} is fixed to the ground" for name in fixed]
    for part, bodies in members.items():
        names = [draft.name_of("body", body) for body in bodies]
        draft.notes += [f"body {name} is held rigidly on {names[0]}" for name in names[1:]]
        masses = m.body_mass[bodies]
        centre = masses @ d.xipos[bodies] / masses.sum()
        axes, arms = d.ximat[bodies].reshape(-1, 3, 3), d.xipos[bodies] - centre
        tensor = np.einsum("bij,bj,bkj", axes, m.body_inertia[bodies], axes)
        tensor += np.sum(masses @ arms**2) * np.eye(3) - (masses * arms.T) @ arms
        values, axes = np.diagonal(tensor), {}
        if np.abs(tensor - np.diag(values)).max() > 1e-10 * values.max():
            values, (x, y, _) = (pair := np.linalg.eigh(tensor))[0], pair[1].T
            axes = {"x": digits(x), "up": digits(np.cross(x, y))}
        point = draft.point(f"{names[0]}_centre", centre, [])
        keys = {"mass": digits([masses.sum()])[0], "inertia": digits(values, 0.0)}
        name = draft.add("bodies", names[0], centre=point, **keys, **axes)
        draft.parts[part], motion = name, np.zeros(6)
        draft.library.mj_objectVelocity(m, d, draft.library.mjtObj.mjOBJ_XBODY, part, motion, 0)
        if motion.any():
            spin, size = motion[:3], np.abs(motion).max()
            velocity = digits(motion[3:] + np.cross(spin, centre - d.xpos[part]), size)
            keys = {"part": name, "velocity": velocity, "spin": digits(spin, size)}
            draft.add("initial_velocities", name, about=point, **keys)


def add_joints(draft: Draft) -> None:
    """Add the joints of the tree; CampaignError where those of one body have no equivalent."""
    m, d, problems = draft.model, draft.data, []
    for part in list(draft.parts)[1:]:
        joints = list(range(m.body_jntadr[part], m.body_jntadr[part] + m.body_jntnum[part]))
        parent, turn = draft.part(m.body_parentid[part]), 1
        pair, kinds = (parent, part), "".join("fbsh"[m.jnt_type[joint]] for joint in joints)
        if kinds == "f":
            continue
        names = [draft.name_of("joint", joint) for joint in joints]
        if kinds in ("hs", "hss"):  # seen from the second part, slides come first
            joints, kinds, pair, turn = joints[::-1], kinds[::-1], pair[::-1], -1
        places = d.xanchor[joints]
        equivalent = _equivalent(kinds, turn * d.xaxis[joints], d.qpos[m.jnt_qposadr[joints]])
        if not equivalent or (kinds == "hh" and np.ptp(places, axis=0).max() > OPEN * draft.size):
            problems.append(f"body {draft.parts[part]} has the joints {', '.join(names)}")
            continue
        keys, signs = equivalent
        text = names[0] if len(names) == 1 else f"{draft.parts[part]}_joint"
        keys |= {"parts": [draft.parts[p] for p in pair], "at": draft.point(text, places[-1], pair)}
        name = draft.add("joints", text, **keys)
        for joint, kind, (suffix, sign) in zip(joints, kinds, signs.items(), strict=False):
            draft.openings[joint] = name + suffix, sign, UNITS[kind]
            if suffix:
                text = f"joint {draft.name_of('joint', joint)} is the opening {name + suffix}"
                draft.notes.append(text)
    if problems:
        raise CampaignError(
            f"{'; '.join(problems)}; allowed for several joints of one body: two hinges that meet "
            "at right angles, a hinge along or normal to a slide, or one normal to two slides that "
            "are normal to each other; put a body with mass between others"
        )


def _equivalent(kinds: str, axes: np.ndarray, q: np.ndarray) -> tuple[dict, dict] | None:
    """Keys of the joint that stands for the elementary joints of a body (letters b, s, h), and the
    signs of its openings by suffix; None: there is none. axes (n, 3): of each; q: positions."""
    cosines = (axes @ axes.T)[np.triu_indices(len(axes), 1)]
    is_normal, is_parallel = abs(cosines) < NORMAL, abs(cosines) > 1 - NORMAL**2
    pattern = kinds, "".join(np.select([is_normal, is_parallel], ["n", "p"], "-"))
    type_ = next((type_ for type_, row in JOINTS.items() if row[:2] == pattern), "")
    keys: dict = {"type": type_}
    signs = dict.fromkeys(JOINTS.get(type_, pattern)[-1], 1.0)
    if not type_ or type_ == "spherical":
        return (keys, {}) if type_ else None
    if type_ == "cylindrical":
        signs["_slide"] = float(np.sign(cosines[0]))
    if type_ == "planar":
        signs["_y"] = float(np.sign(np.linalg.det(axes[[2, 0, 1]])))
    lines, triples = [*map(digits, axes)], zip(signs.values(), q, kinds, strict=True)
    values = [with_unit(sign * x, UNITS[kind]) for sign, x, kind in triples]
    if type_ == "universal":
        return keys | {"axis": lines[0], "other": lines[1], "openings": values}, signs
    keys |= {f"opening{suffix}": x for suffix, x in zip(signs, values, strict=True)}
    keys |= {"x": lines[0]} if type_ in ("planar", "pin in slot") else {}
    return keys | {"axis": lines[-1]}, signs


def add_loops(draft: Draft) -> None:
    """Add joints for equalities: `weld` is fixed, `connect` spherical, two of the same parts a
    revolute joint about the line through their points."""
    m, loops = draft.model, defaultdict(list)
    connect, weld = int(draft.library.mjtEq.mjEQ_CONNECT), int(draft.library.mjtEq.mjEQ_WELD)
    for i in range(m.neq):
        name, type_ = draft.name_of("equality", i), m.eq_type[i]
        is_taken = type_ in (connect, weld) and m.eq_active0[i]
        if is_taken and len(parts := {*_ends(draft, i)[0]}) == 2:
            loops[i if type_ == weld else frozenset(parts)].append(i)
        else:
            text = "allowed: connect and weld of two bodies, active at the start"
            draft.leave_out(f"equality {name}", text)
    for loop in loops.values():
        first, last = (_ends(draft, i)[1][0] for i in (loop[0], loop[-1]))
        length = np.linalg.norm(last - first)
        if len(loop) == 2 and length > 1e-4 * draft.size:
            names = " and ".join(draft.name_of("equality", i) for i in loop)
            draft.notes.append(f"{names} are one revolute joint")
            _close(draft, loop[0], type="revolute", axis=digits((last - first) / length))
        else:
            for i in loop:  # a weld without a torquescale holds places alone
                is_fixed = m.eq_type[i] == weld and m.eq_data[i, 10]
                _close(draft, i, type="fixed" if is_fixed else "spherical")


def _ends(draft: Draft, equality: int) -> tuple[list[int], np.ndarray]:
    """Parts of an equality, and the place (2, 3), m, at which each of them is held."""
    m, d, mj = draft.model, draft.data, draft.library
    ids = [m.eq_obj1id[equality], m.eq_obj2id[equality]]
    if m.eq_objtype[equality] == mj.mjtObj.mjOBJ_SITE:
        return [*map(draft.part, m.site_bodyid[ids])], d.site_xpos[ids]
    sign = -1 if m.eq_type[equality] == mj.mjtEq.mjEQ_WELD else 1
    arms = d.xmat[ids].reshape(2, 3, 3) @ m.eq_data[equality, :6].reshape(2, 3, 1)[::sign]
    return [*map(draft.part, ids)], d.xpos[ids] + arms[:, :, 0]


def _close(draft: Draft, equality: int, **keys: Any) -> None:
    """Add a joint in which an equality closes a loop, which is assembled where it is open."""
    d, name = draft.data, draft.name_of("equality", equality)
    parts, places = _ends(draft, equality)
    keys["parts"] = [draft.parts[part] for part in parts]
    is_row = d.efc_type == draft.library.mjtConstraint.mjCNSTR_EQUALITY
    gap = np.abs(d.efc_pos[is_row & (d.efc_id == equality)]).max(initial=0.0)
    is_open, remedy = gap >= OPEN * draft.size, "kept as it is"
    if is_open and keys["type"] != "fixed":
        triples = zip(keys["parts"], places, parts, strict=True)
        keys["at"] = {n: draft.point(f"{name}_{n}", x, [part]) for n, x, part in triples}
        draft.table["assemble"], remedy = "true", "closed before the run"
    else:
        keys["at"] = draft.point(name, places[0], parts)
    if is_open:
        draft.notes.append(f"equality {name} is off by {gap:.3g} at the start, and {remedy}")
    draft.add("joints", name, **keys)


def _limit(
    draft: Draft, name: str, stop: str, solref: np.ndarray, solimp: np.ndarray, inverse: float
) -> dict[str, Any]:
    """Stiffness and damping of MuJoCo's soft limit: with the impedance d its force is d/A (-b v - k
    r); A, `inverse`, is the acceleration by a unit force (its documentation, Computation). Empty
    where they are not finite. name, stop: of what has it, and of what it becomes, for the note."""
    a, b = map(float, solref)
    d = float(np.clip(solimp[1], 1e-4, 0.9999))
    if inverse <= 1e-12 * draft.model.body_invweight0.max() or b == 0 < a:
        reason = f"MuJoCo's limit has no finite stiffness; add a {stop} with that of the real one"
        draft.leave_out(f"range of {name}", reason)
        return {}
    draft.notes.append(f"range of {name} is a {stop} about as soft as MuJoCo's limit")
    values = (1 / (d * a**2 * b**2), 2 / a) if a > 0 else (-a / d, -b)
    return dict(zip(("stiffness", "damping"), digits(np.array(values) / inverse), strict=True))


def add_joint_forces(draft: Draft) -> None:
    """Add what acts on joints."""
    m = draft.model
    for joint, (opening, sign, unit) in draft.openings.items():
        dof = int(m.jnt_dofadr[joint])
        rest = with_unit(sign * m.qpos_spring[m.jnt_qposadr[joint]], unit)
        sticks = {"sticks": "exactly"} if unit == "rad" else {"bristle_deflection": "0.01 mm"}
        draft.act(joint, opening, "stiffness", m.jnt_stiffness[joint], rest=rest)
        draft.act(joint, opening, "damping", m.dof_damping[dof])
        draft.act(joint, opening, "frictionloss", m.dof_frictionloss[dof], **sticks)
        if m.jnt_limited[joint]:
            lower, upper = (with_unit(x, unit) for x in sorted(sign * m.jnt_range[joint]))
            soft = m.jnt_solref[joint], m.jnt_solimp[joint], m.dof_invweight0[dof]
            if keys := _limit(draft, opening, "stop", *soft):
                keys |= {"type": "stop", "joint": opening, "lower": lower, "upper": upper}
                draft.add("actions", f"{opening}_range", **keys)


def add_tendons(draft: Draft) -> None:
    """Add spatial tendons through sites as cables, or as struts if they push as well."""
    m = draft.model
    for tendon in range(m.ntendon):
        name, first = draft.name_of("tendon", tendon), int(m.tendon_adr[tendon])
        rows = slice(first, first + int(m.tendon_num[tendon]))
        if np.any(m.wrap_type[rows] != draft.library.mjtWrap.mjWRAP_SITE):
            draft.leave_out(f"tendon {name}", "allowed: spatial tendons through sites only")
            continue
        ends = [draft.site(int(site)) for site in m.wrap_objid[rows]]
        stiffness, damping = digits([m.tendon_stiffness[tendon], m.tendon_damping[tendon]])
        if stiffness:
            _add_spring(draft, name, ends, stiffness, *digits(m.tendon_lengthspring[tendon]))
        if damping and len(ends) == 2:
            draft.add("struts", f"{name}_damper", type="damper", between=ends, damping=damping)
        elif damping:
            draft.leave_out(f"damping of tendon {name}")
        if m.tendon_limited[tendon]:
            fields = m.tendon_solref_lim, m.tendon_solimp_lim, m.tendon_invweight0
            low, rest = digits(m.tendon_range[tendon])
            text = f"{name}_range" if stiffness else name
            if keys := _limit(draft, name, "cable", *(field[tendon] for field in fields)):
                EA = rest * keys["stiffness"]
                draft.add("cables", text, through=ends, EA=EA, rest=rest)
            if low > 0:
                draft.leave_out(f"limit of tendon {name} at {low:.6g} m", "cables do not push")


def _add_spring(draft: Draft, name: str, ends: list, stiffness: float, low: float, high: float):
    """Add the spring of a tendon, which is slack between two lengths (m)."""
    if low and len(ends) == 2:
        sides = {"both ways": high} if low == high else {"push": low, "pull": high}
        for side, rest in sides.items():
            keys = {"between": ends, "stiffness": stiffness, "rest": rest, "acts": side}
            draft.add("struts", name, type="spring", **keys)
    else:
        EA = draft.parameter(f"{name}_EA", stiffness * high, "N", name)
        draft.add("cables", name, through=ends, EA=EA, rest=high)
        if low:
            draft.leave_out(f"what tendon {name} pushes with below {low:.6g} m")


def add_actuators(draft: Draft) -> None:
    """Add actuators on joints at a constant control: what stays of their force is a torque motor;
    what falls with the position is a spring, with the rate a damper."""
    m, mj = draft.model, draft.library
    biases = int(mj.mjtBias.mjBIAS_NONE), int(mj.mjtBias.mjBIAS_AFFINE)
    trunks = int(mj.mjtTrn.mjTRN_JOINT), int(mj.mjtTrn.mjTRN_JOINTINPARENT)
    for i in range(m.nactuator):
        name, joint = draft.name_of("actuator", i), int(m.actuator_trnid[i, 0])
        bias = m.actuator_biasprm[i, :3] * (m.actuator_biastype[i] == biases[1])
        is_plain = m.actuator_gaintype[i] == mj.mjtGain.mjGAIN_FIXED and bias[1:].max() <= 0
        is_plain &= m.actuator_dyntype[i] == mj.mjtDyn.mjDYN_NONE
        is_plain &= m.actuator_biastype[i] in biases and joint in draft.openings
        group = int(np.clip(m.actuator_group[i], -1, 31) % 32)
        is_off = draft.is_disabled("ACTUATION") or m.opt.disableactuator >> group & 1
        if is_off or not is_plain or m.actuator_trntype[i] not in trunks:
            text = "allowed: motors and servos of a hinge or slide, in a group that is not disabled"
            draft.leave_out(f"actuator {name}", text)
            continue
        control, (_, sign, unit) = draft.data.ctrl[m.actuator_ctrladr[i]], draft.openings[joint]
        if m.actuator_ctrllimited[i]:
            control = np.clip(control, *m.actuator_ctrlrange[i])
        gear = m.actuator_gear[i, 0]
        force = sign * gear * (m.actuator_gainprm[i, 0] * control + bias[0])
        stiffness, damping = -(gear**2) * bias[1:]
        if stiffness:
            rest = draft.parameter(f"{name}_target", force / stiffness, unit, name)
            draft.act(joint, name, "stiffness", stiffness, rest=rest)
        else:
            draft.act(joint, name, "motor", force)
        draft.act(joint, name, "damping", damping)
        draft.notes.append(f"actuator {name} has the control {control:g} all the time")
        if m.actuator_forcelimited[i] or m.jnt_actfrclimited[joint]:
            draft.leave_out(f"limit of the force of actuator {name}")


def convert(path: Path, target: Path, keyframe: str = "") -> list[str]:
    """Write the model in a file, MJCF or URDF, as the file of a structure; returns notes on what is
    not taken, or not as it is. CampaignError without `mujoco`, for a model that it cannot read, and
    for joints without an equivalent. target: file to make (.yaml); keyframe: at which the structure
    starts; "": where the model's file has its bodies."""
    if target.exists() or target.suffix not in (".yaml", ".yml"):
        raise CampaignError(f"--to {target}; allowed: a .yaml file that does not exist yet")
    draft = _read(path, keyframe)
    for step in (add_parts, add_joints, add_loops, add_joint_forces, add_tendons, add_actuators):
        step(draft)
    for site in filter(lambda i: draft.model.site(i).name, range(draft.model.nsite)):
        draft.add("record", draft.model.site(site).name, **draft.site(site))
    if len(draft.parts) == 1:
        raise CampaignError(f"{path} has no body that moves; allowed: a model with joints")
    _note_objects(draft)
    _note_urdf(draft, path)
    structure = Structure(path.stem, **{key: x for key, x in draft.table.items() if x})
    structure.build()
    lines = [f"Made from {path.name} by MuJoCo {draft.library.__version__}.", *draft.notes]
    write_text(target, "".join(f"# {line}\n" for line in lines) + structure.text())
    return draft.notes


def _read(path: Path, keyframe: str) -> Draft:
    if not path.is_file() or path.suffix in (".yaml", ".yml"):
        fault = "it is a YAML file, no model" if path.is_file() else "there is no such file"
        raise CampaignError(f"{path}: {fault}; allowed: a model, .xml (MJCF) or .urdf")
    library = load_mujoco()
    try:
        spec = library.MjSpec.from_file(str(path))
        spec.compiler.fusestatic = False
        _leave_meshes(library, spec)
        model = spec.compile()
    except (ValueError, OSError) as error:
        raise CampaignError(f"{path}: MuJoCo cannot read it: {error}") from None
    keys = [model.key(i).name for i in range(model.nkey)]
    if keyframe and keyframe not in keys:
        allowed = ", ".join(keys) or "none, as the model has no keyframe"
        raise CampaignError(f"--keyframe {keyframe} is not in {path}; allowed: {allowed}")
    draft = Draft(library, model, keys.index(keyframe) if keyframe else None)
    for key in sorted({*keys} - {keyframe}):
        draft.leave_out(f"keyframe {key}", f"the structure starts there by --keyframe {key}")
    return draft


def _leave_meshes(library: Any, spec: Any) -> None:
    """Make spheres of meshes whose mass does not count, as their files are often elsewhere."""
    is_all = spec.compiler.inertiafromgeom == library.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    for geom in spec.geoms:
        body = geom.parent
        while body.name != "world" and not body.joints:
            body = body.parent
        is_light = body.name == "world" or (geom.parent.explicitinertial and not is_all)
        if geom.meshname and is_light:
            geom.type, geom.meshname = library.mjtGeom.mjGEOM_SPHERE, ""
            geom.size = [1e-3, 0, 0]
    for mesh in [*spec.meshes]:
        if all(geom.meshname != mesh.name for geom in spec.geoms):
            spec.delete(mesh)


def _note_objects(draft: Draft) -> None:
    """Note which objects, properties and options have no part in the structure."""
    m = draft.model
    for count in OBJECTS.split():
        kind = count.replace("cam", "camera")
        for i in range(getattr(m, f"n{count}")):
            draft.leave_out(f"{kind} {draft.name_of(kind, i)}")
    geoms = np.flatnonzero(m.geom_contype | m.geom_conaffinity)
    geoms = np.concatenate([geoms, m.pair_geom1, m.pair_geom2])
    bodies = sorted({draft.name_of("body", body) for body in m.geom_bodyid[geoms]})
    if len(bodies) > 1 and not any(map(draft.is_disabled, ("CONTACT", "CONSTRAINT"))):
        draft.leave_out(f"contact of {', '.join(bodies)}", "bodies pass through each other")
    for kind, field in ((kind, field) for kind, row in FIELDS.items() for field in row.split()):
        rows = [i for i, row in enumerate(getattr(m, field)) if np.any(row)]
        rows = m.dof_jntid[rows].tolist() if field.startswith("dof") else rows
        for i in sorted(set(rows) - set(draft.openings if kind.startswith("ball") else ())):
            name = draft.name_of(kind.split()[-1], i)
            draft.leave_out(f"{field.partition('_')[2]} of {kind} {name}")
    for key in filter(lambda key: np.any(getattr(m.opt, key)), ("wind", "density", "viscosity")):
        draft.leave_out(f"option {key}")


def _note_urdf(draft: Draft, path: Path) -> None:
    """Note which elements of a file in URDF MuJoCo does not read."""
    is_urdf = b"<robot" in path.read_bytes()
    for element in ElementTree.parse(path).getroot().iter() if is_urdf else ():
        tags, name = [child.tag for child in element], element.get("name", "")
        for tag in sorted({*tags} - {*URDF.split()}, key=tags.index):
            draft.leave_out(f"<{tag}> of <{element.tag}> {name}".rstrip())
        if "collision" in tags and "inertial" not in tags:
            draft.notes.append(f"link {name} has the mass of its shapes at 1000 kg/m3")
