"""What the schema finds wrong with a config, as sentences with key, value and what is allowed."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Mapping
from functools import cache
from typing import Any

from fpm.errors import did_you_mean, likely

# Sections of definitions by name, which are wrong as a whole.
_WHOLE = ("intervals", "responses", "quantities", "requirements")


def schema_problems(raw: Any, schema: Mapping) -> tuple[list[str], dict | None]:
    """What `schema` finds wrong with `raw`, one sentence each that starts with the key.

    Also a copy of `raw` without what is wrong, so that the rest can be looked at too; None when
    that leaves no config.
    """
    endless = _not_finite(raw)
    raw, problems = _as_meant(_of_words(raw), schema)
    problems += [
        f"{key}: {value} is not allowed; allowed: a finite number" for key, value in endless
    ]
    validator = _validator()(schema)
    errors = sorted(validator.iter_errors(raw), key=lambda e: list(map(str, e.absolute_path)))
    sound = copy.deepcopy(raw)
    told = {key for key, _ in endless}
    for error in errors:
        if ".".join(map(str, error.absolute_path)) not in told:
            problems += _sentences(error)
        _remove(sound, error)
    problems = list(dict.fromkeys(problems))  # two rules may say the same of a value
    return problems, None if endless or not validator.is_valid(sound) else sound


@cache
def _validator() -> Any:
    """The class that checks data by a schema; to make it takes as long as to check a config."""
    from jsonschema import Draft202012Validator
    from jsonschema.validators import extend

    # JSON knows no difference between 2 and 2.0; what counts with it does.
    types = Draft202012Validator.TYPE_CHECKER
    types = types.redefine("integer", lambda _, value: type(value) is int)
    return extend(Draft202012Validator, type_checker=types)


def _as_meant(raw: Any, schema: Mapping) -> tuple[Any, list[str]]:
    """The config with sections whose names are likely others under those, and sentences of them:
    what would follow from such a slip is not told."""
    known, problems = schema["properties"], []
    if not isinstance(raw, Mapping):
        return raw, problems
    out = dict(raw)
    for name in [name for name in raw if isinstance(name, str) and name not in known]:
        former = next((part for part, of in known.items() if of.get("formerly") == name), "")
        meant = former or likely(name, known)
        if meant and meant not in out:
            problems.append(_no_key("", name, known))
            out[meant] = out.pop(name)
    return out, problems


def _no_key(dotted: str, name: str, known: Mapping) -> str:
    """That a key is not known, with the likely one."""
    renamed = {part.get("formerly"): other for other, part in known.items()}
    hint = did_you_mean(renamed.get(name, name), known)
    return f"{dotted}{name}: there is no such key{hint}; allowed: {', '.join(known)}"


def _remove(data: Any, error: Any) -> None:
    """Take what `error` complains about out of `data`, where it is the value of a key."""
    path = list(error.absolute_path)
    if error.validator == "additionalProperties":
        known = error.schema.get("properties", {})
        paths = [[*path, name] for name in error.instance if name not in known]
    elif "propertyNames" in error.absolute_schema_path:
        paths = [[*path, error.instance]]
    else:
        # A definition without one of its keys would only raise another complaint.
        paths = [path[:2] if path[0] in _WHOLE else path] if path else []
    for *parents, last in paths:
        place = data
        for part in parents:
            place = place.get(part) if isinstance(place, Mapping) else None
        if isinstance(place, dict):
            place.pop(last, None)


def _sentences(error: Any) -> list[str]:
    """A `jsonschema` error as sentences: key, value, what is allowed."""
    key = ".".join(str(part) for part in error.absolute_path)
    dotted = f"{key}." if key else ""
    if error.validator == "additionalProperties":
        known = error.schema.get("properties", {})
        return [_no_key(dotted, name, known) for name in error.instance if name not in known]
    if error.validator == "required":
        missing = [name for name in error.validator_value if name not in error.instance]
        name = next(name for name in missing if repr(name) in error.message)
        allowed = error.schema["properties"][name].get("allowed", "a value")
        return [f"{dotted}{name}: missing; allowed: {allowed}"]
    if "propertyNames" in error.absolute_schema_path:
        allowed = error.schema["allowed"]
        return [f"{dotted}{error.instance}: not a name that can be used; allowed: {allowed}"]
    allowed = error.schema.get("allowed", error.message)
    return [f"{key or 'the file'}: {show(error.instance)} is not allowed; allowed: {allowed}"]


def show(value: Any) -> str:
    """A value as short text for a message."""
    text = json.dumps(value, default=str) if not isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _of_words(value: Any) -> Any:
    """A copy in which whole numbers of more than 64 bits, which arrays do not hold, are floats."""
    if isinstance(value, Mapping):
        return {name: _of_words(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_of_words(item) for item in value]
    too_long = isinstance(value, int) and 1 << 63 <= abs(value) <= 1 << 1000
    return float(value) if too_long else value


def _not_finite(value: Any, key: str = "") -> list[tuple[str, float]]:
    """Keys and values of the numbers in `value` that are infinite or not a number."""
    if isinstance(value, Mapping):
        return [
            hit
            for name, item in value.items()
            for hit in _not_finite(item, f"{key}.{name}".lstrip("."))
        ]
    if isinstance(value, list):
        return [hit for i, item in enumerate(value) for hit in _not_finite(item, f"{key}[{i}]")]
    if isinstance(value, float) and not math.isfinite(value):
        return [(key, value)]
    if isinstance(value, int) and abs(value) > 1 << 1000:  # no float holds it
        return [(key, f"a number of some {value.bit_length() // 3.33:.0f} digits")]
    return []
