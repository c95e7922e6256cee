"""Decisions of an adaptive campaign, and whole campaigns on closed-form functions."""

import numpy as np
import pytest

from deployable.intervals import IntervalError, Progress, Specification, decide, fit
from deployable.intervals.designs import parts_of
from deployable.intervals.estimates import direction_tails


def progress(error, order=(3, 3), method="tensor_lobatto", budget=1000, **more):
    specification = Specification(method, order, more.pop("parts", ()))
    points = specification.design().points
    more.setdefault("tails", np.ones(len(order)))
    return Progress(specification, error, points=points, tolerance=0.01, budget=budget, **more)


def test_stops_at_the_tolerance_or_the_budget_and_says_which():
    done = decide(progress(0.005))
    assert (done.action, done.met) == ("stop", True)
    assert "meets" in done.reason
    spent = decide(progress(0.5, budget=16))
    assert (spent.action, spent.met) == ("stop", False)
    assert "budget of 16 runs is spent" in spent.reason


def test_raises_what_matters_and_counts_only_new_runs():
    decision = decide(progress(0.5, order=(4, 4), tails=[1.0, 1e-3]))
    assert decision.action == "raise order"
    assert decision.specification.order == (8, 4)
    assert decision.new_runs == 45 - 25
    decision = decide(progress(0.5, order=(3, 3), method="tensor_roots"))
    assert decision.specification.order == (5, 5)


def test_takes_a_cheaper_raise_where_the_budget_is_short():
    decision = decide(progress(0.5, order=(2, 2), tails=[1.0, 0.9], budget=16))
    assert decision.specification.order == (4, 2)
    assert decision.considered


def test_adds_a_direction_that_was_left_out():
    decision = decide(progress(0.5, order=(4, 0)))
    assert decision.action == "add direction"
    assert decision.specification.order == (4, 2)
    decision = decide(progress(0.005, order=(4, 0), free=[True, False]))
    assert decision.met


def test_splits_where_a_higher_order_did_not_help():
    decision = decide(progress(0.5, order=(4, 4), tails=[0.1, 1.0], history=[0.6]))
    assert decision.action == "split"
    assert decision.specification.parts == (
        ((-1.0, -1.0), (1.0, 0.0)),
        ((-1.0, 0.0), (1.0, 1.0)),
    )
    assert decide(progress(0.5, history=[5.0])).action == "raise order"


@pytest.mark.parametrize(
    ("function", "met", "actions"),
    [
        (lambda u: np.exp(u[:, 0]) * np.cos(u[:, 1]), True, {"raise order"}),
        (lambda u: np.abs(u[:, 0]) + 0.1 * u[:, 1], True, {"raise order", "split"}),
        (lambda u: np.sign(u[:, 0] - 0.123) * (1 + u[:, 1]), False, {"raise order", "split"}),
    ],
)
def test_whole_campaigns_end_for_the_right_reason(function, met, actions):
    now, history, seen = Specification("tensor_lobatto", (2, 2)), [], set()
    points = now.design().points
    test = np.random.default_rng(0).uniform(-1, 1, (200, 2))
    for _ in range(30):
        error, tails = 0.0, np.zeros(2)
        for part in parts_of(now.design()):
            surrogate = fit(part.design, function(part.points)[:, None])
            inside = test[part.contains(test)]
            told = surrogate.evaluate(part.to_local(inside))[:, 0] - function(inside)
            error = max(error, np.abs(told).max(initial=0.0) / 2)
            tails += direction_tails(surrogate)[:, 0]
        decision = decide(Progress(now, error, tails, points, 1e-3, 600, history))
        if decision.action == "stop":
            break
        history = [*history, error] if decision.action != "split" else []
        seen.add(decision.action)
        now = decision.specification
        points = np.unique(np.concatenate([points, now.design(points).points]), axis=0)
        assert len(points) <= 600
    assert decision.action == "stop"
    assert decision.met == met
    assert seen <= actions


def test_wrong_inputs_are_refused():
    for change in ({"tolerance": 0.0}, {"budget": 0}, {"error": np.nan}, {"tails": [1.0]}):
        good = {
            "specification": Specification("tensor_lobatto", (2, 2)),
            "error": 0.5,
            "tails": [1.0, 1.0],
            "points": np.zeros((0, 2)),
            "tolerance": 0.1,
            "budget": 10,
        }
        with pytest.raises(IntervalError):
            decide(Progress(**(good | change)))
