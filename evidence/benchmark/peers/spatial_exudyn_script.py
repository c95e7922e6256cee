"""A structure in space in Exudyn: geometrically exact beams, rigid bodies, revolute joints.

Joints are ideal where the integrator is implicit, stiff springs where it is explicit (which takes
no constraints)."""

import exudyn as exu
import numpy as np
from exudyn import itemInterface as item
from exudyn.rigidBodyUtilities import RotationMatrix2EulerParameters, RotationMatrix2RotationVector

PENALTY = 1e6
"""Stiffness (N/m) of the springs that stand for joints with an explicit integrator."""


def build(mbs, structure, explicit):
    """Everything but what is recorded; returns the markers of the named points."""
    if np.any(structure["velocity"]) or np.any(structure["spin"]):
        raise ValueError("structures in space start at rest")
    nodes = _nodes(mbs, structure, explicit)
    gravity = structure["gravity"]
    for body in _beams(mbs, structure, nodes):
        if any(gravity):
            weight = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=body))
            mbs.AddLoad(item.LoadMassProportional(markerNumber=weight, loadVector=gravity))
    bodies = _bodies(mbs, structure, nodes)
    _hinges(mbs, structure, bodies, explicit)
    return {
        name: marker(mbs, bodies[point["node"]], point["arm"], np.eye(3))
        for name, point in structure["points"].items()
    }


def _nodes(mbs, structure, explicit):
    """Numbers of the nodes; None for what is held altogether."""
    numbers = []
    for position, frame, fixed in zip(
        structure["position"], structure["frame"], structure["fixed"], strict=True
    ):
        frame = np.array(frame)
        if all(fixed):
            numbers.append(None)
            continue
        if any(fixed):
            raise ValueError("nodes in space are held altogether or not at all")
        if explicit:
            turn = list(RotationMatrix2RotationVector(frame))
            node = item.NodeRigidBodyRotVecLG(referenceCoordinates=position + turn)
        else:
            turn = list(RotationMatrix2EulerParameters(frame))
            node = item.NodeRigidBodyEP(referenceCoordinates=position + turn)
        numbers.append(mbs.AddNode(node))
    return numbers


def _beams(mbs, structure, nodes):
    items = []
    for element in structure["elements"]:
        section = exu.BeamSection()
        section.stiffnessMatrix = np.diag(element["stiffness"])
        section.massPerLength = element["mass"]
        section.inertia = np.diag(element["inertia"])
        pair = [nodes[i] for i in element["nodes"]]
        beam = item.ObjectBeamGeometricallyExact(
            nodeNumbers=pair, length=element["length"], sectionData=section
        )
        items.append(mbs.AddObject(beam))
    return items


def _bodies(mbs, structure, nodes):
    """Bodies by node, to which arms can be fixed: on nodes of beams of next to no mass."""
    if structure["bodies"]:
        raise ValueError("structures in space are of beams")
    ends = [n for hinge in structure["hinges"] for n in hinge["nodes"]]
    ends += [point["node"] for point in structure["points"].values()]
    bodies = {}
    for n in dict.fromkeys(ends):
        if nodes[n] is None:
            place, frame = structure["position"][n], structure["frame"][n]
            body = item.ObjectGround(referencePosition=place, referenceRotation=frame)
        else:
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
        if hinge["stiffness"] or hinge["damping"]:
            spring = item.ObjectConnectorTorsionalSpringDamper(
                markerNumbers=markers,
                stiffness=hinge["stiffness"],
                damping=hinge["damping"],
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
