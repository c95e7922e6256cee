"""What acts in a MuJoCo model: springs, dampers, friction and limits, tendons, actuators."""

from typing import Any

import numpy as np

from deployable.campaign.convert.sheet import Sheet, measure, vector


def _soft(solref: np.ndarray, solimp: np.ndarray, inverse: float) -> list[float]:
    """Stiffness and damping of MuJoCo's soft limit: with the impedance d its force is d/A (-b v - k
    r); A, `inverse`, is the acceleration by a unit force (its documentation, Computation)."""
    first, second = map(float, solref)
    most = float(np.clip(solimp[1], 1e-4, 0.9999))
    direct = -first / most, -second
    values = (1 / (most * first**2 * second**2), 2 / first) if first > 0 else direct
    return vector(np.array(values) / inverse)


def _units(sheet: Sheet, joint: int) -> tuple[str, str, str, str]:
    """Units of an opening, of what moves it, of stiffness and of damping."""
    if sheet.model.jnt_type[joint] == sheet.code("mjtJoint.SLIDE"):
        return "m", "N", "N/m", "N s/m"
    return "rad", "N m", "N m/rad", "N m s/rad"


def _act(
    sheet: Sheet, joint: int, word: str, text: str, key: str, value: float, **keys: Any
) -> None:
    """Add an action on a joint's opening, with the parameter `<text>_<key>` of what it is by."""
    unit, force, stiffness, damping = _units(sheet, joint)
    units = {"stiffness": stiffness, "damping": damping}
    name = sheet.parameter(f"{text}_{key}", value, units.get(key, force), f"of {text}")
    slide = {"torsion spring": "spring"} if unit == "m" else {}
    keys = {"type": slide.get(word, word), "joint": sheet.openings[joint][0], key: name, **keys}
    sheet.add("actions", f"{text}_{word.split()[-1]}", **keys)


def add_joint_forces(sheet: Sheet) -> None:
    """Add what acts on joints."""
    m = sheet.model
    for joint, (opening, sign) in sheet.openings.items():
        dof, unit = int(m.jnt_dofadr[joint]), _units(sheet, joint)[0]
        if stiffness := m.jnt_stiffness[joint]:
            rest = measure(sign * m.qpos_spring[m.jnt_qposadr[joint]], unit)
            _act(sheet, joint, "torsion spring", opening, "stiffness", stiffness, rest=rest)
        if damping := m.dof_damping[dof]:
            _act(sheet, joint, "damper", opening, "damping", damping)
        if loss := m.dof_frictionloss[dof]:
            key, keys = ("force", {}) if unit == "m" else ("moment", {"sticks": "exactly"})
            _act(sheet, joint, "friction", opening, key, loss, **keys)
        if m.jnt_limited[joint]:
            lower, upper = (measure(x, unit) for x in sorted(sign * m.jnt_range[joint]))
            values = m.jnt_solref[joint], m.jnt_solimp[joint], m.dof_invweight0[dof]
            k, c = _soft(*values)
            ends: dict[str, Any] = {"lower": lower, "upper": upper, "stiffness": k, "damping": c}
            sheet.add("actions", f"{opening}_range", type="stop", joint=opening, **ends)
            sheet.notes.append(
                f"range of {opening} is about as soft a stop as MuJoCo's: state its own"
            )


def add_tendons(sheet: Sheet) -> None:
    """Add spatial tendons through sites as cables, or as struts if they push as well."""
    m = sheet.model
    for tendon in range(m.ntendon):
        name, first = sheet.name_of("tendon", tendon), int(m.tendon_adr[tendon])
        rows = slice(first, first + int(m.tendon_num[tendon]))
        if np.any(m.wrap_type[rows] != sheet.code("mjtWrap.SITE")):
            sheet.left(f"tendon {name}", "allowed: spatial tendons that run through sites only")
            continue
        ends = [sheet.at_site(int(site)) for site in m.wrap_objid[rows]]
        stiffness, damping = vector([m.tendon_stiffness[tendon], m.tendon_damping[tendon]])
        low, high = vector(m.tendon_lengthspring[tendon])
        if stiffness and low and len(ends) == 2:
            keys = {"stiffness": stiffness, "rest": high, "acts": "pull" if low < high else None}
            sheet.add("struts", name, type="spring", between=ends, **keys)
        elif stiffness:
            EA = sheet.parameter(f"{name}_EA", stiffness * high, "N", f"of {name}")
            sheet.add("cables", name, through=ends, EA=EA, rest=high)
        if stiffness and low and (len(ends) > 2 or low < high):
            sheet.left(f"what {name} pushes with below {low:.6g} m")
        if damping and len(ends) == 2:
            sheet.add("struts", f"{name}_damper", type="damper", between=ends, damping=damping)
        elif damping:
            sheet.left(f"damping of tendon {name}")
        if m.tendon_limited[tendon]:
            soft = m.tendon_solref_lim[tendon], m.tendon_solimp_lim[tendon]
            rest = vector(m.tendon_range[tendon])[1]
            k = _soft(*soft, m.tendon_invweight0[tendon])[0]
            text = f"{name}_range" if stiffness else name
            sheet.add("cables", text, through=ends, EA=rest * k, rest=rest)
            sheet.notes.append(
                f"range of {name} is about as soft a cable as MuJoCo's: state its EA"
            )


def add_actuators(sheet: Sheet) -> None:
    """Add actuators on joints at a constant control: a part of the force that stays is a torque
    motor; one that falls with the position a spring, with the rate a damper."""
    m = sheet.model
    plain = [(sheet.code("mjtGain.FIXED"), sheet.code(f"mjtBias.{b}"), sheet.code("mjtDyn.NONE"))
             for b in ("NONE", "AFFINE")]  # fmt: skip
    on_joint = sheet.code("mjtTrn.JOINT"), sheet.code("mjtTrn.JOINTINPARENT")
    for i in range(m.nactuator):
        name, joint = sheet.name_of("actuator", i), int(m.actuator_trnid[i, 0])
        types = m.actuator_gaintype[i], m.actuator_biastype[i], m.actuator_dyntype[i]
        bias = m.actuator_biasprm[i, :3] * (types == plain[1])
        is_on = m.actuator_trntype[i] in on_joint and joint in sheet.openings
        if not is_on or types not in plain or bias[1:].max() > 0:
            sheet.left(f"actuator {name}", "allowed: motors and servos of a hinge or slide")
            continue
        gear, sign = float(m.actuator_gear[i, 0]), sheet.openings[joint][1]
        control, unit = float(sheet.data.ctrl[m.actuator_ctrladr[i]]), _units(sheet, joint)[0]
        sheet.notes.append(f"actuator {name} has the control {control:g} all the time")
        force = sign * gear * (m.actuator_gainprm[i, 0] * control + bias[0])
        stiffness, damping = -(gear**2) * bias[1:]
        if stiffness:
            rest = sheet.parameter(f"{name}_target", force / stiffness, unit, f"of {name}")
            _act(sheet, joint, "torsion spring", name, "stiffness", stiffness, rest=rest)
        else:
            key = "force" if unit == "m" else "torque"
            _act(sheet, joint, "torque motor", name, key, force)
        if damping:
            _act(sheet, joint, "damper", name, "damping", damping)
        if m.actuator_forcelimited[i] or m.jnt_actfrclimited[joint]:
            sheet.left(f"limit of the force of actuator {name}")
