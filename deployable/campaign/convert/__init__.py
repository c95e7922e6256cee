"""Models in MJCF and URDF as structures' files, and structures of rigid bodies as MJCF."""

import logging
import re
from collections import defaultdict
from pathlib import Path
from typing import Any
from unicodedata import normalize
from xml.etree.ElementTree import SubElement, fromstring, indent, parse, tostring

import numpy as np

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_text
from fpm import elements as e
from fpm.elements.openings.opening import moving_at_start
from fpm.solver.start import consistent_scene
from fpm.structures.names import Names
from fpm.structures.reading import Problems, commas
from fpm.structures.structure import Structure

JOINTS = {"spherical": "ball", "prismatic": "slide", "revolute": "hinge"}
"""Our joints, in the order of MuJoCo's types from 1 on, which are called otherwise."""

ACTIONS: dict[str, tuple] = {
    "stiffness": (e.TorsionSpring, "torsion spring, stiffness, N m/rad", "spring, stiffness, N/m"),
    "damping": (e.Damper, "damper, damping, N m s/rad", "damper, damping, N s/m"),
    "frictionloss": (e.Friction, "friction, moment, N m", "friction, force, N"),
    "motor": (e.TorqueMotor, "torque motor, torque, N m", "torque motor, force, N"),
}
"""What acts on a joint, by MuJoCo's word: element; type, key, unit on an angle, and on a slide."""

OPEN = 1e-7  # gap of a loop at the start, as a share of the model's extent, that counts as open
GROUPS = "gravity parameters points bodies joints actions cables struts initial_velocities record"
SKIPPED = """asset axis child collision color compiler connect contact equality fixed geom inertial
keyframe material mesh origin parent site size statistic visual weld"""
INNER = "actuator custom default deformable extension frame link mujoco sensor tendon worldbody"
SOLVER = "|class|name|group|user|sol.*"
EQUIVALENTS = dict.fromkeys(INNER.split(), ".*") | {
    "body": f"childclass|pos|quat|mocap{SOLVER}",
    "dynamics": "damping|friction",
    "flag": "(?!spring|damper|frictionloss|limit|equality|clampctrl|actuation|constraint).*",
    "general": f"joint.*|site|tendon|body|c.*|gear|input|(gain|bias|dyn)(prm|type){SOLVER}",
    "joint": f"type|pos|axis|ref|range|limited|stiffness|springref|damping|frictionloss{SOLVER}",
    "limit": "lower|upper",
    "option": "(?!wind|density|viscosity|actuatorgroupdisable).*",
    "spatial": f"stiffness|springlength|damping|width|material|rgba{SOLVER}",
}
"""Attributes of elements of MJCF and URDF that are taken, or without effect on a motion. Others are
noted by name, but for what is in elements that are `SKIPPED`: looks, and what `Draft` notes."""


def load_mujoco() -> Any:
    """Return the library, whose warnings go to the log. CampaignError where it is missing."""
    try:
        import mujoco
    except ImportError:
        text = "MJCF and URDF need mujoco: pip install 'deployable-intervals[mjcf]'"
        raise CampaignError(text) from None
    mujoco.set_mju_user_warning(logging.getLogger("deployable").warning)
    return mujoco


def convert(path: Path, target: Path, keyframe: str = "") -> list[str]:
    """Write the model in a file, MJCF or URDF, as the file of a structure; returns notes on what is
    not taken, or not as it is. CampaignError for a model that cannot be read. target: file to make
    (.yaml); keyframe: at which the structure starts; "": where the model's file has its bodies."""
    if target.exists() or target.suffix not in (".yaml", ".yml"):
        raise CampaignError(f"--to {target}; allowed: a .yaml file that does not exist yet")
    if not path.is_file() or path.suffix in (".yaml", ".yml", ".xacro", ".sdf"):
        raise CampaignError(f"{path}; allowed: the file of a model, .xml (MJCF) or .urdf")
    draft = Draft(path, keyframe)
    structure = Structure(path.stem, **{key: x for key, x in draft.table.items() if x})
    structure.build()
    lines = [f"Made from {path.name} by MuJoCo {draft.mj.__version__}.", *draft.notes]
    write_text(target, "".join(f"# {line}\n" for line in lines) + structure.text())
    return draft.notes


def _digits(values: Any) -> Any:
    """Return numbers with 12 digits, and 0 for those that are rounding beside the largest."""
    least = 1e-13 * np.abs(values).max()
    numbers = [float(f"{x:.12g}") if abs(x) > least else 0.0 for x in np.ravel(values)]
    return numbers if np.ndim(values) else numbers[0]


def _with_unit(value: float, unit: str) -> str:
    return f"{np.degrees(value):.14g} deg" if unit == "rad" else f"{value:.12g} {unit}"


class Draft:
    """A structure made of the model in a file at a keyframe. mj: the module `mujoco`; m, d: MjModel
    and MjData at the start; table: of the structure's file; notes: what is not taken, or not as it
    is; parts: names by body, of those welded together the same; openings: name and unit, by hinge
    or slide of the model; sites: part and point of each."""

    def __init__(self, path: Path, keyframe: str):
        self.mj, self.notes = (mj := load_mujoco()), list[str]()
        try:
            spec = mj.MjSpec.from_file(str(path))
            spec.compiler.fusestatic = False
            self._leave_meshes(spec)
            self.m = m = spec.compile()
        except (ValueError, OSError) as error:
            raise CampaignError(f"{path}: MuJoCo cannot read it: {error}") from None
        contacts = np.any(m.geom_contype[:, None] & m.geom_conaffinity) or m.npair
        if contacts and not m.opt.disableflags & mj.mjtDisableBit.mjDSBL_CONTACT:
            self.leave_out("contact of geoms", "bodies pass through each other")
        self.d = mj.MjData(m)
        keys = [self.name_of("key", i) for i in range(m.nkey)]
        if keyframe in keys:
            mj.mj_resetDataKeyframe(m, self.d, keys.index(keyframe))
        elif keyframe:
            raise CampaignError(f"--keyframe {keyframe} is not in {path}; allowed: {commas(keys)}")
        for key in sorted({*keys} - {keyframe}):
            self.leave_out(f"keyframe {key}", f"the structure starts there by --keyframe {key}")
        mj.mj_forward(m, self.d)
        self.table: dict[str, Any] = {group: {} for group in GROUPS.split()}
        if not m.opt.disableflags & mj.mjtDisableBit.mjDSBL_GRAVITY:
            self.table["gravity"] = _digits(m.opt.gravity)
        self.parts, self.sites = np.array(["ground"] * m.nbody, object), list[dict]()
        self.openings: dict[int, tuple[str, str]] = {}
        self._names = Names(Problems(""), {})
        self._add_bodies()
        self._add_joints()
        if (xml := parse(path).getroot()).tag != "robot":  # whose equalities are of `mimic`
            xml = fromstring(spec.to_xml())
            self._add_loops()
        self._add_tendons()
        self._add_actuators()
        if not self.table["bodies"]:
            raise CampaignError(f"{path} has no body that moves; allowed: a model with joints")
        self._note_others(xml)

    def _leave_meshes(self, spec: Any) -> None:
        """Make spheres of meshes whose mass does not count, as their files are often elsewhere."""
        is_all = spec.compiler.inertiafromgeom == self.mj.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
        fixed = [spec.worldbody, *(body for body in spec.worldbody.bodies if not body.joints)]
        for geom in (geom for geom in spec.geoms if geom.meshname):
            if geom.parent in fixed or (geom.parent.explicitinertial and not is_all):
                geom.type, geom.meshname, geom.size = self.mj.mjtGeom.mjGEOM_SPHERE, "", [1] * 3
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
        keys = {"value": _digits(value), "unit": unit, "description": f"of {owner}"}
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
        name = self.add("points", text, place=_digits(place))
        for part in {*parts} - {"ground"}:
            self.table["bodies"][part].setdefault("points", []).append(name)
        return name

    def _add_bodies(self) -> None:
        """Add bodies that move, each with all that is welded to it, and points of all sites."""
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
            values, (x, _, z) = (pair := np.linalg.eigh(tensor))[0], pair[1].T
            keys = {"centre": self.point(f"{names[0]}_centre", centre, []), "x": _digits(x)}
            keys |= {"mass": _digits(masses.sum()), "inertia": _digits(values), "up": _digits(z)}
            name = self.add("bodies", names[0], **keys)
            self.parts[bodies] = name
            jacobians = np.zeros((2, 3, m.nv))
            self.mj.mj_jac(m, d, *jacobians, centre, part)
            velocity, spin = jacobians @ d.qvel
            if velocity.any() or spin.any() or m.jnt_type[m.body_jntadr[part]] == 0:  # free
                motion = {"velocity": _digits(velocity), "spin": _digits(spin)}
                self.add("initial_velocities", name, part=name, about=keys["centre"], **motion)
        for i in range(m.nsite):
            part, name = self.parts[m.site_bodyid[i]], self.name_of("site", i)
            self.sites.append({"part": part, "at": self.point(name, d.site_xpos[i], [part])})
            if m.site(i).name:
                self.add("record", name, **self.sites[i])

    def _add_joints(self) -> None:
        """Add joints of the tree with what acts on them. A limit becomes a stop with the stiffness
        and damping of MuJoCo's beyond its width (its documentation, Computation)."""
        m, d = self.m, self.d
        if names := [self.name_of("body", i) for i in np.flatnonzero(m.body_jntnum > 1)]:
            allowed = "one for each body; put a light body with mass and inertia between two joints"
            raise CampaignError(f"several joints of body {', '.join(names)}; allowed: {allowed}")
        for i, kind in enumerate(m.jnt_type):
            joint, body, name = m.joint(i), m.jnt_bodyid[i], self.name_of("joint", i)
            parts, unit = [*self.parts[[m.body_parentid[body], body]]], "m" if kind == 2 else "rad"
            keys: dict[str, Any] = {"type": [*JOINTS][kind - 1], "parts": parts}
            if kind > 1:
                place = _with_unit(d.qpos[joint.qposadr[0]], unit)
                keys |= {"axis": _digits(d.xaxis[i]), "opening": place}
            if kind > 0:
                name = self.add("joints", name, at=self.point(name, d.xanchor[i], parts), **keys)
            self.openings[i] = name, unit
            keys = {"stiffness": {"rest": _with_unit(joint.qpos_spring[0], unit)}}
            keys["frictionloss"] = {"sticks": "exactly"}
            for word in ("stiffness", "damping", "frictionloss"):
                value = getattr(joint, word)[0]
                if value and kind > 1:
                    self.act(i, name, word, value, **keys.get(word, {}))
                elif value:
                    self.leave_out(f"{word} of joint {name}", "allowed: that of hinges and slides")
            a, b = joint.solref
            if joint.limited[0] and (kind < 2 or b == 0 < a):
                text = "allowed: that of hinges and slides, with a damping ratio above 0"
                self.leave_out(f"range of joint {name}", text)
            elif joint.limited[0]:
                self.notes.append(f"range of {name} is a stop about as soft as MuJoCo's limit")
                soft = np.array([1 / (a * b) ** 2, 2 / a] if a > 0 else [-a, -b])
                stiffness, damping = _digits(soft / joint.invweight0[0])
                lower, upper = (_with_unit(x, unit) for x in joint.range)
                keys = {"lower": lower, "upper": upper, "stiffness": stiffness, "damping": damping}
                self.add("actions", f"{name}_range", type="stop", joint=name, **keys)

    def _add_loops(self) -> None:
        """Add joints for equalities: `weld` is fixed, `connect` spherical, two of the same parts a
        revolute joint about the line through their points. Loops that are open are assembled."""
        m, d, mj = self.m, self.d, self.mj
        connects: dict[frozenset, tuple] = {}
        for i, kind in enumerate(m.eq_type):
            name, ids = self.name_of("equality", i), [m.eq_obj1id[i], m.eq_obj2id[i]]
            rows = (d.efc_type == mj.mjtConstraint.mjCNSTR_EQUALITY) & (d.efc_id == i)
            gaps = np.abs(d.efc_pos[rows])  # three places; of a weld also three angles
            is_site = m.eq_objtype[i] == mj.mjtObj.mjOBJ_SITE
            bodies = m.site_bodyid[ids] if is_site else ids if kind < 2 else [0, 0]
            is_turned, parts = gaps[3:].max(initial=0.0) >= OPEN, [self.parts[b] for b in bodies]
            if not m.eq_active0[i] or is_turned or parts[0] == parts[1]:
                text = "connect and weld of two parts, active at the start, where no weld is turned"
                self.leave_out(f"equality {name}", f"allowed: {text}")
                continue
            arms = m.eq_data[i, :6].reshape(2, 3, 1)[:: -1 if kind else 1]
            places = d.xpos[bodies] + (d.xmat[bodies].reshape(2, 3, 3) @ arms)[:, :, 0]
            places = d.site_xpos[ids] if is_site else places
            is_open, pair = gaps.max(initial=0.0) >= OPEN * m.stat.extent, frozenset(parts)
            joint, place = connects.pop(pair, ("", places[0]))
            length = np.linalg.norm(line := places[0] - place)
            if kind == 0 and not is_open and length > 1e-4 * m.stat.extent:
                self.table["joints"][joint].update(type="revolute", axis=_digits(line / length))
                self.notes.append(f"{joint} and {name} are one revolute joint")
                continue
            if is_open:
                self.table["assemble"] = "true"
                self.notes.append(f"equality {name} is open at the start, and closed before a run")
                ends = zip(parts, places, strict=True)
                point: Any = {part: self.point(f"{name}_{part}", x, [part]) for part, x in ends}
            else:
                point = self.point(name, places[0], parts)
            type_ = "fixed" if kind and m.eq_data[i, 10] else "spherical"  # torquescale
            joint = self.add("joints", name, type=type_, parts=parts, at=point)
            if kind == 0 and not is_open:
                connects[pair] = joint, places[0]

    def _add_tendons(self) -> None:
        """Add spatial tendons through sites as cables, or as struts if they push as well."""
        m = self.m
        for i in range(m.ntendon):
            name, rows = self.name_of("tendon", i), m.tendon_adr[i] + np.arange(m.tendon_num[i])
            stiffness, damping = m.tendon_stiffness[i], m.tendon_damping[i]
            low, high = _digits(m.tendon_lengthspring[i] * (stiffness > 0))  # slack between these
            is_rope = np.all(m.wrap_type[rows] == self.mj.mjtWrap.mjWRAP_SITE)
            ends = [self.sites[site] for site in m.wrap_objid[rows]] if is_rope else []
            is_inner, is_strut = len({end["part"] for end in ends}) < 2, damping or low
            if is_inner or (stiffness and not high) or (is_strut and len(rows) > 2):
                text = 'between two parts, with more sites with springlength="0 L" and no damping'
                self.leave_out(f"tendon {name}", f"allowed: spatial tendons {text}")
                continue
            if low:
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

    def _add_actuators(self) -> None:
        """Add actuators on joints at a constant control: what stays of their force is a torque
        motor; what falls with the position is a spring, with the rate a damper."""
        motors: dict[int, dict[str, float]] = defaultdict(dict)  # forces, by joint: one motor each
        for i in range(self.m.nactuator):
            a, name = self.m.actuator(i), self.name_of("actuator", i)
            bias, joint = a.biasprm[:3] * a.biastype[0], int(a.trnid[0])
            # on a hinge or slide, or in its parent, with no bias or an affine one
            is_plain = a.trntype[0] <= 1 and a.biastype[0] <= 1 and self.m.jnt_type[joint] > 1
            if not is_plain or a.gaintype[0] or a.dyntype[0] or bias[1:].max() > 0:
                self.leave_out(f"actuator {name}", "allowed: motors and servos of a hinge or slide")
                continue
            control = self.d.ctrl[self.m.actuator_ctrladr[i]]
            control = np.clip(control, *a.ctrlrange) if a.ctrllimited[0] else control
            force = a.gear[0] * (a.gainprm[0] * control + bias[0])
            stiffness, damping = -(a.gear[0] ** 2) * bias[1:]
            self.notes.append(f"actuator {name} has the control {control:g} all the time")
            if stiffness:
                unit = self.openings[joint][1]
                rest = self.parameter(f"{name}_target", force / stiffness, unit, name)
                self.act(joint, name, "stiffness", stiffness, rest=rest)
            else:
                motors[joint][name] = force
            if damping:
                self.act(joint, name, "damping", damping)
        for joint, forces in motors.items():
            self.act(joint, "_".join(forces), "motor", sum(forces.values()))

    def _note_others(self, parent: Any) -> None:
        """Note what is in an element of the model and not in the table of what is `EQUIVALENTS`."""
        for element in (child for child in parent if child.tag not in SKIPPED.split()):
            name = f"{element.tag} {element.get('name') or parent.get('name', '')}".strip()
            if element.tag not in EQUIVALENTS:
                self.leave_out(name)
                continue
            for key, text in element.attrib.items():
                is_poly = key in ("stiffness", "damping") and any(map(float, text.split()[1:]))
                if is_poly or not re.fullmatch(EQUIVALENTS[element.tag], key):
                    self.leave_out(f"{'nonlinear part of ' * is_poly}{key} of {name}")
            self._note_others(element)


EMPTY = """<mujoco><compiler angle="radian" autolimits="true"/>
<option timestep="1e-4" integrator="RK4" tolerance="1e-14" iterations="200"/><default>
<joint solreffriction="2e-4 1" solimpfriction="0.9999 0.9999 1e-3" solimplimit="1e-4 1e-4 1e-3"/>
<equality solref="2e-3 1" solimp="0.9999 0.9999 1e-3"/></default>
<worldbody/><equality/><tendon/><actuator/><keyframe/></mujoco>"""
"""Loops and friction of MuJoCo are soft: by these numbers they differ little from exact ones. Loads
act on in a limit, as in a stop, by its least impedance."""

CLOSING = {"fixed": ["weld"], "spherical": ["connect"], "revolute": ["connect", "connect"]}
KINDS = [row[0] for row in ACTIONS.values()]
CONDITIONS: dict = dict.fromkeys([*KINDS, e.Stop, e.Gravity], lambda element: True) | {
    e.Damping: lambda damping: not damping.rate,
    e.Hinge: lambda hinge: hinge.type in JOINTS and not hinge.support,
    e.Joint: lambda joint: joint.type in ("spherical", "fixed"),
    e.Friction: lambda friction: friction.is_exact,
    e.TorqueMotor: lambda motor: np.isinf(motor.no_load),
    e.Cable: lambda cable: not cable.has_friction and cable.drum < 0,
    e.Strut: lambda strut: len(strut.lengths) == 1 and not strut.forces[0],
}
"""Kinds of element that have an equivalent, and when; besides, none may follow a curve of time."""


def write_mjcf(run: Any, folder: Path, frames: int) -> list[Path]:
    """Write the structure of a run at its start as `<run.name>.xml` into `folder`, and its motion
    as the keyframe `start`. CampaignError for what has no equivalent. frames: not used."""
    scene = consistent_scene(run.scene)
    names = []
    for element in (element for elements in scene.kinds.values() for element in elements):
        noun = {e.Beams: "bar", e.Hinge: "joint", e.Joint: "joint"}.get(type(element))
        noun = "support" if getattr(element, "type", "") == "held" else noun
        has_equivalent = CONDITIONS.get(type(element), lambda element: False)(element)
        if not has_equivalent or getattr(element, "curve", -1) >= 0:
            title = f"{noun} {element.name}" if noun else element.title(scene)
            names.append(title or type(element).__name__.lower())
    is_held = np.any(scene.fixed, axis=1) & ~np.all(scene.fixed, axis=1)
    names += [f"the support of {name}" for name, p in scene.bodies.items() if is_held[p]]
    _refuse(names, "rigid bodies, and what acts without memory or curve (see docs/convert.md)")
    try:
        root = Tree(scene, load_mujoco()).root
    except ValueError as error:
        raise CampaignError(f"MuJoCo does not take {run.name}: {error}") from None
    indent(_put(root, model=run.name))
    write_text(folder / f"{run.name}.xml", tostring(root, encoding="unicode") + "\n")
    return [folder / f"{run.name}.xml"]


def _refuse(names: list[str], allowed: str) -> None:
    if names:
        text = f"MJCF has no equivalent of {commas(dict.fromkeys(names), 8)}; allowed: {allowed}"
        raise CampaignError(text)


def _put(element: Any, tag: str = "", **keys: Any) -> Any:
    """Set attributes (texts, or numbers with 15 digits) of an XML element, or of a new one in it
    with a tag; returns that element."""
    element = SubElement(element, tag) if tag else element
    for key, value in keys.items():
        is_text = isinstance(value, str)
        element.set(key, value if is_text else " ".join(f"{x + 0.0:.15g}" for x in np.ravel(value)))
    return element


class Tree:
    """The XML of a scene. Bodies hang on each other in a tree, each by one joint; joints that are
    left over close loops, by equalities. All frames are the global one at the start. root: the XML;
    names: of bodies that move, by particle; bodies: XML of each and of the ground, likewise."""

    def __init__(self, scene: Any, mujoco: Any):
        self.scene, self.root = scene, (root := fromstring(EMPTY))
        _, option, _, self.world, self.equality, self.tendon, self.actuator, keyframe = root
        _put(option, gravity=scene.gravity)
        is_ground = scene.fixed.all(axis=1)
        self.names = {p: name for name, p in scene.bodies.items() if not is_ground[p]}
        self.bodies = dict.fromkeys([-1, *np.flatnonzero(is_ground)], self.world)
        self._add_loops(self._add_bodies())
        self._add_tendons()
        for name, beam in scene.points.items():
            self._add_site(name, beam)
        motors = e.TorqueMotor.find(scene)
        for i, motor in enumerate(motors):
            joint = scene.hinges[motor.hinge].name
            _put(self.actuator, "motor", name=f"{joint}_motor{i or ''}", joint=joint)
        model = mujoco.MjModel.from_xml_string(tostring(root, encoding="unicode"))
        self._add_stops(model)
        data, motion = mujoco.MjData(model), moving_at_start(scene)
        mujoco.mj_forward(model, data)
        jacobians = np.zeros((len(self.names), 2, 3, model.nv))
        for jacobian, name in zip(jacobians, self.names.values(), strict=True):
            mujoco.mj_jacBodyCom(model, data, *jacobian, model.body(name).id)
        rates = np.stack([motion.velocity, motion.spin], axis=1)[[*self.names]]
        qvel = np.linalg.lstsq(jacobians.reshape(-1, model.nv), rates.ravel())[0]
        _put(keyframe, "key", name="start", qvel=qvel, ctrl=[motor.torque for motor in motors])

    def _add_bodies(self) -> list:
        """Add all bodies, each on one that is there already, by a joint on which something acts if
        there is one, or free. Returns the joints that are left over, which close loops."""
        scene, bodies = self.scene, self.bodies
        acts = {x.hinge for kind in (*KINDS, e.Stop) for x in kind.find(scene)}
        joints = [*scene.hinges, *scene.kinds.get(e.Joint, [])]
        closing = [x for i, x in enumerate(joints) if i not in acts and x.type in CLOSING]
        joints.sort(key=lambda joint: joint in closing)
        while particles := [p for p in self.names if p not in bodies]:
            ready = (j for j in joints if sum(p in bodies for p in j.particles) == 1)
            parent, child, joint = -1, particles[0], next(ready, None)
            if joint:
                joints.remove(joint)
                parent, child = joint.particles[:: -1 if joint.particles[1] in bodies else 1]
            body = bodies[child] = _put(bodies[parent], "body", name=self.names[child])
            inertial = _put(body, "inertial", pos=scene.position[child], mass=scene.mass[child])
            _put(inertial, xyaxes=scene.frame[child].T[:2], diaginertia=scene.inertia[child])
            if not joint:
                _put(body, "freejoint", name=f"{self.names[child]}_free")
            elif joint.type in JOINTS:
                self._add_joint(body, joint, 1 if child == joint.particles[1] else -1)
        names = [f"the loop of {joint.joint}" for joint in joints if joint not in closing]
        _refuse(names, "loops with a revolute, spherical or fixed joint on which nothing acts")
        return joints

    def _add_joint(self, body: Any, joint: Any, sign: int) -> None:
        """Add the joint by which a body hangs on another; sign: -1 if it is the first part."""
        scene, place = self.scene, joint.beams[1].end_in(self.scene)
        element = _put(body, "joint", name=joint.joint, type=JOINTS[joint.type], pos=place)
        if isinstance(joint, e.Hinge):
            axis, moment = sign * scene.frame[joint.particles[0]] @ joint.axes[0], 0.0
            _put(element, axis=axis, ref=joint.opening)
            for word, (kind, words, _) in [*ACTIONS.items()][:3]:
                actions = [x for x in kind.find(scene) if scene.hinges[x.hinge] is joint]
                _put(element, **{word: sum(getattr(x, words.split(", ")[1]) for x in actions)})
                moment += sum(x.stiffness * x.rest for x in actions if word == "stiffness")
            _put(element, springref=moment / (float(element.get("stiffness")) or 1.0))

    def _add_site(self, name: str, beam: Any) -> None:
        _put(self.bodies[beam.particle], "site", name=name, pos=beam.end_in(self.scene), size=0.005)

    def _add_loops(self, joints: list) -> None:
        """Add equalities for joints; the second of a revolute one lies further along its axis."""
        for joint in joints:
            first, second = (self.names.get(p, "world") for p in joint.particles)
            axis = self.scene.frame[joint.particles[0]] @ joint.axes[0]
            for i, tag in enumerate(CLOSING[joint.type]):
                keys = {"name": joint.name + i * "_axis", "body1": first, "body2": second}
                equality = _put(self.equality, tag, **keys)
                if tag == "connect":
                    step = 0.2 * i * np.ptp(self.scene.position) * axis
                    _put(equality, anchor=joint.beams[0].end_in(self.scene) + step)

    def _add_tendons(self) -> None:
        """Add cables and struts, with the lengths between which each is slack."""
        for element in (*e.Cable.find(self.scene), *e.Strut.find(self.scene)):
            if isinstance(element, e.Cable):
                push, pull, rest = 0.0, -element.stiffness / element.rest, element.rest
            else:
                (push, pull), rest = element.slopes, element.lengths[0]
            slack = [rest if push or not pull else 0.0, rest if pull or not push else 1e6]
            tendon = _put(self.tendon, "spatial", name=element.name, stiffness=-min(push, pull))
            _put(tendon, springlength=slack, damping=getattr(element, "damping", 0.0))
            for i, beam in enumerate(element.beams):
                self._add_site(f"{element.name}_{i}", beam)
                _put(tendon, "site", site=f"{element.name}_{i}")

    def _add_stops(self, model: Any) -> None:
        """Add stops as ranges of joints, with stiffness and damping in the terms of the soft limits
        of MuJoCo, which has the inverse weights of joints in its model."""
        for i, hinge in enumerate(self.scene.hinges):
            stops = [stop for stop in e.Stop.find(self.scene) if stop.hinge == i]
            values = {(stop.stiffness, stop.damping) for stop in stops}
            ends = {"below": -1e3, "above": 1e3} | {stop.side: stop.angle for stop in stops}
            if len(values) > 1 or len({stop.side for stop in stops}) < len(stops):
                _refuse([f"the stops of {hinge.name}"], "one at each end, equally stiff and damped")
            for pair in values:
                weight = model.dof_invweight0[model.joint(hinge.name).dofadr[0]]
                joint = self.root.find(f".//joint[@name='{hinge.name}']")
                _put(joint, range=[*ends.values()], solreflimit=-weight * np.array(pair))
