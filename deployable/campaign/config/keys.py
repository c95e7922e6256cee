"""What the keys of a config are: their limits, words for messages and JSON Schema."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from itertools import pairwise
from math import inf
from textwrap import dedent
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from fpm.declare import NO_VALUE, Key, NumberLimits


class RefusedError(ValueError):
    """Raised by a section of the config for values that it must not have together. key: the one to
    blame, relative to the section; text: what is wrong and what is allowed; without both the whole
    section is refused, and its `Rule` says what is allowed."""

    def __init__(self, key: str = "", text: str = ""):
        self.key, self.text = key, text


@dataclass(frozen=True)
class Rule(Key, NumberLimits):
    """A config key. What its type does not say stands beside this by `Annotated`: limits of the
    number, or of how many entries a mapping or list has; `unit`: of the number, "1": none, or what
    has it: "parameter", "response", "quantity"; allowed: what is allowed, in words; text: what an
    entry of a mapping is; units: of the numbers of a definition, pairs of key and unit; pattern:
    regular expression for the whole text. `rule_of` adds `options`, types that its value may be of,
    and keys below it: `children` by name, of a `section` (class), or `entry` for all `names`."""

    allowed: str = ""
    default: Any = field(default=NO_VALUE, kw_only=True)
    text: str = field(default="", kw_only=True)
    units: tuple[tuple[str, str], ...] = ()
    pattern: str = ""
    section: Any = None
    children: Mapping[str, Rule] = field(default_factory=dict, hash=False)
    entry: Rule | None = None
    names: Any = None
    options: tuple[Any, ...] = ()

    def fits(self, value: Any) -> bool:
        """Return whether a `value` is within the limits, or fits the pattern."""
        is_fit = not self.pattern or re.fullmatch(self.pattern, value) is not None
        number = len(value) if isinstance(value, str | dict | tuple) else value
        return is_fit and (not isinstance(number, int | float) or self.allows(number))

    def child(self, name: Any) -> Rule | None:
        """Return the description of the key `name` below this one, else of any entry, else None."""
        return self.children.get(name, self.entry)

    def take(self, value: Any) -> Any:
        """A value that is not a mapping of keys as the type of the key has it (a number is a float,
        a list a tuple), or NO_VALUE if it is not allowed."""
        values = (_take(option, value) for option in self.options)
        value = next((x for x in values if x is not NO_VALUE), NO_VALUE)
        return value if value is NO_VALUE or self.fits(value) else NO_VALUE

    @property
    def schema(self) -> dict[str, Any]:  # type: ignore[override]
        parts = [_schema(option, self) for option in self.options]
        if self.section or self.entry:
            texts = docstrings(self.section) if self.section else {}
            children = {name: child.schema for name, child in self.children.items()}
            for name, text in texts.items():
                children[name]["description"] = text
            table: dict[str, Any] = {
                "type": "object",
                "properties": children,
                "additionalProperties": self.entry.schema if self.entry else False,
                "required": [n for n, child in self.children.items() if child.default is NO_VALUE],
                **_finite(minProperties=self.least, maxProperties=self.most),
            }
            if self.names and self.names.pattern:
                table["propertyNames"] = {"pattern": f"^(?:{self.names.pattern})$"}
            parts.append(table)
        parts = [*filter(None, parts)]
        result = {"anyOf": parts} if len(parts) > 1 else dict(*parts)
        return result | ({"description": self.text} if self.text else {})


def rule_of(hint: Any, default: Any = NO_VALUE) -> Rule:
    """Describe a config key of a type, a dataclass, a dict or a union of these, with all keys below
    it; default: its value when it is left out."""
    rule, hint = _parts(hint)
    parts: dict[str, Any] = {}
    options = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    for option in options:
        if get_origin(option) is dict:
            name, entry = get_args(option)
            parts |= {"names": _parts(name)[0], "entry": rule_of(entry)}
        elif is_dataclass(option):
            hints, children = get_type_hints(option, include_extras=True), {}
            for f in fields(option):
                value = NO_VALUE if f.default is MISSING else f.default
                value = value if f.default_factory is MISSING else f.default_factory()
                children[f.name] = rule_of(hints[f.name], value)
            text = " ".join((option.__doc__ or "").split())
            parts |= {"section": option, "children": children, "text": text}
    if is_dataclass(hint):
        usual = "a mapping"
    elif get_origin(hint) is Literal:
        usual = f"one of {', '.join(f'`{word}`' for word in get_args(hint))}"
    elif hint is bool:
        usual = "`true` or `false`"
    else:
        usual = rule.describe("a whole number" if hint is int else "")
    words = rule.allowed or usual
    return replace(rule, allowed=words, default=default, options=options, **parts)


def _parts(hint: Any) -> tuple[Rule, Any]:
    """The Rule beside a type, and the type itself."""
    rule = next((m for m in getattr(hint, "__metadata__", ()) if isinstance(m, Rule)), Rule())
    return rule, get_args(hint)[0] if get_origin(hint) is Annotated else hint


def _take(hint: Any, value: Any) -> Any:
    """Return the value as a type has it; NO_VALUE: a text is not a number, 2.0 no whole number."""
    rule, hint = _parts(hint)
    kind, kinds = get_origin(hint), get_args(hint)
    if kind is tuple and isinstance(value, list):
        kinds = kinds[:1] * len(value) if kinds[-1] is ... else kinds
        items = tuple(map(_take, kinds, value))
        value = items if len(kinds) == len(value) and NO_VALUE not in items else NO_VALUE
    elif hint is float and isinstance(value, int | float) and not isinstance(value, bool):
        value = float(value)
    elif not (hint is Any or (kind is Literal and value in kinds) or type(value) is hint):
        return NO_VALUE
    return value if value is NO_VALUE or rule.fits(value) else NO_VALUE


def _schema(hint: Any, rule: Rule) -> dict[str, Any]:
    """What JSON Schema says of a type within the limits of a rule; {} for mappings."""
    type_rule, hint = _parts(hint)
    rule = rule if type_rule == Rule() else type_rule
    kind, kinds = get_origin(hint), get_args(hint)
    if hint in (int, float):
        limits = _finite(minimum=rule.least, exclusiveMinimum=rule.above, maximum=rule.most)
        number = {"type": "integer" if hint is int else "number", **limits}
        with_unit = {"type": "string", "pattern": r"^\s*[-+.\d]"}
        return {"anyOf": [number, with_unit]} if rule.unit else number
    if kind is Literal:
        return {"enum": [*kinds]}
    if kind is tuple:
        is_open = kinds[-1] is ...  # whose number of items the rule limits
        least, most = (rule.least, rule.most) if is_open else (len(kinds), len(kinds))
        count = _finite(minItems=least, maxItems=most)
        return {"type": "array", "items": _schema(kinds[0], Rule(unit=rule.unit)), **count}
    return {str: {"type": "string"}, bool: {"type": "boolean"}}.get(hint, {})


def _finite(**limits: float) -> dict[str, Any]:
    return {name: limit for name, limit in limits.items() if abs(limit) < inf}


def docstrings(hint: type) -> dict[str, str]:
    """Return what stands below the fields of a class (hint), by their names, on one line each."""
    definition: Any = ast.parse(dedent(inspect.getsource(hint))).body[0]
    pairs: Any = pairwise(definition.body)
    return {
        field.target.id: " ".join(text.value.value.split())
        for field, text in pairs
        if (type(field), type(text)) == (ast.AnnAssign, ast.Expr)
    }
