"""Definitions of responses and quantities in a config: which kind they are of, and its keys."""

from collections.abc import Iterable, Mapping
from typing import Any

from fpm.errors import SceneError, did_you_mean, fold_name, hint_new


def kind_of(key: str, definition: Any, kinds: Mapping[str, Any], addition: str = "") -> str:
    """Return the kind that a definition is of, its one key that is among `kinds`; SceneError for
    none or several, and for keys that are not those of the kind. key: dotted path of the
    definition; kinds: types with `mandatory` and `optional` keys, by name; addition: what else a
    definition may be, in words."""
    names = [name for name in kinds if isinstance(definition, Mapping) and name in definition]
    if len(names) != 1:
        raise SceneError(key, definition, f"exactly one of {', '.join(kinds)}{addition}")
    (name,) = names
    mandatory, optional = kinds[name].mandatory, kinds[name].optional
    unknown_keys = [entry for entry in definition if entry not in {name, *mandatory, *optional}]
    if unknown_keys or not definition.keys() >= {*mandatory}:
        allowed = " and ".join(filter(None, (name, ", ".join(mandatory))))
        allowed += f", perhaps with {', '.join(optional)}" if optional else ""
        allowed += "" if mandatory or optional else " alone"
        if {"unit", "units"} & {*unknown_keys}:
            allowed += ", in the SI unit of its kind: leave the unit out"
        hints = ((entry, hint_new(entry, optional)) for entry in unknown_keys)
        allowed += "".join(f"; {entry}{hint}" for entry, hint in hints if hint)
        if len(unknown_keys) == 1:  # whose line is told
            key = f"{key}.{unknown_keys[0]}"
        raise SceneError(key, ", ".join(map(str, unknown_keys)) or dict(definition), allowed)
    return name


def check_choice(key: str, value: object, choices: Iterable[str], addition: str = "") -> str:
    """Return a `value` that is one of `choices`; else SceneError, which tells what is likely meant.
    key: of the value; addition: what else is allowed, in words."""
    names = list(choices)
    if isinstance(value, int | str) and fold_name(str(value)) in names:
        return fold_name(str(value))
    if not isinstance(value, str) or value not in names:
        hint = did_you_mean(value, names) if isinstance(value, str) else ""
        allowed = f"one of {', '.join(names) or '(there is none)'}{addition}{hint}"
        raise SceneError(key, value, allowed)
    return value
