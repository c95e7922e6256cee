"""Limits of a number: what states one checks by them, and says them in words."""

import re
from dataclasses import dataclass
from math import inf
from typing import Any

from fpm.errors import SceneError


@dataclass(frozen=True, kw_only=True)
class NumberLimits:
    """What a number may be. unit: as "N m", "" for none; least, most: bounds that are allowed
    themselves; above: one that is not; is_whole: whether it has no fraction."""

    unit: str = ""
    least: float = -inf
    above: float = -inf
    most: float = inf
    is_whole: bool = False

    def allows(self, value: float) -> bool:
        """Return whether a number, `value`, is within the limits; NaN is not."""
        is_within = self.least <= value <= self.most and (value > self.above or self.above == -inf)
        return is_within and (not self.is_whole or value == round(value))

    def describe(self, noun: str = "", unit: str = "") -> str:
        """Return in words what is allowed: "a number above 0 (m)". noun: for "a number", "": that;
        unit: "" or "1" for none."""
        words = noun or ("a whole number" if self.is_whole else "a number")
        least, most, has_end = _text(self.least), _text(self.most), self.most < inf
        if self.above > -inf:
            words += f" above {_text(self.above)}" + f", up to {most}" * has_end
        elif self.least > -inf:
            words += f" from {least} to {most}" if has_end else f" of at least {least}"
        elif has_end:
            words += f" of at most {most}"
        return words + f" ({unit})" * (unit not in ("", "1"))

    def check(self, key: str, value: Any, noun: str = "") -> float:
        """Return a finite number within the limits, an int if whole; SceneError if `value` is none.
        key, noun: what messages call it, as in `describe`."""
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not (is_number and -inf < value < inf and self.allows(value)):
            raise SceneError(key, value, self.describe(noun, self.unit))
        return int(value) if self.is_whole else float(value)


def _text(limit: float) -> str:
    """A limit as people write it: 1e-9, 0.0001, 1000000."""
    return str(limit) if isinstance(limit, int) else re.sub(r"e\+?(-?)0*", r"e\1", f"{limit:g}")
