"""Limits of numbers: what they allow, and that they say just that."""

import numpy as np
import pytest

from fpm.declare import NumberLimits
from fpm.errors import SceneError

SAID = {
    "a number": {},
    "a number above 0 (m)": {"above": 0, "unit": "m"},
    "a number above 0, up to 1": {"above": 0.0, "most": 1, "unit": "1"},
    "a number from 1e-9 to 1e6 (s)": {"least": 1e-9, "most": 1e6, "unit": "s"},
    "a number of at least 0.0001": {"least": 1e-4},
    "a number of at most 5": {"most": 5.0},
    "a whole number from 1 to 1000000": {"least": 1, "most": 1_000_000, "is_whole": True},
}


@pytest.mark.parametrize("words", SAID)
def test_limits_are_said_in_words(words):
    limits = NumberLimits(**SAID[words])
    assert limits.describe(unit=limits.unit) == words


@pytest.mark.parametrize(("limits", "right", "wrong"), [
    ({"above": 0}, [1e-300, np.inf], [0, -1, np.nan]),
    ({"least": 0, "most": 1}, [0, 1.0], [-1e-300, 1.0000001, np.nan]),
    ({"least": 1, "is_whole": True}, [1, 2.0], [0, 1.5]),
])  # fmt: skip
def test_numbers_within_are_allowed(limits, right, wrong):
    limits = NumberLimits(**limits)
    assert all(map(limits.allows, right)) and not any(map(limits.allows, wrong))


@pytest.mark.parametrize("value", [True, "1", None, np.inf, np.nan, 10**400, [1.0], -1])
def test_what_is_no_number_within_is_refused_with_what_would_be(value):
    limits = NumberLimits(least=0, most=1e300, unit="m")
    with pytest.raises(SceneError, match=r"key = .* expected a size from 0 to 1e300 \(m\)"):
        limits.check("key", value, "a size")


def test_a_number_is_returned_as_what_it_is_to_be():
    assert isinstance(NumberLimits().check("key", 1), float)
    assert isinstance(NumberLimits(is_whole=True).check("key", 2.0), int)
