"""Geometry and closed-form motion of the general mitred Bennett frame.

Frame.  Four congruent square bars (length L, side a) stand in the four quadrants of the plane:
AB in x > 0, y > 0; BC is its mirror image in x = 0, CD its half turn about z, DA its mirror image
in y = 0.  Hinges B and D stay in the plane x = 0, A and C in y = 0.  ``mu`` is half the corner
angle at B of the deployed (flat) frame, ``lam`` (lambda) the roll of the section about the bar.

Link frames.  The origin is the A-side (A or C) end of the bar's axis; x runs along the bar to the
B-side (B or D) end; y and z are normal to the sides of the section.  For AB and CD, y is the normal
of the inner upper side in the deployed state and z that of the outer upper side.  A mirror image of
a right-handed frame is left-handed, so for BC and DA the two names are exchanged: y is outer, z is
inner.  All four frames are then proper rotations, and a square section has the same inertia and
stiffness about both.  In the frame of AB the geometry is:

    axis at A   (cos wA, sin wA, 0)      tan wA = cot(mu) / cos(lam)
    axis at B   (cos wB, 0, sin wB)      tan wB = tan(mu) / sin(lam)
    arm at A    (-a/2 sin(lam) tan(mu), 0, a/2)           from the A-side end of the axis
    arm at B    (-a/2 cos(lam) cot(mu), a/2, 0)           from the B-side end of the axis
    hinge length  a / sin w      constant  c = hA.hB = cos wA cos wB

Motion.  The axes at A and B and the z axis span a spherical triangle with a right angle at z and
the constant hypotenuse arccos c.  Its angle at B is ``PB = PB0 + psiB / 2``, so the opening psiB at
B is a coordinate of the whole motion without a singularity, and Napier's rules give the rest:

    tan(90 deg - beta) = tan(arccos c) cos PB,     tan PA tan PB = 1 / c,     psiA = 2 (PA0 - PA)

with the unit axes hB = (0, cos beta, sin beta) and hA = (cos gamma, 0, sin gamma), hence
sin beta sin gamma = c at all times.  The motion ends in a bundle of four parallel bars (axes along
z) at cos(psiB / 2) = cos(lam) cos(mu), cos(psiA / 2) = -sin(lam) sin(mu), where BD = AC = a."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fpm.elements.cross import columns, cross
from fpm.errors import SceneError

LINKS = ("AB", "BC", "CD", "DA")
HINGES = ("A", "B", "C", "D")

# Table 1 of the paper prints one decimal; values that agree to that digit are the same.
OMEGA_TOLERANCE_DEG = 0.05

# The links as images of AB, in the order of LINKS: by reflections and the half turn of the world,
# of which the reflections exchange the names of the section's axes.
_HALF_TURN = np.diag([-1.0, -1.0, 1.0])
_IMAGES = np.array([np.eye(3), np.diag([-1.0, 1.0, 1.0]), _HALF_TURN, np.diag([1.0, -1.0, 1.0])])
_EXCHANGE_YZ = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
_EXCHANGES = np.array([np.eye(3), _EXCHANGE_YZ, np.eye(3), _EXCHANGE_YZ])

# Bodies of each hinge, in the order for which a positive turn of body 2 about the axis opens it.
_HINGE_BODIES = {"A": ("AB", "DA"), "B": ("AB", "BC"), "C": ("CD", "BC"), "D": ("CD", "DA")}


@dataclass(frozen=True)
class Hinge:
    """One revolute hinge in the frames of its two links.

    ``arm`` goes from the link's end to the midpoint of the hinge line (the virtual beam) in m,
    ``axis`` is the unit hinge direction, ``reference`` a unit vector normal to it, from the hinge
    line into the end face.  The opening psi is the turn of body 2 against body 1 about the axis;
    at psi = 0 (end faces shut) the two references coincide, at psi > 0 the hinge is open."""

    name: str
    body1: str
    body2: str
    at_start: bool  # True: at the origin of both links (A, C); False: at x = L (B, D)
    length: float  # of the hinge line, m
    arm1: np.ndarray
    arm2: np.ndarray
    axis1: np.ndarray
    axis2: np.ndarray
    reference1: np.ndarray
    reference2: np.ndarray


@dataclass(frozen=True)
class Pose:
    """World position of the linkage; leading axes follow the openings asked for.

    ``origin`` (..., 4, 3) m and ``rotation`` (..., 4, 3, 3) follow LINKS, the rotation's columns
    being the link frame's axes; ``point`` (..., 4, 3) m (midpoints of the hinge lines), ``axis``
    (..., 4, 3) and ``opening`` (..., 4) rad follow HINGES."""

    origin: np.ndarray
    rotation: np.ndarray
    point: np.ndarray
    axis: np.ndarray
    opening: np.ndarray


@dataclass(frozen=True)
class BennettGeometry:
    """Frame given by bar length and section side (m), section roll and half corner angle (rad).

    Use :func:`bennett_geometry` to build one from degrees with all checks."""

    length: float
    side: float
    lam: float
    mu: float

    # --- constants of one link, in the frame of AB -----------------------------------------------

    @cached_property
    def omega_a(self) -> float:
        """Angle between the hinge line at A (and C) and the bar, rad."""
        return math.atan2(1.0, math.tan(self.mu) * math.cos(self.lam))

    @cached_property
    def omega_b(self) -> float:
        """Angle between the hinge line at B (and D) and the bar, rad."""
        return math.atan2(math.tan(self.mu), math.sin(self.lam))

    @cached_property
    def epsilon_a(self) -> float:
        """Rise of the hinge line at A over the plane of the deployed frame, rad."""
        return math.atan(math.cos(self.mu) * math.tan(self.lam))

    @cached_property
    def epsilon_b(self) -> float:
        """Rise of the hinge line at B over the plane of the deployed frame, rad."""
        return math.atan2(math.sin(self.mu), math.tan(self.lam))

    @property
    def axis_product(self) -> float:
        """The constant c = hA . hB = cos wA cos wB = sin eA sin eB."""
        return math.cos(self.omega_a) * math.cos(self.omega_b)

    @property
    def axis_a(self) -> np.ndarray:
        return np.array([math.cos(self.omega_a), math.sin(self.omega_a), 0.0])

    @property
    def axis_b(self) -> np.ndarray:
        return np.array([math.cos(self.omega_b), 0.0, math.sin(self.omega_b)])

    @property
    def arm_a(self) -> np.ndarray:
        """From the A-side end of the bar's axis to the midpoint of the hinge line, m."""
        x = -0.5 * self.side * math.sin(self.lam) * math.tan(self.mu)
        return np.array([x, 0.0, 0.5 * self.side])

    @property
    def arm_b(self) -> np.ndarray:
        """From the B-side end of the bar's axis to the midpoint of the hinge line, m."""
        x = -0.5 * self.side * math.cos(self.lam) / math.tan(self.mu)
        return np.array([x, 0.5 * self.side, 0.0])

    @property
    def hinge_length_a(self) -> float:
        """Length of the hinge line at A, the edge of the mitred end face, m."""
        return self.side / math.sin(self.omega_a)

    @property
    def hinge_length_b(self) -> float:
        """Length of the hinge line at B, the edge of the mitred end face, m."""
        return self.side / math.sin(self.omega_b)

    @property
    def face_normal_a(self) -> np.ndarray:
        """Normal of the end face at A (deployed: the y axis of the world), into the bar."""
        s, c = math.sin(self.mu), math.cos(self.mu)
        return np.array([c, -math.cos(self.lam) * s, math.sin(self.lam) * s])

    @property
    def face_normal_b(self) -> np.ndarray:
        """Normal of the end face at B (deployed: the x axis of the world), into the bar."""
        s, c = math.sin(self.mu), math.cos(self.mu)
        return np.array([-s, -math.cos(self.lam) * c, math.sin(self.lam) * c])

    @property
    def folded_opening_b(self) -> float:
        """Opening at B and D in the bundle of four parallel bars, rad (less than pi)."""
        return 2.0 * math.acos(math.cos(self.lam) * math.cos(self.mu))

    @property
    def shortest_edge(self) -> float:
        """Shortest edge of the mitred bar along its axis, m (positive in a bar that exists)."""
        loss = (math.cos(self.lam) + math.sin(self.lam)) / math.sin(2.0 * self.mu)
        return self.length - self.side * loss

    # --- motion ----------------------------------------------------------------------------------

    @cached_property
    def _angle_b0(self) -> float:
        """Angle PB0 of the spherical triangle at B when the frame is deployed, rad."""
        sine, cosine = math.sin(self.epsilon_a), math.cos(self.epsilon_a)
        return math.atan2(cosine, sine * math.cos(self.epsilon_b))

    def opening_a(self, opening_b):
        """Opening at A and C (rad) for the opening at B and D (rad, scalar or array)."""
        c = self.axis_product

        def angle_a(angle_b):
            return np.arctan2(np.cos(angle_b), c * np.sin(angle_b))

        return 2.0 * (angle_a(self._angle_b0) - angle_a(self._angle_b0 + 0.5 * opening_b))

    def opening_from_fold(self, degrees):
        """Opening at B (rad) that is ``degrees`` short of the folded bundle."""
        return self.folded_opening_b - np.radians(degrees)

    def axis_angles(self, opening_b) -> tuple[np.ndarray, np.ndarray]:
        """Angles (beta, gamma) in rad of the hinge axes at B and A in their mirror planes.

        hB = (0, cos beta, sin beta) and hA = (cos gamma, 0, sin gamma)."""
        angle_b = self._angle_b0 + 0.5 * np.asarray(opening_b, dtype=float)
        c = self.axis_product
        s = math.sqrt(1.0 - c * c)
        leg_b = np.arctan2(s * np.cos(angle_b), c)
        leg_a = np.arcsin(s * np.sin(angle_b))
        return 0.5 * np.pi - leg_b, 0.5 * np.pi + leg_a

    def pose(self, opening_b) -> Pose:
        """Place all four links for the opening at B (rad, scalar or array; 0 is deployed).

        Points A and C lie on the plane z = 0; add any common translation or rotation you like."""
        psi = np.asarray(opening_b, dtype=float)
        beta, _ = self.axis_angles(psi)
        zero = np.zeros_like(psi)
        # AB turns by -psi/2 about hB away from the mirror plane, its mirror image BC by +psi/2.
        hinge = columns(zero, np.cos(beta), np.sin(beta))
        normal = columns(1.0 + zero, zero, zero)
        cosine, sine = np.cos(0.5 * psi)[..., None], np.sin(0.5 * psi)[..., None]
        side = cosine * normal - sine * cross(hinge, normal)
        world = columns(hinge, side, cross(hinge, side))
        local_hinge, local_normal = self.axis_b, self.face_normal_b
        local = columns(local_hinge, local_normal, cross(local_hinge, local_normal))
        rotation = world @ local.T

        end_b = np.array([self.length, 0.0, 0.0])
        span = rotation @ (end_b + self.arm_b - self.arm_a)
        point_a = columns(-span[..., 0], zero, zero)
        point_b = columns(zero, span[..., 1], span[..., 2])
        origin = point_a - rotation @ self.arm_a
        axis_a = rotation @ self.axis_a

        opening_a = self.opening_a(psi)
        return Pose(
            origin=(origin[..., None, None, :] @ _IMAGES)[..., 0, :],  # each equals its transpose
            rotation=_IMAGES @ rotation[..., None, :, :] @ _EXCHANGES,
            point=_with_half_turn(point_a, point_b),
            axis=_with_half_turn(axis_a, hinge),
            opening=columns(opening_a, psi, opening_a, psi),
        )

    # --- what a model of the linkage is made of --------------------------------------------------

    def hinges(self) -> tuple[Hinge, ...]:
        """The four hinges, in the order of HINGES, in the frames of their links."""
        # References from the hinge line (outer edge) into the face: towards the end of the axis.
        reference_a = _turn_into_face(self.axis_a, self.arm_a)
        reference_b = _turn_into_face(self.axis_b, self.arm_b)
        hinge_a = self.hinge_length_a, self.arm_a, self.axis_a, reference_a
        hinge_b = self.hinge_length_b, self.arm_b, self.axis_b, reference_b
        hinges = []
        for name in HINGES:
            at_start = name in "AC"
            length, arm, axis, reference = hinge_a if at_start else hinge_b
            body1, body2 = _HINGE_BODIES[name]
            # Body 1 is AB or CD, body 2 a mirror image.  The axis lies in the mirror plane, so the
            # same arrow has the image's components.
            pairs = (x for v in (arm, axis, reference) for x in (v, _EXCHANGE_YZ @ v))
            hinges.append(Hinge(name, body1, body2, at_start, length, *pairs))
        return tuple(hinges)


def _with_half_turn(vectors_a: np.ndarray, vectors_b: np.ndarray) -> np.ndarray:
    """Vectors (..., 4, 3) at A, B, C and D from those (..., 3) at A and B."""
    vectors = np.empty((*vectors_a.shape[:-1], 4, 3))
    vectors[..., 0, :], vectors[..., 1, :] = vectors_a, vectors_b
    vectors[..., 2:, :] = vectors[..., :2, :] @ _HALF_TURN
    return vectors


def _turn_into_face(axis: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Unit vector in the end face, normal to the hinge axis, from the hinge line inwards."""
    normal = -arm + (arm @ axis) * axis
    return normal / np.linalg.norm(normal)


def _mu_from_omega(omega_deg: float, lam: float) -> float:
    """Half corner angle at B (rad) whose hinge line at B makes omega with the bar."""
    return math.atan(math.tan(math.radians(omega_deg)) * math.sin(lam))


def bennett_geometry(
    length: float,
    side: float,
    lambda_deg: float,
    mu_deg: float | None = None,
    omega_deg: float | None = None,
) -> BennettGeometry:
    """Check the table's numbers (m, degrees) and return the frame's geometry.

    ``mu_deg`` is half the corner angle at B, ``omega_deg`` the angle between the hinge line at B
    and the bar; they determine each other, ``tan(omega) = tan(mu) / sin(lambda)``, so one of them
    is enough.  When both are given they must agree to the digit that the paper prints; when
    neither is, the corners are square (mu = 45 degrees).

    Raises SceneError naming the numbers that disagree or are out of range."""
    for key, value in (("L", length), ("a", side)):
        if not (math.isfinite(value) and value > 0.0):
            raise SceneError(key, value, "a positive length in m")
    angles = {"lambda_deg": lambda_deg, "mu_deg": mu_deg, "omega_deg": omega_deg}
    for key, value in angles.items():
        if value is not None and not 0.0 < value < 90.0:
            raise SceneError(key, value, "an angle between 0 and 90 degrees, both excluded")
    lam = math.radians(lambda_deg)
    if mu_deg is not None:
        mu = math.radians(mu_deg)
    elif omega_deg is not None:
        mu = _mu_from_omega(omega_deg, lam)
    else:
        mu = 0.25 * math.pi

    geometry = BennettGeometry(length=length, side=side, lam=lam, mu=mu)
    if mu_deg is not None and omega_deg is not None:
        omega_b = math.degrees(geometry.omega_b)
        if abs(omega_deg - omega_b) > OMEGA_TOLERANCE_DEG:
            raise SceneError(
                "omega_deg",
                omega_deg,
                f"{omega_b:.2f} degrees (to {OMEGA_TOLERANCE_DEG}) at B, which lambda_deg = "
                f"{lambda_deg:g} and mu_deg = {mu_deg:g} require (and "
                f"{math.degrees(geometry.omega_a):.2f} at A); or keep it and take mu_deg = "
                f"{math.degrees(_mu_from_omega(omega_deg, lam)):.2f}, "
                "or leave omega_deg or mu_deg out",
            )
    if geometry.shortest_edge <= 0.0:
        raise SceneError(
            "L",
            length,
            f"above {length - geometry.shortest_edge:.6g} m, below which the mitre cuts of the two "
            f"ends meet (a = {side:g} m, lambda_deg = {lambda_deg:g}, mu_deg = "
            f"{math.degrees(mu):.6g})",
        )
    return geometry
