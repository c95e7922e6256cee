"""Runs that may be refused: at the default step, then as the message says, until one goes through;
and scenes that must be refused."""

from collections.abc import Callable, Iterable

import fpm
from evidence.rows import Row, refusal


def attempt(
    rows: list[Row], name: str, scene: fpm.Scene, duration: float,
    steps: Iterable[tuple[str, float]], **options,
) -> tuple[str, fpm.Outcome | None]:  # fmt: skip
    """Run a scene with each of some steps (what it adds to the name, s) until one is not refused;
    the first refusal is a row. Returns the name with what helped, and the outcome or None."""
    is_refused = False
    for label, step in steps:
        (outcome,) = fpm.simulate(scene, duration=duration, step=step, **options)
        if outcome.failure is None:
            return name + label.format(steps=outcome.steps) * is_refused, outcome
        if not is_refused:
            rows.append(refusal(name, outcome.failure))
        is_refused = True
    return name, None


def must_refuse(name: str, build: Callable[[], object]) -> Row:
    """The row of what must be refused when a scene is built."""
    try:
        build()
    except fpm.SceneError as error:
        return refusal(name, error)
    return Row(name, "built", passed=False, source="fpm.SceneError")
