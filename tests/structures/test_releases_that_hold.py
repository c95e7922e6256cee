"""Releases that would hold for ever, told before anything runs."""

import pytest

from fpm.structures.plausible import warnings
from fpm.structures.text_file import loads

WING = """
name: wing
points: {root: [0, 0, 0], p: [0.5, 0, 0], middle: [1, 0, 0], q: [1.5, 0, 0], end: [2, 0, 0]}
bodies:
  inboard: {mass: 1 kg, centre: p, inertia: [0.1, 0.1, 0.1], points: [root, middle]}
  outboard: {mass: 1 kg, centre: q, inertia: [0.1, 0.1, 0.1], points: [middle, end]}
joints:
  root: {type: revolute, parts: [ground, inboard], at: root, axis: z}
  middle: {type: revolute, parts: [inboard, outboard], at: middle, axis: z}
actions:
  spring: {type: torsion spring, joint: root, stiffness: 1 N m/rad, rest: 180 deg}
  end_of_root: {type: ROOT}
  bolt: {type: release, joint: middle, RELEASE}
record:
  end: {part: outboard, at: end}
"""
LATCH = "latch, joint: root, angle: 90 deg, side: below"
STOP = "stop, joint: root, upper: 60 deg, stiffness: 10 N m/rad"
WAITS = "release on middle waits until root passes 89 deg, "


@pytest.mark.parametrize(
    ("root", "release", "words"),
    [
        (LATCH, "watch: root, level: 89 deg", None),
        (LATCH, "watch: root, level: 95 deg, time: 9 s", None),
        (
            LATCH + ", capture_range: 2 deg",
            "watch: root, level: 89 deg",
            WAITS + "beyond 88 deg",
        ),
        (LATCH.replace("below", "above"), "watch: root, level: 95 deg", None),
        (STOP, "watch: root, level: 89 deg", WAITS + "beyond the stop at 60 deg"),
        (STOP, "watch: root, level: -89 deg", None),
        (LATCH, "watch: middle, level: 89 deg", "watches the joint that it holds"),
        (LATCH, "time: 11 s", "lets go at 11 s: the run ends at 10 s"),
    ],
)
def test_what_keeps_a_release_from_letting_go_is_told(root, release, words):
    scene = loads(WING.replace("ROOT", root).replace("RELEASE", release)).build()
    sentences = [text for text in warnings(scene, 10.0) if text.startswith("release")]
    assert len(sentences) == bool(words) and (words or "") in "".join(sentences)
