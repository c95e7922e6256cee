"""Units on the numbers of a raw config: `duration: 3 s`, `relative: 10 %`, `at_most: 2.5 s`.

Each becomes a number in the unit that its key has (`Rule.unit`), which may be that of a parameter,
response or quantity, before anything else is checked: all that follows knows numbers alone."""

import re
from collections.abc import Mapping
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from typing import Any

import fpm
from deployable.campaign.config.keys import Rule
from deployable.campaign.config.models import Config
from deployable.campaign.config.read import show, whole
from deployable.campaign.config.resolve import with_margins
from deployable.campaign.config.sections import scene_type
from fpm.arithmetic.units import NUMBER, Dimension, Unit, UnitError, number_hint, unit
from fpm.files.outcome import eventful
from fpm.reading import quantity_definitions
from fpm.reading.quantities import KINDS

_TEXT = re.compile(  # the exponent is of the number, never a unit
    r"((?>[-+]?(?:\d{1,60}(?:\.\d{0,60})?|\.\d{1,60})(?:[eE][-+]?\d{1,3})?))\s*(\D.*)"
)
_CONFIG_UNITS = {
    "%": Unit(1, 100, NUMBER, "%"),
    "min": Unit(60, 1, Dimension(time=1), "min"),
    "W": Unit(1, 1, Dimension(1, 2, -3), "W"),
}
"""Units of configs that are names or operators in structures."""

_ON_SLIDES = {"rad/s2": "m/s2", "N m": "N"}
_WRONG = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError)
"""Errors raised where units depend on something of the config that is wrong itself."""


class StatedUnits:
    """Units stated in a raw config. raw: the config with numbers for texts of a number and a unit
    that fits its key; misfits: a sentence for each of the others, by key; unknowns: of those that
    are of something unknown, which have become numbers without unit."""

    def __init__(self, raw: Mapping):
        self.misfits: dict[str, str] = {}
        self.unknowns: dict[str, str] = {}
        self._source = raw
        self._sections: dict[str, Any] = {}
        self.raw = {name: self._section(name) for name in raw}

    def _section(self, name: str) -> Any:
        if name not in self._sections:
            value, key = self._source.get(name), whole().children.get(name)
            self._sections[name] = (
                self._resolve(value, key, key.unit, (name,), "") if key else value
            )
        return self._sections[name]

    def _resolve(
        self, value: Any, key: Rule, symbol: str, path: tuple, owner: str, parent: Any = None
    ) -> Any:
        """Convert the numbers of a value at a path to the unit `symbol`, or to that of `owner`, a
        name. parent: the mapping that has the value."""
        if isinstance(value, Mapping):
            result: dict[str, Any] = {}
            symbols = dict(key.units)
            for name, item in value.items():
                entry = key.child(name)
                symbol = entry.unit or symbols.get(name, "") if entry else ""
                label = owner if name in key.children else name
                place = (*path, str(name))
                result[name] = (
                    self._resolve(item, entry, symbol, place, label, value) if entry else item
                )
            return result
        if isinstance(value, list | tuple):
            return [self._resolve(item, key, symbol, path, owner, parent) for item in value]
        if int in key.options and isinstance(value, float) and value.is_integer():
            return int(value)
        match = symbol and isinstance(value, str) and _TEXT.fullmatch(value.strip())
        if not match:
            return value
        try:
            symbol = self._symbol_of(symbol, path, owner, parent)
        except _WRONG:
            full_path = ".".join(path)
            self.unknowns[full_path] = f"{full_path}: {show(value)}, whose unit cannot be checked"
            return float(match[1])
        number, unit_name = match.groups()
        return self._number(value, number, unit_name, symbol, path, key)

    def _number(
        self, text: str, number: str, name: str, symbol: str, path: tuple, key: Rule
    ) -> Any:
        """Return a number in the unit `symbol`, or its text if the unit does not fit: a misfit."""
        hint, words = "", ", or in %" if symbol == "1" else f" ({symbol})"
        try:
            words += ", with or without a unit that fits" * (symbol != "1")
            if (value := _convert(number, name, symbol)) is not None:
                return value
            if name == "%" and path[-1] == "absolute":
                hint = f" (did you mean relative: {text}?)"
        except UnitError:
            hint = number_hint(text) or f" ({name} is not a unit)"
        except OverflowError:
            hint = " (no finite number)"
        place = ".".join(path)
        allowed = f"{key.allowed}{words}"
        self.misfits[place] = f"{place}: {show(text)} is not allowed{hint}; allowed: {allowed}"
        return text

    # -- units that depend on the structure ---------------------------------------------------

    def _symbol_of(self, symbol: str, path: tuple, owner: str, parent: Any) -> str:
        """Return the unit of a key, by name."""
        if symbol == "parameter":
            owners = [owner] if owner else self._source["intervals"]  # of runs of one parameter
            parameters = self._structure(path).parameters
            (symbol,) = {parameters[name].unit for name in owners}
            return symbol
        if symbol == "quantity":
            return self._quantities[owner].unit
        if symbol == "response":
            if path[0] == "quantities":
                (owner,) = (parent[kind] for kind in KINDS if kind in parent)
            return self._responses[owner].unit
        if symbol in _ON_SLIDES:
            opening = parent.get("along", parent.get("margin"))
            opening = opening if isinstance(opening, str) else opening[0]
            slides = {hinge.name: hinge.slides for hinge in self._structure(path).sample.hinges}
            return _ON_SLIDES[symbol] if slides[opening] else symbol
        return symbol

    def _structure(self, path: tuple = ("",)) -> Any:
        case = self._source["cases"][path[1]] if path[0] == "cases" else {}
        section = case if "file" in case else self._source["scene"]
        return scene_type(section.get("name") or "", section.get("file") or "")

    @cached_property
    def _with_margins(self) -> Config:
        names = ("responses", "margins")
        sections: dict[str, Any] = {
            name: {key: x for key, x in dict(self._section(name) or {}).items()
                   if isinstance(x, Mapping)}
            for name in names
        }  # fmt: skip
        sections |= {"scene": None, "review": self._source.get("review")}
        config = Config(campaign="", intervals={}, **sections)
        return with_margins(config, {"duration": 0})[0]

    @cached_property
    def _responses(self) -> dict[str, Any]:
        scene, responses = self._structure().sample, {}
        for name, definition in self._with_margins.responses.items():
            with suppress(fpm.SceneError):
                responses[name] = fpm.responses.parse(name, definition, scene)
        return responses

    @cached_property
    def _quantities(self) -> dict[str, Any]:
        elements = eventful(self._structure().sample)
        definitions = dict(self._section("quantities") or {}) | self._with_margins.quantities
        quantities, _ = quantity_definitions.parse(definitions, self._responses.values(), elements)
        return {quantity.name: quantity for quantity in quantities}


def number_in(symbol: str, text: Any) -> Any:
    """Return the number of a text such as `200 N mm/rad` in the unit `symbol`; whatever else it is,
    or has a unit that does not fit, as it is."""
    if isinstance(text, str) and (match := _TEXT.fullmatch(text.strip())):
        with suppress(UnitError, OverflowError):
            value = _convert(match[1], match[2], symbol)
            return text if value is None else value
    return text


def _convert(number: str, name: str, symbol: str) -> float | None:
    """A number with the unit `name` in the unit `symbol`; None where it does not fit."""
    source, target = _unit(name), _unit(symbol)
    if not source.fits(target):
        return None
    factor = Fraction(source.numerator) / Fraction(source.denominator)
    factor *= Fraction(target.denominator) / Fraction(target.numerator)
    is_whole = factor == 1 and number.lstrip("+-").isdigit()
    return int(number) if is_whole else float(Fraction(number) * factor)


def _unit(text: str) -> Unit:
    return _CONFIG_UNITS.get(text) or unit(text.replace("degree", "deg"))
