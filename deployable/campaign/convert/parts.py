"""Bodies and joints of a MuJoCo model, in its tree and where equalities close loops."""

from collections import defaultdict

import numpy as np

from deployable.campaign.convert.draft import Draft, digits, with_unit
from deployable.campaign.errors import CampaignError

NORMAL = 1e-6
"""Cosine up to which directions are normal to each other, as in structures' files."""

TYPES: dict[str, tuple[str, tuple[str, ...]]] = {
    "b": ("spherical", ()), "h": ("revolute", ("",)), "s": ("prismatic", ("",)),
    "hhn": ("universal", ("_axis", "_other")), "shp": ("cylindrical", ("_slide", "_turn")),
    "shn": ("pin in slot", ("_slide", "_turn")), "sshnnn": ("planar", ("_x", "_y", "_turn")),
}  # fmt: skip
"""Joints with the suffixes of their openings, by what they stand for: a ball, slides and hinges,
with axes that are normal (n) or parallel (p), pair by pair."""

OPEN = 1e-7
"""Gap of a loop at the start, as a share of the model's size, from which on it counts as open."""


def add_parts(draft: Draft) -> None:
    """Add each part as a body, with the mass and inertia of all that is welded to it."""
    m, d, members = draft.model, draft.data, defaultdict(list)
    for body in range(1, m.nbody):
        members[draft.part(body)].append(body)
    for body in members.pop(0, ()):
        draft.notes.append(f"body {draft.name_of('body', body)} is fixed to the ground")
    for part, bodies in members.items():
        names = [draft.name_of("body", body) for body in bodies]
        draft.notes += [f"body {name} is held rigidly on {names[0]}" for name in names[1:]]
        masses = m.body_mass[bodies]
        centre = masses @ d.xipos[bodies] / masses.sum()
        tensor = np.zeros((3, 3))
        for body, mass in zip(bodies, masses, strict=True):
            axes, arm = d.ximat[body].reshape(3, 3), d.xipos[body] - centre
            tensor += axes * m.body_inertia[body] @ axes.T
            tensor += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        point = draft.point(f"{names[0]}_centre", centre)
        keys = {"mass": digits([masses.sum()])[0], "centre": point, **_inertia(tensor)}
        name = draft.parts[part] = draft.add("bodies", names[0], **keys)
        motion = np.zeros(6)
        draft.library.mj_objectVelocity(m, d, draft.code("mjtObj.mjOBJ_XBODY"), part, motion, 0)
        if motion.any():
            spin, size = motion[:3], np.abs(motion).max()
            velocity = digits(motion[3:] + np.cross(spin, centre - d.xpos[part]), size)
            keys = {"part": name, "velocity": velocity, "spin": digits(spin, size)}
            draft.add("initial_velocities", name, about=point, **keys)


def _inertia(tensor: np.ndarray) -> dict:
    """Keys of a body for an inertia tensor (3, 3), in global axes if they are principal."""
    values, axes = np.diagonal(tensor), np.eye(3)
    if np.abs(tensor - np.diag(values)).max() < 1e-10 * values.max():
        return {"inertia": digits(values, 0.0)}
    values, axes = np.linalg.eigh(tensor)
    x, z = axes[:, 0], np.cross(axes[:, 0], axes[:, 1])
    return {"inertia": digits(values, 0.0), "x": digits(x), "up": digits(z)}


def add_joints(draft: Draft) -> None:
    """Add the joints of the tree; CampaignError where those of one body have no equivalent."""
    m, d, problems = draft.model, draft.data, []
    for part in list(draft.parts)[1:]:
        joints = list(range(m.body_jntadr[part], m.body_jntadr[part] + m.body_jntnum[part]))
        parent, sign = draft.part(m.body_parentid[part]), 1
        pair, kinds = (parent, part), "".join("fbsh"[m.jnt_type[joint]] for joint in joints)
        if kinds == "f":
            continue
        names = [draft.name_of("joint", joint) for joint in joints]
        if kinds in ("hs", "hss"):  # seen from the second part, slides come first
            joints, kinds, pair, sign = joints[::-1], kinds[::-1], pair[::-1], -1
        places = d.xanchor[joints]
        equivalent = _equivalent(kinds, sign * d.xaxis[joints], d.qpos[m.jnt_qposadr[joints]])
        if not equivalent or (kinds == "hh" and np.ptp(places, axis=0).max() > OPEN * draft.size):
            problems.append(f"body {draft.parts[part]} has the joints {', '.join(names)}")
            continue
        keys, signs = equivalent
        text = names[0] if len(names) == 1 else f"{draft.parts[part]}_joint"
        keys |= {"parts": [draft.parts[p] for p in pair]}
        keys |= {"at": draft.point(text, places[-1], parent, part)}
        name = draft.add("joints", text, **keys)
        for joint, kind, (suffix, sign) in zip(joints, kinds, signs.items(), strict=False):
            draft.openings[joint] = name + suffix, sign, "rad" if kind == "h" else "m"
            if suffix:
                text = draft.name_of("joint", joint)
                draft.notes.append(f"joint {text} is the opening {name + suffix}")
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
    relations = "".join(np.select([is_normal, is_parallel], ["n", "p"], "-"))
    if kinds + relations not in TYPES:
        return None
    type_, suffixes = TYPES[kinds + relations]
    signs = np.ones(len(kinds))
    if type_ == "cylindrical":
        signs[0] = np.sign(cosines[0])
    if type_ == "planar":
        signs[1] = np.sign(np.linalg.det(axes[[2, 0, 1]]))
    values = [
        with_unit(x, "rad") if k == "h" else s * x for k, s, x in zip(kinds, signs, q, strict=True)
    ]
    keys: dict = {"type": type_}
    if type_ == "universal":
        keys |= {"axis": digits(axes[0]), "other": digits(axes[1]), "openings": values}
    elif type_ != "spherical":
        keys |= {"axis": digits(axes[-1])}
        keys |= {f"opening{suffix}": x for suffix, x in zip(suffixes, values, strict=True)}
    if type_ in ("planar", "pin in slot"):
        keys["x"] = digits(axes[0])
    return keys, dict(zip(suffixes, signs.tolist(), strict=False))


def add_loops(draft: Draft) -> None:
    """Add joints for equalities: `weld` is fixed, `connect` spherical, two of the same parts a
    revolute joint about the line through their points."""
    m, d, loops = draft.model, draft.data, defaultdict(list)
    connect, weld = draft.code("mjtEq.mjEQ_CONNECT"), draft.code("mjtEq.mjEQ_WELD")
    for e in range(m.neq):
        name, ids = draft.name_of("equality", e), [m.eq_obj1id[e], m.eq_obj2id[e]]
        if m.eq_type[e] not in (connect, weld) or not m.eq_active0[e]:
            draft.leave_out(f"equality {name}", "allowed: connect, weld, active at the start")
            continue
        bodies, places = ids, m.eq_data[e, :6].reshape(2, 3)
        if m.eq_objtype[e] == draft.code("mjtObj.mjOBJ_SITE"):
            bodies, places = m.site_bodyid[ids], d.site_xpos[ids]
        else:
            places = places[:: 1 if m.eq_type[e] == connect else -1]
            places = d.xpos[ids] + np.einsum("ijk,ik->ij", d.xmat[ids].reshape(2, 3, 3), places)
        parts = [draft.part(body) for body in bodies]
        if parts[0] == parts[1]:
            draft.leave_out(f"equality {name}", "both its bodies are one")
            continue
        loops[(e,) if m.eq_type[e] == weld else tuple(sorted(parts))].append((e, parts, places))
    for loop in loops.values():
        chord = loop[-1][2][0] - loop[0][2][0]
        length = np.linalg.norm(chord)
        is_pin = len(loop) == 2 and length > 1e-4 * draft.size
        for e, parts, places in loop[:1] if is_pin else loop:
            keys: dict = {"type": "fixed" if m.eq_type[e] == weld else "spherical"}
            if is_pin:
                keys = {"type": "revolute", "axis": digits(chord / length)}
                names = [draft.name_of("equality", loop[k][0]) for k in (0, 1)]
                draft.notes.append(f"{names[0]} and {names[1]} are one revolute joint")
            _add_loop(draft, keys, e, parts, places)


def _add_loop(draft: Draft, keys: dict, e: int, parts: list, places: np.ndarray) -> None:
    d, name = draft.data, draft.name_of("equality", e)
    rows = (d.efc_type == draft.code("mjtConstraint.mjCNSTR_EQUALITY")) & (d.efc_id == e)
    gap, names = np.abs(d.efc_pos[rows]).max(initial=0.0), [draft.parts[part] for part in parts]
    if gap < OPEN * draft.size or keys["type"] == "fixed":
        keys["at"], remedy = draft.point(name, places[0], *parts), "kept as it is"
    else:
        triples = zip(names, places, parts, strict=True)
        keys["at"] = {n: draft.point(f"{name}_{n}", place, part) for n, place, part in triples}
        draft.structure.table["assemble"], remedy = "true", "closed before the run"
    if gap >= OPEN * draft.size:
        draft.notes.append(f"equality {name} is off by {gap:.3g} at the start, and {remedy}")
    draft.add("joints", name, parts=names, **keys)
