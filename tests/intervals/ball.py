"""A bouncing ball in closed form: what a response with collisions does to a surrogate."""

from __future__ import annotations

import numpy as np


def bounces(height, restitution=0.8, gravity=9.81, duration=2.0) -> np.ndarray:
    """Times of the impacts before `duration`, for a ball dropped from `height` at rest."""
    fall = np.sqrt(2 * height / gravity)
    times, flight = [fall], 2 * fall * restitution
    while times[-1] + flight < duration:
        times.append(times[-1] + flight)
        flight *= restitution
    return np.array([t for t in times if t < duration])


def ball(time, height, restitution=0.8, gravity=9.81) -> tuple[np.ndarray, np.ndarray]:
    """Height and velocity (T) at `time` (T)."""
    time = np.asarray(time, dtype=float)
    impacts = bounces(height, restitution, gravity, time[-1] + 1e-9)
    position = height - 0.5 * gravity * time**2
    velocity = -gravity * time
    speed = np.sqrt(2 * gravity * height)
    for impact in impacts:
        speed *= restitution
        since = time - impact
        later = since >= 0
        position = np.where(later, speed * since - 0.5 * gravity * since**2, position)
        velocity = np.where(later, speed - gravity * since, velocity)
    return position, velocity
