"""Units as they are written behind a number, and the dimensions that they stand for.

All is computed in SI units. Angles count as numbers (rad = 1), so that N m/rad and N m agree."""

import math
import re
from typing import NamedTuple

from fpm.errors import did_you_mean


class Dimension(NamedTuple):
    """Physical dimension of a quantity, as powers. mass: of kg; length: of m; time: of s; bare:
    whether it is of a plain number without unit, which fits any dimension and is in SI units;
    vector: whether of three such quantities, along x, y and z."""

    mass: float = 0
    length: float = 0
    time: float = 0
    bare: bool = False
    vector: bool = False

    @property
    def powers(self) -> tuple[float, float, float]:
        """Return the powers of kg, m and s, to compare dimensions regardless of `bare`."""
        return self[:3]

    def fits(self, dimension: "Dimension") -> bool:
        """Return whether a value of this dimension may stand where `dimension` is required: powers
        are equal, or this is a number without unit; and both are of vectors or of numbers."""
        is_one = self.vector == dimension.vector
        return is_one and (self.bare or self.powers == dimension.powers)

    def __str__(self) -> str:
        if self.vector:
            unit_text = str(self._replace(vector=False))
            return f"a vector in {unit_text}" if any(self.powers) else "a vector without unit"
        symbol = next((n for n, u in _UNITS.items() if u[2] == self.powers and u[0] == u[1]), None)
        symbol = "N m" if symbol == "J" else symbol  # of springs and torques
        if not any(self.powers):
            return "a number without unit" if self.bare else "a number or an angle"
        parts = [
            name if power == 1 else f"{name}{power:g}"
            for name, power in zip(("kg", "m", "s"), self.powers, strict=True)
            if power
        ]
        return symbol or " ".join(parts)


NUMBER = Dimension()
BARE = Dimension(bare=True)


def power(dimension: Dimension, exponent: float) -> Dimension:
    """Return the dimension of a quantity of a given dimension raised to `exponent`, a number."""
    kg, m, s = dimension.powers
    return Dimension(exponent * kg, exponent * m, exponent * s, dimension.bare)


def product(first: Dimension, second: Dimension, sign: int = 1) -> Dimension:
    """Return the dimension of the product of two quantities (sign 1), or of their quotient (-1)."""
    kg, m, s = (p + sign * q for p, q in zip(first.powers, second.powers, strict=True))
    return Dimension(kg, m, s, first.bare and second.bare, first.vector or second.vector)


class Unit(NamedTuple):
    """Unit of measure: value * numerator / denominator is in SI units. dimension: its physical
    dimension; udunits: its spelling in netCDF files."""

    numerator: float
    denominator: float
    dimension: Dimension
    udunits: str

    def si(self, value: float) -> float:
        """Return a value, given in this unit, in SI units."""
        return value * self.numerator / self.denominator

    def fits(self, target: "Unit") -> bool:
        """Return whether a number in this unit may stand for one in another: of the same dimension,
        no angle for a plain number, no frequency for an angular one."""
        first, second = (bool(re.search("rad|deg|rpm", x.udunits)) for x in (self, target))
        is_free = any(target.dimension.powers) and "Hz" not in self.udunits + target.udunits
        is_same = self.dimension.powers == target.dimension.powers
        return is_same and (first == second or is_free)


_UNITS = {  # name: numerator, denominator, powers of kg, m, s
    "m": (1, 1, (0, 1, 0)),
    "mm": (1, 1000, (0, 1, 0)),
    "cm": (1, 100, (0, 1, 0)),
    "um": (1, 10**6, (0, 1, 0)),
    "km": (1000, 1, (0, 1, 0)),
    "kg": (1, 1, (1, 0, 0)),
    "s": (1, 1, (0, 0, 1)),
    "ms": (1, 1000, (0, 0, 1)),
    "us": (1, 10**6, (0, 0, 1)),
    "N": (1, 1, (1, 1, -2)),
    "kN": (1000, 1, (1, 1, -2)),
    "MN": (10**6, 1, (1, 1, -2)),
    "Pa": (1, 1, (1, -1, -2)),
    "kPa": (1000, 1, (1, -1, -2)),
    "MPa": (10**6, 1, (1, -1, -2)),
    "GPa": (10**9, 1, (1, -1, -2)),
    "J": (1, 1, (1, 2, -2)),
    "rad": (1, 1, (0, 0, 0)),
    "mrad": (1, 1000, (0, 0, 0)),
    "deg": (math.pi / 180, 1, (0, 0, 0)),
    "Hz": (1, 1, (0, 0, -1)),
    "rpm": (2 * math.pi, 60, (0, 0, -1)),
}
NAMES = tuple(_UNITS)

_NAME = "|".join(sorted(_UNITS, key=len, reverse=True))
_TERM = rf"(?:{_NAME})(?:\^?[234]|[²³⁴])?(?![\w.(])"
CHAIN = rf"/?\s*{_TERM}(?:(?:\s*[/·]\s*|\s+){_TERM})*"
"""Regular expression of a unit behind a number: `mm`, `N m/rad`, `m/s2`, `m/s²`, `m/s^2`, `/s`."""
_PLAIN = str.maketrans("²³⁴·", "234 ", "^")

_FACTOR = re.compile(rf"\s*(/?)\s*({_NAME})(-?[1-4])?(?![A-Za-z])")


class UnitError(ValueError):
    """Raised for text that is no unit."""


def is_unit(name: str) -> bool:
    """Return whether a name, such as "mm" or "m2", reads as a unit, and so cannot name a number."""
    return re.fullmatch(rf"(?:{_NAME})[234]?", name) is not None


def unit(text: str) -> Unit:
    """Return the unit of a text such as "N m/rad" or "N m rad-1"; "" and "1" are that of pure
    numbers. Raises UnitError for anything else."""
    rest = re.sub(r"^\s*1?\s*(?=/|$)", "", text).translate(_PLAIN)
    top = bottom = 1.0
    dimension, factors = NUMBER, []
    while rest.strip():
        match = _FACTOR.match(rest)
        if not match:
            word = re.sub(r"^\s*/?\s*([A-Za-z]*).*", r"\1", rest, flags=re.S) or rest.strip()
            parts = re.findall(_NAME, word) if re.fullmatch(f"(?:{_NAME})+", word) else []
            # degF, mV and mi are units of other things, which no unit here replaces
            is_other = re.fullmatch(rf"(?:{_NAME})[A-Z]\w*", word) or len(word) < 3
            is_foreign = is_other and word.lower() not in map(str.lower, NAMES)
            guess = "" if is_foreign else did_you_mean(word, NAMES)
            whole = text.strip().replace(word, " ".join(parts))
            hint = f" (did you mean {whole}?)" if parts else guess
            if parts[1:] and parts[0] == "m":  # `m J` would be metres times joules
                hint = f" (m is the metre: write milli as 1e-3 {' '.join(parts[1:])})"
            raise UnitError(
                f"{text!r} is not a unit{hint}; allowed: products and "
                f"quotients such as N m/rad of {', '.join(NAMES)}"
            )
        slash, name, digits = match.groups()
        exponent = int(digits or 1) * (-1 if slash else 1)
        numerator, denominator, powers = _UNITS[name]
        if exponent < 0:
            numerator, denominator = denominator, numerator
        top, bottom = top * numerator ** abs(exponent), bottom * denominator ** abs(exponent)
        dimension = product(dimension, power(Dimension(*powers), exponent))
        name = "degree" if name == "deg" else name
        factors.append(name if exponent == 1 else f"{name}{exponent}")
        rest = rest[match.end() :]
    return Unit(top, bottom, dimension, " ".join(factors) or "1")
