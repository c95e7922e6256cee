"""A linkage as plain numbers, for peers that build it in an interpreter of their own."""

import numpy as np

import fpm


def describe(scene: fpm.Scene) -> dict:
    """Nodes, beam elements, hinges and torsion springs of a scene, ready for JSON.

    nodes: position (n, 3) m and frame (n, 3, 3), the element's axes as columns; elements: nodes,
    length (m) and section rigidities; hinges: the two nodes, arms (m) and frames (3, 3) in each
    node's own axes whose third column is the hinge axis, the axes of the point that are held, and
    the spring with its opening at the start (rad) and stiffness (N m/rad).
    """
    elements = []
    for beams in scene.beams:
        s, m = beams.section, beams.material
        shear = m.G * s.A * 5 / 6
        rigidities = [m.E * s.A, shear, shear, m.G * s.J, m.E * s.Iy, m.E * s.Iz]
        for nodes, length in zip(beams.nodes, beams.length, strict=True):
            elements.append(
                {
                    "nodes": nodes.tolist(),
                    "length": float(length),
                    "stiffness": rigidities,
                    "mass": m.rho * s.A,
                    "inertia": [m.rho * (s.Iy + s.Iz), m.rho * s.Iy, m.rho * s.Iz],
                }
            )
    hinges = []
    for index, hinge in enumerate(scene.hinges):
        frames = []
        for axis, reference in zip(hinge.axes, hinge.references, strict=True):
            frames.append(np.column_stack([reference, np.cross(axis, reference), axis]))
        # The first frame is turned by the opening, so that the two coincide at the start.
        turn = hinge.opening
        c, s = np.cos(turn), np.sin(turn)
        frames[0] = frames[0] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        hinges.append(
            {
                "name": hinge.name,
                "nodes": list(hinge.particles),
                "arms": [beam.arm.tolist() for beam in hinge.beams],
                "frames": [frame.tolist() for frame in frames],
                "opening": hinge.opening,
                "stiffness": sum(x.stiffness for x in scene.springs if x.hinge == index),
                "support": hinge.support,
            }
        )
    return {
        "position": scene.position.tolist(),
        "frame": scene.frame.tolist(),
        "elements": elements,
        "hinges": hinges,
    }
