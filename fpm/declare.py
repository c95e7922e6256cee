"""What a value may be, declared once: unit, limits, words, default and meaning.

Fields of elements, keys of structure files and keys of configs are declared by these classes. What
checks values, packs them for kernels, describes and refuses them, and the tables and JSON Schemas
of keys follow from the declaration. A field of a dataclass without one is left to its class."""

import re
from collections.abc import Callable, Container, Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cache
from math import inf
from typing import Any, ClassVar

import numpy as np

from fpm.errors import SceneError, did_you_mean

NO_VALUE = object()
"""Default of a key that must be given."""

SLIDE_UNITS = {
    "rad": "m", "rad/s": "m/s", "rad s-1": "m s-1", "N m": "N", "N m s": "N s",
    "N m/rad": "N/m", "N m s/rad": "N s/m", "kg m2": "kg",
}  # fmt: skip
"""Units of what acts on hinges, and those of the same on slides."""

_KEY = "fpm"


@dataclass(frozen=True, kw_only=True)
class NumberLimits:
    """What a number may be. unit: as "N m", "" or "1" for none; least, most: bounds, themselves
    allowed; above: one that is not; is_whole: whether it has no fraction."""

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


@dataclass(frozen=True)
class Key:
    """What a field of an element, or a key of a file, may be (base class). default: its value when
    it is left out, NO_VALUE if it must not be; text: its meaning, for docs; name: of the field;
    words: what messages call it, {noun} being the element type's word and {title} the element, "":
    its name; is_topology: whether it must be equal in scenes simulated side by side; is_shown:
    whether descriptions of a structure say its value."""

    default: Any = NO_VALUE
    text: str = ""
    name: str = field(default="", kw_only=True)
    words: str = field(default="", kw_only=True)
    is_topology: bool = field(default=False, kw_only=True)
    is_shown: bool = field(default=False, kw_only=True)
    schema: ClassVar[Any] = {}  # what JSON Schema says of the key's values in a file

    @property
    def allowed(self) -> str:
        """Values that the key may have, in words, for messages and documentation."""
        raise NotImplementedError

    def for_slides(self, joints: Container[str]) -> "Key":
        """Return this key as an entry about slides takes it, with m for rad; by default unchanged.
        joints: keys of the entry, such as "joint", that name slides."""
        return self

    def read(self, node: Any, place: Any) -> Callable[[Any], Any]:
        """Read this key's value (a Node) in a structure file, once; return a function of a sample's
        Builder, which returns the value (SI units) or raises SceneError. What is wrong with the
        text is noted in place.problems, and SkippedError raised. place: where it stands (Place)."""
        raise NotImplementedError


@dataclass(frozen=True)
class Number(Key, NumberLimits):
    """A number, or `count` of them, with limits. finite: whether infinity is refused; optional:
    whether None is allowed; zero: whether descriptions say a 0; joint: key of the entry that names
    its joint: on a slide the unit is that of SLIDE_UNITS."""

    finite: bool = field(default=True, kw_only=True)
    optional: bool = field(default=False, kw_only=True)
    count: int = field(default=1, kw_only=True)
    zero: bool = field(default=True, kw_only=True)
    joint: str = field(default="joint", kw_only=True)
    schema: ClassVar[Any] = {"type": ["number", "string"]}

    def allows(self, value: float) -> bool:
        return (not self.finite or -inf < value < inf) and super().allows(value)

    def fits(self, value: Any) -> bool:
        """Return whether a field's value is as many numbers as it has, all within the limits."""
        if value is None:
            return self.optional
        numbers = numbers_in(value)
        return len(numbers) == self.count and all(map(self.allows, numbers))

    @property
    def allowed(self) -> str:
        if self.is_whole:
            return f"{self.describe()}, of parameters with `whole: true`"
        noun = {"": "a number", "rad": "an angle"}.get(self.unit, f"a value in {self.unit}")
        return self.describe(noun)

    def for_slides(self, joints):
        of_slide = SLIDE_UNITS.get(self.unit, self.unit)
        return replace(self, unit=of_slide) if self.joint in joints else self

    def read(self, node, place):
        if self.is_whole:
            bound = place.whole(node, self.allowed)
        else:
            bound = place.number(node, self.unit, self.allowed)

        def value(build: Any) -> float:
            number = build.number(bound, place.key)
            if not self.allows(number):
                raise SceneError(place.key, number, self.allowed)
            return round(number) if self.is_whole else number

        return value


@dataclass(frozen=True)
class Word(Key):
    """One of some words, as "above". values: allowed ones, a tuple; of an element's field each with
    the number that stands for it in kernels' arrays."""

    values: Any = ()

    @property
    def allowed(self) -> str:
        return ", ".join(self.values)

    @property
    def schema(self) -> dict[str, Any]:  # type: ignore[override]
        return {"enum": [x == "true" if x in ("true", "false") else x for x in self.values]}

    def read(self, node, place):
        if node.text not in self.values:
            place.refuse(node, self.allowed + did_you_mean(node.text, self.values))
        return lambda build: node.text


@dataclass(frozen=True)
class Index(Key):
    """An index into a list of the scene, in files a name. group: the list, as "hinges"; least: -1
    where that is allowed and means none; types: of hinges, allowed types, (): all; only_angles:
    whether none whose opening is a length."""

    group: str = ""
    least: int = 0
    types: tuple[str, ...] = ()
    only_angles: bool = False


def _text(limit: float) -> str:
    """Write a limit as people do: 1e-9, 0.0001, 1000000."""
    return str(limit) if isinstance(limit, int) else re.sub(r"e\+?(-?)0*", r"e\1", f"{limit:g}")


# -- fields of elements ----------------------------------------------------------------------------


def _field(kind: type[Any], default: Any, **keys: Any) -> Any:
    """Declare a dataclass field with a default of its own; in files, infinity and the index -1 are
    what nobody writes: the key is left out."""
    in_files = {MISSING: NO_VALUE, inf: None, -1: None}.get(default, default)
    return field(default=default, metadata={_KEY: kind(in_files, **keys)})


def number(
    unit: str = "", least=-inf, above=-inf, *, default=MISSING, is_shown=True, **keys
) -> Any:
    """Declare a dataclass field that holds one or more numbers. least, above: lower bound, itself
    allowed or not; default: MISSING where a value must be given; is_shown: whether descriptions say
    it (a single number); keys: more attributes of its `Number`."""
    keys["is_shown"] = is_shown and keys.get("count", 1) == 1
    keys.setdefault("optional", default is None)
    return _field(Number, default, unit=unit, least=least, above=above, **keys)


def stiffness(unit: str = "N m/rad", words: str = "{noun} stiffness", **keys) -> Any:
    """Declare a dataclass field for a stiffness, at least 0. keys: as of `number`."""
    return number(unit, 0.0, words=words, **keys)


def damping(**keys) -> Any:
    """Declare a dataclass field of an element that holds a damping constant (N m s/rad), at least
    0. keys: further arguments of `number` (default, text, ...)."""
    return number("N m s/rad", 0.0, zero=False, **keys)


def word(values: Mapping[Any, float], *, default=MISSING, **keys) -> Any:
    """Declare a dataclass field of an element that takes one of some words. values: allowed words,
    each with the number that stands for it in kernels; default: MISSING where one must be given;
    keys: further attributes of its `Word` (is_topology, words, text)."""
    return _field(Word, default, values=values, **keys)


def index(group: str, least: int = 0, *, default=MISSING, **keys) -> Any:
    """Declare a dataclass field that holds an index into the list `group` of the scene. least,
    default: -1 where none is allowed; keys: further ones of its `Index` (types, words, text)."""
    return _field(Index, default, group=group, least=least, is_topology=True, **keys)


def topology(default: Any = MISSING) -> Any:
    """Declare a dataclass field of an element, of any type, whose value must be equal in scenes
    simulated side by side. default: MISSING where a value must be given."""
    return _field(Key, default, is_topology=True)


def plain_field() -> Any:
    """Declare a dataclass field of an element whose value must be given, after others that have a
    declaration: to type checkers these look as if they had a default."""
    return field()


def _specs(kind: Any) -> dict[str, Any]:
    """Return the declarations (Key: unit, limits, words) of the fields of a dataclass `kind`, by
    field name, for checks and packing; fields without one are left out."""
    key_fields = [f for f in fields(kind) if _KEY in f.metadata]
    return {f.name: replace(f.metadata[_KEY], name=f.name) for f in key_fields}


specs: Callable[[Any], dict[str, Any]] = cache(_specs)


def numbers_in(value: Any) -> Any:
    """Return the numbers (k,) of a field's value: one as a tuple of it, arrays flattened."""
    return (value,) if isinstance(value, float | int) else np.ravel(value)
