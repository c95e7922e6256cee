"""A structure in the x-y plane in Exudyn, in its items for the plane: the fastest that it has."""

import numpy as np
from exudyn import itemInterface as item


def build(mbs, structure):
    """Everything but what is recorded; returns the markers of the named points.

    The coordinates of a node are its displacements and its turn, all 0 at the start."""
    nodes = _nodes(mbs, structure)
    bodies, gravity = _bodies(mbs, structure, nodes), structure["gravity"]
    for body in [*bodies.values(), *_beams(mbs, structure, nodes)]:
        if any(gravity):
            weight = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=body))
            mbs.AddLoad(item.LoadMassProportional(markerNumber=weight, loadVector=gravity))
    _supports(mbs, structure, nodes)
    for hinge in structure["hinges"]:
        _hinge(mbs, structure, nodes, bodies, hinge)
    for loop in structure["loops"]:
        _loop(mbs, structure, nodes, loop)
    return {
        name: _marker(mbs, structure, nodes, bodies, point["node"], point["arm"])
        for name, point in structure["points"].items()
    }


def _nodes(mbs, structure):
    """Numbers of the nodes; what is held altogether is ground."""
    numbers = []
    for place, velocity, spin, fixed in zip(
        *(structure[key] for key in ("position", "velocity", "spin", "fixed")), strict=True
    ):
        if all(fixed):
            node = item.NodePointGround(referenceCoordinates=place)
        else:
            node = item.NodeRigidBody2D(
                referenceCoordinates=[*place[:2], 0.0], initialVelocities=[*velocity[:2], spin[2]]
            )
        numbers.append(mbs.AddNode(node))
    return numbers


def _bodies(mbs, structure, nodes):
    """Rigid bodies by node."""
    bodies = {}
    for body in structure["bodies"]:
        n = body["node"]
        frame = np.array(structure["frame"][n])
        inertia = float(frame[2] ** 2 @ np.array(body["inertia"]))  # about z
        rigid_body = item.ObjectRigidBody2D(mass=body["mass"], inertia=inertia, nodeNumber=nodes[n])
        bodies[n] = mbs.AddObject(rigid_body)
    return bodies


def _beams(mbs, structure, nodes):
    items = []
    for element in structure["elements"]:
        frame = np.array(structure["frame"][element["nodes"][0]])
        normal = int(np.argmax(np.abs(frame[2])))  # the section's axis that is normal to the plane
        axial, shear_y, shear_z = element["stiffness"][:3]
        beam = item.ObjectBeamGeometricallyExact2D(
            nodeNumbers=[nodes[n] for n in element["nodes"]],
            length=element["length"],
            massPerLength=element["mass"],
            crossSectionInertia=element["inertia"][normal],
            bendingStiffness=element["stiffness"][3 + normal],
            axialStiffness=axial,
            shearStiffness=shear_y if normal == 2 else shear_z,
        )
        items.append(mbs.AddObject(beam))
    return items


def _supports(mbs, structure, nodes):
    """Nodes that are held along x or y, or about z."""
    ground = mbs.AddNode(item.NodePointGround())
    ground = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for node, fixed in zip(nodes, structure["fixed"], strict=True):
        if all(fixed):
            continue
        for coordinate, is_fixed in enumerate((fixed[0], fixed[1], fixed[5])):
            if is_fixed:
                pair = [ground, _coordinate(mbs, node, coordinate)]
                mbs.AddObject(item.ObjectConnectorCoordinate(markerNumbers=pair))


def _coordinate(mbs, node, coordinate):
    return mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))


def _marker(mbs, structure, nodes, bodies, n, arm):
    """A marker at the end of a rigid arm, given in the node's own axes."""
    arm = np.array(structure["frame"][n]) @ np.array(arm)
    if n in bodies:
        return mbs.AddMarker(
            item.MarkerBodyPosition(bodyNumber=bodies[n], localPosition=[*arm[:2], 0.0])
        )
    if all(structure["fixed"][n]):
        place = np.array(structure["position"][n]) + arm
        node = mbs.AddNode(item.NodePointGround(referenceCoordinates=list(place)))
        return mbs.AddMarker(item.MarkerNodePosition(nodeNumber=node))
    if np.abs(arm).max() > 1e-12:
        raise ValueError("joints of beams in the plane lie on their nodes")
    return mbs.AddMarker(item.MarkerNodePosition(nodeNumber=nodes[n]))


def _sense(structure, hinge):
    """1 where the hinge's axis is z, -1 where it is -z."""
    n = hinge["nodes"][0]
    axis = np.array(structure["frame"][n]) @ np.array(hinge["frames"][0])[:, 2]
    if abs(abs(axis[2]) - 1) > 1e-9:
        raise ValueError("hinges in the plane turn about z")
    return float(np.sign(axis[2]))


def _hinge(mbs, structure, nodes, bodies, hinge):
    """A joint with its spring and damper, which act on the turns of its two nodes."""
    pair = zip(hinge["nodes"], hinge["arms"], strict=True)
    markers = [_marker(mbs, structure, nodes, bodies, n, arm) for n, arm in pair]
    mbs.AddObject(item.ObjectJointRevolute2D(markerNumbers=markers))
    if hinge["stiffness"] or hinge["damping"]:
        is_ground = [all(structure["fixed"][n]) for n in hinge["nodes"]]
        turns = [
            _coordinate(mbs, nodes[n], 0 if h else 2)
            for n, h in zip(hinge["nodes"], is_ground, strict=True)
        ]
        spring = item.ObjectConnectorCoordinateSpringDamper(
            markerNumbers=turns,
            stiffness=hinge["stiffness"],
            damping=hinge["damping"],
            offset=_sense(structure, hinge) * (hinge["rest"] - hinge["opening"]),
        )
        mbs.AddObject(spring)


def _loop(mbs, structure, nodes, loop):
    """A loop is linear in the turns of the nodes of its two hinges."""
    share = {}
    for number, radius, side in zip(loop["hinges"], loop["radii"], (1, -1), strict=True):
        hinge = structure["hinges"][number]
        lever = side * radius * _sense(structure, hinge)
        for n, sign in zip(hinge["nodes"], (-1, 1), strict=True):
            share[n] = share.get(n, 0.0) + sign * lever
    row = np.zeros((len(share), 3))
    row[:, 2] = list(share.values())
    row = row.ravel()
    size = len(row)
    mbs.AddObject(
        item.ObjectGenericODE2(
            nodeNumbers=[nodes[n] for n in share],
            massMatrix=np.zeros((size, size)),
            stiffnessMatrix=loop["stiffness"] * np.outer(row, row),
            dampingMatrix=np.zeros((size, size)),
            forceVector=-loop["stiffness"] * loop["slip"] * row,
        )
    )
