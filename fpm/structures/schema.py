"""The JSON Schema of all keys of structure files, made from its statements."""

from typing import Any

from fpm.declare import NO_VALUE
from fpm.structures.keys import STRING
from fpm.structures.model import KEYS, TEXTS, UNIT_KEYS, overall
from fpm.structures.statement import Statement
from fpm.structures.statements import GROUPS
from fpm.structures.text_file import PARAMETER_KEYS


def schema() -> dict[str, Any]:
    """Return the JSON Schema of structure files, by which editors complete and check them. What
    depends on names and units is left to the program."""
    tables: dict[str, Any] = {
        group: {"additionalProperties": {"anyOf": [_entry(kind) for kind in kinds.values()]}}
        for group, kinds in GROUPS.items()
    }
    parameter = {"properties": {k: {} for k in PARAMETER_KEYS}, "additionalProperties": False}
    tables |= {"let": {}, "points": {}, "parameters": {"additionalProperties": parameter}}
    unit_keys = {key: tables.get(key, {}) for key in UNIT_KEYS}
    unit = {"properties": unit_keys, "additionalProperties": False, "required": ["count"]}
    tables["repeat"] = {"additionalProperties": unit}
    tops = dict.fromkeys(TEXTS, STRING) | _entry(overall)["properties"]
    tops |= {key: {"type": ["object", "null"], **table} for key, table in tables.items()}
    properties = {key: tops[key] for key in KEYS}
    return {"type": "object", "properties": properties, "additionalProperties": False}


def _entry(statement: Statement) -> dict[str, Any]:
    """What JSON Schema says of an entry, on a hinge or a slide."""
    keys = {name: key for slides in ((), ("joint",)) for name, (_, key) in
            statement.for_slides(slides).items()}  # fmt: skip
    properties = {name: key.schema | {"description": key.text} for name, key in keys.items()}
    common = keys.keys() & statement.keys & statement.for_slides(["joint"]).keys()
    mandatory = [name for name in common if keys[name].default is NO_VALUE]
    if statement.type:
        properties["type"], mandatory = {"const": statement.type}, [*mandatory, "type"]
    return {
        "type": "object",
        "description": statement.text,
        "properties": properties,
        "additionalProperties": False,
        "required": sorted(mandatory),
    }
