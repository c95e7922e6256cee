"""The config of a campaign: read, filled with defaults, checked, before any job starts.

    config = load_config(["config/paper.yaml"])
    config["solver"]["duration"]

A config is a plain nested dict that follows `workflow/schemas/config.schema.yaml`. Everything wrong
with it is collected into one `ConfigError`: first what the schema can tell, then what needs the
scene (`campaign.scene_checks`).
"""

from __future__ import annotations

import copy
import difflib
import hashlib
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from campaign.errors import ConfigError
from campaign.loader import load

SCHEMA_PATH = Path(__file__).parents[1] / "workflow" / "schemas" / "config.schema.yaml"

# The sections that decide which runs there are and what they hold.
RUN_SECTIONS = ("campaign", "scene", "solver", "intervals", "design", "held_out", "responses")


@cache
def schema() -> dict:
    """The schema of a config (do not change it)."""
    return load(SCHEMA_PATH)


def load_config(
    paths: Sequence[str | Path], overrides: Mapping | None = None, source: str | None = None
) -> dict:
    """The checked config from YAML files, later ones and `overrides` winning key by key.

    Raises `ConfigError` that lists everything that is wrong.
    """
    merged: dict = {}
    for path in paths:
        merge(merged, load(path))
    merge(merged, overrides or {})
    return check_config(merged, source or ", ".join(str(path) for path in paths))


def check_config(raw: Mapping, source: str = "the config") -> dict:
    """`raw` with the defaults filled in; raises `ConfigError` with everything that is wrong."""
    problems = schema_problems(raw)
    if problems:
        raise ConfigError(source, problems)
    config = with_defaults(raw)
    from campaign.scene_checks import scene_problems

    problems = scene_problems(config)
    if problems:
        raise ConfigError(source, problems)
    return config


def merge(into: dict, other: Mapping) -> dict:
    """Put `other` into `into`, mapping by mapping; returns `into`."""
    for key, value in other.items():
        if isinstance(value, Mapping) and isinstance(into.get(key), Mapping):
            into[key] = merge(dict(into[key]), value)
        else:
            into[key] = copy.deepcopy(value)
    return into


def with_defaults(raw: Mapping) -> dict:
    """A copy of `raw` with the schema's defaults where a key is absent."""

    def fill(value: Any, part: Mapping) -> Any:
        if not isinstance(value, Mapping):
            return copy.deepcopy(value)
        known = part.get("properties", {})
        filled = {key: fill(item, known.get(key, {})) for key, item in value.items()}
        for key, sub in known.items():
            if key not in filled and "default" in sub:
                filled[key] = fill(sub["default"], sub)
        return filled

    config = fill(raw, schema())
    if config["design"]["method"] == "scan" and "order" not in raw.get("design", {}):
        config["design"]["order"] = None
    return config


def config_hash(config: Mapping, sections: Iterable[str] | None = None) -> str:
    """First 16 hex digits of the SHA-256 of the config, or of some of its sections."""
    part = config if sections is None else {key: config[key] for key in sections}
    return digest(part)


def digest(data: Any) -> str:
    """First 16 hex digits of the SHA-256 of `data` as canonical JSON (floats to their last bit)."""
    return hashlib.sha256(canonical_json(data).encode()).hexdigest()[:16]


def canonical_json(data: Any) -> str:
    """`data` as JSON that is the same for equal data."""
    return json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)


def schema_problems(raw: Any) -> list[str]:
    """What the schema finds wrong with `raw`, one sentence each that starts with the key."""
    from jsonschema import Draft202012Validator

    problems = [
        f"{key}: {value} is not allowed; allowed: a finite number"
        for key, value in _not_finite(raw)
    ]
    errors = sorted(
        Draft202012Validator(schema()).iter_errors(raw),
        key=lambda e: list(map(str, e.absolute_path)),
    )
    for error in errors:
        problems.extend(_sentences(error))
    return problems


def _sentences(error: Any) -> list[str]:
    """A `jsonschema` error as sentences: key, value, what is allowed."""
    key = ".".join(str(part) for part in error.absolute_path)
    dotted = f"{key}." if key else ""
    if error.validator == "additionalProperties":
        known = list(error.schema.get("properties", {}))
        unknown = [name for name in error.instance if name not in known]
        return [
            f"{dotted}{name}: there is no such key{did_you_mean(name, known)}; "
            f"allowed: {', '.join(known)}"
            for name in unknown
        ]
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


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`" (did you mean x?)"` when a known name is close, else an empty string."""
    close = difflib.get_close_matches(name, list(known), n=1)
    return f" (did you mean {close[0]}?)" if close else ""


def show(value: Any) -> str:
    """A value as short text for a message."""
    text = json.dumps(value, default=str) if not isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


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
    return []
