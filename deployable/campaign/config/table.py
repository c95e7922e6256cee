"""All config keys as a table: `python -m deployable keys > docs/config.md`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

from deployable.campaign.config.check import schema

_HEAD = """\
# Keys of a config

A campaign is one YAML file, checked before any job starts; `python -m deployable check FILE`
does it without running anything. `<name>` stands for a name of your own or of the scene. Numbers
are in SI units unless a unit is given. This page is made from
`deployable/campaign/config/schema.yaml` by `python -m deployable keys`.

| key | what it is | allowed | default |
|---|---|---|---|
"""


def rows(part: Mapping, prefix: str = "") -> Iterator[tuple[str, str, str, str]]:
    """Key, description, what is allowed and default of every key below a part of the schema."""
    required = part.get("required", [])
    children = list(part.get("properties", {}).items())
    more = part.get("additionalProperties")
    if isinstance(more, Mapping):
        children.append(("<name>", more))
    for name, sub in children:
        key = f"{prefix}{name}"
        unit = f" ({sub['unit']})" if "unit" in sub else ""
        default = "required" if name in required else _default(sub)
        yield key, sub["description"] + unit, sub["allowed"], default
        yield from rows(sub, f"{key}.")


def _default(part: Mapping) -> str:
    if "default" not in part or part["default"] == {}:
        return ""
    value = part["default"]
    return f"`{value}`" if isinstance(value, str) else f"`{json.dumps(value)}`"


def table() -> str:
    """The whole page as Markdown."""
    lines = [
        f"| `{key}` | {description} | {allowed} | {default} |"
        for key, description, allowed, default in rows(schema())
    ]
    return _HEAD + "\n".join(lines) + "\n"
