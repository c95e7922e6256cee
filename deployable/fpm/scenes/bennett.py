"""The paper's Bennett linkage, for the general mitred frame (bennett_geometry.py)."""

import math

from deployable.fpm.errors import SceneError
from deployable.fpm.kinds.beam import Material, Section
from deployable.fpm.scene import Scene
from deployable.fpm.scenes import DENSITIES, LENGTHS, MODULI, SIDES, Parameter, SceneType
from deployable.fpm.scenes.bennett_geometry import HINGES, LINKS, bennett_geometry

# Global axes along which the hinge points A and C are held.
SUPPORTS = {
    "plane": {"A": "z", "C": "z"},
    "pinned": {"A": "xyz"},
    "free": {},
}


def _positive(default, unit, description, usual) -> Parameter:
    return Parameter(default, unit, description, lower=0.0, lower_open=True, usual=usual)


def _corner(default, description) -> Parameter:
    return Parameter(default, "degree", description, 0.0, 90.0, lower_open=True, upper_open=True)


# Table 1 of the paper, and the readings chosen where it is silent.
PARAMETERS = {
    "L": _positive(0.45, "m", "length of a link's axis", LENGTHS),
    "a": _positive(0.035, "m", "side of the square section", SIDES),
    "lambda_deg": _corner(45.0, "roll of the section about the link's axis"),
    "mu_deg": _corner(
        None, "half corner angle at B of the deployed frame; left out: from omega_deg, else 45"
    ),
    "omega_deg": _corner(
        None, "angle of the hinge line at B to the link; left out: from lambda_deg and mu_deg"
    ),
    "E": _positive(1.0e9, "Pa", "Young's modulus", MODULI),
    "nu": Parameter(0.3, "1", "Poisson's ratio", -1.0, 0.5, lower_open=True),
    "rho": _positive(800.0, "kg m-3", "density", DENSITIES),
    "K_C": Parameter(1.0e4, "N rad-1", "contact stiffness per length of hinge line", lower=0.0),
    "K_F": Parameter(5.5, "N rad-1", "torsion spring per length of hinge line", lower=0.0),
    "damping": Parameter(0.0, "s-1", "mass-proportional damping", lower=0.0),
    "start_deg": Parameter(
        3.0, "degree", "opening at B by which the start is short of the folded bundle", 0.0, 180.0
    ),
    # One element would put half the mass at either end, which triples a link's inertia.
    "elements_per_link": Parameter(12, "1", "beam elements of a link", 2, 1000, kind="integer"),
    "inertia_scale": Parameter(1.0, "1", "factor on the section's rotational inertia", lower=1.0),
    "supports": Parameter(
        "plane",
        "1",
        "plane: A and C stay at their height; pinned: A stays in place; free: none",
        kind="choice",
        choices=tuple(SUPPORTS),
    ),
}


def build(
    *,
    L: float,
    a: float,
    lambda_deg: float,
    mu_deg: float | None,
    omega_deg: float | None,
    E: float,
    nu: float,
    rho: float,
    K_C: float,
    K_F: float,
    damping: float,
    start_deg: float,
    elements_per_link: int,
    inertia_scale: float,
    supports: str,
) -> Scene:
    """The linkage at rest, ``start_deg`` of opening at B short of the folded bundle.

    Parameters as in PARAMETERS.  Hinges and points are named A, B, C, D; the points are the
    midpoints of the hinge lines.  Raises SceneError for numbers that contradict each other.
    """
    geometry = bennett_geometry(L, a, lambda_deg, mu_deg, omega_deg)
    largest = math.degrees(geometry.folded_opening_b)
    # The last digits of the largest value are rounding; closure itself is a start.
    if not 0.0 <= start_deg <= largest + 1e-9:
        raise SceneError(
            "start_deg", start_deg, f"0 (the folded bundle) to {largest:.6g} degrees (deployed)"
        )
    pose = geometry.pose(geometry.opening_from_fold(start_deg))
    section, material = Section.square(a), Material(E, nu, rho)

    scene = Scene("bennett", damping=damping)
    links = {}
    for name, origin, rotation in zip(LINKS, pose.origin, pose.rotation, strict=True):
        links[name] = scene.add_link(
            origin,
            origin + L * rotation[:, 0],
            rotation[:, 2],
            section,
            material,
            elements_per_link,
            name=f"link {name}",
            inertia_scale=inertia_scale,
        )
    for i, hinge in enumerate(geometry.hinges()):
        end = 0 if hinge.at_start else -1
        bodies = (hinge.body1, hinge.body2)
        particles = [links[body].particles[end] for body in bodies]
        rotations = [pose.rotation[LINKS.index(body)] for body in bodies]
        index = scene.add_hinge(
            hinge.name,
            particles,
            pose.point[i],
            pose.axis[i],
            references=(rotations[0] @ hinge.reference1, rotations[1] @ hinge.reference2),
            opening=pose.opening[i],
            support=SUPPORTS[supports].get(hinge.name, ""),
        )
        scene.add_torsion_spring(index, K_F * hinge.length)
        scene.add_contact(index, K_C * hinge.length)
        scene.add_point(hinge.name, particles[0], pose.point[i])
    return scene


SCENE = SceneType(
    "bennett",
    "Bennett linkage of four square bars with mitred ends, unfolding by its springs",
    PARAMETERS,
    points=HINGES,
    hinges=HINGES,
    function=build,
)
