"""Fields of elements: units, limits and words of each.

Checks, packing, descriptions of elements and the keys of a structure file follow from these
(kind.py). A field of a dataclass without a spec is left to its element type.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cache
from typing import Any

import numpy as np

from fpm.errors import SceneError

_KEY = "fpm"


@dataclass(frozen=True)
class FieldSpec:
    """Spec of a field of an element. same: whether it must be equal in scenes that run side by
    side. words: its name in messages, with {called} or {title} of the element (kind.py); text: its
    meaning, for the docs' table of keys; is_shown: whether descriptions say its value."""

    name: str = ""
    same: bool = False
    words: str = ""
    text: str = ""
    is_shown: bool = False


@dataclass(frozen=True)
class Number(FieldSpec):
    """Spec of `count` numbers in a unit; `least` (allowed) or `above` (not allowed) is their lower
    bound. finite: whether they must be; optional: whether None is allowed; zero: whether
    descriptions of elements say the value if it is 0."""

    unit: str = ""
    least: float | None = None
    above: float | None = None
    finite: bool = True
    optional: bool = False
    count: int = 1
    zero: bool = True

    def allows(self, value: float) -> bool:
        """Whether one number (in the field's unit) is allowed."""
        low = self.least is not None and not value >= self.least
        low = low or (self.above is not None and not value > self.above)
        return not low and not math.isnan(value) and (math.isfinite(value) or not self.finite)

    def allowed(self, unit: str) -> str:
        """Allowed values in words, for messages, as "a number >= 0 (m)"; unit: "" for none."""
        plural = f"{self.count} {'finite ' * self.finite}numbers"
        singular = f"a {'finite ' * self.finite}number"
        end = f" >= {self.least:g}" if self.least is not None else ""
        end = f" > {self.above:g}" if self.above is not None else end
        return f"{singular if self.count == 1 else plural}{end}{f' ({unit})' if unit else ''}"


@dataclass(frozen=True)
class Word(FieldSpec):
    """Spec of one of some words, and the number that represents each in kernels."""

    values: Mapping[Any, float] | None = None


@dataclass(frozen=True)
class Index(FieldSpec):
    """Spec of an index into a list of the scene, by the list's name; `least` -1: or none. types: of
    hinges."""

    of: str = ""
    least: int = 0
    types: tuple[str, ...] = ()


def _field(spec: FieldSpec, default: Any) -> Any:
    return field(default=default, metadata={_KEY: spec})


def number(
    unit: str = "", least=None, above=None, *, default=MISSING, is_shown=True, **keys
) -> Any:
    """Field of an element with a number, or several. unit: as "N m"; least, above: lower bound,
    allowed or not; default: MISSING where it must be given; is_shown, keys: as of `Number`."""
    keys |= {"is_shown": is_shown and keys.get("count", 1) == 1, "optional": default is None}
    return _field(Number(unit=unit, least=least, above=above, **keys), default)


def stiffness(unit: str = "N m/rad", words: str = "{called} stiffness", **keys) -> Any:
    """Field with a stiffness, at least 0. words: its name in messages; keys: of `number`."""
    return number(unit, 0.0, words=words, **keys)


def damping(**keys) -> Any:
    """Field of an element with a damping constant (N m s/rad), at least 0; keys: of `number`."""
    return number("N m s/rad", 0.0, zero=False, **keys)


def word(values: Mapping[Any, float], *, default=MISSING, **keys) -> Any:
    """Field of an element with one of some words. values: number that stands for each in kernels;
    default: MISSING where it must be given; keys: of `Word`."""
    return _field(Word(values=values, **keys), default)


def index(group: str, least: int = 0, *, default=MISSING, **keys) -> Any:
    """Field of an element with the index of something in the list `group` of the scene, at least
    `least` (-1: or none). default: MISSING where it must be given; keys: of `Index`."""
    return _field(Index(of=group, least=least, same=True, **keys), default)


def same(default: Any = MISSING) -> Any:
    """Field of an element with anything that must be equal in scenes that run side by side."""
    return _field(FieldSpec(same=True), default)


@cache
def specs(kind: type) -> dict[str, FieldSpec]:
    """Specs of the fields of an element type `kind`, by name of the field."""
    keyed = [f for f in fields(kind) if _KEY in f.metadata]
    return {f.name: replace(f.metadata[_KEY], name=f.name) for f in keyed}


def numbers_in(value: Any) -> Sequence[float]:
    """Numbers (k,) of a field's value: one number, or an array, flat."""
    return (value,) if isinstance(value, float | int) else np.ravel(value)


def check_number(subject: str, value: Any, number: Number, unit: str) -> None:
    """Check the value of a field; raises SceneError unless it is allowed. subject: the field's name
    in messages; number: its spec; unit: that of the message."""
    if value is None and number.optional:
        return
    numbers = numbers_in(value)
    if len(numbers) != number.count or not all(map(number.allows, numbers)):
        raise SceneError(subject, value, number.allowed(unit))
