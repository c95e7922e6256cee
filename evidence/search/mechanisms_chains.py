"""Boxes of 12 to 40 tolerances with known bounds: chains, stacks, trains and many latches."""

from __future__ import annotations

import numpy as np

from evidence.search.mechanisms_slides import SLIDE, TRAVEL, mechanism, peak

DESIGN = {"method": "screening", "samples": 400}


def rows(count: int, line: str) -> str:
    """Lines, or parameters, one for each number i from 1, with h = i - 1 and j = i + 1."""
    return "".join(line.format(i=i, h=i - 1, j=i + 1) for i in range(1, count + 1))


def tips(*values):
    """Gap between the tips of two arms of three links, and the height of one."""
    lengths, angles = np.array(values[:6]), np.array(values[6:])
    ends = []
    for part in (slice(0, 3), slice(3, 6)):
        turns = np.cumsum(angles[part], axis=0)
        ends.append([(lengths[part] * f(turns)).sum(axis=0) for f in (np.cos, np.sin)])
    (x, y), (r, s) = ends
    return np.hypot(x + r - 1.8 * np.cos(0.3) - 1e-3, y - s), y


def stack(*values):
    """Side step of a stack of eccentric rings: each acts only together with its angle."""
    e, a = np.array(values[:8]), np.array(values[8:])
    return (e * np.sin(a)).sum(axis=0), np.hypot(
        0.2 + (e * np.cos(a)).sum(axis=0), (e * np.sin(a)).sum(axis=0)
    )


def sums(*values):
    """A mass of ten parts on ten springs: when it passes the middle, and how fast."""
    w = np.sqrt(np.sum(values[10:], axis=0) / np.sum(values[:10], axis=0))
    return np.pi / 2 / w, 0.1 * w


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


LINKS = [(c, i, f"rod_{c}{i - 1}" if i > 1 else "ground") for c in "ab" for i in (1, 2, 3)]

BOXES = (
    mechanism(
        "12: gap of two arms",
        rows(3, "l{i} m 0.298 0.302,")
        + rows(3, "r{i} m 0.298 0.302,")
        + "p1 rad 0.295 0.305,p2 rad -0.005 0.005,p3 rad -0.005 0.005,"
        "q1 rad 0.295 0.305,q2 rad -0.005 0.005,q3 rad -0.005 0.005",
        """
let: {span: (1.8 m)*cos(0.3 rad) + 1 mm, pa: p1 + p2, pb: pa + p3, qa: q1 + q2, qb: qa + q3}
points:
  a0: [0, 0, 0]
  a1: a0 + l1*[cos(p1), sin(p1), 0]
  a2: a1 + l2*[cos(pa), sin(pa), 0]
  a3: a2 + l3*[cos(pb), sin(pb), 0]
  b0: [span, 0, 0]
  b1: b0 + r1*[-cos(q1), sin(q1), 0]
  b2: b1 + r2*[-cos(qa), sin(qa), 0]
  b3: b2 + r3*[-cos(qb), sin(qb), 0]
bodies:
"""
        + "".join(
            f"  rod_{c}{i}: {{type: rod, from: {c}{i - 1}, to: {c}{i}, mass: 1, diameter: 2 cm}}\n"
            for c, i, _ in LINKS
        )
        + "joints:\n"
        + "".join(
            f"  on_{c}{i}: {{type: revolute, at: {c}{i - 1}, axis: z, "
            f"parts: [{part}, rod_{c}{i}]}}\n"
            for c, i, part in LINKS
        )
        + "record: {a: {part: rod_a3, at: a3}, b: {part: rod_b3, at: b3}}",
        tips,
        {"way": {"distance": ["a", "b"]}, "top": {"position": "a", "component": "y"}},
        {"gap": {"final": "way"}, "height": {"final": "top"}},
        duration=0.01,
        instants=11,
        design=DESIGN,
    ),
    mechanism(
        "16: stack of eccentric rings",
        rows(8, "e{i} m -0.001 0.001,") + rows(8, "t{i} rad -0.5 0.5,").rstrip(","),
        "points:\n  o: [0, 0, 0]\n  p0: [0.2 m, 0, 0]\n"
        + rows(8, "  p{i}: p{h} + e{i}*[cos(t{i}), sin(t{i}), 0]\n")
        + """
bodies: {stack: {mass: 1, centre: o, points: [p8], box: [10 cm, 10 cm, 10 cm]}}
joints: {foot: {type: revolute, parts: [ground, stack], at: o, axis: z}}
record: {o: {part: ground, at: o}, top: {part: stack, at: p8}}
""",
        stack,
        {"y": {"position": "top", "component": "y"}, "way": {"distance": ["o", "top"]}},
        {"side": {"final": "y"}, "height": {"final": "way"}},
        duration=0.01,
        instants=11,
        design=DESIGN,
    ),
    mechanism(
        "20: sums of masses and springs",
        rows(10, "w{i} kg 0.07 0.13,") + rows(10, "k{i} N/m 0.8 1.2,").rstrip(","),
        SLIDE.replace("mass: mass", "mass: " + "+".join(f"w{i}" for i in range(1, 11)))
        + "actions:\n"
        + rows(10, "  s{i}: {{type: spring, joint: slide, stiffness: k{i}, rest: 0}}\n")
        + "record: {block: {part: block, at: o}}",
        sums,
        TRAVEL | {"speed": {"velocity": "block", "component": "norm"}},
        {"t_zero": {"crossing": "way", "level": 0}, "fastest": {"largest": "speed"}},
        start="0.1 m",
        duration=1.0,
        instants=401,
        design=DESIGN,
    ),
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
