"""What viscous moments about hinges cost: for kinds that damp openings.

Their kernels take the rate of an opening from its changes d over the last two steps,
(3 d - d_before) / 2 h (damped_opening_kernels.py).
"""

STEP_SHARE = 0.9
"""Largest share of the stable step for which `stiffness_of_damping` vouches: that of a run."""


def softness(scene, hinge: int) -> float:
    """Inverse inertia (1/kg m²) against which a moment about a hinge of that index turns it."""
    found = scene.hinges[hinge]
    free = [~scene.fixed[p, 3:] / scene.inertia[p] for p in found.particles]
    return float(sum(axis**2 @ inverse for axis, inverse in zip(found.axes, free, strict=True)))


def stiffness_of_damping(scene, hinge: int, damping: float) -> float:
    """Stiffness (N m/rad) that takes the place of a damping c (N m s/rad) in the stable step.

    With rates as above, leapfrog is stable where K + (4/h) c D <= 4/h², D being the square of the
    opening's row, whose largest eigenvalue is the softness w. A run takes h = 2 s/W, s = 0.9, with
    the highest frequency W of K + k D; so K <= W² - k D, and (2 c W/s - k) w <= (1/s² - 1) W² is
    enough. That holds for any W, hence in any structure, with k = (2 c/s)² w / (4 (1/s² - 1)).
    """
    share = STEP_SHARE
    return (2 * damping / share) ** 2 * softness(scene, hinge) / (4 * (share**-2 - 1))
