"""What comes next towards an accuracy: more runs, a finer mesh or step, a check, or an end.

Pure logic, without files or runs. Errors are shares of the widths of responses and quantities, by
part: surrogate, step and mesh.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from deployable.campaign.config.sections import Accuracy
from deployable.campaign.plan.plan import Rounds
from deployable.campaign.runs.progress import duration_text

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


def decide(
    asked: Accuracy, shares: Shares, state: Rounds, cost: Cost, step_is_free: bool
) -> Decision:
    """Decide on the next round.

    1. Where all errors are as small as asked for, stop if this round was checked for step and mesh,
       else check it.
    2. What step or mesh alone make too large, where these are kept or what would be needed is not
       affordable, is set aside: no run helps it. Where nothing else is unmet, that ends the rounds.
    3. Where step and mesh of the others take too much of what is asked for, halve the larger.
    4. Else add runs, as many as the errors are expected to need, and check them at once where
       that is cheap.
    5. When the budget allows no more runs, end; the reason names what is not met, and what that
       would cost.
    """
    unmet = {name: parts for name, parts in shares.items() if _whole(parts) > asked.shares[name]}
    if not unmet:
        if "step" in state.check:
            near = max(shares, key=lambda name: _whole(shares[name]) / asked.shares[name])
            reason = "the whole error is as small as asked for; nearest to that is "
            return Decision("stop", reason + told(asked, {near: shares[near]}), met=True)
        reason = "the surrogate's error is small enough; step and mesh are checked where it decides"
        return Decision("check", reason, ("step", "mesh"))
    needs = needed(asked, shares, state, cost, step_is_free)
    wanted = {name: need.action for name, need in needs.items() if not need.why_not}
    if not wanted:
        why = "; ".join(dict.fromkeys(need.why_not for need in needs.values()))
        return _end(asked, unmet, why, state, cost)
    action, worst = _next(asked, {name: unmet[name] for name in wanted}, wanted)
    if action == "runs" and (why := _too_dear(asked, action, cost)):
        return _end(asked, unmet, why, state, cost)
    reason = f"{told(asked, {worst: shares[worst]})}; "
    if action == "runs":
        last = _is_last(asked, {name: unmet[name] for name in wanted}, state, cost)
        check = ("step", "mesh") if last else ()
        return Decision("runs", f"{reason}{cost.more} runs are added", check)
    check = ("mesh",) if action == "mesh" else ("step", "mesh")
    return Decision(action, f"{reason}the {action} is halved", check)


@dataclass(frozen=True)
class Need:
    """The action that a response or quantity needs, and why it cannot be had, if so."""

    action: str
    why_not: str = ""


def needed(
    asked: Accuracy, shares: Shares, state: Rounds, cost: Cost, step_is_free: bool
) -> dict[str, Need]:
    """What each response and quantity needs that is not as accurate as asked for.

    A mesh that is too coarse comes first: all runs are made again with a finer one. Where it cannot
    be had, runs help what its error leaves room for.
    """
    first = all(done.action in ("mesh", "step") for done in state.rounds)
    limit, found = _FIRST if first else _LATER, {}
    for name, parts in shares.items():
        aim, others = asked.shares[name], parts.get("mesh", 0.0) + parts.get("step", 0.0)
        if not _whole(parts) > aim:  # nor where it is no number
            continue
        need = Need("runs")
        if others > limit * aim:
            action = "mesh" if parts.get("mesh", 0.0) >= parts.get("step", 0.0) else "step"
            why = _too_dear(asked, action, cost)
            if (action == "mesh" and not asked.mesh) or (action == "step" and not step_is_free):
                why = f"the config keeps its {action}"
            elif not why and action == "mesh" and _is_hopeless(asked, name, parts, state, cost):
                why = "a finer mesh does not get there within the budget"
            if not why or others >= aim:
                need = Need(action, why)
        found[name] = need
    return found


def _too_dear(asked: Accuracy, action: str, cost: Cost) -> str:
    """Why the budget does not allow an action; nothing where it does."""
    runs, seconds = cost.of(action)
    if cost.runs + runs > asked.runs:
        spent = f"{cost.runs} are spent, {2 * cost.checked} kept for the last check"
        return f"the budget of {asked.runs} runs does not allow more ({spent})"
    if cost.seconds + seconds > 60 * asked.minutes:
        spent = duration_text(max(1.0, cost.seconds))
        return f"the budget of {asked.minutes:g} minutes does not allow more ({spent} are spent)"
    return ""


def growth(asked: Accuracy, shares: Shares, state: Rounds, nodes: int) -> float:
    """The factor by which so many nodes have to become more for surrogates of what is pursued to be
    as accurate as asked for, by how errors fell when runs were added last."""
    wanted = _LEAST
    for name, parts in shares.items():
        if _whole(parts) > asked.shares[name]:
            excess = parts["surrogate"] / (_SPARE * _left(asked.shares[name], parts))
            wanted = max(wanted, excess ** (1 / _rate(name, parts, state, nodes)))
    return min(wanted, _MOST)


def _rate(name: str, parts: Mapping[str, float], state: Rounds, nodes: int) -> float:
    """Power of the number of nodes, now so many, with which the surrogate's error falls."""
    last = state.rounds[-1] if state.rounds else None
    if last is None or last.action != "runs" or not 0 < last.nodes < nodes:
        return _RATE
    before, now = last.shares[name]["surrogate"], parts["surrogate"]
    if now <= 0 or before <= now:
        return _RATES[0]
    return min(max(math.log(before / now) / math.log(nodes / last.nodes), _RATES[0]), _RATES[1])


def _left(aim: float, parts: Mapping[str, float]) -> float:
    """What is left of an aim for the surrogate."""
    return max(aim - parts.get("mesh", 0.0) - parts.get("step", 0.0), (1 - _LATER) * aim)


def _is_last(asked: Accuracy, unmet: Shares, state: Rounds, cost: Cost) -> bool:
    """Whether surrogates are expected to be accurate enough after the next runs, and a check is
    cheaper than a round of its own."""
    fall = cost.nodes / (cost.nodes + cost.more)
    return cost.of("check")[1] <= _ROUND and all(
        parts["surrogate"] * fall ** _rate(name, parts, state, cost.nodes)
        <= _left(asked.shares[name], parts)
        for name, parts in unmet.items()
    )  # fmt: skip


def told(asked: Accuracy, shares: Shares) -> str:
    """Errors in words: `vBz 7 % of the width (surrogate 1 %, mesh 6 %), asked for 5 %`."""
    texts = []
    for name, parts in shares.items():
        each = ", ".join(f"{part} {_percent(share)}" for part, share in parts.items())
        texts.append(f"{name} {_percent(_whole(parts))} of the width ({each}), "
                     f"asked for {_percent(asked.shares[name])}")  # fmt: skip
    return "; ".join(texts)


def _next(asked: Accuracy, unmet: Shares, wanted: Mapping[str, str]) -> tuple[str, str]:
    """The action that the response or quantity farthest from its aim needs, and its name; a finer
    mesh or step comes before runs, which are all made again then."""

    def excess(name: str, *parts: str) -> float:
        return sum(unmet[name].get(part, 0.0) for part in parts) / asked.shares[name]

    if finer := [name for name, action in wanted.items() if action != "runs"]:
        worst = max(finer, key=lambda name: excess(name, "mesh", "step"))
        return wanted[worst], worst
    return "runs", max(wanted, key=lambda name: excess(name, *unmet[name]))


def _end(asked: Accuracy, unmet: Shares, why: str, state: Rounds, cost: Cost) -> Decision:
    if "step" not in state.check:
        reason = f"{why}; step and mesh are checked where the bounds are decided"
        return Decision("check", reason, ("step", "mesh"))
    needs = "; ".join(_needs(asked.shares[name], name, unmet[name], state, cost) for name in unmet)
    return Decision("stop", f"{why}: {told(asked, unmet)}. {needs}")


def _needs(aim: float, name: str, parts: Mapping[str, float], state: Rounds, cost: Cost) -> str:
    """What it would take to bring one error down to its aim, by how parts fell so far."""
    others = parts.get("mesh", 0.0) + parts.get("step", 0.0)
    nodes, seconds, texts = cost.nodes, cost.each, []
    if others > _LATER * aim:
        fall = _fall(name, parts.get("mesh", 0.0), state, cost) or 2.0
        if fall < _HARDLY:
            return f"{name} has an error of the mesh that hardly falls with a finer one"
        halvings = _halvings(others, aim, fall)
        part = "mesh" if parts.get("mesh", 0.0) >= parts.get("step", 0.0) else "step"
        seconds *= {"mesh": 4, "step": 2}[part] ** halvings
        texts.append(f"a {part} {2**halvings} times as fine")
    left = max(aim - min(others, aim / 2), 0.1 * aim)
    if parts["surrogate"] > left:
        nodes = math.ceil(nodes * min(parts["surrogate"] / left, 100.0))
        texts.append(f"some {nodes} runs")
    time = duration_text(max(1.0, (nodes + 4 * cost.checked) * seconds))
    return f"{name} would take {' and '.join(texts) or 'more runs'}, about {time} of a core"


def _is_hopeless(
    asked: Accuracy, name: str, parts: Mapping[str, float], state: Rounds, cost: Cost
) -> bool:
    """Whether the mesh that is needed, by how its error fell last, takes more than the budget."""
    fall = _fall(name, parts.get("mesh", 0.0), state, cost)
    if fall is None:  # the first mesh tells nothing
        return False
    if fall < _HARDLY:
        return True
    others = parts.get("mesh", 0.0) + parts.get("step", 0.0)
    halvings = _halvings(others, asked.shares[name], fall)
    factor = sum(4.0**i for i in range(1, halvings + 1))
    seconds = (cost.nodes + 4 * cost.checked) * cost.each * factor
    return cost.seconds + seconds > 60 * asked.minutes


def _halvings(error: float, aim: float, fall: float) -> int:
    """How often a mesh must be halved for its error to take half of the aim."""
    return max(1, math.ceil(math.log(2 * error / aim) / math.log(fall)))


def _fall(name: str, now: float, state: Rounds, cost: Cost) -> float | None:
    """The factor by which the error of the mesh, now that, fell when it was last halved, at most 8;
    None where it was not."""
    meshes = {done.elements: done.shares.get(name, {}).get("mesh", 0.0) for done in state.rounds}
    coarser = [share for elements, share in sorted(meshes.items()) if elements < cost.elements]
    return min(coarser[-1] / now, 8.0) if coarser and now > 0 else None


def _whole(parts: Mapping[str, float]) -> float:
    return sum(parts.values())


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"
