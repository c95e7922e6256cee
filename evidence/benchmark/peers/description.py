"""The linkage as plain numbers, for Exudyn, which builds it in an interpreter of its own."""

import numpy as np

import fpm
from fpm.elements import Hinge, TorsionSpring


def describe(scene: fpm.Scene) -> dict:
    """A scene of beams at rest with hinges and springs between them, ready for JSON; without its
    contacts.

    nodes: position (n, 3) m, frame (n, 3, 3), the element's axes as columns; elements: nodes,
    length (m) and section rigidities; hinges: the two nodes, arms (m) and frames (3, 3) in each
    node's own axes whose third column is the hinge axis, the axes of the point that are held, and
    the spring with the opening at the start (rad); points: node and arm."""
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
    return {
        "position": scene.position.tolist(),
        "frame": scene.frame.tolist(),
        "elements": elements,
        "hinges": [_hinge(scene, index, hinge) for index, hinge in enumerate(scene.hinges)],
        "points": {
            name: {"node": beam.particle, "arm": beam.arm.tolist()}
            for name, beam in scene.points.items()
        },
    }


def _hinge(scene: fpm.Scene, index: int, hinge: Hinge) -> dict:
    frames = []
    for axis, reference in zip(hinge.axes, hinge.references, strict=True):
        frames.append(np.column_stack([reference, np.cross(axis, reference), axis]))
    # The first frame is turned by the opening, so that the two coincide at the start.
    c, s = np.cos(hinge.opening), np.sin(hinge.opening)
    frames[0] = frames[0] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    springs = [spring for spring in TorsionSpring.find(scene) if spring.hinge == index]
    stiffness = sum(spring.stiffness for spring in springs)
    moment = sum(spring.stiffness * spring.rest for spring in springs)
    return {
        "name": hinge.name,
        "nodes": list(hinge.particles),
        "arms": [beam.arm.tolist() for beam in hinge.beams],
        "frames": [frame.tolist() for frame in frames],
        "opening": hinge.opening,
        "stiffness": stiffness,
        "rest": moment / stiffness if stiffness else 0.0,
        "support": hinge.support,
    }
