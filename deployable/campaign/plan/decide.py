"""What comes next towards an accuracy: more runs, a finer mesh or step, a check, or an end.

Pure logic, without files or runs. Errors are shares of the widths of responses and quantities, by
part: surrogate, step and mesh."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from deployable.campaign.config.sections import Accuracy
from deployable.campaign.plan.plan import Rounds
from deployable.campaign.text.numbers import duration_text

Shares = Mapping[str, Mapping[str, float]]

_INITIAL_SHARE, _FINAL_SHARE = 0.5, 0.75
"""Share of the tolerance that step and mesh may take: with the first runs, and with more."""

_HARDLY = 1.3  # factor by which the error of a mesh must fall for the next one to be worth its cost


_STAGNANT, _STAGNANT_RUNS = 0.9, 4.0
"""An error does not fall with runs if at least this many times that with a quarter of them."""

_RATE, _RATES = 1.5, (0.75, 4.0)
"""A surrogate's error falls like runs to minus this power, till two rounds tell it; limits."""

_LEAST, _MOST = 1.25, 4.0
"""Factors by which a round has more runs than the last; above 2 where they are cheap."""

_SPARE = 0.75
"""Share that is aimed at of what is left for a surrogate's error, not to miss it by little."""

COMPONENTS = ("step", "mesh")  # parts of an error that a check tells

CHECKED_RUNS = 14
"""Runs for each quantity after the rounds: six at its bounds, eight at its limit-state surface."""

UNKNOWN = 1e6  # share of a width: an error that is not known, or larger

ROUND, RUN_FILES = 0.5, 0.01
"""Core seconds of a round beside its runs (a shorter check is made at once), of a run's file."""


@dataclass(frozen=True)
class Resources:
    """What the rounds of an `accuracy` have spent, and what the next actions would take. runs,
    seconds (of one core, estimated): spent so far; nodes: runs that are fitted; next_runs: would be
    added; check_runs: repeated in a check; run_seconds: of one run; elements: of the mesh; reserve:
    runs kept for the bounds of quantities."""

    runs: int
    seconds: float
    nodes: int
    next_runs: int
    check_runs: int
    run_seconds: float
    elements: int
    reserve: int = 0

    def need_of(self, action: str) -> tuple[int, float]:
        """Return the runs and the seconds of one core that an action takes: "check", or "runs",
        "step" or "mesh" with the checks of step and mesh during it and at the end."""
        runs, cost, checks, check_cost = {
            "check": (0, 0, 2, 6), "runs": (self.next_runs, 1, 2, 6),
            "step": (self.nodes, 2, 2, 12), "mesh": (self.nodes, 4, 3, 40),
        }[action]  # fmt: skip
        seconds = (cost * runs + check_cost * self.check_runs) * self.run_seconds
        return runs + checks * self.check_runs, seconds


@dataclass(frozen=True)
class Decision:
    """The next action of an `accuracy`, with the `reason` as a sentence: "stop", "check", "runs"
    (add some), "mesh" or "step" (halve it and repeat all). check: errors, of "step" and "mesh", for
    which the next round repeats runs; met: whether all are tolerable."""

    action: str
    reason: str
    check: tuple[str, ...] = ()
    met: bool = False


@dataclass(frozen=True)
class Errors:
    """Estimated errors of the bounds of the response or quantity `name`, as fractions of its width.
    tolerance: of their sum; parts: by component, "surrogate" and, if known, "step", "mesh"."""

    name: str
    tolerance: float
    parts: Mapping[str, float]

    @property
    def total(self) -> float:
        """Sum of the errors by surrogate, step and mesh, as a fraction of the interval's width."""
        return sum(self.parts.values())

    @property
    def surrogate(self) -> float:
        """Error of the surrogate; 0 for quantities, which are bounded after the rounds."""
        return self.parts.get("surrogate", 0.0)

    @property
    def discretization(self) -> float:
        """Error by mesh and step, as a fraction of the width; more runs do not reduce it."""
        return self.parts.get("mesh", 0.0) + self.parts.get("step", 0.0)

    @property
    def larger(self) -> str:
        """Which of "mesh" and "step" has the larger error; "mesh" if they are equal."""
        return "mesh" if self.parts.get("mesh", 0.0) >= self.parts.get("step", 0.0) else "step"

    @property
    def allowance(self) -> float:
        """Error that the surrogate may have, as a fraction of the width: the tolerance less the
        errors by mesh and step, but at least a quarter of the tolerance."""
        least = (1 - _FINAL_SHARE) * self.tolerance
        return max(self.tolerance - self.discretization, least)

    def __str__(self) -> str:
        components = ", ".join(f"{part} {_percent(value)}" for part, value in self.parts.items())
        total, tolerance = _percent(self.total), _percent(self.tolerance)
        return f"{self.name} {total} of the width ({components}), tolerance {tolerance}"


@dataclass(frozen=True)
class RefinementState:
    """State after a finished round, from which `decide` takes the next action. shares: errors by
    name and component, as fractions of widths; state: earlier rounds, and the errors that this one
    was checked for; is_step_free: whether the step may be halved."""

    accuracy: Accuracy
    shares: Shares
    state: Rounds
    cost: Resources
    is_step_free: bool

    @cached_property
    def unmet(self) -> list[Errors]:
        """Errors of responses above their tolerances, and of quantities above the share of these
        that step and mesh may take; not NaN, of constant ones."""
        limits = [e.tolerance * (1.0 if e.surrogate else _FINAL_SHARE) for e in self._all]
        return [
            error for error, limit in zip(self._all, limits, strict=True) if error.total > limit
        ]

    @property
    def _all(self) -> list[Errors]:
        tolerances = self.accuracy.tolerances
        return [Errors(name, tolerances[name], parts) for name, parts in self.shares.items()]

    @cached_property
    def needs(self) -> dict[str, tuple[str, str]]:
        """What each response or quantity beyond its tolerance needs, by name: the action, "runs",
        "mesh" or "step", that would bring it within, and why that cannot be, empty if it can."""
        return {error.name: self._need(error) for error in self.unmet}

    @property
    def reducible(self) -> list[Errors]:
        """Errors of responses and quantities beyond tolerance whose needed action is possible."""
        return [error for error in self.unmet if not self.needs[error.name][1]]

    def decide(self) -> Decision:
        """Decide on the next action of the rounds, with the reason. A check repeats the runs that
        decide the bounds with a finer step and mesh, to estimate the errors by both.

        1. If all errors are tolerable, stop if this round was checked for the step, else check.
        2. A response or quantity is given up if step and mesh together reach its tolerance and the
           larger cannot be made finer (the config gives it, the budget is too small, or a finer
           mesh hardly helps), or if the surrogate's error did not fall with four times the runs. If
           all that are beyond their tolerances are given up, stop, after a check as in 1.
        3. Else, if step and mesh take more than half of a tolerance (three quarters once there were
           rounds with other actions), halve the larger of the two.
        4. Else add `cost.next_runs` runs, and check in the same round if these are expected to
           suffice and the check takes little time.
        5. If the budget does not allow these runs, stop, after a check as in 1; the reason names
           what is beyond its tolerance, and what it would take."""
        if not self.unmet:
            if "step" in self.state.check:
                closest = max(self._all, key=lambda error: error.total / error.tolerance)
                reason = f"no error exceeds its tolerance; nearest to it is {closest}"
                return Decision("stop", reason, met=True)
            reason = (
                "the surrogate's error is small enough; step and mesh are checked where it decides"
            )
            return Decision("check", reason, COMPONENTS)
        if not self.reducible:
            return self._end("; ".join(dict.fromkeys(cause for _, cause in self.needs.values())))
        finer = [error for error in self.reducible if self.needs[error.name][0] != "runs"]
        if finer:  # comes before runs, which are all made again then
            worst = max(finer, key=lambda error: error.discretization / error.tolerance)
            action, _ = self.needs[worst.name]
            check: tuple[str, ...] = ("mesh",) if action == "mesh" else COMPONENTS
            return Decision(action, f"{worst}; the {action} is halved", check)
        if reason := self._exceeds_budget("runs"):
            return self._end(reason)
        worst = max(self.reducible, key=lambda error: error.total / error.tolerance)
        fall = self.cost.nodes / (self.cost.nodes + self.cost.next_runs)
        is_enough = all(
            error.surrogate * fall ** self._rate(error) <= error.allowance
            for error in self.reducible
        )
        is_cheap = self.cost.need_of("check")[1] <= ROUND  # than a round of its own
        check = COMPONENTS if is_enough and is_cheap else ()
        return Decision("runs", f"{worst}; {self.cost.next_runs} runs are added", check)

    def growth(self) -> float:
        """Factor (1.25 to 4) for the number of fitted runs, so that the surrogate's errors that can
        be met fall to three quarters of their allowance, at the rate at which they fell last."""
        ratios = [(e.surrogate / (_SPARE * e.allowance), self._rate(e)) for e in self.reducible]
        return min(max([_LEAST, *(ratio ** (1 / rate) for ratio, rate in ratios)]), _MOST)

    def _need(self, error: Errors) -> tuple[str, str]:
        """Too coarse a mesh comes first; where none finer can be had, runs help what it leaves of
        responses; those for quantities come after the rounds."""
        is_first = all(record.action in ("mesh", "step") for record in self.state.rounds)
        fraction = _INITIAL_SHARE if is_first else _FINAL_SHARE
        if not error.discretization > fraction * error.tolerance:
            return "runs", self._stagnation(error)
        action, cause = error.larger, self._exceeds_budget(error.larger)
        if not (self.accuracy.mesh if action == "mesh" else self.is_step_free):
            cause = f"the config keeps its {action}"
        elif not cause and action == "mesh" and self._is_not_converging(error):
            cause = "a finer mesh does not get there within the budget"
        is_needed = not cause or not error.surrogate or error.discretization >= error.tolerance
        return (action, cause) if is_needed else ("runs", "")

    def _stagnation(self, error: Errors) -> str:
        """Say that the error hardly fell with four times as many runs; empty if it did."""
        nodes, value = self.cost.nodes, error.surrogate
        for record in self.state.rounds:
            if record.elements == self.cost.elements and 0 < _STAGNANT_RUNS * record.nodes <= nodes:
                previous = record.shares.get(error.name, {}).get("surrogate", math.inf)
                if value >= _STAGNANT * previous:
                    return (
                        f"the surrogate's error of {error.name} does not fall with more runs "
                        f"({_percent(previous)} of the width with {record.nodes} runs, "
                        f"{_percent(value)} with {nodes}): it jumps, or has an edge, inside the box"
                    )
        return ""

    def _exceeds_budget(self, action: str) -> str:
        """Say why the budget does not allow an action; nothing if it does."""
        cost, budget = self.cost, self.accuracy
        runs, seconds = cost.need_of(action)
        if cost.runs + runs + cost.reserve > budget.max_runs:
            rest = max(0, budget.max_runs - cost.runs)
            reserve = min(2 * cost.check_runs + cost.reserve, rest)
            costs = f"{cost.runs} are spent, {reserve} kept for checks"
            costs += f"{' and quantities' * bool(cost.reserve)}, {rest - reserve} left"
            return f"the budget of {budget.max_runs} runs does not allow more ({costs})"
        if cost.seconds + seconds > 60 * budget.max_core_minutes:
            costs = f"{budget.max_core_minutes:g} minutes does not allow more "
            costs += f"({duration_text(max(1.0, cost.seconds))} are spent)"
            return f"the budget of {costs}"
        return ""

    def _rate(self, error: Errors) -> float:
        """Power of the number of nodes with which the surrogate's error falls."""
        last, nodes = self.state.rounds[-1] if self.state.rounds else None, self.cost.nodes
        if last is None or last.action != "runs" or not 0 < last.nodes < nodes:
            return _RATE
        previous = last.shares[error.name].get("surrogate", 0.0)
        current = error.surrogate
        if current <= 0 or previous <= current:
            return _RATES[0]
        rate = math.log(previous / current) / math.log(nodes / last.nodes)
        return min(max(rate, _RATES[0]), _RATES[1])

    def _end(self, cause: str) -> Decision:
        if "step" not in self.state.check:
            reason = f"{cause}; step and mesh are checked where the bounds are decided"
            return Decision("check", reason, COMPONENTS)
        unmet, takes = "; ".join(map(str, self.unmet)), "; ".join(map(self._takes, self.unmet))
        return Decision("stop", f"{cause}: {unmet}. {takes}")

    def _takes(self, error: Errors) -> str:
        """Say what would bring an error down to its tolerance, from how its parts fell so far."""
        if self._stagnation(error):
            return f"more runs do not help {error.name}"
        nodes, seconds, texts = self.cost.nodes, self.cost.run_seconds, []
        if error.discretization > _FINAL_SHARE * error.tolerance:
            fall = self._fall(error) or 2.0
            if fall < _HARDLY:
                return f"{error.name} has an error of the mesh that hardly falls with a finer one"
            halvings = _halvings(error, fall)
            seconds *= {"mesh": 4, "step": 2}[error.larger] ** halvings
            texts.append(f"a {error.larger} {2**halvings} times as fine")
        tolerance = error.tolerance
        allowance = max(tolerance - min(error.discretization, tolerance / 2), 0.1 * tolerance)
        if error.surrogate > allowance:
            is_known = error.surrogate < UNKNOWN
            nodes = math.ceil(nodes * min(error.surrogate / allowance, 100.0))
            texts.append(f"some {nodes} runs beside those of checks" if is_known else "more runs")
        time = duration_text(max(1.0, (nodes + 4 * self.cost.check_runs) * seconds))
        need = " and ".join(texts) or "more runs"
        return f"{error.name} would take {need}, about {time} of a core"

    def _is_not_converging(self, error: Errors) -> bool:
        """Return whether the mesh needed, by its `_fall`, exceeds the budget, or it hardly fell."""
        if (fall := self._fall(error)) is None or fall < _HARDLY:
            return fall is not None
        factor = sum(4.0**i for i in range(1, _halvings(error, fall) + 1))
        seconds = (self.cost.nodes + 4 * self.cost.check_runs) * self.cost.run_seconds * factor
        return self.cost.seconds + seconds > 60 * self.accuracy.max_core_minutes

    def _fall(self, error: Errors) -> float | None:
        """Factor by which the mesh's error fell when last halved, at most 8; None if never."""
        current, rounds = error.parts.get("mesh", 0.0), self.state.rounds
        meshes = {row.elements: row.shares.get(error.name, {}).get("mesh", 0.0) for row in rounds}
        coarser = [value for n, value in sorted(meshes.items()) if n < self.cost.elements]
        return min(coarser[-1] / current, 8.0) if coarser and current > 0 else None


def _halvings(error: Errors, fall: float) -> int:
    """Return how often a mesh must be halved for its error to be half of its tolerance."""
    return max(1, math.ceil(math.log(2 * error.discretization / error.tolerance) / math.log(fall)))


def _percent(value: float) -> str:
    return f"{100 * value:.2g} %" if value < UNKNOWN else "an unknown share"
