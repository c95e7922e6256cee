"""The config of a campaign: read, filled with defaults, checked, before any job starts.

    config = load_config(["config/paper.yaml"])
    config["solver"]["duration"]

A config is a plain nested dict that follows `config.schema.yaml` beside this file. Everything wrong
with it is collected into one `ConfigError`: what the schema tells (`campaign.schema_checks`), then
what needs the scene (`campaign.scene_checks`).
"""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from campaign.errors import ConfigError
from campaign.loader import load

SCHEMA_PATH = Path(__file__).parent / "config.schema.yaml"

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
    from campaign.presets import with_preset
    from campaign.scene_checks import scene_problems
    from campaign.schema_checks import schema_problems

    problems, sound = schema_problems(raw, schema())
    config = None if sound is None else with_defaults(with_preset(sound))
    if config is not None:
        problems += scene_problems(config)
    if problems or config is None:
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
