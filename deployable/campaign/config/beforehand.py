"""The files of `snakemake --configfile`, looked at before Snakemake reads them.

It does so before any rule of ours is read, tells neither the line of an error nor which file is
missing, and would run the Python that a file with the key `__use_yte__` holds. A profile is read
earlier still, and may hold Python itself: workflow/profiles/default calls `look`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from deployable.campaign.config.loader import load
from deployable.campaign.errors import ConfigError

_EXECUTED = "__use_yte__"


def look(arguments: Sequence[str] | None = None) -> None:
    """End with status 1 and our own words if a file that Snakemake's arguments name (those of this
    process) cannot be read, is not YAML, or asks for Python in it to be run."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--configfile", "--configfiles", nargs="*", default=[], dest="files")
    try:
        for path in parser.parse_known_args(arguments)[0].files:
            if _EXECUTED in load(path):
                raise ConfigError(path, [f"{_EXECUTED}: not allowed; nothing in a config is run"])
    except ConfigError as error:
        print(error, file=sys.stderr)
        sys.exit(1)
