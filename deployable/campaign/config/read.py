"""A config as its models take it, and what they refuse: key, value and what is allowed."""

import json
import math
import re
from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

from deployable.campaign.config.keys import ConfigKey, RefusedError, config_key_of
from deployable.campaign.config.models import Config
from fpm.errors import did_you_mean, likely, number_hint
from fpm.structures.model import KEYS
from fpm.structures.reading import commas

_LABELS = ("[key]", "dict[str,any]", "str")
"""What pydantic puts into the places of errors besides names: of keys, of a choice of types."""


def read(raw: Any) -> tuple[Config | None, dict, list[str]]:
    """Check a raw config by the models of its sections: returns the `Config`, a copy of the valid
    part of `raw`, and a sentence for each problem. Invalid keys are left out, so that the rest can
    be checked too; the config is None if that rest is invalid too, or a number is not finite."""
    endless: dict[str, Any] = {}
    right, problems = _correct_sections(_plain(raw, "", endless))
    problems += [f"{key}: {value} is not allowed; allowed: a finite number"
                 for key, value in endless.items()]  # fmt: skip
    config, faults = _validate(right)
    for fault in sorted(faults):
        if ".".join(fault.path) not in endless and fault.text not in problems:
            problems.append(fault.text)
    if faults and not endless:
        for fault in faults:
            _remove(right, fault.faulty_path)
        config, _ = _validate(right)
    return None if endless else config, right, problems


@cache
def whole() -> ConfigKey:
    """Describe all keys that a config may have: the tree of the whole config, made once."""
    return config_key_of(Config)


@cache
def _adapter() -> Any:
    from pydantic import TypeAdapter

    return TypeAdapter(Config)


class Fault(NamedTuple):
    """A problem of a config: a sentence, `text`, on the key at `path`, and `faulty_path`, what must
    be removed to check the rest: of a mapping's entry the whole entry."""

    path: tuple[str, ...]
    faulty_path: tuple[str, ...]
    text: str


def _validate(raw: Any) -> tuple[Config | None, list[Fault]]:
    from pydantic import ValidationError

    try:  # as JSON, in which a strict model takes lists for tuples
        return _adapter().validate_json(json.dumps(raw, default=str)), []
    except ValidationError as error:
        faults = [_fault(raw, detail) for detail in error.errors(include_url=False)]
    # Of a choice of types, the one that goes deepest was meant.
    paths = [fault.path for fault in faults]
    return None, [f for f in faults if not any(p[: len(f.path)] == f.path != p for p in paths)]


def _fault(raw: Any, error: Mapping) -> Fault:
    """What pydantic found, from its place: names of keys, types of a choice, numbers in lists."""
    names, kind = list(error["loc"]), error["type"]
    unknown = [names.pop()] if kind == "unexpected_keyword_argument" else []
    path, keys, value = [], [whole()], raw
    for name in names:
        if name not in _LABELS and (child := keys[-1].child(name)):
            path.append(name)
            keys.append(child)
            value = value.get(name) if isinstance(value, Mapping) else None
    entry = next((i for i, name in enumerate(path, 1) if name not in keys[i - 1].children), None)
    refusal = error.get("ctx", {}).get("error")
    if unknown:
        (unknown_key,) = unknown
        text = _no_key(path, unknown_key, keys[-1])
        path += unknown
    elif isinstance(refusal, RefusedError) and refusal.text:
        place = [*path, refusal.key] if refusal.key else path
        return Fault((*place,), (*path[:entry],), f"{'.'.join(place)}: {refusal.text}")
    else:
        key, allowed = ".".join(path) or "the file", keys[-1].allowed
        if "[key]" in names:
            reason, allowed = "not a name that can be used", keys[-2].names
        elif kind == "missing" and names[-1] in path:
            reason = "missing"
        else:
            unit = keys[-1].rule.unit
            hint = number_hint(value, with_unit=False) if isinstance(value, str) else ""
            if "number" not in allowed:
                is_word = isinstance(value, str) and value[:1].isalpha()
                hint = did_you_mean(value, re.findall(r"`(\w+)`", allowed)) if is_word else ""
            allowed += f" ({unit})" if unit in ("s", "min") else ""
            reason = f"{show(value)} is not allowed{hint}"
        text = f"{key}: {reason}; allowed: {allowed}"
    return Fault((*path,), (*path[:entry],), text)


def _correct_sections(raw: Any) -> tuple[Any, list[str]]:
    """The config with sections under the names likely meant, and a sentence for each renamed."""
    names: Any = Config.__dataclass_fields__
    fixes: dict[str, str] = {}
    for name in [name for name in raw if isinstance(name, str) and name not in names]:
        likely_name = likely(name, names)
        if likely_name not in ("", *raw, *fixes.values()):
            fixes[name] = likely_name
    problems = [_no_key([], name, whole()) for name in fixes]
    return {fixes.get(name, name): section for name, section in raw.items()}, problems


def _no_key(path: list[str], name: str, section: ConfigKey) -> str:
    """That a key is not known, with the likely one."""
    hint = did_you_mean(name, section.children)
    if not hint and path and name in Config.__dataclass_fields__:
        hint = " (it stands at the top of the file)"
    elif not hint and not path and name in KEYS:
        hint = " (it stands in the file of the structure)"
    key = ".".join([*path, name])
    return (
        f"{key}: there is no such key{hint}; allowed: {commas(section.children, 6 if hint else 99)}"
    )


def _remove(data: Any, path: tuple[str, ...]) -> None:
    """Take the value of a key out of nested mappings, where it is there."""
    for name in path[:-1]:
        data = data.get(name) if isinstance(data, Mapping) else None
    if path and isinstance(data, dict):
        data.pop(path[-1], None)


def show(value: Any) -> str:
    """Write a value as text for a message, at most 60 characters of it."""
    text = json.dumps(value, default=str) if not isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def sentence(key: str, error: Any) -> str:
    """Write an error of `fpm` or `intervals`, which know value and allowed, as a message on a key
    of the config."""
    return f"{key}: {show(error.value)} is not allowed; allowed: {error.allowed}"


def _plain(value: Any, key: str, endless: dict[str, Any]) -> Any:
    """A copy fit for arrays and JSON; `endless` gets keys and values of numbers not finite."""
    if isinstance(value, Mapping):
        return {
            _plain(name, "", {}): _plain(item, f"{key}.{name}".lstrip("."), endless)
            for name, item in value.items()
        }
    if isinstance(value, list | tuple):
        return [_plain(item, f"{key}[{i}]", endless) for i, item in enumerate(value)]
    if isinstance(value, str):
        return value.encode(errors="replace").decode()
    if isinstance(value, float) and not math.isfinite(value):
        endless[key] = value
    elif isinstance(value, int) and abs(value) > 1 << 1000:  # no float holds it
        endless[key] = f"a number of some {value.bit_length() // 3.33:.0f} digits"
        return math.inf
    elif isinstance(value, int) and abs(value) >= 1 << 63:
        return float(value)
    return value
