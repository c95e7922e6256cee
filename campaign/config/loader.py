"""YAML as people mean it: no key twice, `1e9` is a number, and errors with their line."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from campaign.errors import ConfigError

# YAML 1.1 takes 1e9 (no dot, no sign) for a string; YAML 1.2 and everybody else for a number.
_FLOAT = re.compile(r"^[-+]?(\d[\d_]*)(\.[\d_]*)?([eE][-+]?\d+)$|^[-+]?\.\d[\d_]*([eE][-+]?\d+)?$")


class _Loader(yaml.SafeLoader):
    """SafeLoader that notes keys given twice, or that are not text, in `problems`."""

    def __init__(self, stream):
        super().__init__(stream)
        self.problems: list[str] = []

    def construct_mapping(self, node, deep=False):
        first: dict[object, int] = {}
        for key_node, _ in node.value:
            if key_node.tag == "tag:yaml.org,2002:merge":
                continue
            if not isinstance(key_node, yaml.ScalarNode):
                continue  # SafeLoader refuses it
            key = self.construct_object(key_node, deep=True)
            line = key_node.start_mark.line + 1
            if not isinstance(key, str):
                self.problems.append(f"line {line}: the key {key!r} is not a name; allowed: text")
            elif key in first:
                self.problems.append(
                    f"line {line}: {key} is defined twice (first on line {first[key]}); "
                    "allowed: each key once"
                )
            first.setdefault(key, line)
        if not all(isinstance(key, str) for key in first):
            return {}
        return super().construct_mapping(node, deep=deep)


_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+0123456789."))


def parse(text: str, source: str) -> dict:
    """The mapping that `text` holds.

    Raises `ConfigError`, naming `source` and the line, when `text` is not YAML, repeats a key, or
    is not a mapping.
    """
    loader = _Loader(text)
    try:
        data = loader.get_single_data()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        what = ", ".join(part for part in (error.context, error.problem) if part)
        raise ConfigError(source, [f"{place}this is not YAML: {what}"]) from None
    except yaml.YAMLError as error:
        raise ConfigError(source, [f"this is not YAML: {error}"]) from None
    finally:
        loader.dispose()
    if loader.problems:
        raise ConfigError(source, loader.problems)
    if not isinstance(data, dict):
        found = "nothing" if data is None else type(data).__name__
        raise ConfigError(source, [f"the file holds {found}; allowed: a mapping of keys"])
    return data


def retyped(value: Any) -> Any:
    """`value` with the text in it read as YAML: Snakemake's `--config` leaves numbers as text."""
    if isinstance(value, Mapping):
        return {key: retyped(item) for key, item in value.items()}
    if isinstance(value, list):
        return [retyped(item) for item in value]
    if isinstance(value, str):
        return parse(f"value: {value}", "--config")["value"] if value else value
    return value


def load(path: str | Path) -> dict:
    """The mapping in the file at `path`; raises `ConfigError` like `parse`, and without a file."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ConfigError(str(path), [f"the file cannot be read: {reason}"]) from None
    return parse(text, str(path))
