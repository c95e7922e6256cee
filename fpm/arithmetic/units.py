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
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_PLAIN = str.maketrans("²³⁴·", "234 ", "^")

_FACTOR = re.compile(rf"\s*(/?)\s*({_NAME})(-?[1-4])?(?![A-Za-z])")


class UnitError(ValueError):
    """Raised for text that is not a unit."""


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
            plural = [word[:-1]] * (word.endswith("s") and word[:-1] in _UNITS)
            readings = plural + _readings(word)
            # degF, mV and mi are units of other things, which no unit here replaces
            is_other = re.fullmatch(rf"(?:{_NAME})[A-Z]\w*", word) or len(word) < 3
            is_foreign = is_other and word.lower() not in map(str.lower, NAMES)
            sign = "/" if rest.lstrip().startswith("/") else " "
            wholes = [text.strip().replace(word, x.replace(" ", sign)) for x in readings]
            hint = f" (did you mean {' or '.join(wholes)}?)"
            # `m J` would be metres times joules
            if readings and all(reading.startswith("m ") for reading in readings):
                hint = f" (m is the metre: write milli as 1e-3 {readings[0][2:]})"
            elif not readings:
                hint = "" if is_foreign else did_you_mean(word, NAMES)
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


def _readings(word: str) -> list[str]:
    """Return the products of units that a word without spaces could stand for."""
    if len(word) > 8:  # of which there are too many
        return []
    pairs = ((name, word[len(name) :]) for name in _UNITS if word.startswith(name))
    products = ((name, reading) for name, rest in pairs for reading in _readings(rest))
    products = ((name, reading) for name, reading in products if reading.split()[0] != name)
    return [word] * (word in _UNITS) + [f"{name} {reading}" for name, reading in products]


_FOREIGN = {
    "in": (25.4, "mm"), "inch": (25.4, "mm"), '"': (25.4, "mm"), "ft": (0.3048, "m"),
    "lb": (0.45359237, "kg"), "lbf": (4.4482216152605, "N"), "psi": (6894.757293168, "Pa"),
    "kgf": (9.80665, "N"), "kp": (9.80665, "N"), "t": (1e3, "kg"), "g": (1e-3, "kg"),
    "bar": (1e5, "Pa"), "degree": (1, "deg"), "degrees": (1, "deg"), "radians": (1, "rad"),
    "rev": (2 * math.pi, "rad"), "min": (60, "s"), "minutes": (60, "s"), "h": (3600, "s"),
    "hr": (3600, "s"), "sec": (1, "s"), "seconds": (1, "s"), "msec": (1e-3, "s"),
    "usec": (1e-6, "s"), "nsec": (1e-9, "s"), "ns": (1e-9, "s"), "dm": (0.1, "m"),
}  # fmt: skip
"""Units of other programs, as so many of these."""

_CASELESS = ("deg", "rad", "rpm", *(word for word in _FOREIGN if len(word) > 2))
_PREFIXES = {"u": 1e-6, "m": 1e-3, "c": 0.01, "da": 10.0, "k": 1e3}
_PREFIX_FORM = re.compile("([umck]|da)(N|J|Pa|Hz|deg|rad)")
_PRODUCT = re.compile("(kg(?!s)|[mckM]?N|daN)(mm|cm|m|s)")
_WORD = re.compile(r'(/?\s*)([A-Za-z]+|")(-?[1-4])?')
_SIGNS = _PLAIN | str.maketrans("µμ−⁻¹*×⋅∙", "uu--1    ") | {ord("°"): "deg"}


def translate(text: str) -> tuple[float, str]:
    """Return a factor and a unit here for one as other programs write it, such as `kNm`, `N-m`,
    `mm/min` or `in`; (1, text) for a text that has none of these."""
    factor = 1.0

    def translate_word(match: re.Match) -> str:
        nonlocal factor
        slash, word, digits = match.groups("")
        word = word.lower() if word.lower() in _CASELESS else word
        if (product := _PRODUCT.fullmatch(word)) and "-" not in digits:  # N m-1 or 1/(N m)?
            first, word = product.groups()
            slash = _WORD.sub(translate_word, slash + first) + (slash.strip() or " ")
        elif word not in _UNITS:
            size, word = _FOREIGN.get(word, (1.0, word))
            if prefix_match := _PREFIX_FORM.fullmatch(word):
                size, word = _PREFIXES[prefix_match[1]], prefix_match[2]
            factor *= size ** ((-1 if slash.strip() else 1) * int(digits or 1))
        return f"{slash}{word}{digits}"

    plain = text.translate(_SIGNS).strip().rstrip(".").replace("U/min", "rpm")
    name = _WORD.sub(translate_word, re.sub(r"(?<=[A-Za-z\d])[.-](?=[A-Za-z])", " ", plain))
    return factor, name


def number_hint(text: str, with_unit: bool = True) -> str:
    """Return a hint for the message on a text that is not an allowed number: " (did you mean x?)"
    for a percentage, a decimal comma, a power with `^` or a unit of other programs; " (a number
    alone, ...)" for a unit where none may be; else "". with_unit: whether it may have a unit."""
    if any(sign in text for sign in "\u2212\u2013\u2014"):  # as copied from a page
        plain = re.sub("[\u2212\u2013\u2014]", "-", text)
        sign = re.findall("[\u2212\u2013\u2014]", text)[0]
        return f" (“{sign}” is not a minus sign: write {plain})"
    comma = re.sub(r"^([-+]?\d+),(\d+)", r"\1.\2", text.strip())
    match = re.fullmatch(rf"({_NUMBER})\s*(\D.*)?", comma)
    number, symbol = (float(match[1]), (match[2] or "").replace("^", "")) if match else (0.0, "")
    word, (factor, own_unit) = "", translate(symbol)
    if re.fullmatch(r"[-+]?\d{1,3}(\.\d{3}){2,}", text):  # dots between thousands
        word = f"{float(text.replace('.', '')):.9g}"
    elif symbol == "%":
        word = f"{number / 100:.9g}"
        if with_unit:
            return f" (did you mean {word}? A share of another value is a product: {word}*k)"
    elif symbol not in ("", "s") and match and not with_unit:
        return " (a number alone, in the unit of what it is for)"
    elif match and not with_unit:
        word = f"{number:.9g}"
    elif own_unit.split() != symbol.split() and re.fullmatch(CHAIN, own_unit):
        word = f"{number * factor:.9g} {own_unit}"
    elif "^" in text:
        word = f"{match[1]} {symbol}" if match else text.replace("^", "**")
    elif match and comma != text.strip():
        word = comma
    return f" (did you mean {word}?)" if word else ""
