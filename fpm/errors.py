"""Errors of the mechanics. Each one names the key, the value, what is allowed, and the remedy."""

import difflib
import re
import unicodedata
from collections.abc import Iterable
from math import inf, isfinite

MOST_TURN = 0.25
"""Turn of a body in a step (rad) at which its joints surely close, and energies balance."""


class SceneError(ValueError):
    """Raised for a scene, parameter, response or argument that is not allowed. key: name of what is
    wrong; value: as given; allowed: what would be, in words; text: the message, "": of these."""

    def __init__(self, key: str, value: object, allowed: str, text: str = ""):
        self.key, self.value, self.allowed, self.text = key, value, allowed, text
        super().__init__(text or f"{key} = {value!r} is not allowed; expected {allowed}")

    def __reduce__(self):
        return type(self), (self.key, self.value, self.allowed, self.text)


class InstabilityError(RuntimeError):
    """Raised, or kept as `Outcome.failure`, for a run whose numbers mean nothing: its energy
    balance broke, numbers are not finite, or a watched quantity (such as strain) is too large.

    Attributes: `time` (s) of the first failed check; `element`, name of the element with the most
    energy, the first non-finite one, or the one to blame; `step` (s) used; `limit` (s), stable step
    of the scene at its start; `balance` (J), the error of the energy balance; `scale` (J), largest
    energy so far; `cause`, name of the watched quantity too large (None: the balance broke);
    `largest`, all watched quantities by name; `words`, two texts, cause and remedy (None: no
    cause); `remedy`, of the type of `element` where the balance broke ("": it knows none);
    `final_words`, two such texts for a failure that no shorter step mends (None: one may); `turn`
    (rad), the largest of a body in the step, of those at `element` if it joins some."""

    def __init__(
        self, time, element, step, limit, balance, scale, cause=None, largest=None, words=None,
        remedy="", final_words=None, turn=0.0,
    ):  # fmt: skip
        self.time, self.element, self.step, self.limit = time, element, step, limit
        self.balance, self.scale, self.cause = balance, scale, cause
        self.largest, self.words, self.remedy = largest or {}, words, remedy
        self.final_words, self.turn = final_words, turn
        turn_words, turn_remedy = describe_turn(turn if step <= limit else 0.0, step)
        text = "numbers are no longer finite"
        if isfinite(balance):
            text = f"the energy balance has an error of {balance:.3g} J in {scale:.3g} J"
            text += f", and {turn_words}" if turn_words else ""
        violent = (
            "the step is below the limit of the undeformed scene, so the motion itself is "
            "too violent for it: halve solver.step, refine the mesh, or soften the contact"
        )
        rigid = "nothing is elastic: halve solver.step (auto does, and finds out if it helps)"
        remedy = remedy or turn_remedy or (violent if limit < inf else rigid)
        is_told = words is not None and (isfinite(balance) or step <= limit)
        if is_told:
            text, remedy = words
        if step > limit:
            remedy = f"use a step below {limit:.4g} s (solver.step: auto takes one)"
        super().__init__(
            f"{'stopped' if is_told and step <= limit else 'unstable'} at t = {time:.6g} s: {text}"
            f"{f', worst in element {element}' if element != 'none' else ''}; "
            f"step {step:.4g} s, stable limit {limit:.4g} s; {remedy}"
        )

    def __reduce__(self):
        return type(self), tuple(vars(self).values())  # in the order of the arguments

    def as_final(self) -> "InstabilityError":
        """Return this error with its `final_words`, as no shorter step mends the failure."""
        self.words = self.final_words
        self.args = (f"stopped at t = {self.time:.6g} s: {'; '.join(self.final_words or ())}",)
        return self


def describe_turn(turn: float, step: float) -> tuple[str, str]:
    """Return cause and remedy in words where a body turns too far, by `turn` (rad), in a `step`
    (s); both "" if it does not."""
    if not MOST_TURN < turn < inf:
        return "", ""
    return (
        f"a body turns by {turn:.2g} rad in a step, at {turn / step:.3g} rad/s",
        f"take a solver.step of at most {MOST_TURN * step / turn:.2g} s",
    )


def fold_name(name: str) -> str:
    """Return a name in the one spelling of its letters that keys have, and names in expressions."""
    return unicodedata.normalize("NFC", name).replace("µ", "μ")


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """Return a hint to end the message that `name` is unknown: " (did you mean x?)", x being the
    closest of `names`, those allowed; or, in parentheses too, that a number has a point, no comma,
    that a colon or a space is missing, or what the name was changed to; "" without a guess."""
    names = list(names)
    ((head, sign, value),) = re.findall(r"\A(\w*)([ :]?)(.*)", name, re.DOTALL)
    if name[:1].isdigit():
        return " (a number has a point, not a comma, as in 1.5)"
    if sign and value and head in names and not re.fullmatch(r"[\[(/] ?[^\d\s.+-][^,]*", value):
        missing = "colon" if sign == " " else "space behind the colon"
        return f" (a {missing} is missing: `{head}: {value.strip()}`)"
    guess = likely(name, names) or (head if head in names else "")
    return f" (did you mean {guess}?)" if guess else ""


def likely(name: str, names: Iterable[str]) -> str:
    """Return which of `names`, those allowed, an unknown name most likely means: a synonym, or one
    of like spelling; "" if there is none."""
    names, plain = list(names), name.lower().replace("_", " ")
    close = [word for word in names if word.lower() == name.lower()]
    close += [word for word in _WORDS.get(plain, "").split(", ") if word in names]
    close += difflib.get_close_matches(name, names, n=1)
    return close[0] if close else ""


_WORDS = {
    "max": "at_most, upper, largest", "maximum": "at_most, upper, largest",
    "peak": "largest", "min": "at_least, lower, smallest", "minimum": "at_least, lower, smallest",
    "least": "lower", "most": "upper", "density": "rho", "poisson": "nu", "modulus": "E",
    "young": "E", "angle": "opening, rest, level", "hinge": "revolute", "pin": "revolute",
    "rotary": "revolute", "linear": "prismatic", "slider": "prismatic", "slide": "prismatic",
    "ball": "spherical", "weld": "fixed", "rigid": "fixed", "cardan": "universal",
    "sleeve": "cylindrical", "nut": "screw", "spindle": "screw", "thread": "screw",
    "tape spring": "tabulated spring", "pipe": "tube", "round": "circle", "box": "rectangle",
    "lock": "latch", "damping": "damper", "k": "stiffness", "points": "through",
    "nodes": "elements", "mesh": "elements", "motions": "initial_velocities", "scan": "sobol",
    "monte carlo": "sobol", "lhs": "sobol", "latin hypercube": "sobol", "gltf": "glb",
    "paraview": "vtk", "mujoco": "mjcf", "png": "figures", "pdf": "figures", "grad": "deg",
    "sek": "s", "sekunden": "s", "tol": "relative", "tolerance": "capture_range, relative",
    "plusminus": "absolute", "time": "duration", "share": "tolerance", "runs": "max_runs",
    "minutes": "max_core_minutes", "rounds": "max_iterations", "finer": "discretization",
    "of": "tolerance_by_name", "nodes per job": "runs_per_job",
}  # fmt: skip
"""Words of other programs and of everyday, and those of this one for the same."""
