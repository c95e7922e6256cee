"""The linkage in Exudyn: a script for the interpreter that has Exudyn, whatever its version.

Reads {"structure": ..., "duration": s, "instants": n, "runs": [...]} from the file named in its
first argument, and prints one JSON object per run, with the places of the structure's named points
at the instants. The compiled module without range checks is taken. Beams are geometrically exact.
Joints are ideal, or stiff springs with an explicit integrator, which takes no constraints."""

import json
import sys
import time

sys.exudynFast = True

import exudyn as exu  # noqa: E402
import numpy as np  # noqa: E402
from exudyn import itemInterface as item  # noqa: E402
from exudyn.rigidBodyUtilities import (  # noqa: E402
    RotationMatrix2EulerParameters,
    RotationMatrix2RotationVector,
)

PENALTY = 1e6
"""Stiffness (N/m) of the springs that stand for joints with an explicit integrator."""


def build(mbs, structure, explicit):
    """Everything but what is recorded; returns the markers of the named points."""
    nodes = _nodes(mbs, structure, explicit)
    _beams(mbs, structure, nodes)
    bodies = _bodies(mbs, structure, nodes)
    _hinges(mbs, structure, bodies, explicit)
    return {
        name: marker(mbs, bodies[point["node"]], point["arm"], np.eye(3))
        for name, point in structure["points"].items()
    }


def _nodes(mbs, structure, explicit):
    """Numbers of the nodes."""
    numbers = []
    for position, frame in zip(structure["position"], structure["frame"], strict=True):
        frame = np.array(frame)
        if explicit:
            turn = list(RotationMatrix2RotationVector(frame))
            node = item.NodeRigidBodyRotVecLG(referenceCoordinates=position + turn)
        else:
            turn = list(RotationMatrix2EulerParameters(frame))
            node = item.NodeRigidBodyEP(referenceCoordinates=position + turn)
        numbers.append(mbs.AddNode(node))
    return numbers


def _beams(mbs, structure, nodes):
    for element in structure["elements"]:
        section = exu.BeamSection()
        section.stiffnessMatrix = np.diag(element["stiffness"])
        section.massPerLength = element["mass"]
        section.inertia = np.diag(element["inertia"])
        pair = [nodes[i] for i in element["nodes"]]
        beam = item.ObjectBeamGeometricallyExact(
            nodeNumbers=pair, length=element["length"], sectionData=section
        )
        mbs.AddObject(beam)


def _bodies(mbs, structure, nodes):
    """Bodies by node, to which arms can be fixed: on nodes of beams, of next to no mass."""
    ends = [n for hinge in structure["hinges"] for n in hinge["nodes"]]
    ends += [point["node"] for point in structure["points"].values()]
    light = {"mass": 1e-12, "inertia": [1e-15] * 3 + [0.0] * 3}
    return {
        n: mbs.AddObject(item.ObjectRigidBody(nodeNumber=nodes[n], **light))
        for n in dict.fromkeys(ends)
    }


def marker(mbs, body, arm, frame):
    """A marker at the end of a rigid arm with axes of its own."""
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = frame, arm
    return mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=body, localHT=transform))


def _hinges(mbs, structure, bodies, explicit):
    """Joints, their springs and the supports."""
    for hinge in structure["hinges"]:
        markers = [
            marker(mbs, bodies[n], arm, np.array(frame))
            for n, arm, frame in zip(hinge["nodes"], hinge["arms"], hinge["frames"], strict=True)
        ]
        if explicit:
            stiff = np.diag([PENALTY] * 3 + [PENALTY * 1e-3] * 2 + [0.0])
            mbs.AddObject(
                item.ObjectConnectorRigidBodySpringDamper(markerNumbers=markers, stiffness=stiff)
            )
        else:
            mbs.AddObject(item.ObjectJointRevoluteZ(markerNumbers=markers))
        if hinge["stiffness"]:
            spring = item.ObjectConnectorTorsionalSpringDamper(
                markerNumbers=markers,
                stiffness=hinge["stiffness"],
                offset=hinge["rest"] - hinge["opening"],
            )
            mbs.AddObject(spring)
        if hinge["support"]:
            _support(mbs, structure, hinge, bodies, explicit)


def _support(mbs, structure, hinge, bodies, explicit):
    node = hinge["nodes"][0]
    point = marker(mbs, bodies[node], hinge["arms"][0], np.eye(3))
    place = np.array(structure["position"][node])
    place = place + np.array(structure["frame"][node]) @ np.array(hinge["arms"][0])
    ground = mbs.AddNode(item.NodePointGround(referenceCoordinates=list(place)))
    ground = mbs.AddMarker(item.MarkerNodePosition(nodeNumber=ground))
    axes = [int(axis in hinge["support"]) for axis in "xyz"]
    if explicit:
        spring = item.ObjectConnectorCartesianSpringDamper(
            markerNumbers=[ground, point], stiffness=[PENALTY * h for h in axes]
        )
        mbs.AddObject(spring)
    else:
        joint = item.ObjectJointSpherical(markerNumbers=[ground, point], constrainedAxes=axes)
        mbs.AddObject(joint)


def run(task, options):
    """Cpu seconds of solving, and the places (m) of the points at the instants."""
    explicit, step, duration = "solver" in options, options["step"], task["duration"]
    exu.config.printToConsole = False
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    points = build(mbs, task["structure"], explicit)
    position = exu.OutputVariableType.Position
    sensors = {
        name: mbs.AddSensor(
            item.SensorMarker(markerNumber=point, outputVariableType=position, storeInternal=True)
        )
        for name, point in points.items()
    }
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(duration / step)
    settings.timeIntegration.endTime = duration
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.stepInformation = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = duration / (task["instants"] - 1)
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.parallel.numberOfThreads = 1
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    if explicit:
        kind = getattr(exu.DynamicSolverType, options["solver"])
    else:
        kind = exu.DynamicSolverType.GeneralizedAlpha
    solver_start = time.process_time()
    success = mbs.SolveDynamic(settings, solverType=kind)
    cpu = time.process_time() - solver_start
    curves = {name: mbs.GetSensorStoredData(sensor) for name, sensor in sensors.items()}
    times = np.linspace(0, duration, task["instants"])
    places = {
        name: np.column_stack([np.interp(times, rows[:, 0], x) for x in rows[:, 1:].T]).tolist()
        for name, rows in curves.items()
    }
    return {
        "ok": bool(success) and all(np.isfinite(rows).all() for rows in curves.values()),
        "cpu": cpu,
        "steps": round(duration / step),
        "points": places,
        "version": exu.__version__,
    }


def main(path):
    with open(path) as file:
        task = json.load(file)
    for options in task["runs"]:
        try:
            result = run(task, options)
        except Exception as error:  # Exudyn reports a failed step by several kinds
            result = {"ok": False, "error": str(error)[:300]}
        print(json.dumps({**options, **result}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
