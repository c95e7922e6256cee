"""What a verification problem works with: it runs scenes, notes what they cost, and keeps rows.

A problem is a function of a Bench. It builds small scenes through the public interface of ``fpm``,
runs them with ``bench.simulate`` and hands its findings to ``bench.check`` (a value against a
reference) and ``bench.curve`` (for the plots).
"""

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field

import numpy as np

import fpm


@dataclass(frozen=True)
class Row:
    """One line of the table.

    `error` is |value - reference| / scale and passes up to `tolerance`; `measure` says what the
    scale is ("relative": the reference; "absolute": 1 of the value's unit; or in words). A row with
    measure "at least" passes if the value is not below the reference. element_steps and cpu (s)
    are what the problem had cost when the row was written, since the row before.
    """

    problem: str
    name: str
    value: float
    reference: float
    tolerance: float
    error: float
    passed: bool
    measure: str
    source: str
    element_steps: int
    cpu: float

    def as_dict(self) -> dict:
        """The row for summary.json; numbers that are not finite become None."""
        return {
            key: None if isinstance(x, float) and not math.isfinite(x) else x
            for key, x in asdict(self).items()
        }


@dataclass(frozen=True)
class Curve:
    """A line of a plot: x (n,), y (n,), its label; reference curves are drawn dashed or dotted."""

    x: np.ndarray
    y: np.ndarray
    label: str
    reference: bool = False


@dataclass
class Figure:
    """A plot of one problem; axis labels carry the units."""

    title: str
    x_label: str
    y_label: str
    logarithmic: bool = False
    equal: bool = False
    curves: list[Curve] = field(default_factory=list)

    def curve(self, x, y, label: str, reference: bool = False) -> None:
        """Add a line; x, y (n,)."""
        self.curves.append(Curve(np.asarray(x, float), np.asarray(y, float), label, reference))


class Bench:
    """Runs the scenes of one problem and collects its rows and figures.

    quick: the problem may leave out its finest meshes and longest runs (the tests do).
    """

    def __init__(self, problem: str, quick: bool = False):
        self.problem, self.quick = problem, quick
        self.rows: list[Row] = []
        self.figures: list[Figure] = []
        self._element_steps = 0
        self._cpu = 0.0

    def simulate(self, scenes, **options) -> list[fpm.Outcome]:
        """``fpm.simulate``, with its cost noted; raises the failure of a run that broke down."""
        with self.timed():
            outcomes = fpm.simulate(scenes, **options)
        for outcome in outcomes:
            if outcome.failure is not None:
                raise outcome.failure
            self._element_steps += outcome.steps * max(1, len(outcome.scene.elements))
        return outcomes

    @contextmanager
    def timed(self) -> Iterator[None]:
        """Count the cpu time of the block as solver time."""
        start = time.process_time()
        yield
        self._cpu += time.process_time() - start

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
        """Write a row: `value` against `reference`, off by at most `tolerance` times `scale`.

        scale: None means the reference itself (measure "relative").
        """
        if scale is None:
            scale = abs(reference) if measure == "relative" else 1.0
        error = abs(float(value) - float(reference)) / scale
        self._add(name, value, reference, tolerance, error, error <= tolerance, measure, source)

    def check_small(self, name: str, value: float, tolerance: float, source: str, of: str) -> None:
        """Write a row for a value that should be zero; `of`: what it is a share of."""
        self.check(name, value, 0.0, tolerance, source, 1.0, f"share of {of}")

    def check_at_least(self, name: str, value: float, least: float, source: str) -> None:
        """Write a row for a value that must not be below `least`."""
        error = max(0.0, float(least) - float(value))
        self._add(name, value, least, 0.0, error, bool(value >= least), "at least", source)

    def broke(self, error: Exception) -> None:
        """Write a failing row for a run that broke down, which ends the problem."""
        self._add(f"broke down: {error}", math.nan, math.nan, 0.0, math.nan, False, "", "")

    def _add(self, name, value, reference, tolerance, error, passed, measure, source):
        # Not-a-number passes no comparison, so a broken value is a failing row.
        self.rows.append(
            Row(
                self.problem, f"{self.problem}: {name}", float(value), float(reference),
                float(tolerance), float(error), bool(passed), measure, source,
                self._element_steps, self._cpu,
            )
        )  # fmt: skip
        self._element_steps, self._cpu = 0, 0.0

    def figure(self, title: str, x_label: str, y_label: str, **options) -> Figure:
        """Start a plot of this problem."""
        self.figures.append(Figure(title, x_label, y_label, **options))
        return self.figures[-1]


def observed_orders(errors, factor: float = 2.0) -> np.ndarray:
    """Orders of convergence (n-1,) from errors (n,) of meshes refined by `factor` each time."""
    errors = np.asarray(errors, float)
    return np.log(errors[:-1] / errors[1:]) / np.log(factor)
