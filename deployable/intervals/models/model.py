"""What `bounds_dataset` asks of a model."""

from __future__ import annotations

import numpy as np

from ..designs import Design
from ..estimates import ErrorEstimate
from ..ranges import Range
from ..samples import Samples


class Model:
    """A model of n responses over the box, at T instants, for k parameters.

    A new model is a file with a subclass and a line in `models.MODELS`. Its constructor fits it;
    further keyword-only arguments of that are the options that a user has.

    Attributes
    ----------
    kind
        What its bounds are; "enclosed ..." or "attained ..." where they are a model's range.
    tested
        Indices of the runs that were not fitted, and test it.
    attributes
        What else a bounds dataset tells of it.
    """

    kind: str
    tested: np.ndarray = np.zeros(0, dtype=int)
    attributes: dict

    def __init__(self, samples: Samples, design: Design | None) -> None:
        raise NotImplementedError

    def range(self) -> Range:
        """Its range (n, T) over the box, arguments (n, T, k) in unit coordinates."""
        raise NotImplementedError

    def error(self, found: Range, window: float | None) -> ErrorEstimate:
        """Estimated error (n, T) of the bounds that `range` found; `window` as in `widen`."""
        raise NotImplementedError

    def centre(self) -> np.ndarray | None:
        """Its values (n, T) at the centre of the box, if it has any there."""
        return None

    def variables(self) -> dict:
        """Further variables of a bounds dataset, by name."""
        return {}
