"""The config of a campaign: read, checked, filled with defaults and resolved before any job starts.

    campaign = load_config(["config/paper.yaml"])
    campaign.experiment.solver.duration

Everything wrong with it is collected into one `ConfigError`: what the models of its sections refuse
(`models`, by `read`), then what needs the scene (`scene_checks`).
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from pathlib import Path

from deployable.campaign.config.loader import load
from deployable.campaign.config.read import read
from deployable.campaign.config.scene_checks import accuracy_problems, resolve
from deployable.campaign.config.sections import Campaign
from deployable.campaign.errors import ConfigError

_OF_STRUCTURES = {"points", "bars", "bodies", "joints", "parameters"}
"""Keys by which a structure's file is known."""


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
    if "campaign" not in raw and len(raw.keys() & _OF_STRUCTURES) > 1:
        raise ConfigError(source, [
            "this is a structure's file; allowed: `python -m deployable structure` with it, or a "
            "campaign that names it (`scene: {file: ...}`)"
        ])  # fmt: skip
    config, given, problems = read(raw)
    campaign = None
    if config is not None:
        problems += accuracy_problems(config, given)
        campaign, more = resolve(config, given)
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


def anchored(raw: Mapping, folder: str | Path) -> Mapping:
    """`raw` with the path of its scene's file, which is relative to `folder`, as seen from here.

    A path below the working folder stays short; any other becomes absolute.
    """
    scene = raw.get("scene")
    if not isinstance(scene, Mapping) or not isinstance(scene.get("file"), str):
        return raw
    path = Path(folder, scene["file"]).resolve()
    here = Path.cwd().resolve()
    path = path.relative_to(here) if path.is_relative_to(here) else path
    return {**raw, "scene": {**scene, "file": str(path)}}
