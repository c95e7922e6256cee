"""What a verification problem works with: it runs scenes, notes what they cost, and keeps rows.

A problem is a function of a Bench. It builds small scenes through the public interface of ``fpm``,
runs them with ``bench.simulate`` and hands its findings to ``bench.check``: a value against a
reference."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

import fpm
from evidence.rows import Row, at_least, close_to


class Bench:
    """Runs the scenes of one problem and collects its rows, and what they cost.

    quick: the problem may leave out its finest meshes and longest runs (the tests do).
    element_steps; cpu (s): of all runs so far."""

    def __init__(self, problem: str, quick: bool = False):
        self.problem, self.quick = problem, quick
        self.rows: list[Row] = []
        self.element_steps = 0
        self.cpu = 0.0

    def simulate(self, scenes, **options) -> list[fpm.Outcome]:
        """``fpm.simulate``, with its cost noted; raises the failure of a run that broke down."""
        with self.time_solver():
            outcomes = fpm.simulate(scenes, **options)
        for outcome in outcomes:
            if outcome.failure is not None:
                raise outcome.failure
            self.element_steps += outcome.steps * max(1, len(outcome.scene.elements))
        return outcomes

    @contextmanager
    def time_solver(self) -> Iterator[None]:
        """Count the cpu time of the block as solver time."""
        start = time.process_time()
        yield
        self.cpu += time.process_time() - start

    def check(
        self,
        name: str,
        value: float,
        reference: float,
        tolerance: float,
        source: str,
        scale: float | None = None,
        measure: str = "relative",
    ) -> None:
        """Write a row: `value` against `reference`; error allowed: `tolerance` times `scale`.

        scale: None means the reference itself (measure "relative"), or else 1 of the value's unit;
        measure says what the scale is."""
        if scale is None:
            scale = abs(reference) if measure == "relative" else 1.0
        note = "" if measure == "absolute" else f"tolerance {tolerance:g}, {measure}"
        self._add(close_to(name, value, reference, tolerance * scale, source, note))

    def check_small(
        self, name: str, value: float, tolerance: float, source: str, whole: str
    ) -> None:
        """Write a row for a value that should be zero; `whole`: what it is a share of."""
        self._add(close_to(name, value, 0.0, tolerance, source, f"share of {whole}"))

    def check_at_least(self, name: str, value: float, least: float, source: str) -> None:
        """Write a row for a value that must not be below `least`."""
        self._add(at_least(name, value, least, source))

    def add_failure(self, error: Exception) -> None:
        """Write a failing row for a run that broke down, which ends the problem."""
        self._add(Row(f"broke down: {error}", None, passed=False))

    def _add(self, row: Row) -> None:
        self.rows.append(replace(row, name=f"{self.problem}: {row.name}", group=self.problem))


def observed_orders(errors, factor: float = 2.0) -> np.ndarray:
    """Orders of convergence (n-1,) from errors (n,) of meshes refined by `factor` each time."""
    errors = np.asarray(errors, float)
    return np.log(errors[:-1] / errors[1:]) / np.log(factor)
