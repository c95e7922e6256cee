"""A mass on a cable that rubs, from event to event: no time steps, and nothing of the solver.

In the plane, the cable runs from a fixed end through fixed eyelets to the mass. As long as the same
eyelets slip in the same directions, the tensions follow from the mass's place alone: stretches
between two eyelets that stick share their unstrained length, with Eytelwein's ratios of tensions
between them. The motion is integrated (DOP853) up to the next event: an eyelet begins to slip,
or its slip comes to rest, or the cable turns slack or tight. Which slip then is found by trying all
3^p patterns on a moment later: one has slips that agree with their friction, and tensions within
their bounds elsewhere."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.integrate import solve_ivp

G = 9.81
MOMENT = 1e-6
"""Time (s) after an event at which it is decided what slips."""

ROUNDING = 1e-12
"""Slip (m) in the wrong direction, and excess of ln(T'/T), that mean nothing."""


@dataclass(frozen=True)
class Rope:
    """fixed (p + 1, 2): its end and the eyelets (m); mass (kg); EA (N); rest (m); friction."""

    fixed: np.ndarray
    mass: float
    EA: float
    rest: float
    friction: float

    def measure(self, place: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Lengths (p + 1,), ln of the ratios of tensions (p,), direction from the mass (2,)."""
        vectors = np.diff([*self.fixed, place], axis=0)
        headings = np.arctan2(vectors[:, 1], vectors[:, 0])
        turns = np.abs((np.diff(headings) + np.pi) % (2 * np.pi) - np.pi)
        lengths = np.hypot(*vectors.T)
        return lengths, self.friction * turns, -vectors[-1] / lengths[-1]

    def strains(self, place: np.ndarray, material: np.ndarray, slips) -> np.ndarray:
        """Strains (p + 1,), from unstrained lengths before and where it slips: -1, 0 or 1."""
        lengths, logs, _ = self.measure(place)
        strains = np.empty(len(lengths))
        for group in np.split(np.arange(len(lengths)), np.flatnonzero(np.array(slips) == 0) + 1):
            steps = [slips[j - 1] * logs[j - 1] for j in group[1:]]
            ratios, spans = np.exp(np.cumsum([0.0, *steps])), lengths[group]
            total, strain = material[group].sum(), 0.0
            for _ in range(50):
                shares = 1 / (1 + ratios * strain)
                change = (spans @ shares - total) / (spans * ratios @ shares**2)
                strain += change
                if abs(change) < 1e-16:
                    break
            strains[group] = ratios * strain
        return strains

    def unstrained(self, place: np.ndarray, strains: np.ndarray) -> np.ndarray:
        """Unstrained lengths (p + 1,)."""
        return self.measure(place)[0] / (1 + strains)

    def decide(self, place: np.ndarray, material: np.ndarray) -> tuple[int, ...]:
        """Where it slips, from these unstrained lengths, to be at a place where it is tight."""
        logs = self.measure(place)[1]
        for slips in product((0, 1, -1), repeat=len(logs)):
            strains = self.strains(place, material, slips)
            if strains.min() <= 0:
                continue
            slides = np.cumsum((self.unstrained(place, strains) - material)[::-1])[-2::-1]
            excess = (np.abs(np.diff(np.log(strains))) - logs) * (np.array(slips) == 0)
            if min(slides * slips) >= -ROUNDING and max(excess) <= ROUNDING:
                return slips
        raise RuntimeError(f"no pattern of slipping at {place}")

    def longer(self, place: np.ndarray) -> float:
        """By how much it is longer than at rest (m)."""
        return self.measure(place)[0].sum() - self.rest

    def acceleration(self, place: np.ndarray, tension: float) -> np.ndarray:
        """Of the mass (m/s²)."""
        return np.array([0.0, -G]) + tension / self.mass * self.measure(place)[2]


@dataclass(frozen=True)
class Phase:
    """From one event to the next: start and end (s), the motion, what slips; None: slack."""

    start: float
    end: float
    motion: Callable[[float], np.ndarray]
    slips: tuple[int, ...] | None
    material: np.ndarray

    def tensions(self, rope: Rope, time: float) -> np.ndarray:
        """Of all stretches (N)."""
        if self.slips is None:
            return np.zeros(len(rope.fixed))
        return rope.EA * rope.strains(self.motion(time)[:2], self.material, self.slips)

    def energy(self, rope: Rope, time: float) -> float:
        """Of motion, height and strain (J)."""
        state, tensions = self.motion(time), self.tensions(rope, time)
        lengths = rope.unstrained(state[:2], tensions / rope.EA)
        strain_energy = tensions**2 @ lengths / (2 * rope.EA)
        return rope.mass * (0.5 * state[2:] @ state[2:] + G * state[1]) + strain_energy


def phases(rope: Rope, place: np.ndarray, duration: float) -> Iterator[Phase]:
    """The motion of the mass, let go slack at a place (2,), up to a duration (s)."""
    time, state, slips = 0.0, np.array([*place, 0.0, 0.0]), None
    material = np.zeros(len(rope.fixed))
    while time < duration:
        phase = _phase(rope, time, state, slips, material, duration)
        yield phase
        time, state = phase.end, phase.motion(phase.end)
        tensions = phase.tensions(rope, time)
        material = rope.unstrained(state[:2], tensions / rope.EA)
        pull = rope.acceleration(state[:2], tensions[-1])
        change = np.concatenate([state[2:] + 0.5 * MOMENT * pull, pull]) * MOMENT
        time, state = time + MOMENT, state + change
        slips = None
        if rope.longer(state[:2]) > 0:
            slips = rope.decide(state[:2], material)
            material = rope.unstrained(state[:2], rope.strains(state[:2], material, slips))


def _phase(rope, time, state, slips, material, duration) -> Phase:
    """Integrated up to the next event."""
    if slips is None:
        events = [lambda t, y: -rope.longer(y[:2])]
    else:
        events = [lambda t, y: rope.longer(y[:2])]
        events += [_event(rope, material, slips, j) for j in range(len(slips))]
    for event in events:
        event.terminal, event.direction = True, -1

    def rates(_, y):
        tension = 0.0
        if slips is not None:
            tension = rope.EA * rope.strains(y[:2], material, slips)[-1]
        return np.concatenate([y[2:], rope.acceleration(y[:2], tension)])

    solution = solve_ivp(
        rates, (time, duration), state, "DOP853", dense_output=True, events=events,
        rtol=1e-10, atol=1e-12, max_step=0.02,
    )  # fmt: skip
    return Phase(time, solution.t[-1], solution.sol, slips, material)


def _event(rope: Rope, material: np.ndarray, slips, j: int) -> Callable:
    """What gets negative as eyelet j begins to slip, or as its slip turns back."""

    def margin(_, y):
        strains = rope.strains(y[:2], material, slips)
        return rope.measure(y[:2])[1][j] - abs(np.log(strains[j + 1] / strains[j]))

    def rate(_, y):
        ends = []
        for shift in (-MOMENT, MOMENT):
            place = y[:2] + shift * y[2:]
            strains = rope.strains(place, material, slips)
            ends.append(rope.unstrained(place, strains)[j + 1 :].sum())
        return slips[j] * (ends[1] - ends[0])

    return rate if slips[j] else margin
