"""Two arms driven by motors: a structure that follows measured torques, which lie beside the
project.

The authors' numbers (github.com/dfki-ric-underactuated-lab/double_pendulum, design C.1, model 2.0)
are those of the equations of motion. The second arm's inertia about the elbow is below its mass
times the distance² of its centre, as of no rigid body. Only the products and sums in these
equations count: here the second arm is heavier and its centre nearer, and the first arm lighter,
for the same equations. Their dry friction is cf arctan(100 w), so that it is pi/2 cf here."""

import json
import os
import tempfile
from pathlib import Path

import numpy as np

import fpm
from evidence.registry import ROOT
from fpm.structures.curves_file import CurvesFile

CURVES = Path(os.environ.get("MEASURED", ROOT.parent / "shared/measured"), "two_arms_driven.csv")
STEP = 1e-4  # s

TEXT = """
name: two_arms
description: Two arms that hang, with a motor at each joint
let:
  length: 0.2 m # of the first arm
  distance: 0.3 m # of the second arm's centre from the elbow; the authors' is 0.4684 m
  mass: 0.3369 kg*0.4684 m/distance # of the second arm
  excess: mass - 0.3369 kg
  offset: (0.7586 kg*0.2 m - excess*length)/0.7586 kg # of the first arm's centre
  shaft: 6.287e-5 kg m2 # inertia of each motor, whose gear is 6
  upper: 0.04211 kg m2 - excess*length**2 - 0.7586 kg*offset**2 + 36*shaft
  lower: 0.05104 kg m2 - mass*distance**2
points:
  O: [0, 0, 0]
  A: [0, 0, -offset]
  B: [0, 0, -length]
  C: [0, 0, -length - distance]
bodies:
  first_arm: {mass: 0.7586 kg, centre: A, points: [O, B], inertia: [upper, upper, upper]}
  second_arm: {mass: mass, centre: C, points: [B], inertia: [lower, lower, lower]}
  rotor: {mass: 1e-6 kg, centre: B, inertia: [shaft, shaft, shaft]}
joints:
  shoulder: {type: revolute, parts: [ground, first_arm], at: O, axis: y}
  elbow: {type: revolute, parts: [first_arm, second_arm], at: B, axis: y}
  axle: {type: revolute, parts: [first_arm, rotor], at: B, axis: y}
curves:
  one: {file: FILE, column: torque_shoulder}
  two: {file: FILE, column: torque_elbow}
actions:
  motor_1: {type: torque motor, joint: shoulder, torque: 1 N m, curve: one}
  motor_2: {type: torque motor, joint: elbow, torque: 1 N m, curve: two}
  gear: {type: loop, joints: [elbow, axle], radii: [60 mm, -10 mm], stiffness: 1 MN/m, preload: 9 N}
  oil_1: {type: damper, joint: shoulder, damping: 3.69e-3 N m s/rad}
  oil_2: {type: damper, joint: elbow, damping: 6.45e-4 N m s/rad}
  rub_1: {type: friction, joint: shoulder, moment: pi/2*0.1747 N m, sticks: exactly}
  rub_2: {type: friction, joint: elbow, moment: pi/2*0.1100 N m, sticks: exactly}
gravity: [0, 0, -9.81]
"""


def simulate_arms(curves: Path, duration: float) -> np.ndarray:
    """Angles (3, T): time (s), shoulder and elbow (rad), from rest at hanging, with the torques in
    the file `curves`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "two_arms.yaml")
        path.write_text(TEXT.replace("FILE", json.dumps(str(curves.resolve()))), encoding="utf-8")
        scene = fpm.structures.load(path).build()
    (outcome,) = fpm.simulate(scene, duration=duration, instants=1001, step=STEP)
    return np.array([outcome.time, outcome.openings["shoulder"], outcome.openings["elbow"]])


def largest_differences(curves: Path, duration: float) -> dict[str, float]:
    """Largest differences (rad) of the simulated angles from those in the file `curves`."""
    file, (times, *angles) = CurvesFile.read(curves), simulate_arms(curves, duration)
    rows = file.times <= duration
    return {
        name: float(np.abs(np.interp(file.times, times, angle) - file.columns[name])[rows].max())
        for name, angle in zip(("shoulder", "elbow"), angles, strict=True)
    }
