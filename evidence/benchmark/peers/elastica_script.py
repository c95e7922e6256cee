"""Rods in PyElastica: a script for the interpreter that has PyElastica.

Reads {"elements", "length", "side", "E", "nu", "rho", "duration", "runs": [{"rods", "step"}]} from
the file named in its first argument, and prints one JSON object per run: straight rods of a square
section's area, in a row, hinged to each other by PyElastica's joints (springs), that swing sideways
at first at 1 m/s. `elements` and `length` (m) are those of all rods
together."""

import json
import sys
import time
from importlib.metadata import version
from itertools import pairwise

import elastica as ea
import numpy as np


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Connections):
    """What the rods live in."""


def build(task, rods):
    simulator = Simulator()
    elements, length = task["elements"] // rods, task["length"] / rods
    shear = task["E"] / (2 * (1 + task["nu"]))
    all_rods = []
    for k in range(rods):
        rod = ea.CosseratRod.straight_rod(
            elements,
            start=np.array([k * length, 0.0, 0.0]),
            direction=np.array([1.0, 0.0, 0.0]),
            normal=np.array([0.0, 0.0, 1.0]),
            base_length=length,
            base_radius=task["side"] / np.sqrt(np.pi),
            density=task["rho"],
            youngs_modulus=task["E"],
            shear_modulus=shear,
        )
        x = rod.position_collection[0]
        rod.velocity_collection[1] = np.sin(np.pi * x / task["length"])
        simulator.append(rod)
        all_rods.append(rod)
    for first, second in pairwise(all_rods):
        joint = simulator.connect(
            first_rod=first, second_rod=second, first_connect_idx=-1, second_connect_idx=0
        )
        joint.using(ea.HingeJoint, k=1e6, nu=0.0, kt=1e2, normal_direction=np.array([0, 0, 1.0]))
    simulator.finalize()
    return simulator, all_rods


def run(task, rods, step):
    """Cpu and wall seconds of a run after one of a few steps, which compiles."""
    simulator, all_rods = build(task, rods)
    stepper = ea.PositionVerlet()
    warm = 10
    ea.integrate(stepper, simulator, final_time=warm * step, n_steps=warm, progress_bar=False)
    steps = round(task["duration"] / step)
    wall, cpu = time.perf_counter(), time.process_time()
    ea.integrate(stepper, simulator, final_time=steps * step, n_steps=steps, progress_bar=False)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    speeds = np.concatenate([rod.velocity_collection for rod in all_rods], axis=1)
    sane = bool(np.isfinite(speeds).all() and np.abs(speeds).max() < 10.0)
    return {"ok": sane, "wall": wall, "cpu": cpu, "steps": steps, "version": version("pyelastica")}


def main(path):
    with open(path) as file:
        task = json.load(file)
    for options in task["runs"]:
        try:
            result = run(task, options["rods"], options["step"])
        except Exception as error:  # a rod that breaks down stops with several kinds
            result = {"ok": False, "error": str(error)[:300]}
        print(json.dumps({**options, **result}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
