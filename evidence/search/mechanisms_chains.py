"""Boxes of 30 and 40 tolerances with known bounds: a train of masses, and many latches."""

from __future__ import annotations

import numpy as np

from evidence.search.mechanisms_slides import mechanism, peak

DESIGN = {"method": "screening", "samples": 400}


def rows(count: int, line: str) -> str:
    """Lines, or parameters, one for each number i from 1, with h = i - 1 and j = i + 1."""
    return "".join(line.format(i=i, h=i - 1, j=i + 1) for i in range(1, count + 1))


def train(*values):
    """A blow on the end of a train of masses and springs: force at its root, way of its end."""
    m, k = np.array(values[:15]).T, np.array(values[15:]).T
    stiff = np.zeros((len(m), 15, 15))
    i = np.arange(15)
    stiff[:, i, i] = k + np.column_stack([k[:, 1:], 0 * k[:, 0]])
    stiff[:, i[1:], i[:-1]] = stiff[:, i[:-1], i[1:]] = -k[:, 1:]
    root = 1 / np.sqrt(m)
    squares, shapes = np.linalg.eigh(stiff * root[:, :, None] * root[:, None, :])
    w, times = np.sqrt(squares), np.linspace(0, 2.5, 501)
    waves = np.sin(w[:, :, None] * times) / w[:, :, None]
    kick = shapes[:, -1] / root[:, -1:]
    force = k[:, :1] * root[:, :1] * ((shapes[:, 0] * kick)[:, None] @ waves)[:, 0]
    travel = root[:, -1] * np.sum(shapes[:, -1] * kick * waves[:, :, 200], axis=1)
    return -peak(force), 1.5 + travel


def latches(*values):
    """Twenty hubs on springs: when the first, the tenth and the last of them latches."""
    times = np.sort(np.pi / 3 * np.sqrt(np.array(values[:20]) / np.array(values[20:])), axis=0)
    return times[0], times[9], times[19]


BOXES = (
    mechanism(
        "30: train of masses and springs",
        rows(15, "w{i} kg 0.8 1.2,") + rows(15, "k{i} N/m 80 120,").rstrip(","),
        "points:\n"
        + rows(15, "  p{i}: [{i}*(0.1 m), 0, 0]\n")
        + "bodies:\n"
        + rows(
            15,
            "  b{i}: {{mass: w{i}, centre: p{i}, box: [5 cm, 5 cm, 5 cm], points: [p{i}, p{j}]}}\n",
        ).replace(", p16", "")
        + "joints:\n"
        + rows(
            15, "  j{i}: {{type: prismatic, parts: [b{h}, b{i}], at: p{i}, axis: x, opening: 0}}\n"
        ).replace("b0,", "ground,")
        + "actions:\n"
        + rows(15, "  s{i}: {{type: spring, joint: j{i}, stiffness: k{i}, rest: 0}}\n")
        + "initial_velocities: {blow: {part: b15, about: p15, velocity: [1 m/s, 0, 0]}}\n"
        "record: {end: {part: b15, at: p15}}",
        train,
        {
            "pull": {"joint_moment": "j1", "part": "spring"},
            "x": {"position": "end", "component": "x"},
        },
        {"force": {"smallest": "pull"}, "way": {"value": "x", "at": 1.0}},
        duration=2.5,
        instants=1001,
        design=DESIGN,
    ),
    mechanism(
        "40: twenty latches",
        rows(20, "I{i} kg_m2 0.9 1.1,") + rows(20, "k{i} N_m/rad 0.9 1.1,").rstrip(","),
        "points:\n"
        + rows(20, "  p{i}: [{i}*(0.1 m), 0, 0]\n")
        + "bodies:\n"
        + rows(20, "  b{i}: {{mass: 1, centre: p{i}, inertia: [I{i}, I{i}, I{i}]}}\n")
        + "joints:\n"
        + rows(
            20, "  j{i}: {{type: revolute, parts: [ground, b{i}], at: p{i}, axis: z, opening: 0}}\n"
        )
        + "actions:\n"
        + rows(
            20,
            "  s{i}: {{type: torsion spring, joint: j{i}, stiffness: k{i}, rest: 2 rad}}\n"
            "  pin{i}: {{type: latch, joint: j{i}, angle: 1 rad}}\n",
        ),
        latches,
        {"angle": {"opening": "j1"}},
        {f"t_{n}": {"event": "latches", "number": n} for n in (1, 10, 20)},
        duration=1.5,
        instants=301,
        design=DESIGN,
    ),
)
