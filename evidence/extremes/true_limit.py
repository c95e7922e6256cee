"""The true stability limit of a scene, found by bisection on whether a run breaks down.

Above the limit the fastest mode grows by exp(2 arccosh(step / limit)) a step, so from rounding it
passes any bound within some hundred steps even at 1.001 times the limit: growth of 9 % a step."""

import numpy as np

import fpm


def disturb(scene: fpm.Scene, speed: float, seed: int = 0) -> fpm.Scene:
    """Give every free particle a small random velocity (m/s) and spin, so that all modes take part.

    The spin is that which makes the rotational energy of a particle as large as the other. Changes
    the scene in place and returns it."""
    random = np.random.default_rng(seed)
    n = len(scene.mass)
    gyration = np.sqrt(scene.inertia.mean(axis=1) / scene.mass)[:, None]
    scene.velocity = scene.velocity + speed * random.standard_normal((n, 3))
    scene.spin = scene.spin + speed * random.standard_normal((n, 3)) / gyration
    scene.velocity[scene.fixed[:, :3]] = 0.0
    scene.spin[scene.fixed[:, 3:]] = 0.0
    return scene


def breaks_down(scene: fpm.Scene, step: float, steps: int = 3000) -> bool:
    """Whether a run of so many steps fails its energy balance."""
    (outcome,) = fpm.simulate([scene], duration=steps * step, instants=2, step=step)
    return outcome.failure is not None


def true_limit(scene: fpm.Scene, tolerance: float = 1e-3, steps: int = 3000) -> float:
    """Largest step (s) at which the scene runs, to a relative `tolerance`, from below.

    Doubles or halves from the estimate until the limit is bracketed, then bisects."""
    low = high = fpm.find_stable_step(scene).step
    while breaks_down(scene, low, steps):
        low, high = low / 2, low
    while low == high or not breaks_down(scene, high, steps):
        low, high = high, high * (1.25 if low == high else 2)
        if high > 1e3 * low:
            raise RuntimeError(f"{scene.name}: no limit found up to {high} s")
    while high / low > 1 + tolerance:
        middle = float(np.sqrt(low * high))
        if breaks_down(scene, middle, steps):
            high = middle
        else:
            low = middle
    return low
