"""Bodies and joints of a MuJoCo model, in its tree and where equalities close loops."""

from collections import defaultdict

import numpy as np

from deployable.campaign.convert.sheet import Sheet, measure, vector
from deployable.campaign.errors import CampaignError

PARALLEL = 1e-6
"""Cosine below which directions are normal to each other, as structures' files have it."""

OPEN = 1e-7
"""Gap of a loop at the start, as a share of the model's size, from which on it counts as open."""


def add_parts(sheet: Sheet) -> None:
    """Add each part as a body, with the mass and inertia of all that is welded to it."""
    m, d = sheet.model, sheet.data
    members = defaultdict(list)
    for body in range(1, m.nbody):
        members[sheet.part(body)].append(body)
    for body in members.pop(0, ()):
        sheet.notes.append(f"body {sheet.name_of('body', body)} is fixed to the ground")
    for part, bodies in members.items():
        names = [sheet.name_of("body", body) for body in bodies]
        sheet.notes += [f"body {name} is held rigidly on {names[0]}" for name in names[1:]]
        masses = m.body_mass[bodies]
        centre = masses @ d.xipos[bodies] / masses.sum()
        tensor = np.zeros((3, 3))
        for body, mass in zip(bodies, masses, strict=True):
            axes, arm = d.ximat[body].reshape(3, 3), d.xipos[body] - centre
            tensor += axes * m.body_inertia[body] @ axes.T
            tensor += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        point = sheet.point(f"{names[0]}_centre", centre)
        keys = {"mass": vector([masses.sum()])[0], "centre": point, **_inertia(tensor)}
        name = sheet.parts[part] = sheet.add("bodies", names[0], **keys)
        motion = np.zeros(6)
        sheet.library.mj_objectVelocity(m, d, sheet.code("mjtObj.XBODY"), part, motion, 0)
        if motion.any():
            spin, size = motion[:3], float(np.abs(motion).max())
            velocity = vector(motion[3:] + np.cross(spin, centre - d.xpos[part]), size)
            keys = {"part": name, "velocity": velocity, "spin": vector(spin, size), "about": point}
            sheet.add("initial_velocities", name, **keys)


def _inertia(tensor: np.ndarray) -> dict:
    """Keys of a body for an inertia tensor (3, 3), in global axes if they are principal."""
    diagonal = np.diagonal(tensor)
    if np.abs(tensor - np.diag(diagonal)).max() < 1e-10 * diagonal.max():
        return {"inertia": vector(diagonal, 0.0)}
    values, axes = np.linalg.eigh(tensor)
    up = np.cross(axes[:, 0], axes[:, 1])
    return {"inertia": vector(values, 0.0), "x": vector(axes[:, 0]), "up": vector(up)}


def add_joints(sheet: Sheet) -> None:
    """Add the joints of the tree; CampaignError where those of one body have no equivalent."""
    m, d, foreign = sheet.model, sheet.data, []
    for part in list(sheet.parts)[1:]:
        joints = list(range(m.body_jntadr[part], m.body_jntadr[part] + m.body_jntnum[part]))
        kinds = "".join("fbsh"[m.jnt_type[joint]] for joint in joints)
        if kinds == "f":
            continue
        found = _equivalent(kinds, d.xaxis[joints], d.qpos[m.jnt_qposadr[joints]])
        if kinds == "hh" and np.ptp(d.xanchor[joints], axis=0).max() > OPEN * sheet.size:
            found = None
        names = [sheet.name_of("joint", joint) for joint in joints]
        if found is None:
            foreign.append(f"body {sheet.parts[part]} has the joints {', '.join(names)}")
            continue
        type_, openings, keys = found
        parent = sheet.part(m.body_parentid[part])
        text = names[0] if len(names) == 1 else f"{sheet.parts[part]}_joint"
        keys["at"] = sheet.point(text, d.xanchor[joints[-1]], parent, part)
        keys = {"type": type_, "parts": [sheet.parts[parent], sheet.parts[part]], **keys}
        name = sheet.add("joints", text, **keys)
        for joint, (suffix, sign) in zip(joints, openings.items(), strict=False):
            sheet.openings[joint] = name + suffix, sign
            if suffix:
                sheet.notes.append(
                    f"{sheet.name_of('joint', joint)} is the opening {name + suffix}"
                )
    if foreign:
        raise CampaignError(
            f"{'; '.join(foreign)}; allowed for several joints of one body: two hinges that meet "
            "at right angles, slide and hinge along or normal to it, or two slides and the hinge "
            "normal to both; put a body with mass between others"
        )


def _equivalent(kinds: str, axes: np.ndarray, q: np.ndarray) -> tuple[str, dict, dict] | None:
    """Type of the joint that stands for elementary joints of a body (letters b, h, s), by suffix
    the signs of its openings, and its keys; None if there is none. axes (n, 3): of each, q: its
    position."""
    last, angle = vector(axes[-1]), measure(q[-1], "rad")
    cosines = (axes @ axes.T)[np.triu_indices(len(axes), 1)]
    sign = 1.0
    if kinds in ("b", "h", "s"):
        keys = {} if kinds == "b" else {"axis": last, "opening": angle if kinds == "h" else q[0]}
        types = {"b": "spherical", "h": "revolute", "s": "prismatic"}
        return types[kinds], {"": 1.0} if keys else {}, keys
    keys = {"axis": last, "opening_turn": angle}
    if kinds == "sh" and abs(cosines[0]) > 1 - PARALLEL**2:
        sign = float(np.sign(cosines[0]))
        keys["opening_slide"] = sign * q[0]
        return "cylindrical", {"_slide": sign, "_turn": 1.0}, keys
    if np.abs(cosines).max() > PARALLEL:
        return None
    if kinds == "hh":
        keys = {"axis": vector(axes[0]), "other": last}
        keys["openings"] = [measure(x, "rad") for x in q]
        return "universal", {"_axis": 1.0, "_other": 1.0}, keys
    keys["x"] = vector(axes[0])
    if kinds == "sh":
        keys["opening_slide"] = q[0]
        return "pin in slot", {"_slide": 1.0, "_turn": 1.0}, keys
    if kinds == "ssh":
        sign = float(np.sign(np.cross(axes[2], axes[0]) @ axes[1]))
        keys |= {"opening_x": q[0], "opening_y": sign * q[1]}
        return "planar", {"_x": 1.0, "_y": sign, "_turn": 1.0}, keys
    return None


def add_loops(sheet: Sheet) -> None:
    """Add joints for equalities: `weld` is fixed, `connect` spherical, two of the same parts a
    revolute joint about the line through their points."""
    m, d, loops = sheet.model, sheet.data, defaultdict(list)
    connect, weld = sheet.code("mjtEq.CONNECT"), sheet.code("mjtEq.WELD")
    for e in range(m.neq):
        name, ids = sheet.name_of("equality", e), (m.eq_obj1id[e], m.eq_obj2id[e])
        if m.eq_type[e] not in (connect, weld) or not m.eq_active0[e]:
            sheet.left(f"equality {name}", "allowed: connect and weld that are active at the start")
            continue
        if m.eq_objtype[e] == sheet.code("mjtObj.SITE"):
            parts = [sheet.part(m.site_bodyid[site]) for site in ids]
            places = d.site_xpos[list(ids)]
        else:
            parts, arms = [sheet.part(body) for body in ids], m.eq_data[e, :6].reshape(2, 3)
            arms = arms[:: 1 if m.eq_type[e] == connect else -1]
            pairs = zip(ids, arms, strict=True)
            places = np.array([d.xpos[b] + d.xmat[b].reshape(3, 3) @ arm for b, arm in pairs])
        if parts[0] == parts[1]:
            sheet.left(f"equality {name}", "both its bodies are one")
            continue
        key = (e,) if m.eq_type[e] == weld else tuple(sorted(parts))
        loops[key].append((e, name, parts, places))
    for loop in loops.values():
        chord = loop[-1][3][0] - loop[0][3][0]
        is_pin = len(loop) == 2 and np.linalg.norm(chord) > 1e-4 * sheet.size
        for ends in loop[:1] if is_pin else loop:
            keys: dict = {"type": "fixed" if m.eq_type[ends[0]] == weld else "spherical"}
            if is_pin:
                keys = {"type": "revolute", "axis": vector(chord / np.linalg.norm(chord))}
                sheet.notes.append(f"{loop[0][1]} and {loop[1][1]} are one revolute joint")
            _add_loop(sheet, keys, *ends)


def _add_loop(sheet: Sheet, keys: dict, e: int, name: str, parts: list, places: np.ndarray) -> None:
    d = sheet.data
    rows = (d.efc_type == sheet.code("mjtConstraint.EQUALITY")) & (d.efc_id == e)
    gap = float(np.abs(d.efc_pos[rows]).max(initial=0.0))
    names = [sheet.parts[part] for part in parts]
    if gap < OPEN * sheet.size or keys["type"] == "fixed":
        at: str | dict = sheet.point(name, places[0], *parts)
    else:
        triples = zip(names, places, parts, strict=True)
        at = {n: sheet.point(f"{name}_{n}", place, part) for n, place, part in triples}
        sheet.structure.table["assemble"] = "true"
    if gap >= OPEN * sheet.size:
        remedy = "kept as it is" if isinstance(at, str) else "closed before the run"
        sheet.notes.append(f"equality {name} is off by {gap:.3g} at the start, and {remedy}")
    sheet.add("joints", name, parts=names, at=at, **keys)
