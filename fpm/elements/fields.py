"""Fields of elements: units, limits and words of each.

Checks, packing, descriptions of elements and the keys of a structure file follow from these
(kind.py). A field of a dataclass without a spec is left to its element type."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cache
from math import inf
from typing import Any

import numpy as np

from fpm.arithmetic.limits import NumberLimits
from fpm.errors import SceneError

_KEY = "fpm"


@dataclass(frozen=True)
class FieldSpec:
    """What is stated of one dataclass field of an element type. name: of the field; is_topology:
    whether its value must be equal in scenes simulated side by side; words: its name in messages,
    {noun} being the type's word and {title} the element; "": the field's name; text: its meaning,
    for docs; is_shown: whether descriptions of a structure say its value."""

    name: str = ""
    is_topology: bool = False
    words: str = ""
    text: str = ""
    is_shown: bool = False


@dataclass(frozen=True)
class Number(FieldSpec, NumberLimits):
    """Spec of a field of one or more numbers, with their limits. finite: whether infinity is
    refused; optional: whether None is allowed; count: how many numbers; zero: whether descriptions
    say a 0."""

    finite: bool = True
    optional: bool = False
    count: int = 1
    zero: bool = True

    def allows(self, value: float) -> bool:
        """Return whether a `value` is within the field's limits, and finite if it must be."""
        return super().allows(value) and (math.isfinite(value) or not self.finite)

    def allowed(self, unit: str) -> str:
        """Return in words what is allowed: "a finite number above 0 (m)". unit: "" for none."""
        noun = f"{'finite ' * self.finite}number"
        return self.describe(f"a {noun}" if self.count == 1 else f"{self.count} {noun}s", unit)


@dataclass(frozen=True)
class Word(FieldSpec):
    """Spec of a field that takes one of some words (or False, True), as "above". values: allowed
    values, each with the number that stands for it in kernels' arrays."""

    values: Mapping[Any, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Index(FieldSpec):
    """Spec of a field that holds an index into a list of the scene. group: name of the list, as
    "hinges"; least: -1 where that is allowed and means none, else 0; types: if the list is of
    hinges, which of them the field may refer to ("revolute", ...), empty: all; only_angles: whether
    none whose opening is a length."""

    group: str = ""
    least: int = 0
    types: tuple[str, ...] = ()
    only_angles: bool = False


def _field(spec: FieldSpec, default: Any) -> Any:
    return field(default=default, metadata={_KEY: spec})


def number(
    unit: str = "", least=-inf, above=-inf, *, default=MISSING, is_shown=True, **keys
) -> Any:
    """Declare a dataclass field of an element that holds one or more numbers. unit: as "N m";
    least, above: lower bound, itself allowed (least) or not (above); default: MISSING where a value
    must be given; is_shown: whether descriptions of elements say it (a single number); keys: more
    of its spec `Number` (count, finite, zero, is_topology, words, text)."""
    keys["is_shown"] = is_shown and keys.get("count", 1) == 1
    keys.setdefault("optional", default is None)
    return _field(Number(unit=unit, least=least, above=above, **keys), default)


def stiffness(unit: str = "N m/rad", words: str = "{noun} stiffness", **keys) -> Any:
    """Declare a dataclass field of an element that holds a stiffness, at least 0. unit: as "N/m";
    words: name in messages, {noun} being the type's word; keys: further arguments of `number`."""
    return number(unit, 0.0, words=words, **keys)


def damping(**keys) -> Any:
    """Declare a dataclass field of an element that holds a damping constant (N m s/rad), at least
    0. keys: further arguments of `number` (default, text, ...)."""
    return number("N m s/rad", 0.0, zero=False, **keys)


def word(values: Mapping[Any, float], *, default=MISSING, **keys) -> Any:
    """Declare a dataclass field of an element that takes one of some words. values: allowed words,
    each with the number that stands for it in kernels; default: MISSING where one must be given;
    keys: further attributes of its spec `Word` (is_topology, words, text)."""
    return _field(Word(values=values, **keys), default)


def index(group: str, least: int = 0, *, default=MISSING, **keys) -> Any:
    """Declare a dataclass field of an element that holds an index into a list of the scene. group:
    name of the list, as "hinges"; least: -1 where that is allowed and means none, else 0; default:
    MISSING where one must be given; keys: further ones of its spec `Index` (types, words, text)."""
    return _field(Index(group=group, least=least, is_topology=True, **keys), default)


def topology(default: Any = MISSING) -> Any:
    """Declare a dataclass field of an element, of any type, whose value must be equal in scenes
    simulated side by side. default: MISSING where a value must be given."""
    return _field(FieldSpec(is_topology=True), default)


def plain_field() -> Any:
    """Declare a dataclass field of an element whose value must be given, after others that have a
    spec: to type checkers these look as if they had a default."""
    return field()


def specs(kind: Any) -> dict[str, Any]:
    """Return the specs (FieldSpec: unit, limits, words) of the fields of an element type `kind`, by
    field name, for checks and packing; fields declared without one are left out."""
    return _specs(kind)


@cache
def _specs(kind: type) -> dict[str, Any]:
    key_fields = [f for f in fields(kind) if _KEY in f.metadata]
    return {f.name: replace(f.metadata[_KEY], name=f.name) for f in key_fields}


def numbers_in(value: Any) -> Sequence[float] | np.ndarray:
    """Return the numbers (k,) of a field's value, as kernels and checks take them: one number as a
    tuple of it, an array or nested tuple flattened."""
    return (value,) if isinstance(value, float | int) else np.ravel(value)


def check_number(subject: str, value: Any, number: Number, unit: str) -> None:
    """Check the value of an element's field of numbers; raises SceneError unless it is allowed.
    subject: what messages call the field; value: number, or array of number.count; number: the
    field's spec; unit: unit that the message says."""
    if value is None and number.optional:
        return
    numbers = numbers_in(value)
    if len(numbers) != number.count or not all(map(number.allows, numbers)):
        raise SceneError(subject, value, number.allowed(unit))
