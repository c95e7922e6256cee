"""Samples of a structure built together have the bits of those built one by one, and its errors."""

from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest

from fpm import SceneError, structures
from fpm.solver.pack import check_topology, pack
from fpm.solver.start import consistent_scene, consistent_scenes

LIBRARY = sorted((Path(__file__).parents[2] / "config" / "structures").glob("*.yaml"))
SHIFTS = np.array([0.0, 1.0, -1.0, 0.5, -0.3])


def content(value):
    """What a value is made of, as nested tuples with the bits of numbers."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, float):
        return np.float64(value).tobytes()
    if isinstance(value, dict):
        return [(key, content(item)) for key, item in value.items()]
    if isinstance(value, list | tuple):
        return [content(item) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        return type(value), [content(getattr(value, field.name)) for field in fields(value)]
    return value


def contents(scenes):
    return [content(vars(scene)) for scene in scenes]


def samples_of(structure, names, share=1e-3):
    """Values of some parameters about their defaults, within their ranges."""
    parameters = structure.parameters
    middles = {name: parameters[name].default for name in names}
    rows = [{n: m + (m or 0.01) * share * s for n, m in middles.items()} for s in SHIFTS]
    return [
        row
        for row in rows
        if all(parameters[n].least <= x <= parameters[n].most for n, x in row.items())
    ]


def built(structure, samples):
    """Scenes that are built one by one, or None where one of them is refused."""
    try:
        return [structure.build(**sample) for sample in samples]
    except SceneError:
        return None


LONG = ("ring_truss", "solar_array", "umbrella")
"""Structures that take long; lanes of the first two are compared below."""


@pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=pytest.mark.slow if p.stem in LONG else ()) for p in LIBRARY],
    ids=lambda path: path.stem,
)
def test_samples_built_together_are_those_built_alone(path):
    structure = structures.load(path)
    real = [name for name, p in structure.parameters.items() if not p.is_whole]
    choices = [[name] for name in real] + [real[:3]]
    count = 0
    for names in choices:
        samples = samples_of(structure, names)
        alone = built(structure, samples)
        if alone is not None:
            assert contents(structure.build_all(samples)) == contents(alone), names
            count += len(samples) >= 4
    assert count > len(choices) / 3


def lanes_of(part, lane):
    """The bits of a lane of all arrays in nested tuples that have one."""
    if isinstance(part, tuple):
        return [lanes_of(item, lane) for item in part]
    is_lane = isinstance(part, np.ndarray) and part.dtype.kind == "f" and part.shape[-1:] == (8,)
    return part[..., lane].tobytes() if is_lane else None


@pytest.mark.parametrize(
    ("name", "names"),
    [
        ("solar_array", ("k", "c", "latch")),
        ("nfourbar", ("v",)),
        ("telescope", ("push", "rub")),
        ("ring_truss", ("over", "EA", "mu")),
        ("bennett", ("a", "E")),
        ("wing", ("k", "level", "timer")),
    ],
)
def test_lanes_of_samples_built_together_are_those_of_each_alone(name, names):
    structure = structures.load(LIBRARY[0].with_name(f"{name}.yaml"))
    samples = samples_of(structure, names)
    scenes = consistent_scenes(structure.build_all(samples))
    check_topology(scenes)
    together = pack(scenes, 3)
    for lane, sample in enumerate(samples):
        alone = pack([consistent_scene(structure.build(**sample))], 3)
        parts = zip((together, alone), (lane, 0), strict=True)
        first, second = (
            lanes_of((batch.parts(), batch.world(), batch.record(1e-5, 100)), k)
            for batch, k in parts
        )
        assert first == second, sample


FILE = """
parameters:
  heavy: {value: 1, unit: kg, range: [0.1, 10]}
  extra: {value: 0, unit: kg, range: [0, 10]}
  k: {value: 1, unit: N m/rad, range: [0, 10]}
  x: {value: 1, range: [-2, 2]}
  mu: {value: 0.1, range: [0, 1]}
  more: {value: 0.2, range: [0, 1]}
  lower: {value: -1, range: [-9, 9]}
let:
  rest: sqrt(x)*(1 rad)
points: {O: [0, 0, 0], A: [1, 0, 0], B: [2, 0, 0], C: [2.5, 0.5, 0]}
bodies:
  one: {mass: heavy, centre: O, points: [A], inertia: [1, 1, 1]}
  second: {mass: 2, centre: B, points: [A, C], inertia: [1, 2, 2]}
masses:
  lump: {part: second, at: C, mass: 0.3 kg + extra}
joints:
  hinge: {type: revolute, parts: [one, second], at: A, axis: z}
actions:
  spring: {type: torsion spring, joint: hinge, stiffness: k, rest: rest}
  dry: {type: bearing, joint: hinge, mu: mu, radius: 0.01}
  wet: {type: bearing, joint: hinge, mu: more, radius: 0.02}
  plain: {type: bearing, joint: hinge, mu: 0.3, radius: 0.02}
  stop: {type: stop, joint: hinge, lower: lower*(1 rad), stiffness: 10}
loads:
  push: {part: second, at: C, force: [0, 1, 0]}
  late: {part: second, at: C, force: [0, x*(1 N), 0]}
initial_velocities:
  second: {part: second, about: C, velocity: [x*(1 m/s), 0, 0], spin: [0, 0, 1]}
record:
  tip: {part: second, at: C}
"""


def test_a_sample_that_is_refused_is_refused_as_alone():
    structure = structures.loads(FILE)
    samples = [{"x": value} for value in (1.0, 0.5, -1.0, 0.7)]
    with pytest.raises(SceneError) as alone:
        structure.build(**samples[2])
    assert "let.rest: 'sqrt(x)*(1 rad)' is not allowed" in str(alone.value)
    with pytest.raises(SceneError) as together:
        structure.build_all(samples)
    assert str(together.value) == str(alone.value)
    with pytest.raises(SceneError, match="structure has no parameter y"):
        structure.build_all([{"x": 1.0}] * 4 + [{"y": 1.0}])
