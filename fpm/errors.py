"""Errors of the mechanics. Each one says what was found, what is allowed and what to change."""

import difflib
from collections.abc import Iterable
from math import inf, isfinite


class SceneError(ValueError):
    """A scene, a parameter or a response that cannot be built.

    Attributes: `key` (what was wrong), `value` (what was found), `allowed` (what would be right).
    """

    def __init__(self, key: str, value: object, allowed: str):
        self.key, self.value, self.allowed = key, value, allowed
        super().__init__(f"{key} = {value!r} is not allowed; expected {allowed}")

    def __reduce__(self):
        return type(self), (self.key, self.value, self.allowed)


class InstabilityError(RuntimeError):
    """A run whose numbers can not be trusted: its energy balance broke, or beams are no beams.

    Attributes: `time` (s) of the first check that failed, `element` (name of the element with the
    most energy, the first non-finite one, or the one to blame), `step` (s) used, `limit` (s) the
    stable step of the scene at its start, `balance` (J) the energy that came from nowhere, `scale`
    (J), `cause` the name of what is watched and too large (None: the balance broke), `largest` of
    everything that is watched, by name, `words` what was found and how to cure it by the cause.
    """

    def __init__(
        self, time, element, step, limit, balance, scale, cause=None, largest=None, words=None
    ):
        self.time, self.element, self.step, self.limit = time, element, step, limit
        self.balance, self.scale, self.cause = balance, scale, cause
        self.largest, self.words = largest or {}, words
        found = (
            f"the energy balance is off by {balance:.3g} J of {scale:.3g} J"
            if isfinite(balance)
            else "numbers are no longer finite"
        )
        remedy = (
            "the step is below the limit of the undeformed scene, so the motion itself is "
            "too violent for it: halve solver.step, refine the mesh, or soften the contact"
        )
        if limit == inf:
            remedy = (
                "nothing is elastic: halve solver.step; or joints of rigid bodies contradict each "
                "other, by lengths or axes that do not fit"
            )
        if step > limit:
            remedy = f"use a step below {limit:.4g} s (solver.step: auto takes one)"
        elif words is not None and isfinite(balance):
            found, remedy = words
        super().__init__(
            f"unstable at t = {time:.6g} s: {found}, worst in element {element}; "
            f"step {step:.4g} s, stable limit {limit:.4g} s; {remedy}"
        )

    def __reduce__(self):
        return type(self), (
            self.time, self.element, self.step, self.limit, self.balance, self.scale,
            self.cause, self.largest, self.words,
        )  # fmt: skip


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`" (did you mean x?)"` when a known name is close, else an empty string."""
    meant = likely(name, known)
    return f" (did you mean {meant}?)" if meant else ""


def likely(name: str, known: Iterable[str]) -> str:
    """The known name that is close; "" where none is."""
    known = list(known)
    close = [other for other in known if other.lower() == name.lower()]
    close += difflib.get_close_matches(name, known, n=1)
    return close[0] if close else ""
