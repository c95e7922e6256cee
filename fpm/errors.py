"""Errors of the mechanics. Each one says what was found, what is allowed and what to change."""

from math import isfinite


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
    most strain energy, or the first non-finite one), `step` (s) used, `limit` (s) the stable step
    of the scene at its start, `balance` (J) the energy that came from nowhere, `scale` (J), `bend`
    the largest sine between an element's chord and its ends, `strain` the largest at the surface of
    an element, `gap` the largest of a hinge (m) and of its axes (rad): None unless it is the cause.
    """

    def __init__(
        self, time, element, step, limit, balance, scale, bend=None, strain=None, gap=None
    ):
        self.time, self.element, self.step, self.limit = time, element, step, limit
        self.balance, self.scale, self.bend, self.strain, self.gap = (
            balance,
            scale,
            bend,
            strain,
            gap,
        )
        found = (
            f"the energy balance is off by {balance:.3g} J of {scale:.3g} J"
            if isfinite(balance)
            else "numbers are no longer finite"
        )
        if step > limit:
            remedy = f"use a step below {limit:.4g} s (solver.step: auto takes one)"
        elif gap is not None and isfinite(balance):
            found = f"a hinge gapes by {gap[0]:.2g} m and {gap[1]:.2g} rad"
            remedy = "halve solver.step: the particles of the hinge turn too far in a step"
        elif bend is not None:
            found = f"an element is bent or twisted by {bend:.2g} rad, too much for linear theory"
            remedy = "refine the mesh: the bend and twist of an element fall with its length"
        elif strain is not None:
            found = f"the surface of an element is strained by {strain:.2g}, which no beam bears"
            remedy = (
                "no mesh or step helps where links are bent to a radius below their own height or "
                "stretched by half: stiffen their material, or soften what bends them"
            )
        else:
            remedy = (
                "the step is below the limit of the undeformed scene, so the motion itself is "
                "too violent for it: halve solver.step, refine the mesh, or soften the contact"
            )
        super().__init__(
            f"unstable at t = {time:.6g} s: {found}, worst in element {element}; "
            f"step {step:.4g} s, stable limit {limit:.4g} s; {remedy}"
        )

    def __reduce__(self):
        return type(self), (
            self.time, self.element, self.step, self.limit, self.balance, self.scale,
            self.bend, self.strain, self.gap,
        )  # fmt: skip
