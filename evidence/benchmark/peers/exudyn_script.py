"""The linkage in Exudyn: a script for the interpreter that has Exudyn, whatever its version.

Reads {"linkage": ..., "duration": s, "runs": [...]} from the file named in its first argument, and
prints one JSON object per run. Geometrically exact beams; ideal revolute joints where the
integrator is implicit, stiff springs where it is explicit (which takes no constraints).
"""

import json
import sys
import time

import exudyn as exu
import numpy as np
from exudyn import itemInterface as item
from exudyn.rigidBodyUtilities import RotationMatrix2EulerParameters, RotationMatrix2RotationVector

PENALTY = 1e6
"""Stiffness (N/m) of the springs that stand for joints with an explicit integrator."""


def nodes_of(mbs, linkage, explicit):
    numbers = []
    for position, frame in zip(linkage["position"], linkage["frame"], strict=True):
        frame = np.array(frame)
        if explicit:
            turn = list(RotationMatrix2RotationVector(frame))
            node = item.NodeRigidBodyRotVecLG(referenceCoordinates=position + turn)
        else:
            turn = list(RotationMatrix2EulerParameters(frame))
            node = item.NodeRigidBodyEP(referenceCoordinates=position + turn)
        numbers.append(mbs.AddNode(node))
    return numbers


def add_beams(mbs, linkage, nodes):
    for element in linkage["elements"]:
        section = exu.BeamSection()
        section.stiffnessMatrix = np.diag(element["stiffness"])
        section.massPerLength = element["mass"]
        section.inertia = np.diag(element["inertia"])
        pair = [nodes[i] for i in element["nodes"]]
        beam = item.ObjectBeamGeometricallyExact(
            nodeNumbers=pair, length=element["length"], sectionData=section
        )
        mbs.AddObject(beam)


def add_bodies(mbs, linkage, nodes):
    """Rigid bodies of next to no mass on the hinged nodes, to which arms can be fixed."""
    bodies = {}
    for hinge in linkage["hinges"]:
        for n in hinge["nodes"]:
            body = item.ObjectRigidBody(
                nodeNumber=nodes[n], mass=1e-12, inertia=[1e-15] * 3 + [0.0] * 3
            )
            bodies[n] = mbs.AddObject(body)
    return bodies


def marker(mbs, body, arm, frame):
    """A marker at the end of a rigid arm with axes of its own."""
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = frame, arm
    return mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=body, localHT=transform))


def add_hinges(mbs, linkage, nodes, explicit):
    """Joints, their springs and the supports; returns the markers of the hinge points."""
    points, bodies = {}, add_bodies(mbs, linkage, nodes)
    for hinge in linkage["hinges"]:
        both = [
            marker(mbs, bodies[n], arm, np.array(frame))
            for n, arm, frame in zip(hinge["nodes"], hinge["arms"], hinge["frames"], strict=True)
        ]
        if explicit:
            stiff = np.diag([PENALTY] * 3 + [PENALTY * 1e-3] * 2 + [0.0])
            mbs.AddObject(
                item.ObjectConnectorRigidBodySpringDamper(markerNumbers=both, stiffness=stiff)
            )
        else:
            mbs.AddObject(item.ObjectJointRevoluteZ(markerNumbers=both))
        spring = item.ObjectConnectorTorsionalSpringDamper(
            markerNumbers=both, stiffness=hinge["stiffness"], offset=-hinge["opening"]
        )
        mbs.AddObject(spring)
        point = marker(mbs, bodies[hinge["nodes"][0]], hinge["arms"][0], np.eye(3))
        points[hinge["name"]] = point
        if hinge["support"]:
            add_support(mbs, linkage, hinge, point, explicit)
    return points


def add_support(mbs, linkage, hinge, point, explicit):
    node = hinge["nodes"][0]
    place = np.array(linkage["position"][node])
    place = place + np.array(linkage["frame"][node]) @ np.array(hinge["arms"][0])
    ground = mbs.AddNode(item.NodePointGround(referenceCoordinates=list(place)))
    ground = mbs.AddMarker(item.MarkerNodePosition(nodeNumber=ground))
    held = [int(axis in hinge["support"]) for axis in "xyz"]
    if explicit:
        spring = item.ObjectConnectorCartesianSpringDamper(
            markerNumbers=[ground, point], stiffness=[PENALTY * h for h in held]
        )
        mbs.AddObject(spring)
    else:
        joint = item.ObjectJointSpherical(markerNumbers=[ground, point], constrainedAxes=held)
        mbs.AddObject(joint)


def run(linkage, duration, explicit, step, options):
    """Wall and cpu seconds, and BD (m) at eleven instants."""
    exu.config.printToConsole = False
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    nodes = nodes_of(mbs, linkage, explicit)
    add_beams(mbs, linkage, nodes)
    points = add_hinges(mbs, linkage, nodes, explicit)
    sensors = []
    for name in ("B", "D"):
        sensor = item.SensorMarker(
            markerNumber=points[name],
            outputVariableType=exu.OutputVariableType.Position,
            storeInternal=True,
        )
        sensors.append(mbs.AddSensor(sensor))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(duration / step)
    settings.timeIntegration.endTime = duration
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.stepInformation = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = duration / 10
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.parallel.numberOfThreads = 1
    settings.timeIntegration.newton.useModifiedNewton = options.get("modified", True)
    settings.timeIntegration.generalizedAlpha.spectralRadius = options.get("radius", 0.9)
    if explicit:
        kind = getattr(exu.DynamicSolverType, options["solver"])
    else:
        kind = exu.DynamicSolverType.GeneralizedAlpha
    wall, cpu = time.perf_counter(), time.process_time()
    solved = mbs.SolveDynamic(settings, solverType=kind)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    b, d = (mbs.GetSensorStoredData(sensor) for sensor in sensors)
    distance = np.linalg.norm(b[:, 1:] - d[:, 1:], axis=1)
    return {
        "ok": bool(solved) and bool(np.isfinite(distance).all()),
        "wall": wall,
        "cpu": cpu,
        "steps": round(duration / step),
        "time": b[:, 0].tolist(),
        "distance": distance.tolist(),
        "version": exu.__version__,
    }


def main(path):
    with open(path) as file:
        task = json.load(file)
    for options in task["runs"]:
        try:
            result = run(
                task["linkage"], task["duration"], "solver" in options, options["step"], options
            )
        except Exception as error:  # Exudyn reports a failed step by several kinds
            result = {"ok": False, "error": str(error)[:300]}
        print(json.dumps({**options, **result}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
