"""Supports of hinges: which ones a hinge can be solved alone with, and that it can be then."""

from itertools import chain, combinations, product

import numpy as np
import pytest

import fpm
from fpm.elements.joints.hinge import Hinge, is_regular
from fpm.elements.joints.joint import Joint

AXES = "xyz"
SETS = ["".join(c) for c in chain.from_iterable(combinations(AXES, k) for k in range(4))]


def pair(support="", arm=(0.0, 0.0, 0.0)) -> fpm.Scene:
    """Two particles hinged about y, 0.2 m apart or, without arm, at one place."""
    scene = fpm.Scene("pair")
    scene.add_particles([(0.0, 0, 0), (0.2 * bool(np.any(arm)), 0, 0)], 1.0, (0.01, 0.02, 0.03))
    scene.add_hinge("H", (0, 1), arm, (0, 1, 0), support=support)
    return scene


@pytest.mark.parametrize(
    ("supports", "support"),
    [
        ({1: ("", "x")}, ""),
        ({0: ("", "xz")}, ""),
        ({0: ("z", ""), 1: ("z", "")}, ""),
        ({0: ("xyz", "xyz"), 1: ("xz", "")}, ""),
        ({0: ("", "xyz"), 1: ("", "xyz")}, ""),
        ({1: ("xy", "")}, "yz"),
    ],
)
def test_what_a_lone_hinge_cannot_bear_is_a_joint(supports, support):
    """Each leaves impulses that move nothing, or turns a body about some axes only."""
    scene = pair(support)
    assert (len(Hinge.find(scene)), len(Joint.find(scene))) == (1, 0)
    for particle, (translations, rotations) in supports.items():
        scene.fix(particle, translations, rotations)
    assert (len(Hinge.find(scene)), len(Joint.find(scene))) == (0, 1 + bool(support))


def response(scene: fpm.Scene) -> np.ndarray:
    """Matrix G M^-1 G^T of the only hinge and its supports, straight from their definition."""
    hinge, rows = scene.hinges[0], []
    axis = hinge.axes[0]
    normal = np.linalg.svd(axis[None])[2][1:]
    for p, beam, sign in zip(hinge.particles, hinge.beams, (1, -1), strict=True):
        x, y, z = beam.arm
        turn = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])
        point, none = np.hstack([np.eye(3), turn]), np.zeros((2, 3))
        supports = point[[AXES.index(a) for a in hinge.support]] * (sign > 0)
        block = np.vstack([sign * point, sign * np.hstack([none, normal]), supports])
        inverse = np.concatenate([np.full(3, 1 / scene.mass[p]), 1 / scene.inertia[p]])
        rows.append(block * np.sqrt(inverse * ~scene.fixed[p]))
    rows = np.hstack(rows)
    return rows @ rows.T


@pytest.mark.parametrize("arm", [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.0, 0.03)])
def test_all_that_is_allowed_is_regular(arm):
    """All sets of held axes of both particles and of the hinge point, at once."""
    allowed = 0
    for one, two, support in product(SETS, SETS, SETS):
        scene = pair(support, arm)
        for p, axes in enumerate((one, two)):
            scene.fixed[p, [AXES.index(a) for a in axes]] = True
        for turning in ((0, 0), (0, 1), (1, 0)):
            scene.fixed[:, 3:] = np.array(turning, bool)[:, None]
            if not is_regular(scene.hinges[0], scene.fixed):
                continue
            allowed += 1
            size = np.linalg.eigvalsh(response(scene))
            assert size[0] > 1e-3 * size[-1], (one, two, support, turning)
    assert allowed == 3 * 4**3  # along each axis: none held, one, the other, or the point
