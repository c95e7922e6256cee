"""What comes next towards an accuracy: more runs, a finer mesh or step, a check, or an end.

Pure logic, without files or runs. Errors are shares of the widths of responses and quantities, by
part: surrogate, step and mesh.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from deployable.campaign.config.sections import Accuracy
from deployable.campaign.plan.plan import Rounds
from deployable.campaign.text.numbers import duration_text

Shares = Mapping[str, Mapping[str, float]]

_FIRST, _LATER = 0.5, 0.75
"""Share of what is asked for that step and mesh together may take: with the first runs, when a
finer mesh is cheap, and once there are more."""

_HARDLY = 1.3
"""Factor by which the error of a mesh must fall for the next one to be worth its cost."""


_RATE, _RATES = 1.5, (0.75, 4.0)
"""The error of a surrogate is taken to fall like runs to the power of minus this, as long as no two
rounds tell it; and between which it may be told."""

_LEAST, _MOST = 1.25, 2.0
"""Factors by which a round has more runs than the last."""

_SPARE = 0.75
"""Share of what is left for a surrogate's error that is aimed at: one more round for having missed
it by little costs more than the runs that are too many."""

_BOTH = ("step", "mesh")

_ROUND = 0.5
"""Seconds of a core that a round takes beside its runs: a check that takes less is made at once
where the errors are expected to be small enough after it."""


@dataclass(frozen=True)
class Cost:
    """What was spent, `runs` and `seconds` of a core by estimate, and what is at hand: so many
    `nodes` with so many `elements`, `more` in the next round, `checked` places in a check, a run
    takes `each` second."""

    runs: int
    seconds: float
    nodes: int
    more: int
    checked: int
    each: float
    elements: int

    def of(self, action: str) -> tuple[int, float]:
        """Runs and seconds of the next round after an action, with the check that belongs to it,
        and with that of step and mesh at the end, for which there must be room."""
        if action == "check":
            return 2 * self.checked, 6 * self.checked * self.each
        if action == "runs":
            return self.more + 2 * self.checked, (self.more + 6 * self.checked) * self.each
        if action == "step":
            return self.nodes + 2 * self.checked, (2 * self.nodes + 12 * self.checked) * self.each
        return self.nodes + 3 * self.checked, (4 * self.nodes + 40 * self.checked) * self.each


@dataclass(frozen=True)
class Decision:
    """What to do next, and why: action "stop", "check", "runs", "mesh" or "step"; what to `check`
    then; met: whether everything is as accurate as asked for."""

    action: str
    reason: str
    check: tuple[str, ...] = ()
    met: bool = False


@dataclass(frozen=True)
class Errors:
    """The errors of a response or quantity by part, as shares of its width, and what they may be
    together, `aim`."""

    name: str
    aim: float
    parts: Mapping[str, float]

    @property
    def whole(self) -> float:
        """All of them."""
        return sum(self.parts.values())

    @property
    def others(self) -> float:
        """Those of mesh and step, which no run helps."""
        return self.parts.get("mesh", 0.0) + self.parts.get("step", 0.0)

    @property
    def larger(self) -> str:
        """Which of mesh and step has the larger one."""
        return "mesh" if self.parts.get("mesh", 0.0) >= self.parts.get("step", 0.0) else "step"

    @property
    def left(self) -> float:
        """What is left of the aim for the surrogate."""
        mesh, step = self.parts.get("mesh", 0.0), self.parts.get("step", 0.0)
        return max(self.aim - mesh - step, (1 - _LATER) * self.aim)

    def __str__(self) -> str:
        each = ", ".join(f"{part} {_percent(share)}" for part, share in self.parts.items())
        whole, aim = _percent(self.whole), _percent(self.aim)
        return f"{self.name} {whole} of the width ({each}), asked for {aim}"


@dataclass(frozen=True)
class Need:
    """The action that a response or quantity needs, and why it cannot be had, if so."""

    action: str
    why_not: str = ""


@dataclass(frozen=True)
class Standing:
    """How things stand after a round: what is wanted, the errors, the rounds so far, what was spent
    and is at hand, and whether the step may be chosen."""

    accuracy: Accuracy
    shares: Shares
    state: Rounds
    cost: Cost
    step_is_free: bool

    @cached_property
    def unmet(self) -> list[Errors]:
        """Errors that are larger than they may be; what is no number is none of them."""
        return [one for one in self._all if one.whole > one.aim]

    @property
    def _all(self) -> list[Errors]:
        aims = self.accuracy.shares
        return [Errors(name, aims[name], parts) for name, parts in self.shares.items()]

    @cached_property
    def needs(self) -> dict[str, Need]:
        """What each response and quantity needs that is not as accurate as it should be."""
        return {one.name: self._need(one) for one in self.unmet}

    @property
    def pursued(self) -> list[Errors]:
        """What of these can be had."""
        return [one for one in self.unmet if not self.needs[one.name].why_not]

    def decide(self) -> Decision:
        """Decide on the next round.

        1. Where all errors are small enough, stop if this round was checked for step and mesh, else
           check it.
        2. What step or mesh alone make too large, where these are kept or what would be needed is
           not affordable, is set aside: no run helps it. Where nothing else is unmet, that ends the
           rounds.
        3. Where step and mesh of the others take too much of an aim, halve the larger.
        4. Else add runs, as many as the errors are expected to need, and check them at once where
           that is cheap.
        5. When the budget allows no more runs, end; the reason names what is not met, and what that
           would cost.
        """
        if not self.unmet:
            if "step" in self.state.check:
                near = max(self._all, key=lambda one: one.whole / one.aim)
                reason = f"the whole error is as small as asked for; nearest to that is {near}"
                return Decision("stop", reason, met=True)
            reason = "the surrogate's error is small enough"
            return Decision("check", f"{reason}; step and mesh are checked where it decides", _BOTH)
        if not self.pursued:
            return self._end("; ".join(dict.fromkeys(n.why_not for n in self.needs.values())))
        finer = [one for one in self.pursued if self.needs[one.name].action != "runs"]
        if finer:  # comes before runs, which are all made again then
            worst = max(finer, key=lambda one: one.others / one.aim)
            action = self.needs[worst.name].action
            check = ("mesh",) if action == "mesh" else _BOTH
            return Decision(action, f"{worst}; the {action} is halved", check)
        if why := self._too_dear("runs"):
            return self._end(why)
        worst = max(self.pursued, key=lambda one: one.whole / one.aim)
        check = _BOTH if self._is_last() else ()
        return Decision("runs", f"{worst}; {self.cost.more} runs are added", check)

    def growth(self) -> float:
        """The factor by which nodes have to become more for surrogates of what is pursued to be
        accurate enough, by how errors fell when runs were added last."""
        wanted = [
            (one.parts["surrogate"] / (_SPARE * one.left)) ** (1 / self._rate(one))
            for one in self.pursued
        ]
        return min(max([_LEAST, *wanted]), _MOST)

    def _need(self, one: Errors) -> Need:
        """A mesh that is too coarse comes first: all runs are made again with a finer one. Where it
        cannot be had, runs help what its error leaves room for."""
        is_first = all(done.action in ("mesh", "step") for done in self.state.rounds)
        if not one.others > (_FIRST if is_first else _LATER) * one.aim:
            return Need("runs")
        action, why = one.larger, self._too_dear(one.larger)
        if not (self.accuracy.mesh if action == "mesh" else self.step_is_free):
            why = f"the config keeps its {action}"
        elif not why and action == "mesh" and self._is_hopeless(one):
            why = "a finer mesh does not get there within the budget"
        return Need(action, why) if not why or one.others >= one.aim else Need("runs")

    def _too_dear(self, action: str) -> str:
        """Why the budget does not allow an action; nothing where it does."""
        cost, budget = self.cost, self.accuracy
        runs, seconds = cost.of(action)
        if cost.runs + runs > budget.runs:
            spent = f"{cost.runs} are spent, {2 * cost.checked} kept for the last check"
            return f"the budget of {budget.runs} runs does not allow more ({spent})"
        if cost.seconds + seconds > 60 * budget.minutes:
            spent = f"{duration_text(max(1.0, cost.seconds))} are spent"
            return f"the budget of {budget.minutes:g} minutes does not allow more ({spent})"
        return ""

    def _rate(self, one: Errors) -> float:
        """Power of the number of nodes with which the surrogate's error falls."""
        last, nodes = self.state.rounds[-1] if self.state.rounds else None, self.cost.nodes
        if last is None or last.action != "runs" or not 0 < last.nodes < nodes:
            return _RATE
        before, now = last.shares[one.name]["surrogate"], one.parts["surrogate"]
        if now <= 0 or before <= now:
            return _RATES[0]
        rate = math.log(before / now) / math.log(nodes / last.nodes)
        return min(max(rate, _RATES[0]), _RATES[1])

    def _is_last(self) -> bool:
        """Whether surrogates are expected to be accurate enough after the next runs, and a check is
        cheaper than a round of its own."""
        fall = self.cost.nodes / (self.cost.nodes + self.cost.more)
        return self.cost.of("check")[1] <= _ROUND and all(
            one.parts["surrogate"] * fall ** self._rate(one) <= one.left for one in self.pursued
        )

    def _end(self, why: str) -> Decision:
        if "step" not in self.state.check:
            reason = f"{why}; step and mesh are checked where the bounds are decided"
            return Decision("check", reason, _BOTH)
        unmet, takes = "; ".join(map(str, self.unmet)), "; ".join(map(self._takes, self.unmet))
        return Decision("stop", f"{why}: {unmet}. {takes}")

    def _takes(self, one: Errors) -> str:
        """What it would take to bring one error down to its aim, by how parts fell so far."""
        nodes, seconds, texts = self.cost.nodes, self.cost.each, []
        if one.others > _LATER * one.aim:
            fall = self._fall(one) or 2.0
            if fall < _HARDLY:
                return f"{one.name} has an error of the mesh that hardly falls with a finer one"
            halvings = _halvings(one, fall)
            seconds *= {"mesh": 4, "step": 2}[one.larger] ** halvings
            texts.append(f"a {one.larger} {2**halvings} times as fine")
        left = max(one.aim - min(one.others, one.aim / 2), 0.1 * one.aim)
        if one.parts["surrogate"] > left:
            nodes = math.ceil(nodes * min(one.parts["surrogate"] / left, 100.0))
            texts.append(f"some {nodes} runs")
        time = duration_text(max(1.0, (nodes + 4 * self.cost.checked) * seconds))
        return f"{one.name} would take {' and '.join(texts) or 'more runs'}, about {time} of a core"

    def _is_hopeless(self, one: Errors) -> bool:
        """Whether the mesh that is needed, by how its error fell last, takes more than the budget;
        the first mesh tells nothing."""
        if (fall := self._fall(one)) is None or fall < _HARDLY:
            return fall is not None
        factor = sum(4.0**i for i in range(1, _halvings(one, fall) + 1))
        seconds = (self.cost.nodes + 4 * self.cost.checked) * self.cost.each * factor
        return self.cost.seconds + seconds > 60 * self.accuracy.minutes

    def _fall(self, one: Errors) -> float | None:
        """The factor by which the error of the mesh fell when it was last halved, at most 8; None
        where it was not."""
        now, rounds = one.parts.get("mesh", 0.0), self.state.rounds
        meshes = {done.elements: done.shares.get(one.name, {}).get("mesh", 0.0) for done in rounds}
        coarser = [share for n, share in sorted(meshes.items()) if n < self.cost.elements]
        return min(coarser[-1] / now, 8.0) if coarser and now > 0 else None


def _halvings(one: Errors, fall: float) -> int:
    """How often a mesh must be halved for its error to take half of the aim."""
    return max(1, math.ceil(math.log(2 * one.others / one.aim) / math.log(fall)))


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"
