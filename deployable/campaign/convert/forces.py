"""What acts in a MuJoCo model: springs, dampers, friction and limits, tendons, actuators."""

from typing import Any

import numpy as np

from deployable.campaign.convert.draft import Draft, digits, with_unit

ACTIONS = {  # type, key and unit, each on an angle and on a slide
    "spring": (("torsion spring", "spring"), ("stiffness", "stiffness"), ("N m/rad", "N/m")),
    "damper": (("damper", "damper"), ("damping", "damping"), ("N m s/rad", "N s/m")),
    "friction": (("friction", "friction"), ("moment", "force"), ("N m", "N")),
    "motor": (("torque motor", "torque motor"), ("torque", "force"), ("N m", "N")),
}


def _act(draft: Draft, joint: int, owner: str, word: str, value: float, **keys: Any) -> None:
    """Add an action on the opening of a joint, with a parameter for its value: a motor, or
    what is not 0."""
    opening, _, unit = draft.openings[joint]
    type_, key, value_unit = (pair[unit == "m"] for pair in ACTIONS[word])
    if value or word == "motor":
        text = f"{owner}_{word if word == 'friction' else key}"
        keys[key] = draft.parameter(text, value, value_unit, owner)
        draft.add("actions", f"{owner}_{word}", type=type_, joint=opening, **keys)


def _limit(solref: np.ndarray, solimp: np.ndarray, inverse: float) -> list[float]:
    """Stiffness and damping of MuJoCo's soft limit: with the impedance d its force is d/A (-b v - k
    r); A, `inverse`, is the acceleration by a unit force (its documentation, Computation)."""
    first, second = map(float, solref)
    most = float(np.clip(solimp[1], 1e-4, 0.9999))
    direct = -first / most, -second
    values = (1 / (most * first**2 * second**2), 2 / first) if first > 0 else direct
    return digits(np.array(values) / inverse)


def add_joint_forces(draft: Draft) -> None:
    """Add what acts on joints."""
    m = draft.model
    for joint, (opening, sign, unit) in draft.openings.items():
        dof = int(m.jnt_dofadr[joint])
        rest = with_unit(sign * m.qpos_spring[m.jnt_qposadr[joint]], unit)
        sticks = {"sticks": "exactly"} if unit == "rad" else {"bristle_deflection": "0.01 mm"}
        _act(draft, joint, opening, "spring", m.jnt_stiffness[joint], rest=rest)
        _act(draft, joint, opening, "damper", m.dof_damping[dof])
        _act(draft, joint, opening, "friction", m.dof_frictionloss[dof], **sticks)
        if m.jnt_limited[joint]:
            lower, upper = (with_unit(x, unit) for x in sorted(sign * m.jnt_range[joint]))
            k, c = _limit(m.jnt_solref[joint], m.jnt_solimp[joint], m.dof_invweight0[dof])
            keys: dict[str, Any] = {"lower": lower, "upper": upper, "stiffness": k, "damping": c}
            draft.add("actions", f"{opening}_range", type="stop", joint=opening, **keys)
            draft.notes.append(f"range of {opening} is a stop about as soft as MuJoCo's limit")


def add_tendons(draft: Draft) -> None:
    """Add spatial tendons through sites as cables, or as struts if they push as well."""
    m = draft.model
    for tendon in range(m.ntendon):
        name, first = draft.name_of("tendon", tendon), int(m.tendon_adr[tendon])
        rows = slice(first, first + int(m.tendon_num[tendon]))
        if np.any(m.wrap_type[rows] != draft.code("mjtWrap.mjWRAP_SITE")):
            draft.leave_out(f"tendon {name}", "allowed: spatial tendons through sites only")
            continue
        ends = [draft.site(int(site)) for site in m.wrap_objid[rows]]
        stiffness, damping = digits([m.tendon_stiffness[tendon], m.tendon_damping[tendon]])
        low, high = digits(m.tendon_lengthspring[tendon])
        if stiffness and low and len(ends) == 2:
            sides = {"both ways": high} if low == high else {"push": low, "pull": high}
            for side, rest in sides.items():
                keys = {"stiffness": stiffness, "rest": rest, "acts": side}
                draft.add("struts", name, type="spring", between=ends, **keys)
        elif stiffness:
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
            k, rest = _limit(*soft, m.tendon_invweight0[tendon])[0], m.tendon_range[tendon, 1]
            text = f"{name}_range" if stiffness else name
            draft.add("cables", text, through=ends, EA=rest * k, rest=rest)
            draft.notes.append(f"range of {name} is a cable about as soft as MuJoCo's limit")


def add_actuators(draft: Draft) -> None:
    """Add actuators on joints at a constant control: what stays of their force is a torque motor;
    what falls with the position is a spring, with the rate a damper."""
    m, biases = draft.model, [draft.code(f"mjtBias.mjBIAS_{word}") for word in ("NONE", "AFFINE")]
    gain, dynamics = draft.code("mjtGain.mjGAIN_FIXED"), draft.code("mjtDyn.mjDYN_NONE")
    trunks = [draft.code(f"mjtTrn.mjTRN_{word}") for word in ("JOINT", "JOINTINPARENT")]
    for i in range(m.nactuator):
        name, joint = draft.name_of("actuator", i), int(m.actuator_trnid[i, 0])
        bias = m.actuator_biasprm[i, :3] * (m.actuator_biastype[i] == biases[1])
        is_plain = m.actuator_gaintype[i] == gain and m.actuator_dyntype[i] == dynamics
        is_plain &= m.actuator_biastype[i] in biases and bias[1:].max() <= 0
        if not (is_plain and m.actuator_trntype[i] in trunks and joint in draft.openings):
            draft.leave_out(f"actuator {name}", "allowed: motors and servos of a hinge or slide")
            continue
        control, (_, sign, unit) = draft.data.ctrl[m.actuator_ctrladr[i]], draft.openings[joint]
        if m.actuator_ctrllimited[i]:
            control = np.clip(control, *m.actuator_ctrlrange[i])
        gear = m.actuator_gear[i, 0]
        force = sign * gear * (m.actuator_gainprm[i, 0] * control + bias[0])
        stiffness, damping = -(gear**2) * bias[1:]
        if stiffness:
            rest = draft.parameter(f"{name}_target", force / stiffness, unit, name)
            _act(draft, joint, name, "spring", stiffness, rest=rest)
        else:
            _act(draft, joint, name, "motor", force)
        _act(draft, joint, name, "damper", damping)
        draft.notes.append(f"actuator {name} has the control {control:g} all the time")
        if m.actuator_forcelimited[i] or m.jnt_actfrclimited[joint]:
            draft.leave_out(f"limit of the force of actuator {name}")
