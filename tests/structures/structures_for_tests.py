"""Files of structures, and what is said about those that are wrong."""

import sys
from pathlib import Path

import numpy as np
import pytest

from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import SceneType
from fpm.structures import StructureError, load, loads

FOLDER = Path(__file__).parents[2] / "config" / "structures"

# A bar on the ground: the smallest file that others are made of by changing a line.
SMALL = """
parameters:
  L: {value: 1, unit: m, range: [0.1, 10], description: length}
  stow: {value: 20, unit: deg}
  n: {value: 2, whole: true, range: [2, 50]}
mesh: n
let:
  half: L/2
points:
  A: [0, 0, 0]
  B: [L*cos(stow), 0, L*sin(stow)]
materials:
  steel: {E: 210 GPa, nu: 0.3, rho: 7850 kg/m3}
sections:
  tube: {type: tube, diameter: 35 mm, thickness: 2 mm}
bars:
  arm: {through: [A, B], section: tube, material: steel, elements: n}
joints:
  root: {type: revolute, parts: [ground, arm], at: A, axis: y}
actions:
  spring: {type: torsion spring, joint: root, stiffness: 3 N m/rad, rest: 90 deg}
record:
  tip: {part: arm, at: B}
"""

# A plane four-bar whose coupler is a bar of length 1 m + slack, stated from B.
FOURBAR = """
assemble: {hold: [A]}
parameters:
  slack: {value: 10, unit: mm, range: [-500, 5000]}
points:
  A: [0, 0, 0]
  B: [0, 1 m, 0]
  end: [1 m + slack, 1 m, 0]
  C: [1 m, 1 m, 0]
  D: [1 m, 0, 0]
materials: {steel: {E: 210 GPa, rho: 7850}}
sections: {rod: {type: circle, diameter: 20 mm}}
bars:
  AB: {through: [A, B], section: rod, material: steel, elements: 2}
  BC: {through: [B, end], section: rod, material: steel, elements: 2}
  CD: {through: [C, D], section: rod, material: steel, elements: 2}
joints:
  A: {type: revolute, parts: [ground, AB], at: A, axis: z}
  B: {type: revolute, parts: [AB, BC], at: B, axis: z}
  C: {type: revolute, parts: [BC, CD], at: {BC: end, CD: C}, axis: z}
  D: {type: revolute, parts: [CD, ground], at: D, axis: z}
record:
  C: {part: CD, at: C}
"""


def structure(name: str) -> SceneType:
    """A structure of the library."""
    return load(FOLDER / f"{name}.yaml")


def content(scene: Scene) -> str:
    """All that a scene has, to the last bit."""
    with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
        return repr(vars(scene))


def changed(text: str, *changes: tuple[str, str]) -> str:
    """The text with parts replaced once, each of which it has."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def problems_of(text: str) -> list[str]:
    """What is wrong with a file's text, sentence by sentence."""
    with pytest.raises(StructureError) as caught:
        loads(text)
    return [str(problem) for problem in caught.value.problems]


def refused(text: str, old: str, new: str, said: str) -> list[str]:
    """All that is said of a text with one part replaced: some of it must be what is expected."""
    found = problems_of(changed(text, (old, new)))
    assert any(said in problem for problem in found), found
    return found
