"""By how much latches catch, or are missed, by a panel on a spring, in closed form."""

import numpy as np
import pytest

from fpm.elements.kind import Eventful, Gate
from fpm.files.trajectory import Curves
from fpm.reading.quantities import gate_margin
from fpm.reading.quantity_definitions import parse

RATE, TIME = 0.5, np.linspace(0.0, 8.0, 401)  # of the panel on its spring, rad/s
PIN = Eventful("latch pin", ("latches", "misses"), "hinge", Gate(1.5, 1.0))


def exact(rest, angle, friction=0.0, largest=np.inf):
    """Half the square of the rate at an angle, continued to where it does not come."""
    energy = RATE**2 * angle * (rest - angle / 2 - friction)
    return energy * (1 - 2 * energy / largest**2)


def panel(rest, friction=0.0, pin=PIN):
    """It swings from 0 about what the spring's rest and friction leave, and stays where it caught,
    or, with friction, where it turns back."""
    middle, angle, limit = rest - friction, pin.gate.opening, pin.gate.largest_rate or np.inf
    way = np.clip(1 - angle / middle, -1, 1)
    catch = np.arccos(way) / RATE if 2 * middle > angle else np.inf
    caught = catch < np.inf and middle * RATE * np.sqrt(1 - way**2) <= limit
    end = catch if caught else np.pi / RATE if friction else np.inf
    opening = middle * (1 - np.cos(RATE * np.minimum(TIME, end)))
    events = [[catch, 0, 0 if caught else 1]] if catch < np.inf else np.zeros((0, 3))
    columns = {("opening", "hinge"): opening}
    return Curves(TIME, {}, {}, columns, np.array(events), (pin,), 0, 1e-3)


@pytest.mark.parametrize("rest", [0.3, 0.749, 0.751, 1.2])
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_it_is_the_energy_that_is_left_or_lacks(rest, friction):
    """Also where the joint sticks: it goes on smoothly where it no longer catches."""
    run = panel(rest + friction, friction)
    found, expected = gate_margin(run, "latches", PIN), exact(rest + friction, 1.5, friction)
    assert found == pytest.approx(expected, rel=5e-3, abs=2e-6)
    assert (found > 0) == (rest > 0.75)


@pytest.mark.parametrize("rest", [0.78, 0.81, 0.9])
def test_what_is_passed_too_fast_has_one_below_zero(rest):
    pin = PIN._replace(gate=Gate(1.5, 0.0, largest_rate=0.2))
    expected = exact(rest, 1.5, largest=0.2)
    found = gate_margin(panel(rest, pin=pin), "latches", pin)
    assert found == pytest.approx(expected, rel=1e-3) and (found > 0) == (rest < 0.8)


def test_none_is_told_where_it_may_catch_late_or_starts_beyond():
    beyond, late = Gate(1.5, -1.0), Gate(1.5, 1.0, reach=0.1, largest_rate=1.0)
    for gate in (beyond, late, None):
        assert np.isnan(gate_margin(panel(0.7), "latches", PIN._replace(gate=gate)))
    definitions = {"t": {"event": "latches"}, "m": {"event_margin": "t"}}
    _, (problem,) = parse(definitions, [], [PIN._replace(gate=late)])
    assert "the first time that a latch, stop or contact" in str(problem)
