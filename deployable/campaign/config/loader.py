"""YAML as people mean it: no key twice, `1e9` is a number, and errors with their line."""

import argparse
import os
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from deployable.campaign.errors import ConfigError
from fpm.errors import did_you_mean
from fpm.structures.reading import (
    DEEPEST,
    EMPTY,
    LARGEST,
    MOST,
    ExcessError,
    StructureError,
    join_key,
    read_text,
    why_not_yaml,
)

# YAML 1.1 takes 1e9 (no dot, no sign) for a string; YAML 1.2 and everybody else for a number.
_FLOAT = re.compile(r"^[-+]?(\d[\d_]*)(\.[\d_]*)?([eE][-+]?\d+)$|^[-+]?\.\d[\d_]*([eE][-+]?\d+)?$")


YTE_KEY = "__use_yte__"
"""Key of a file whose Python Snakemake would run."""


class UniqueKeyLoader(yaml.SafeLoader):
    """YAML loader that notes in `problems` (sentences with lines) keys given twice and keys that
    are not text. Dates are left as text; `1e9` is a number."""

    def __init__(self, stream):
        super().__init__(stream)
        self.problems: list[str] = []
        self.depth, self.deepest, self.count = -1, 0, 0
        self.sizes: dict[int, tuple[int, int]] = {}  # of nodes: values, and how deep they go

    def compose_node(self, parent, index):
        """Compose the next YAML node below `parent` (method of `yaml.Composer`); raises
        `ExcessError` for nodes nested too deep or too many, so that hostile files end early."""
        is_alias = self.check_event(yaml.AliasEvent)
        self.depth += 1
        count, deepest, self.deepest = self.count, self.deepest, self.depth
        self._limit()
        node = super().compose_node(parent, index)
        # An alias of what is still being read holds itself.
        size, depth = self.sizes.get(id(node), (1, DEEPEST + 1)) if is_alias else (1, 0)
        self.count, self.deepest = self.count + size, max(self.deepest, self.depth + depth)
        self._limit()
        self.sizes[id(node)] = self.count - count, self.deepest - self.depth
        self.deepest = max(self.deepest, deepest)
        self.depth -= 1
        return node

    def _limit(self):
        if self.deepest > DEEPEST:
            text = f"nested too deep; allowed: {DEEPEST} mappings and lists in each other"
            raise ExcessError(text)
        if self.count > MOST:
            raise ExcessError(f"the file holds more than {MOST} values; allowed: fewer")

    def construct_mapping(self, node, deep=False):
        """Make the dict of a YAML mapping (method of `yaml.SafeLoader`), empty if a key is not
        text. Such keys, and repeated ones (the last counts), are noted in the list `problems`, a
        sentence with the line for each. deep: as in `yaml.SafeLoader`."""
        first: dict[object, int] = {}
        for key_node, _ in node.value:
            if key_node.tag == "tag:yaml.org,2002:merge":
                continue
            if not isinstance(key_node, yaml.ScalarNode):
                continue  # SafeLoader refuses it
            key = self.construct_object(key_node, deep=True)
            line = key_node.start_mark.line + 1
            if not isinstance(key, str):
                hint = did_you_mean(str(key), [])
                text = f"line {line}: the key {key!r} is not a name{hint}; allowed: text"
                self.problems.append(text)
            elif key in first:
                self.problems.append(
                    f"line {line}: {key} is defined twice (first on line {first[key]}); "
                    "allowed: each key once"
                )
            first.setdefault(key, line)
        if not all(isinstance(key, str) for key in first):
            return {}
        return super().construct_mapping(node, deep=deep)


UniqueKeyLoader.yaml_implicit_resolvers = {
    first: [(tag, rule) for tag, rule in rules if not tag.endswith(":timestamp")]
    for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
UniqueKeyLoader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+0123456789."))


class Text(NamedTuple):
    """What a YAML text holds: `data`, its mapping, and `lines`, the line number (from 1) of each
    key by its dotted path, such as `solver.step`."""

    data: dict
    lines: dict[str, int]


def read(text: str, source: str) -> Text:
    """Parse a YAML text: returns its mapping and the line of each key. Raises `ConfigError` if it
    is not YAML, too large, repeats a key or is no mapping; source: what messages call the text."""
    if len(text) > LARGEST:
        allowed = f"at most {LARGEST}"
        raise ConfigError(source, [f"the file has {len(text)} characters; allowed: {allowed}"])
    try:
        loader = UniqueKeyLoader(text)
        root = loader.get_single_node()
        data = loader.construct_document(root) if root else None
    except (ExcessError, yaml.YAMLError, ValueError, OverflowError, TypeError) as error:
        raise ConfigError(source, [_reading_error(error, text)]) from None
    if loader.problems:
        raise ConfigError(source, loader.problems)
    if not isinstance(data, dict):
        content = f"the file holds {type(data).__name__}; allowed: a mapping of keys"
        raise ConfigError(source, [EMPTY if data is None else content])
    return Text(data, dict(_lines(root)))


def _lines(node: yaml.Node, path: str = "") -> Iterator[tuple[str, int]]:
    for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
        yield (name := join_key(path, str(key.value))), key.start_mark.line + 1
        yield from _lines(value, name)


def parse(text: str, source: str) -> dict:
    """Parse a YAML text: returns its mapping. Raises `ConfigError` with the line if it is not YAML,
    repeats a key or is not a mapping; source: what messages call the text."""
    return read(text, source).data


def _reading_error(error: Exception, text: str) -> str:
    """What is wrong with a text, from what was raised when it was read."""
    if isinstance(error, ExcessError):
        return str(error)
    if isinstance(error, yaml.reader.ReaderError):
        line = text.count("\n", 0, error.position) + 1
        return f"line {line}: the character {chr(error.character)!r} is not text"
    if not isinstance(error, yaml.YAMLError):  # of what makes values of text
        return f"a value cannot be read: {str(error).splitlines()[0]}"
    if not isinstance(error, yaml.MarkedYAMLError):
        return f"this is not YAML: {error}"
    if alias := re.search("undefined alias '(.+)'", str(error.problem)):
        reason = f"*{alias[1]} stands for what &{alias[1]} marks, and nothing above is marked so"
        return (
            f"line {error.problem_mark.line + 1}: {reason}; allowed: the value itself, or "
            f"&{alias[1]} before one above"
        )
    line, reason = why_not_yaml(error, text)
    place = f"line {line}: " if line else ""
    return f"{place}this is not YAML: {reason}"


def restore_types(value: Any) -> Any:
    """Copy a value in which each text, also in lists and mappings, is replaced by what it means as
    YAML, such as "1e9" by a number: Snakemake's `--config` leaves numbers as text. Raises
    `ConfigError` for a text that is no YAML."""
    if isinstance(value, Mapping):
        return {key: restore_types(item) for key, item in value.items()}
    if isinstance(value, list):
        return [restore_types(item) for item in value]
    if isinstance(value, str):
        return parse(f"value: {value}", "--config")["value"] if value else value
    return value


def load(path: str | Path) -> dict:
    """Read the YAML file at `path`: returns its mapping. Raises `ConfigError` for no such file, and
    if it is not YAML, repeats a key or is not a mapping."""
    return read_file(path).data


def read_file(path: str | Path) -> Text:
    """Read the YAML file at `path`: returns its mapping and the line of each key. Raises
    `ConfigError` for no such file, and if it is not YAML, repeats a key or is not a mapping."""
    try:
        return read(read_text(path), str(path))
    except StructureError as error:
        raise ConfigError(error.source, [problem.text for problem in error.problems]) from None


def check_snakemake_arguments(arguments: Sequence[str] | None = None) -> None:
    """Check the files that Snakemake's arguments name (None: the arguments of this process), and
    end the process with status 1 and a message if one cannot be read, is not YAML, or asks for
    Python in it to be run, or if the working folder cannot be written to. Snakemake reads them
    before any rule of ours, tells neither the line of an error nor which file is missing, and would
    run what a key `__use_yte__` holds; so workflow/profiles/default calls this."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--configfile", "--configfiles", nargs="*", default=[], dest="files")
    parser.add_argument("--directory", "-d", default=".")
    options, _ = parser.parse_known_args(arguments)
    try:
        if Path(options.directory).is_dir() and not os.access(options.directory, os.W_OK):
            raise ConfigError(str(Path(options.directory).absolute()), [
                "the folder cannot be written to, where Snakemake keeps its notes and results are; "
                "allowed: another one (`--directory`), or `python -m deployable run FILE --results "
                "FOLDER`"
            ])  # fmt: skip
        for path in options.files:
            if YTE_KEY in load(path):
                raise ConfigError(path, [f"{YTE_KEY}: not allowed; nothing in a config is run"])
    except ConfigError as error:
        print(error, file=sys.stderr)
        sys.exit(1)
