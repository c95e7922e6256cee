"""The structure of two driven arms moves by the equations of those who measured them."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from evidence.measured.two_arms import largest_differences

FIRST, SECOND, ROTOR = 0.04211, 0.05104, 6.287e-5  # inertias about the joints, kg m2
COUPLING = 0.3369 * 0.2 * 0.4684
WEIGHTS = 9.81 * np.array([0.7586 * 0.2 + 0.3369 * 0.2, 0.3369 * 0.4684])


def torques(time):
    return np.array([1.5 * np.sin(5 * time), 0.6 * np.sin(7 * time + 4)])


def rates(time, state):
    angles, speeds = state[:2], state[2:]
    cosine, sine = COUPLING * np.cos(angles[1]), COUPLING * np.sin(angles[1])
    outer, mixed = SECOND + 36 * ROTOR, SECOND + cosine - 6 * ROTOR
    inner = FIRST + SECOND + 0.3369 * 0.2**2 + 2 * cosine + 37 * ROTOR
    moments = torques(time) - [3.69e-3, 6.45e-4] * speeds
    moments -= np.pi / 2 * np.array([0.1747, 0.11]) * np.tanh(speeds / 1e-3)
    moments += sine * np.array([2 * speeds[0] * speeds[1] + speeds[1] ** 2, -(speeds[0] ** 2)])
    pulls = WEIGHTS * np.sin([angles[0], angles.sum()])
    moments -= [pulls.sum(), pulls[1]]
    return [*speeds, *np.linalg.solve([[inner, mixed], [mixed, outer]], moments)]


@pytest.mark.slow
def test_the_arms_move_by_the_authors_equations(tmp_path):
    times = np.linspace(0, 1, 501)
    exact = solve_ivp(rates, (0, 1), np.zeros(4), "Radau", times, rtol=1e-6, atol=1e-8).y[:2]
    header = "t [s],shoulder [rad],elbow [rad],torque_shoulder [N m],torque_elbow [N m]"
    table = np.array([times, *exact, *torques(times)]).T
    np.savetxt(tmp_path / "arms.csv", table, delimiter=",", header=header, comments="")
    assert np.ptp(exact, axis=1).min() > 1.0
    assert max(largest_differences(tmp_path / "arms.csv", 1.0).values()) < 1e-3
