"""A structure of all kinds that stands still, to be beside any other: all need the same time loop.

To compile that takes a minute or two, once; then a run takes milliseconds, whatever it has."""

from evidence.attack.metamorphic.structure_text import Structure

PREFIX = "y_"
"""What the names in the ballast begin with; what they do is not compared."""

TINY = 1e-30
"""Gravity (m/s²), damping (1/s) and viscosity that are there and do nothing."""


def _hinge(body: str, name: str) -> dict:
    """A hinge at the body's centre, so that no weight turns it."""
    axis = [0.0, 0.0, 1.0]
    return {"type": "revolute", "parts": ["ground", body], "at": name, "axis": axis, "opening": 0.5}


def _body(centre: str) -> dict:
    return {"mass": 1.0, "centre": centre, "inertia": [1.0, 1.0, 1.0]}


def _joint_actions(joint: str, **actions: dict) -> dict[str, dict]:
    return {f"y_{key}": {"joint": joint, **entry} for key, entry in actions.items()}


_POINTS = {f"y{k}": [3.0, 0.3 * k, 0.1 * (k % 2)] for k in range(12)}
_SOFT = {"stiffness": 1e-3}
BALLAST: Structure = {
    "points": _POINTS,
    "materials": {"y_m": {"E": 1.0, "rho": 1000.0, "stiffness_damping": TINY}},
    "sections": {"y_s": {"type": "circle", "diameter": 0.1}},
    "bars": {
        "y_bar": {"through": ["y8", "y9"], "section": "y_s", "material": "y_m", "elements": 1}
    },
    "bodies": {f"y_b{k}": _body(f"y{k}") for k in (0, 2, 4, 6, 10)},
    "joints": {
        **{f"y_j{k}": _hinge(f"y_b{k}", f"y{k}") for k in (0, 2, 4)},
        "y_u": {"type": "universal", "parts": ["ground", "y_b6"], "at": "y6",
                "axis": [1.0, 0.0, 0.0], "other": [0.0, 1.0, 0.0], "openings": [0.5, 0.5]},
    },
    "curves": {"y_f": {"times": [0.0], "values": [0.0]}},
    "actions": {
        **_joint_actions(
            "y_j0",
            spring={"type": "torsion spring", **_SOFT, "rest": 0.5},
            contact={"type": "contact", **_SOFT},
            motor={"type": "motor", **_SOFT, "turn": 1.0, "curve": "y_f"},
            torque={"type": "torque motor", "torque": 0.0},
            release={"type": "release", **_SOFT, "time": 99.0},
            latch={"type": "latch", **_SOFT, "angle": 40.0},
            damper={"type": "damper", "damping": 1e-3},
            friction={"type": "friction", "moment": 1e-3, "bristle_deflection": 1.0},
            stop={"type": "stop", **_SOFT, "upper": 40.0},
            table={"type": "tabulated spring", "angles": [0.0, 1.0], "moments": [0.0, 0.0]},
        ),
        **_joint_actions("y_j2", exact_motor={"type": "motor", "turn": 1.0, "curve": "y_f"}),
        **_joint_actions(
            "y_j4",
            exact_latch={"type": "latch", "angle": 40.0},
            exact_release={"type": "release", "time": 99.0},
            exact_friction={"type": "friction", "moment": 1.0, "sticks": "exactly"},
        ),
        "y_loop": {"type": "loop", "joints": ["y_j0", "y_u_axis"], "radii": [1.0, 1.0], **_SOFT},
    },
    "loads": {"y_l": {"part": "y_b0", "at": "y0", "force": [0.0, 0.0, 0.0]}},
    "drags": {
        "y_a": {"part": "y_b0", "through": ["y0"], "area": 0.0, "coefficient": 1.0, "density": 1.0}
    },
    "drives": {"y_d": {"part": "y_b10", "at": "y10", "curve": "y_f"}},
    "supports": {
        "y_h": {"part": "y_b6", "at": "y6", "translations": "none", "rotations": "x"},
        "y_h8": {"part": "y_bar", "at": "y8"},
        "y_h9": {"part": "y_bar", "at": "y9"},
    },
    "cables": {
        "y_k": {
            "through": [{"part": "ground", "at": "y1"}, {"part": "y_b4", "at": "y4"},
                        {"part": "y_b2", "at": "y2"}],
            "EA": 1.0, "rest": 99.0, "friction": 0.1,
        }
    },
    "struts": {
        "y_s": {"type": "damper", "damping": 0.0,
                "between": [{"part": "ground", "at": "y1"}, {"part": "y_b4", "at": "y4"}]}
    },
}  # fmt: skip


def add_ballast(structure: Structure) -> Structure:
    """The structure with the ballast beside it, which is not recorded."""
    clone = {"gravity": [0.0, 0.0, TINY], "damping": TINY, "viscosity": TINY, **structure}
    for group, entries in BALLAST.items():
        clone[group] = {**clone.get(group, {}), **entries}
    return clone
