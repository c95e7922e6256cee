"""What the scripts share: arguments, a log file, and errors without a traceback.

Each script connects files to one function of `campaign`, and runs alone as well; its `--help` lists
its arguments. A config may be given as the name of a YAML file or as JSON.
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))  # also without `pip install`

from campaign.errors import CampaignError


def arguments(description: str) -> argparse.ArgumentParser:
    """A parser that knows `--log`."""
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    parser.add_argument("--log", type=Path, help="file that messages go to as well")
    return parser


def run(
    parser: argparse.ArgumentParser, work: Callable[[argparse.Namespace, Callable], None]
) -> None:
    """Call `work(arguments, tell)`; end with status 1 and a message when it raises."""
    options = parser.parse_args()
    log = None
    if options.log:
        options.log.parent.mkdir(parents=True, exist_ok=True)
        log = options.log.open("w", encoding="utf-8")

    def tell(text: str, file_only: bool = False) -> None:
        if not file_only:
            print(text, file=sys.stderr, flush=True)
        if log:
            print(text, file=log, flush=True)

    try:
        work(options, tell)
    except CampaignError as error:
        tell(f"error: {error}")
        sys.exit(1)
    except Exception:
        tell(traceback.format_exc())
        sys.exit(1)


def sections(text: str) -> dict:
    """Sections of a config: JSON as the workflow passes it, or the name of a YAML file."""
    if text.lstrip().startswith("{"):
        return json.loads(text)
    from campaign.config import load_config

    return load_config([text])
