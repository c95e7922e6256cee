"""A polynomial of the design's order through the design's runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..designs import Design
from ..estimates import ErrorEstimate, decay_estimate, error_estimate, overruled
from ..points import match_points, other_runs
from ..ranges import Range, surrogate_range
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

    def __init__(self, samples: Samples, design: Design, *, tolerance: float = 1e-3) -> None:
        self.samples, self.tolerance = samples, tolerance
        self.tested = other_runs(samples.unit, design.points)
        self.design = design
        self.surrogate = fit(design, samples.values[match_points(design.points, samples.unit)])
        self.attributes = {"design_runs": design.runs}

    def range(self) -> Range:
        return surrogate_range(self.surrogate, self.tolerance)

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        samples, surrogate = self.samples, self.surrogate
        unit = samples.unit[self.tested]
        missed = samples.values[self.tested] - surrogate.evaluate(unit)
        held_out = np.abs(missed).max(axis=0, initial=0.0)
        told = decay_estimate(surrogate, samples.time, window)
        at = self.design.points
        decay = overruled(surrogate, at, unit, missed, told, samples.time, window)
        return error_estimate(samples.time, held_out, decay, window)

    def centre(self) -> np.ndarray | None:
        return self.surrogate.evaluate(np.zeros((1, self.samples.unit.shape[1])))[0]


def surrogate_dataset(
    samples: xr.Dataset, design: Design, responses: Sequence[str] | None = None
) -> xr.Dataset:
    """The Chebyshev coefficients of every response at every instant.

    ``coefficient`` (response, term, time) in the response's units, ``multi_index`` (term,
    parameter). A scan without order has no terms and no coefficients.
    """
    import xarray as xr

    data, indices = read_samples(samples, responses), design.multi_indices
    variables: dict[str, tuple] = {
        "multi_index": (("term", "parameter"), indices, {"units": "1", "long_name": "degree"}),
    }
    if len(indices):
        # one response after the other: products of larger matrices round in another way
        fitted = [PolynomialModel(read_samples(samples, [name]), design) for name in data.names]
        values = [model.surrogate.coefficients[:, 0] for model in fitted]
        axes = ("response", "term", "time")
        variables["coefficient"] = (axes, values, {"long_name": "Chebyshev coefficients"})
    return xr.Dataset(variables, coords=data.coordinates(), attrs=samples.attrs)
