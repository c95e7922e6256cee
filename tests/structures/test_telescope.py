"""The telescopic boom of the library beside point masses on a line."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from structures_for_tests import structure

import fpm

PUSH, TIRED, TRAVEL, DAMPING, RUB, TUBE, HEAD = 20.0, 0.6, 0.8, 2.0, 0.5, 1.5, 4.0
MASSES = np.array([TUBE, TUBE, TUBE + HEAD])


def on_a_line(until=2.5) -> tuple[list[float], list[float]]:
    """Times (s) and rates (m/s) at which the slides latch: tubes as points, slides held until the
    one before has opened by nine tenths, velocities changed by impacts that stop a tube alone."""
    held, latched = [False, True, True], [False] * 3
    time, state = 0.0, np.zeros(6)
    times, rates = [], []
    stiffness = TIRED * PUSH / TRAVEL

    def slides(state):
        places, speeds = state[:3], state[3:]
        return np.diff(places, prepend=0.0), np.diff(speeds, prepend=0.0)

    def motion(_, state):
        ways, speeds = slides(state)
        force = PUSH - stiffness * ways - DAMPING * speeds - RUB
        free = np.array([not (h or x) for h, x in zip(held, latched, strict=True)])
        # With held slides their force is unknown: M a + B' l = f, B a = 0.
        pull = np.where(free, force, 0.0)
        right = pull - np.append(pull[1:], 0.0)
        rows = np.eye(3) - np.eye(3, k=-1)
        rows = rows[~free]
        matrix = np.block([[np.diag(MASSES), rows.T], [rows, np.zeros((len(rows),) * 2)]])
        found = np.linalg.solve(matrix, np.append(right, np.zeros(len(rows))))
        return np.append(state[3:], found[:3])

    while not all(latched) and time < until:
        now = latched.index(False)
        waits = now + 1 < 3 and held[now + 1]
        level = 0.9 * TRAVEL if waits else TRAVEL

        def opened(_, state, now=now, level=level):
            return slides(state)[0][now] - level

        opened.terminal = True
        found = solve_ivp(motion, (time, until), state, events=opened, rtol=1e-10, atol=1e-12)
        time, state = found.t[-1], found.y[:, -1].copy()
        if waits:
            held[now + 1] = False
            continue
        times.append(time)
        rates.append(slides(state)[1][now])
        latched[now] = True
        state[3 : 4 + now] = 0.0  # the tubes up to this one stand still
    return times, rates


@pytest.mark.slow
def test_each_tube_latches_when_and_as_fast_as_points_on_a_line_do():
    (outcome,) = fpm.simulate(structure("telescope").build(), duration=2.0, instants=201, step=2e-4)
    assert outcome.failure is None
    times, rates = on_a_line()
    names = [element.name for element in outcome.eventful]
    found = {names[int(e)]: t for t, e, which in outcome.events if names[int(e)][:5] == "latch"}
    wanted = dict(zip([f"latch stage{k}.latch" for k in (1, 2, 3)], times, strict=True))
    assert found == pytest.approx(wanted, abs=2e-4)
    caught = outcome.recorded["slide_latch_rate"]
    told = dict(zip(caught.labels, caught.values[-1], strict=True))
    assert [told[f"stage{k}.latch"] for k in (1, 2, 3)] == pytest.approx(rates, rel=1e-3)
    assert outcome.points["tip"][0][-1, 2] == pytest.approx(1.05 + 3 * TRAVEL, abs=1e-9)
