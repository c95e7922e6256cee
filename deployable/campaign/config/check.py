"""The config of a campaign: read, checked, filled with defaults and resolved before any job starts.

    campaign = load_config(["config/paper.yaml"])
    campaign.experiment.solver.duration

Everything wrong with it is collected into one `ConfigError`: what the schema tells
(`schema_checks`), then what needs the scene (`scene_checks`).
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from deployable.campaign.config.accuracy import accuracy_problems, with_accuracy
from deployable.campaign.config.loader import load, load_own
from deployable.campaign.config.scenes import anchored
from deployable.campaign.config.sections import Campaign
from deployable.campaign.errors import ConfigError

SCHEMA_PATH = Path(__file__).parent / "schema.yaml"


@cache
def schema() -> dict:
    """The schema of a config (do not change it)."""
    return load_own(SCHEMA_PATH)


def load_config(
    paths: Sequence[str | Path], overrides: Mapping | None = None, source: str | None = None
) -> Campaign:
    """The campaign of YAML files, later ones and `overrides` winning key by key.

    A structure's file is sought from the folder of the YAML file that names it, that of `overrides`
    from the working folder.

    Raises `ConfigError` that lists everything that is wrong.
    """
    merged: dict = {}
    for path in paths:
        merge(merged, anchored(load(path), Path(path).parent))
    merge(merged, anchored(overrides or {}, "."))
    return check_config(merged, source or ", ".join(str(path) for path in paths))


def check_config(raw: Mapping, source: str = "the config") -> Campaign:
    """The campaign that `raw` means; raises `ConfigError` with everything that is wrong."""
    from deployable.campaign.config.scene_checks import resolve
    from deployable.campaign.config.schema_checks import schema_problems

    problems, sound = schema_problems(raw, schema())
    campaign = None
    if sound is not None:
        problems += accuracy_problems(sound)
        campaign, more = resolve(with_defaults(with_accuracy(sound)))
        problems += more
    if problems or campaign is None:
        raise ConfigError(source, problems)
    return campaign


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
