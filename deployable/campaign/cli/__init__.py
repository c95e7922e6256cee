"""Campaigns in a shell: check them, run them, or one of their stages.

    python -m deployable new FOLDER                     make a folder with a campaign to edit
    python -m deployable check config/paper.yaml        check a file without running anything
    python -m deployable run config/paper.yaml          plan, simulate, bound, draw; no Snakemake
    python -m deployable structure mast.yaml            check a structure, print what it is, draw it
    python -m deployable convert model.xml --to mine.yaml   a structure of a model in MJCF or URDF
    python -m deployable page results/paper --config config/paper.yaml   make the page again
    python -m deployable export results/paper --to glb  a run for ParaView, viewers, spreadsheets

`deployable-intervals` is the same command, where the package is installed.

A stage takes the folder of a campaign's results, `results/<campaign>`, or of one of its rounds, and
the config as a YAML file (or the sections that it needs, as JSON). `keys` prints all keys, `schema`
a JSON Schema of them."""

import argparse
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import wrap_error
from deployable.campaign.folder import Folder
from deployable.campaign.provenance import program
from deployable.campaign.runs.progress import MessagePrinter
from deployable.campaign.stages import OPTIONS, STAGES
from fpm.errors import SceneError

PROGRAM = "deployable-intervals"


def main(arguments: list[str]) -> int:
    """Run the command that the arguments name, those of the shell without the program's name;
    returns the exit status, 0 when all went well."""
    if arguments and arguments[0].endswith((".yaml", ".yml")):
        arguments = ["check", *arguments]
    is_stage = bool(arguments) and arguments[0] in STAGES
    options = _parser(is_stage).parse_args(arguments or ["--help"])
    try:
        return options.act(options)
    except (CampaignError, SceneError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1


def _parser(is_stage: bool = False) -> argparse.ArgumentParser:
    """The parser of all commands, or, for a process that loads what its stage needs, of stages."""
    script = Path(sys.argv[0]).name
    program = PROGRAM if script.startswith(PROGRAM) else "python -m deployable"
    form = argparse.RawTextHelpFormatter
    parser = argparse.ArgumentParser(program, description=__doc__, formatter_class=form)
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and end")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    if not is_stage:
        import_module("deployable.campaign.cli.commands").add_to(commands, command)
    for name, stage in STAGES.items():
        stage_parser = command(commands, name, stage.text, _run_stage)
        stage_parser.set_defaults(stage=stage)
        stage_parser.add_argument("folder", type=Path, help="folder of the results")
        stage_parser.add_argument("--config", required=True, help="YAML file, or sections as JSON")
        for key in stage.options:
            options: Any = OPTIONS[key]
            stage_parser.add_argument(f"--{key}", **options)
        stage_parser.add_argument("--log", type=Path, help="file that messages go to as well")
    return parser


def command(
    commands: argparse._SubParsersAction, name: str, description: str, function: Callable
) -> argparse.ArgumentParser:
    """Add a command to a parser's subcommands, and return its own parser. function: takes the
    parsed options and returns the exit status."""
    text = description.splitlines()[0]
    parser = commands.add_parser(name, help=text, description=text)
    parser.set_defaults(act=function)
    return parser


class _Version(argparse.Action):
    """Prints the version, also of a checkout that was not installed."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        details = program()
        has_commit = details["commit"] != "unknown"
        print(details["program"] + f", commit {details['commit']}" * has_commit)
        parser.exit()


def _run_stage(options: argparse.Namespace) -> int:
    """Run one stage; messages go to the log file too, and errors come without a traceback."""
    log = None
    with suppress(OSError, CampaignError):  # a full disk, say, which the stage tells better
        if options.log:
            options.log.parent.mkdir(parents=True, exist_ok=True)
            log = options.log.open("w", encoding="utf-8")
    notify = MessagePrinter(*filter(None, (sys.stderr, log)))
    values = {key: getattr(options, key) for key in options.stage.options}
    try:
        sections = options.stage.sections_in(options.config, Folder(options.folder))
        options.stage.run(Folder(options.folder), notify, **sections, **values)
    except (CampaignError, SceneError) as error:
        notify(f"error: {error}")
    except Exception as error:  # a fault of the program, which the log should have
        trace = traceback.format_exc()
        if (message := wrap_error(error)) is not None and log:
            log.write(trace)
        notify(f"error: {message}" if message else trace)
    else:
        return 0
    return 1
