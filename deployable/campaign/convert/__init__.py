"""MJCF and URDF models as structures' files: what is not taken is listed."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from deployable.campaign.convert.draft import GROUPS, Draft
from deployable.campaign.convert.forces import add_actuators, add_joint_forces, add_tendons
from deployable.campaign.convert.parts import add_joints, add_loops, add_parts
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_text

FLAGS = "CONSTRAINT EQUALITY FRICTIONLOSS LIMIT SPRING DAMPER ACTUATION CLAMPCTRL"
URDF = (
    "robot link inertial origin mass inertia visual collision geometry box cylinder sphere capsule "
    "mesh material color texture joint parent child axis limit dynamics mimic mujoco compiler"
)
"""Elements of URDF that MuJoCo reads, or that only say how things look."""

OBJECTS = "flex", "plugin", "sensor", "camera", "light", "skin", "numeric", "text", "tuple"

FIELDS = {
    "joint": "jnt_stiffnesspoly jnt_springyield jnt_margin dof_armature dof_dampingpoly",
    "ball or free joint": "jnt_stiffness jnt_limited dof_damping dof_frictionloss",
    "tendon": "tendon_frictionloss tendon_armature tendon_springyield tendon_stiffnesspoly "
    "tendon_dampingpoly tendon_margin",
    "actuator": "actuator_armature actuator_damping actuator_delay",
    "body": "body_gravcomp",
}
"""`OBJECTS` are not taken, nor are these fields of others where they are not 0."""


def convert(path: Path, target: Path, keyframe: str = "") -> list[str]:
    """Write the model in a file, MJCF or URDF, as the file of a structure; returns notes on what is
    not taken, or not as it is. CampaignError without `mujoco`, for a model that it cannot read, and
    for joints without an equivalent. target: file to make (.yaml); keyframe: at which the structure
    starts; "": where the model's file has its bodies."""
    try:
        import mujoco
    except ImportError:
        text = "MJCF and URDF need mujoco: pip install 'deployable-intervals[mjcf]'"
        raise CampaignError(text) from None
    if target.exists() or target.suffix not in (".yaml", ".yml"):
        raise CampaignError(f"--to {target}; allowed: a .yaml file that does not exist yet")
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        spec.compiler.fusestatic = False
        _leave_meshes(mujoco, spec)
        model = spec.compile()
    except (ValueError, OSError) as error:
        raise CampaignError(f"{path}: MuJoCo cannot read it: {error}") from None
    data, keys = mujoco.MjData(model), [model.key(i).name for i in range(model.nkey)]
    if keyframe and keyframe not in keys:
        allowed = ", ".join(keys) or "none, as the model has no keyframe"
        raise CampaignError(f"--keyframe {keyframe} is not in {path}; allowed: {allowed}")
    if keyframe:
        mujoco.mj_resetDataKeyframe(model, data, keys.index(keyframe))
    mujoco.mj_forward(model, data)
    draft = Draft(mujoco, model, data, path.stem)
    for key in sorted({*keys} - {keyframe}):
        draft.leave_out(f"keyframe {key}", f"the structure starts there by --keyframe {key}")
    for step in (add_parts, add_joints, add_loops, add_joint_forces, add_tendons, add_actuators):
        step(draft)
    if len(draft.parts) == 1:
        raise CampaignError(f"{path} has no body that moves; allowed: a model with joints")
    for site in range(model.nsite):
        if name := model.site(site).name:
            draft.add("record", name, **draft.site(site))
    _note_rest(draft, path)
    table = draft.structure.table
    draft.structure.table = {key: x for key, x in table.items() if x or key not in GROUPS}
    draft.structure.build()
    lines = [f"Made from {path.name} by MuJoCo {mujoco.__version__}.", *draft.notes]
    write_text(target, "".join(f"# {line}\n" for line in lines) + draft.structure.text())
    return draft.notes


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


def _note_rest(draft: Draft, path: Path) -> None:
    """Note what of the model has no part in the structure."""
    m = draft.model
    for kind in OBJECTS:
        for i in range(m.ncam if kind == "camera" else getattr(m, f"n{kind}")):
            draft.leave_out(f"{kind} {draft.name_of(kind, i)}")
    for kind, fields in FIELDS.items():
        for field in fields.split():
            rows = [i for i, row in enumerate(getattr(m, field)) if np.any(row)]
            rows = m.dof_jntid[rows].tolist() if field.startswith("dof") else rows
            for i in sorted(set(rows) - set(draft.openings if kind.startswith("ball") else ())):
                name = draft.name_of(kind.split()[-1], i)
                draft.leave_out(f"{field.partition('_')[2]} of {kind} {name}")
    geoms = np.flatnonzero(m.geom_contype | m.geom_conaffinity)
    geoms = np.concatenate([geoms, m.pair_geom1, m.pair_geom2])
    bodies = sorted({draft.name_of("body", body) for body in m.geom_bodyid[geoms]})
    if len(bodies) > 1 and not draft.is_disabled("CONTACT"):
        draft.leave_out(f"contact of {', '.join(bodies)}", "bodies pass through each other")
    options = [key for key in ("wind", "density", "viscosity") if np.any(getattr(m.opt, key))]
    flags = [flag.lower() for flag in FLAGS.split() if draft.is_disabled(flag)]
    for text in (*(f"option {key}" for key in options), *(f"flag {x}=disable" for x in flags)):
        draft.leave_out(text)
    is_urdf = b"<robot" in path.read_bytes()
    for element in ElementTree.parse(path).getroot().iter() if is_urdf else ():
        tags, name = [child.tag for child in element], element.get("name", "")
        for tag in sorted({*tags} - {*URDF.split()}, key=tags.index):
            draft.leave_out(f"<{tag}> of <{element.tag}> {name}".rstrip())
        if "collision" in tags and "inertial" not in tags:
            draft.notes.append(f"link {name} has the mass of its shapes at 1000 kg/m3")
