"""What acts in a MuJoCo model: springs, dampers, friction and limits, tendons, actuators."""

from typing import Any

import numpy as np

from deployable.campaign.convert.draft import Draft, digits, with_unit


def _limit(solref: np.ndarray, solimp: np.ndarray, inverse: float) -> dict[str, Any]:
    """Stiffness and damping of MuJoCo's soft limit: with the impedance d its force is d/A (-b v - k
    r); A, `inverse`, is the acceleration by a unit force (its documentation, Computation)."""
    a, b = map(float, solref)
    d = float(np.clip(solimp[1], 1e-4, 0.9999))
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
            keys = _limit(m.jnt_solref[joint], m.jnt_solimp[joint], m.dof_invweight0[dof])
            keys |= {"type": "stop", "joint": opening, "lower": lower, "upper": upper}
            draft.add("actions", f"{opening}_range", **keys)
            draft.notes.append(f"range of {opening} is a stop about as soft as MuJoCo's limit")


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
        low, high = digits(m.tendon_lengthspring[tendon])
        is_strut = stiffness and low and len(ends) == 2
        sides = {"both ways": high} if low == high else {"push": low, "pull": high}
        for side, rest in sides.items() if is_strut else ():
            keys = {"between": ends, "stiffness": stiffness, "rest": rest, "acts": side}
            draft.add("struts", name, type="spring", **keys)
        if stiffness and not is_strut:
            EA = draft.parameter(f"{name}_EA", stiffness * high, "N", name)
            draft.add("cables", name, through=ends, EA=EA, rest=high)
            if low:
                draft.leave_out(f"what tendon {name} pushes with below {low:.6g} m")
        if damping and len(ends) == 2:
            draft.add("struts", f"{name}_damper", type="damper", between=ends, damping=damping)
        elif damping:
            draft.leave_out(f"damping of tendon {name}")
        if m.tendon_limited[tendon]:
            soft = m.tendon_solref_lim[tendon], m.tendon_solimp_lim[tendon]
            k = _limit(*soft, m.tendon_invweight0[tendon])["stiffness"]
            low, rest = digits(m.tendon_range[tendon])
            text = f"{name}_range" if stiffness else name
            draft.add("cables", text, through=ends, EA=rest * k, rest=rest)
            draft.notes.append(f"range of {name} is a cable about as soft as MuJoCo's limit")
            if low > 0:
                draft.leave_out(f"limit of tendon {name} at {low:.6g} m", "cables do not push")


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
        is_off = m.opt.disableactuator >> int(np.clip(m.actuator_group[i], -1, 31) % 32) & 1
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
