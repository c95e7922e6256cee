"""In which order a config names things, and how, changes nothing else."""

from __future__ import annotations

import copy
from dataclasses import asdict
from itertools import permutations

import pytest

from deployable import campaign
from deployable.intervals import METHODS

INTERVALS = {"a": {"relative": 0.01}, "E": {"relative": 0.0}, "rho": {"relative": 0.02}}


def told(raw, names):
    """The campaign whose intervals are named in an order."""
    ordered = {name: INTERVALS[name] for name in names}
    return campaign.check_config({**copy.deepcopy(raw), "intervals": ordered})


@pytest.mark.parametrize("method", METHODS)
def test_a_campaign_does_not_know_in_which_order_its_parameters_were_named(raw, method):
    raw["design"] = {"method": method, "samples": 16}
    if method != "screening":  # which has none
        raw["design"]["order"] = 2
    first = told(raw, INTERVALS)
    for names in permutations(INTERVALS):
        other = told(raw, names)
        assert asdict(other) == asdict(first)
        assert list(other.experiment.intervals) == list(first.experiment.intervals)
