"""The YAML of configs: their values, with the lines of keys, or all that is wrong."""

import argparse
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from deployable.campaign.errors import ConfigError
from deployable.campaign.folder import CAMPAIGN
from fpm.structures.reading import Node, Problems, StructureError, join_key, read_text
from fpm.structures.reading import read as read_yaml

NAMES = ("campaign",)  # keys whose values are text, such as 007
YTE_KEY = "__use_yte__"  # key of a file whose Python Snakemake would run


class Text(NamedTuple):
    """What a YAML text holds: `data`, its mapping, and `lines`, the line number (from 1) of each
    key by its dotted path, such as `solver.step`."""

    data: dict
    lines: dict[str, int]


def read(text: str, source: str) -> Text:
    """Parse a YAML text: returns its mapping and the line of each key. Raises `ConfigError` if it
    is not YAML, too large, repeats a key or is not a mapping; source: what messages call the
    text."""
    try:
        root = read_yaml(text, Problems(source), is_typed=True, names=NAMES)
    except StructureError as error:
        raise ConfigError(source, [*map(str, error.problems)]) from None
    table: Any = root.plain
    return Text(table, dict(_lines(root)))


def _lines(node: Node, path: str = "") -> Iterator[tuple[str, int]]:
    for name, line in node.lines.items():
        yield (key := join_key(path, name)), line
        yield from _lines(node.entries[name], key)


def restore_types(value: Any) -> Any:
    """Copy a value in which each text is replaced by what it means as YAML, such as "1e9" by a
    number: Snakemake's `--config` leaves numbers as text. Raises `ConfigError`."""
    if isinstance(value, Mapping):
        pairs = value.items()
        return {key: item if key in NAMES else restore_types(item) for key, item in pairs}
    if isinstance(value, list):
        return [restore_types(item) for item in value]
    if isinstance(value, str):
        return read(f"value: {value}", "--config").data["value"] if value else value
    return value


def read_file(path: str | Path) -> Text:
    """Read the YAML file at `path`: returns its mapping and the line of each key. Raises
    `ConfigError` for no such file, and if it is not YAML, repeats a key or is not a mapping."""
    try:
        text = read_text(path)
    except StructureError as error:
        is_default = str(path) == CAMPAIGN and not Path(path).exists()
        remedy = " (it is read where no other file is named)" * is_default
        raise ConfigError(error.source, [f"{x}{remedy}" for x in error.problems]) from None
    return read(text, str(path))


def check_snakemake_arguments(arguments: Sequence[str] | None = None) -> None:
    """Check the files that Snakemake's arguments name (None: of this process) before it reads them,
    since it tells neither line nor missing file and would run what `__use_yte__` holds: end the
    process with status 1 and a message if one cannot be read or asks for that, or if the working
    folder cannot be written to. Called by workflow/profiles/default."""
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
            if YTE_KEY in read_file(path).data:
                raise ConfigError(path, [f"{YTE_KEY}: not allowed; nothing in a config is run"])
    except ConfigError as error:
        print(error, file=sys.stderr)
        sys.exit(1)
