"""A flexible bar swinging on a fixed hinge: the smallest scene with a smooth response."""

import numpy as np

from deployable.fpm.kinds.beam import Material, Section
from deployable.fpm.scene import Scene
from deployable.fpm.scenes import DENSITIES, LENGTHS, MODULI, SIDES, Parameter, SceneType

PARAMETERS = {
    "L": Parameter(1.0, "m", "length of the bar", 0.0, lower_open=True, usual=LENGTHS),
    "a": Parameter(0.05, "m", "side of its square section", 0.0, lower_open=True, usual=SIDES),
    "E": Parameter(1e9, "Pa", "Young's modulus", 0.0, lower_open=True, usual=MODULI),
    "nu": Parameter(0.3, "1", "Poisson's ratio", lower=-1.0, upper=0.5, lower_open=True),
    "rho": Parameter(1000.0, "kg m-3", "density", 0.0, lower_open=True, usual=DENSITIES),
    "g": Parameter(9.81, "m s-2", "gravity"),
    "angle_deg": Parameter(60.0, "degree", "starting angle from the vertical", -180.0, 180.0),
    "K_F": Parameter(0.0, "N m rad-1", "torsion spring towards the vertical", lower=0.0),
    "damping": Parameter(0.0, "s-1", "mass-proportional damping", lower=0.0),
    "elements": Parameter(8, "1", "beam elements", 2, 1000, kind="integer"),
    "inertia_scale": Parameter(1.0, "1", "factor on the section's rotational inertia", lower=1.0),
}


def build(*, L, a, E, nu, rho, g, angle_deg, K_F, damping, elements, inertia_scale) -> Scene:
    """The pendulum at rest; hinge O at the origin about y, point T at the tip; z points up."""
    scene = Scene("pendulum", gravity=(0.0, 0.0, -g), damping=damping)
    ground = int(scene.add_particles((0.0, 0.0, 0.0), 1.0, 1.0)[0])
    scene.fix(ground)
    angle = np.radians(angle_deg)
    direction = np.array([np.sin(angle), 0.0, -np.cos(angle)])
    section, material = Section.square(a), Material(E, nu, rho)
    bar = scene.add_link(
        (0, 0, 0), L * direction, (0, 1, 0), section, material, elements, "bar", inertia_scale
    )
    hinge = scene.add_hinge(
        "O", (ground, bar.particles[0]), (0, 0, 0), (0, -1, 0),
        references=((0, 0, -1), direction), opening=angle,
    )  # fmt: skip
    if K_F > 0:
        scene.add_torsion_spring(hinge, K_F)
    scene.add_point("O", ground)
    scene.add_point("T", int(bar.particles[-1]))
    return scene


SCENE = SceneType(
    "pendulum", "flexible bar swinging on a fixed hinge", PARAMETERS, ("O", "T"), ("O",), build
)
