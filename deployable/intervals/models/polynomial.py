"""A polynomial of the design's order through the design's runs, on each part of the box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..designs import Design, SplitDesign, parts_of
from ..estimates import ErrorEstimate, decay_estimate, error_estimate, overruled
from ..points import match_points, other_runs
from ..ranges import Range, surrogate_range, union
from ..samples import Samples, read_samples
from ..surrogate import fit
from .model import Model

if TYPE_CHECKING:
    import xarray as xr


class PolynomialModel(Model):
    """Chebyshev polynomials, whose range is enclosed. The other runs test them.

    `tolerance` is the gap between outer and inner range at which subdivision stops, as a share of
    the width.
    """

    kind = "enclosed range of the polynomial"

    def __init__(
        self, samples: Samples, design: Design | SplitDesign, *, tolerance: float = 1e-3
    ) -> None:
        self.samples, self.tolerance = samples, tolerance
        self.tested = other_runs(samples.unit, design.points)
        self.parts = parts_of(design)
        self.surrogates = [
            fit(part.design, samples.values[match_points(part.points, samples.unit)])
            for part in self.parts
        ]
        self.attributes = {"design_runs": design.runs}

    def range(self) -> Range:
        ranges = []
        for part, surrogate in zip(self.parts, self.surrogates, strict=True):
            found = surrogate_range(surrogate, self.tolerance)
            argmin, argmax = part.to_global(found.argmin), part.to_global(found.argmax)
            ranges.append(replace(found, argmin=argmin, argmax=argmax))
        return union(ranges)

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        samples, (held_out, decay) = self.samples, np.zeros((2, *found.lower.shape))
        for part, surrogate in zip(self.parts, self.surrogates, strict=True):
            runs = self.tested[part.contains(samples.unit[self.tested])]
            unit = part.to_local(samples.unit[runs])
            missed = samples.values[runs] - surrogate.evaluate(unit)
            held_out = np.maximum(held_out, np.abs(missed).max(axis=0, initial=0.0))
            told = decay_estimate(surrogate, samples.time, window)
            at = part.design.points
            told = overruled(surrogate, at, unit, missed, told, samples.time, window)
            decay = np.maximum(decay, told)
        return error_estimate(samples.time, held_out, decay, window)

    def centre(self) -> np.ndarray | None:
        middle = np.zeros((1, self.samples.unit.shape[1]))
        for part, surrogate in zip(self.parts, self.surrogates, strict=True):
            if part.contains(middle)[0]:
                return surrogate.evaluate(part.to_local(middle))[0]
        return None


def surrogate_dataset(
    samples: xr.Dataset, design: Design | SplitDesign, responses: Sequence[str] | None = None
) -> xr.Dataset:
    """The Chebyshev coefficients of every response at every instant, for each part of the box.

    ``coefficient`` (response, part, term, time) in the response's units, ``multi_index`` (term,
    parameter), ``part_lower`` and ``part_upper`` (part, parameter) in unit coordinates; there is
    one part unless the design is split. A scan without order has no terms and no coefficients.
    """
    import xarray as xr

    data, parts = read_samples(samples, responses), parts_of(design)
    indices = parts[0].design.multi_indices  # all parts have the same
    variables: dict[str, tuple] = {
        "multi_index": (("term", "parameter"), indices, {"units": "1", "long_name": "degree"}),
    }
    for side in ("lower", "upper"):
        attributes = {"units": "1", "long_name": f"{side} unit coordinate"}
        ends = [getattr(part, side) for part in parts]
        variables[f"part_{side}"] = (("part", "parameter"), ends, attributes)
    if len(indices):
        # one response after the other: products of larger matrices round in another way
        fitted = [PolynomialModel(read_samples(samples, [name]), design) for name in data.names]
        values = [[surrogate.coefficients[:, 0] for surrogate in m.surrogates] for m in fitted]
        axes = ("response", "part", "term", "time")
        variables["coefficient"] = (axes, values, {"long_name": "Chebyshev coefficients"})
    return xr.Dataset(variables, coords=data.coordinates(), attrs=samples.attrs)
