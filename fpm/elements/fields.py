"""Fields of elements: units, limits and words of each.

Checks, packing, descriptions of elements and the keys of a structure file follow from these
(kind.py). A field of a dataclass without a spec is left to its element type."""

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
    """What is stated of a dataclass field of an element. name: the field's; same: whether it must
    be equal in scenes that run side by side; words: its name in messages, {called} or {title} the
    element; text: its meaning, for docs; is_shown: whether descriptions say its value."""

    name: str = ""
    same: bool = False
    words: str = ""
    text: str = ""
    is_shown: bool = False


@dataclass(frozen=True)
class Number(FieldSpec):
    """Spec of a field of one or more numbers. unit: as "N m"; least, above: lower bound, itself
    allowed or not; finite: whether infinity is refused; optional: whether None is allowed; count:
    how many numbers; zero: whether descriptions of elements say the value if it is 0."""

    unit: str = ""
    least: float | None = None
    above: float | None = None
    finite: bool = True
    optional: bool = False
    count: int = 1
    zero: bool = True

    def allows(self, value: float) -> bool:
        """Whether one number, in the field's unit, is within the bounds, and finite if asked."""
        low = self.least is not None and not value >= self.least
        low = low or (self.above is not None and not value > self.above)
        return not low and not math.isnan(value) and (math.isfinite(value) or not self.finite)

    def allowed(self, unit: str) -> str:
        """Allowed values in words for a message, as "a finite number >= 0 (m)". unit: to say, or
        ""."""
        plural = f"{self.count} {'finite ' * self.finite}numbers"
        singular = f"a {'finite ' * self.finite}number"
        end = f" >= {self.least:g}" if self.least is not None else ""
        end = f" > {self.above:g}" if self.above is not None else end
        return f"{singular if self.count == 1 else plural}{end}{f' ({unit})' if unit else ''}"


@dataclass(frozen=True)
class Word(FieldSpec):
    """Spec of a field that takes one of some words. values: the number of each in kernels."""

    values: Mapping[Any, float] | None = None


@dataclass(frozen=True)
class Index(FieldSpec):
    """Spec of a field with an index into a list of the scene. of: the list's attribute, as
    "hinges"; least: -1 where that means none, else 0; types: allowed types of a hinge, (): all."""

    of: str = ""
    least: int = 0
    types: tuple[str, ...] = ()


def _field(spec: FieldSpec, default: Any) -> Any:
    return field(default=default, metadata={_KEY: spec})


def number(
    unit: str = "", least=None, above=None, *, default=MISSING, is_shown=True, **keys
) -> Any:
    """Field of an element with one or more numbers. unit: as "N m"; least, above: lower bound,
    itself allowed or not; default: MISSING where it must be given; is_shown: whether descriptions
    say its value; keys: further fields of `Number` (count, finite, words, text, ...)."""
    keys |= {"is_shown": is_shown and keys.get("count", 1) == 1, "optional": default is None}
    return _field(Number(unit=unit, least=least, above=above, **keys), default)


def stiffness(unit: str = "N m/rad", words: str = "{called} stiffness", **keys) -> Any:
    """Dataclass field of an element with a stiffness, at least 0, in `unit`. words: its name in
    messages, {called} being the element's word; keys: further arguments of `number`."""
    return number(unit, 0.0, words=words, **keys)


def damping(**keys) -> Any:
    """Field of an element with a damping constant (N m s/rad), at least 0; keys: as in `number`."""
    return number("N m s/rad", 0.0, zero=False, **keys)


def word(values: Mapping[Any, float], *, default=MISSING, **keys) -> Any:
    """Field of an element that takes one of some words. values: the number by which kernels know
    each; default: MISSING where it must be given; keys: fields of `Word` (same, words, text)."""
    return _field(Word(values=values, **keys), default)


def index(group: str, least: int = 0, *, default=MISSING, **keys) -> Any:
    """Field of an element with the index of an entry in the scene's list `group`, as "hinges".
    least: -1 where that means none; default: MISSING where it must be given; keys: of `Index`."""
    return _field(Index(of=group, least=least, same=True, **keys), default)


def same(default: Any = MISSING) -> Any:
    """Dataclass field of an element, of any type, whose value must be equal in scenes that run side
    by side; default: MISSING where it must be given."""
    return _field(FieldSpec(same=True), default)


@cache
def specs(kind: type) -> dict[str, FieldSpec]:
    """Specs (Number, Word, Index) of the fields of an element type `kind`, by name."""
    keyed = [f for f in fields(kind) if _KEY in f.metadata]
    return {f.name: replace(f.metadata[_KEY], name=f.name) for f in keyed}


def numbers_in(value: Any) -> Sequence[float]:
    """Numbers (k,) of a field's value for kernels: of one number itself, of an array all, flat."""
    return (value,) if isinstance(value, float | int) else np.ravel(value)


def check_number(subject: str, value: Any, number: Number, unit: str) -> None:
    """Check the value of a field of numbers; raises SceneError unless it is allowed. subject: what
    it is called in messages; number: the field's spec; unit: said in the message."""
    if value is None and number.optional:
        return
    numbers = numbers_in(value)
    if len(numbers) != number.count or not all(map(number.allows, numbers)):
        raise SceneError(subject, value, number.allowed(unit))
