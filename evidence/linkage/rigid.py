"""Rigid Bennett frame with one degree of freedom: the reference for the flexible solver.

Nothing here is taken from ``fpm``.  The deployed bar is cut out of a square prism by the two mirror
planes, its hinge lines are read off as edges of the cut faces, and the motion follows from the
angle beta of the hinge axis at B alone: with hB = (0, cos beta, sin beta) and
hA = (cos gamma, 0, sin gamma), a rigid bar keeps hA . hB = sin beta sin gamma, so

    R(beta) = [hA hB hA x hB] [hA hB hA x hB]_link^-1,

and x = 0 for the hinge point at B, y = 0 for that at A place the bar in the plane.  Derivatives
with respect to beta are analytic.  The other three bars are images of the first one, so the
kinetic energy is four times its own, and Lagrange's equation M q'' + M' q'^2 / 2 + V' = 0 is
integrated with q = beta."""

import math
from dataclasses import dataclass

import numpy as np

_X, _Y, _Z = np.eye(3)
# Matrices that take an axis, as a row, to its vector product with X and with Y.
_BESIDE_X, _BESIDE_Y = np.cross(np.eye(3), _X), np.cross(np.eye(3), _Y)


@dataclass(frozen=True)
class RigidBennett:
    """Rigid linkage; lengths in m, angles in degrees, density in kg/m3, stiffness in N/rad.

    ``supports`` is "plane" (points A and C stay at z = 0 and slide in x and y) or "free" (no
    supports; the centre of mass stays where it starts).  Each bar has the mass rho a^2 L spread
    evenly along its axis between its ends and the section inertia rho a^4 / 12 per length about
    each side, as a beam has; the mitre cuts move neither.  What follows from these (centre, hinge
    points and axes, ...) is in a link frame that is the world's in the deployed state."""

    length: float = 0.45
    side: float = 0.035
    lambda_deg: float = 45.0
    mu_deg: float = 45.0
    density: float = 800.0
    spring_stiffness: float = 5.0  # K^F, per length of hinge line
    contact_stiffness: float = 1.0e4  # K^C, per length of hinge line
    supports: str = "plane"

    def __post_init__(self) -> None:
        if self.supports not in ("plane", "free"):
            raise ValueError(f"supports is {self.supports!r}; allowed are 'plane' and 'free'")
        mu, lam = math.radians(self.mu_deg), math.radians(self.lambda_deg)
        end_a = self.length * math.sin(mu) * _X
        end_b = self.length * math.cos(mu) * _Y
        axis = (end_b - end_a) / self.length
        outer = math.cos(mu) * _X + math.sin(mu) * _Y
        inner_upper = -math.cos(lam) * outer + math.sin(lam) * _Z
        outer_upper = math.sin(lam) * outer + math.cos(lam) * _Z

        def edge(end, plane_normal, face, lateral):
            """Corners of the edge that the face (unit normal) leaves in the cut face."""
            corners = []
            for side in (-1.0, 1.0):
                corner = end + 0.5 * self.side * (face + side * lateral)
                slip = (plane_normal @ corner) / (plane_normal @ axis)
                corners.append(corner - slip * axis)
            return np.array(corners)

        edge_a = edge(end_a, _Y, outer_upper, inner_upper)
        edge_b = edge(end_b, _X, inner_upper, outer_upper)
        length_a = float(np.linalg.norm(edge_a[1] - edge_a[0]))
        length_b = float(np.linalg.norm(edge_b[1] - edge_b[0]))
        mass = self.density * self.side**2 * self.length
        axes = np.stack([axis, inner_upper, outer_upper], axis=-1)
        moments = np.array([self.length**2, self.side**2, self.side**2]) * mass / 12.0

        # Both edges run upwards, so that beta and gamma start between 0 and 180 degrees.
        axis_a, axis_b = (edge_a[1] - edge_a[0]) / length_a, (edge_b[1] - edge_b[0]) / length_b
        self.__dict__.update(
            centre=0.5 * (end_a + end_b), hinge_a=edge_a.mean(axis=0), hinge_b=edge_b.mean(axis=0),
            axis=axis, axis_a=axis_a, axis_b=axis_b,
            hinge_length_a=length_a, hinge_length_b=length_b,
            from_link=np.linalg.inv(np.stack([axis_a, axis_b, np.cross(axis_a, axis_b)], axis=-1)),
            mass=mass, second_moment=axes @ np.diag(moments) @ axes.T,
            beta_deployed=math.atan2(axis_b[2], axis_b[1]),
            # The bars are parallel to z when the axis at B makes its constant angle with z.
            beta_folded=math.pi - math.asin(axis_b @ axis),
        )  # fmt: skip

    # --- kinematics ------------------------------------------------------------------------------

    def motion(self, beta: float) -> dict[str, np.ndarray]:
        """Value, first and second derivative in beta, stacked (3, ...), of what moves with AB.

        Keys: rotation (3, 3, 3), centre, A, B (3, 3) in m, axis_a, axis_b (3, 3), opening_a,
        opening_b (3,) in rad."""
        constant = float(self.axis_a @ self.axis_b)
        sb, cb = math.sin(beta), math.cos(beta)
        # gamma: sin(gamma) = c / sin(beta), on the branch above 90 degrees.
        sg = constant / sb
        cg = -math.sqrt(1.0 - sg * sg)
        sg1 = -constant * cb / sb**2
        sg2 = constant * (1.0 + cb * cb) / sb**3
        g1 = sg1 / cg  # gamma'
        g2 = (sg2 + sg * g1 * g1) / cg  # gamma''

        hb = np.array([[0.0, cb, sb], [0.0, -sb, cb], [0.0, -cb, -sb]])
        turn = np.array([[cg, 0.0, sg], [-sg, 0.0, cg]])
        ha = np.array([turn[0], g1 * turn[1], g2 * turn[1] - g1 * g1 * turn[0]])
        products = np.cross(ha[:, None], hb[None])  # by derivatives of the first and of the second
        second = products[2, 0] + 2.0 * products[1, 1] + products[0, 2]
        cross = np.array([products[0, 0], products[1, 0] + products[0, 1], second])
        rotation = np.stack([ha, hb, cross], axis=-1) @ self.from_link

        # A on the plane y = 0, B on x = 0; z is measured from A, or from the centre of mass.
        axis_a, axis_b = rotation @ self.hinge_a, rotation @ self.hinge_b
        centre = rotation @ self.centre
        datum = axis_a if self.supports == "plane" else centre
        shift = -np.stack([axis_b[:, 0], axis_a[:, 1], datum[:, 2]], axis=-1)

        # The end faces lie in the mirror planes when deployed; their turn about the axes since
        # then is half an opening, and its sense is that of a bar leaving the plane.
        opening_a = -2.0 * _angle(rotation @ _Y, ha @ _BESIDE_Y, _Y)
        opening_b = -2.0 * _angle(rotation @ _X, hb @ _BESIDE_X, _X)
        return {
            "rotation": rotation,
            "centre": centre + shift,
            "A": axis_a + shift,
            "B": axis_b + shift,
            "axis_a": ha,
            "axis_b": hb,
            "opening_a": opening_a,
            "opening_b": opening_b,
        }

    def beta_at(self, opening_b: float) -> float:
        """Angle beta (rad) at which the hinge B is open by ``opening_b`` (rad)."""
        from scipy.optimize import brentq

        # beta grows with the opening; a little of the contact side is allowed.
        low = 0.5 * (self.beta_deployed + math.asin(self.axis_a @ self.axis_b))
        high = math.pi - 0.5 * (math.pi - self.beta_folded + math.asin(self.axis_a @ self.axis_b))

        def gap(beta):
            return self.motion(beta)["opening_b"][0] - opening_b

        if gap(low) > 0.0 or gap(high) < 0.0:
            raise ValueError(f"opening {opening_b!r} rad at B is outside the motion")
        return brentq(gap, low, high, xtol=1e-15, rtol=1e-15)

    @property
    def folded_opening_b(self) -> float:
        """Opening at B (rad) of the bundle of four parallel bars."""
        return float(self.motion(self.beta_folded)["opening_b"][0])

    # --- dynamics --------------------------------------------------------------------------------

    def inertia(self, motion: dict[str, np.ndarray]) -> tuple[float, float]:
        """Generalised inertia M (kg m2) of all four bars and its derivative in beta."""
        rotation, centre = motion["rotation"], motion["centre"]
        first = rotation[1] @ self.second_moment
        value = self.mass * centre[1] @ centre[1] + np.sum(first * rotation[1])
        slope = 2.0 * self.mass * centre[1] @ centre[2] + 2.0 * np.sum(first * rotation[2])
        return 4.0 * float(value), 4.0 * float(slope)

    def potential(self, motion: dict[str, np.ndarray]) -> tuple[float, float, float]:
        """Energy of springs and of contacts (J), and the slope of their sum in beta."""
        spring = contact = slope = 0.0
        for name, length in (
            ("opening_a", self.hinge_length_a),
            ("opening_b", self.hinge_length_b),
        ):
            opening, opening1 = motion[name][0], motion[name][1]
            overlap = min(opening, 0.0)
            # Two hinges of each kind: factor 2 / 2.
            spring += self.spring_stiffness * length * opening**2
            contact += self.contact_stiffness * length * overlap**2
            moment = self.spring_stiffness * opening + self.contact_stiffness * overlap
            slope += 2.0 * length * moment * opening1
        return float(spring), float(contact), float(slope)

    def state_rate(self, _time: float, state: np.ndarray) -> list[float]:
        """Right-hand side of the ODE for state = (beta, dbeta/dt)."""
        beta, rate = state
        motion = self.motion(beta)
        inertia, inertia_slope = self.inertia(motion)
        slope = self.potential(motion)[2]
        return [rate, -(slope + 0.5 * inertia_slope * rate * rate) / inertia]

    def simulate(
        self, start_deg: float, times: np.ndarray, tolerance: float = 1e-12
    ) -> dict[str, np.ndarray]:
        """Release the linkage at rest, ``start_deg`` of opening at B short of the bundle.

        ``times`` (T,) s ascending from 0.  Returns arrays (T,): time, BD, AC (m), height of B over
        A (m), velocity_Bz (m/s), opening_a, opening_b (rad), kinetic, spring, contact, energy
        (J); and ``closings``, ``openings`` (s): instants at which the end faces meet and part."""
        from scipy.integrate import solve_ivp

        times = np.asarray(times, dtype=float)
        beta = self.beta_at(self.folded_opening_b - math.radians(start_deg))

        def contact(_time, state):
            return state[0] - self.beta_deployed  # same zero and sign as the openings

        contact.terminal = True
        time, state = 0.0, np.array([beta, 0.0])
        states = np.empty((times.size, 2))
        closings, openings = [], []
        # The contact makes the moment's slope jump: one solution per phase between the jumps.
        while time < times[-1]:
            gap, rate = state[0] - self.beta_deployed, state[1]
            is_closed = gap < 0.0 or (gap == 0.0 and rate < 0.0)
            contact.direction = 1.0 if is_closed else -1.0
            solution = solve_ivp(
                self.state_rate, (time, times[-1]), state, method="DOP853", rtol=tolerance,
                atol=tolerance, dense_output=True, events=contact,
            )  # fmt: skip
            if solution.status < 0:
                raise RuntimeError(f"rigid linkage: {solution.message} at t = {solution.t[-1]} s")
            end_time = solution.t[-1]
            rows = (times >= time) & (times <= end_time)
            if rows.any():
                states[rows] = solution.sol(times[rows]).T
            time = end_time
            if solution.status == 1:
                (openings if is_closed else closings).append(float(end_time))
                state = np.array([self.beta_deployed, solution.y[1, -1]])
        return {
            "time": times,
            **self._observe(states),
            "closings": np.array(closings),
            "openings": np.array(openings),
        }

    def _observe(self, states: np.ndarray) -> dict[str, np.ndarray]:
        """Curves of what is compared, from states (T, 2)."""
        names = ("BD", "AC", "height", "velocity_Bz", "opening_a", "opening_b")
        energies = ("kinetic", "spring", "contact")
        curves = {name: np.empty(len(states)) for name in (*names, *energies)}
        for i, (beta, rate) in enumerate(states):
            motion = self.motion(beta)
            spring, contact, _ = self.potential(motion)
            a, b = motion["A"], motion["B"]
            row = (
                2.0 * abs(b[0, 1]), 2.0 * abs(a[0, 0]), b[0, 2] - a[0, 2], b[1, 2] * rate,
                motion["opening_a"][0], motion["opening_b"][0],
                0.5 * self.inertia(motion)[0] * rate * rate, spring, contact,
            )  # fmt: skip
            for name, value in zip((*names, *energies), row, strict=True):
                curves[name][i] = value
        curves["energy"] = curves["kinetic"] + curves["spring"] + curves["contact"]
        return curves


def _angle(vector: np.ndarray, side: np.ndarray, zero: np.ndarray) -> np.ndarray:
    """Angle about an axis from ``zero`` to ``vector``, with its first two derivatives.

    ``vector`` and ``side``, the vector product of axis and ``zero``, hold value and derivatives
    (3, 3); ``vector`` is normal to the axis."""
    cosine = vector @ zero
    sine = np.array(
        [
            vector[0] @ side[0],
            vector[1] @ side[0] + vector[0] @ side[1],
            vector[2] @ side[0] + 2.0 * vector[1] @ side[1] + vector[0] @ side[2],
        ]
    )
    # cos^2 + sin^2 = 1 throughout, so no denominators.
    first = cosine[0] * sine[1] - sine[0] * cosine[1]
    second = cosine[0] * sine[2] - sine[0] * cosine[2]
    return np.array([math.atan2(sine[0], cosine[0]), first, second])
