"""A config as its models take it, and what they refuse: key, value and what is allowed."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from functools import cache
from typing import Any

from deployable.campaign.config.keys import Part, RefusedError, part_of
from deployable.campaign.config.models import Config
from fpm.errors import did_you_mean, likely


def read(raw: Any) -> tuple[Config | None, dict, list[str]]:
    """What `raw` says, the part of it that is right, and a sentence for each thing that is wrong.

    What is wrong is left out, so that the rest can be looked at too; None where that leaves no
    config.
    """
    endless: dict[str, Any] = {}
    right, problems = _as_meant(_plain(raw, "", endless))
    problems += [f"{key}: {value} is not allowed; allowed: a finite number"
                 for key, value in endless.items()]  # fmt: skip
    config, faults = _validated(right)
    for path, _, text in sorted(faults, key=lambda fault: fault[0]):
        if ".".join(path) not in endless and text not in problems:
            problems.append(text)
    if faults and not endless:
        for _, left_out, _ in faults:
            _remove(right, left_out)
        config, _ = _validated(right)
    return None if endless else config, right, problems


@cache
def whole() -> Part:
    """The config with all its keys."""
    return part_of(Config)


@cache
def _adapter() -> Any:
    from pydantic import TypeAdapter

    return TypeAdapter(Config)


Fault = tuple[tuple[str, ...], tuple[str, ...], str]
"""Path of what is wrong, of what to leave out for it, and a sentence."""


def _validated(raw: Any) -> tuple[Config | None, list[Fault]]:
    from pydantic import ValidationError

    try:  # as JSON, in which a strict model takes lists for tuples
        return _adapter().validate_json(json.dumps(raw, default=str)), []
    except ValidationError as error:
        faults = [_fault(raw, found) for found in error.errors(include_url=False)]
    # Of a choice of types, the one that goes deepest was meant.
    paths = [path for path, _, _ in faults]
    return None, [
        fault
        for fault in faults
        if not any(path[: len(fault[0])] == fault[0] != path for path in paths)
    ]


def _fault(value: Any, error: Mapping) -> Fault:
    """What pydantic found, from its place: names of keys, types of a choice, numbers in lists."""
    part, path, entry = whole(), [], None
    unknown = error["type"] == "unexpected_keyword_argument"
    *place, last = error["loc"] or [""]
    is_name = last == "[key]"
    for name in place if unknown or is_name else [*place, last]:
        if below := part.below(name):
            path.append(name)
            if name not in part.children and entry is None:
                entry = len(path)
            above, part = part, below
            value = value.get(name) if isinstance(value, Mapping) else None
    left_out = tuple(path[:entry])
    key = ".".join(path)
    if unknown:
        text = _no_key(f"{key}." if key else "", last, part)
        return (*path, last), left_out if entry else (*path, last), text
    allowed = part.allowed
    refused = error.get("ctx", {}).get("error")
    if is_name:
        text = f"{key}: not a name that can be used; allowed: {above.names}"
    elif error["type"] == "missing" and last in path:
        text = f"{key}: missing; allowed: {allowed}"
    elif isinstance(refused, RefusedError) and refused.text:
        path += [refused.key] if refused.key else []
        text = f"{'.'.join(path)}: {refused.text}"
    else:
        text = f"{key or 'the file'}: {show(value)} is not allowed; allowed: {allowed}"
    return tuple(path), left_out, text


def _as_meant(raw: Any) -> tuple[Any, list[str]]:
    """The config with sections whose names are likely others under those, and sentences of them:
    what would follow from such a slip is not told."""
    known, problems = Config.__dataclass_fields__, []
    if not isinstance(raw, Mapping):
        return raw, problems
    out = dict(raw)
    for name in [name for name in raw if isinstance(name, str) and name not in known]:
        meant = likely(name, known)
        if meant and meant not in out:
            problems.append(_no_key("", name, whole()))
            out[meant] = out.pop(name)
    return out, problems


def _no_key(dotted: str, name: str, part: Part) -> str:
    """That a key is not known, with the likely one."""
    renamed = {b.key.formerly: other for other, b in part.children.items() if b.key.formerly}
    hint = did_you_mean(renamed.get(name, name), part.children)
    return f"{dotted}{name}: there is no such key{hint}; allowed: {', '.join(part.children)}"


def _remove(data: Any, path: tuple[str, ...]) -> None:
    """Take the value of a key out of nested mappings, where it is there."""
    for name in path[:-1]:
        data = data.get(name) if isinstance(data, Mapping) else None
    if path and isinstance(data, dict):
        data.pop(path[-1], None)


def show(value: Any) -> str:
    """A value as short text for a message."""
    text = json.dumps(value, default=str) if not isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _plain(value: Any, key: str, endless: dict[str, Any]) -> Any:
    """A copy as arrays and JSON hold it: whole numbers of more than 64 bits are floats, text is
    Unicode. endless: gets keys and values of numbers that are infinite or none."""
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
    elif isinstance(value, int) and abs(value) >= 1 << 63:
        return float(value)
    return value
