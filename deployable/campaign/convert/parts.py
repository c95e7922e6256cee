"""Bodies and joints of a MuJoCo model, in its tree and where equalities close loops."""

from collections import defaultdict

import numpy as np

from deployable.campaign.convert.draft import JOINTS, Draft, digits, with_unit
from deployable.campaign.errors import CampaignError

UNITS = {"h": "rad", "s": "m"}  # of openings of hinges and slides
NORMAL = 1e-6  # cosine up to which directions are normal to each other, as in structures' files
OPEN = 1e-7  # gap of a loop at the start, as a share of the model's size, that counts as open


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
    m, d, loops, mj = draft.model, draft.data, defaultdict(list), draft.library
    for e in range(m.neq):
        name, ids = draft.name_of("equality", e), [m.eq_obj1id[e], m.eq_obj2id[e]]
        is_weld = m.eq_type[e] == mj.mjtEq.mjEQ_WELD
        if not (is_weld or m.eq_type[e] == mj.mjtEq.mjEQ_CONNECT) or not m.eq_active0[e]:
            draft.leave_out(f"equality {name}", "allowed: connect, weld, active at the start")
            continue
        bodies, places = ids, m.eq_data[e, :6].reshape(2, 3)[:: -1 if is_weld else 1]
        if m.eq_objtype[e] == mj.mjtObj.mjOBJ_SITE:
            bodies, places = m.site_bodyid[ids], d.site_xpos[ids]
        else:
            places = d.xpos[ids] + np.einsum("ijk,ik->ij", d.xmat[ids].reshape(2, 3, 3), places)
        parts = [draft.part(body) for body in bodies]
        if parts[0] == parts[1]:
            draft.leave_out(f"equality {name}", "both its bodies are one")
            continue
        type_ = "fixed" if is_weld and m.eq_data[e, 10] else "spherical"  # torquescale
        loops[(e,) if is_weld else tuple(sorted(parts))].append((e, name, type_, parts, places))
    for loop in loops.values():
        chord = loop[-1][4][0] - loop[0][4][0]
        length = np.linalg.norm(chord)
        is_pin = len(loop) == 2 and length > 1e-4 * draft.size
        if is_pin:
            draft.notes.append(f"{loop[0][1]} and {loop[1][1]} are one revolute joint")
        for e, name, type_, parts, places in loop[:1] if is_pin else loop:
            keys: dict = {"type": type_, "parts": [draft.parts[part] for part in parts]}
            if is_pin:
                keys |= {"type": "revolute", "axis": digits(chord / length)}
            rows = (d.efc_type == mj.mjtConstraint.mjCNSTR_EQUALITY) & (d.efc_id == e)
            gap, remedy = np.abs(d.efc_pos[rows]).max(initial=0.0), "kept as it is"
            if gap < OPEN * draft.size or type_ == "fixed":
                keys["at"] = draft.point(name, places[0], parts)
            else:
                triples = zip(keys["parts"], places, parts, strict=True)
                keys["at"] = {n: draft.point(f"{name}_{n}", x, [part]) for n, x, part in triples}
                draft.structure.table["assemble"], remedy = "true", "closed before the run"
            if gap >= OPEN * draft.size:
                draft.notes.append(
                    f"equality {name} is off by {gap:.3g} at the start, and {remedy}"
                )
            draft.add("joints", name, **keys)
