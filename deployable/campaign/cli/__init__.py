"""Bound the motion of deployable structures whose parameters are intervals."""

import argparse
import logging
import re
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.provenance import program
from deployable.campaign.runs.progress import LOGGER, MessagePrinter
from deployable.campaign.stages import OPTIONS, STAGES
from fpm.errors import SceneError, did_you_mean

PROGRAM = "deployable"

GROUPS = {
    "campaigns": ("new", "check", "run", "compare", "export"),
    "structures": ("structure", "convert"),
    "reference": ("schema",),
    "stages, which `run` calls one after another": tuple(STAGES),
}
"""Commands by what they are about, as the help lists them."""

EXAMPLES = """examples:
  {program} new mine --start panel      make the folder `mine` with a campaign to edit
  cd mine && {program} check            tell how many runs the campaign takes
  {program} run                         make its results, results/panel/report.html first
  {program} export results/panel --to glb
  {program} structure bennett           describe and draw a structure of the library

`{program} COMMAND --help` lists the options of a command."""


def main(arguments: list[str]) -> int:
    """Run the command that the arguments name, those of the shell without the program's name;
    returns the exit status, 0 when all went well."""
    if arguments and arguments[0].endswith((".yaml", ".yml")):
        arguments = ["check", *arguments]
    if arguments[:1] == ["help"]:
        arguments = [*arguments[1:], "--help"]
    is_stage = bool(arguments) and arguments[0] in STAGES
    parser, names = _parser(is_stage), [name for group in GROUPS.values() for name in group]
    if arguments and arguments[0] not in names and not arguments[0].startswith("-"):
        hint = did_you_mean(arguments[0], names)
        parser.error(f"there is no command {arguments[0]!r}{hint}; allowed: {', '.join(names)}")
    options, rest = parser.parse_known_args(arguments or ["--help"])
    if rest:
        allowed = {*re.findall(r"(?<!\w)--?\w[\w-]*", options.parser.format_help())}
        words = sorted(word for word in allowed if word.startswith("--"))
        text = f"there is no option {rest[0]}{did_you_mean(rest[0], words)}"
        text = text if rest[0].startswith("-") else f"{rest[0]} is one word too many"
        if rest[0].partition("=")[0] in allowed:
            text = f"{rest[0]} belongs behind the command: `{options.parser.prog} {rest[0]} ...`"
        options.parser.error(f"{text}; allowed: {', '.join(words)}")
    LOGGER.setLevel(options.level)
    try:
        return options.act(options)
    except (CampaignError, SceneError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1


class _Parser(argparse.ArgumentParser):
    """A parser that says what is likely meant by a word that is not a choice."""

    def error(self, message: str) -> NoReturn:
        match = re.search(r"invalid choice: '([^']*)' \(choose from (.*)\)", message)
        hint = did_you_mean(match[1], re.findall(r"[\w-]+", match[2])) if match else ""
        super().error(message + hint)


def _parser(is_stage: bool = False) -> argparse.ArgumentParser:
    """Make the parser of all commands; is_stage: of the stages alone, to load only these."""
    script = Path(sys.argv[0]).name
    program = PROGRAM if script.startswith(PROGRAM) else "python -m deployable"
    parser = _Parser(
        program, usage="%(prog)s [-h] [--version] COMMAND ...", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument(
        "--version", action=Print, nargs=0, const=_version, help="print the version and exit"
    )
    commands = parser.add_subparsers(
        metavar="COMMAND", required=True, prog=program, help=argparse.SUPPRESS
    )
    if not is_stage:
        import_module("deployable.campaign.cli.commands").add_to(commands, command, Print)
    for name, stage in STAGES.items():
        stage_parser = command(commands, name, stage.text, _run_stage)
        stage_parser.set_defaults(stage=stage)
        stage_parser.add_argument("folder", type=Path, help="folder of the results")
        stage_parser.add_argument("--config", required=True, help="YAML file, or sections as JSON")
        for key in stage.options:
            options: Any = OPTIONS[key]
            stage_parser.add_argument(f"--{key}", **options)
        stage_parser.add_argument("--log", type=Path, help="file that messages go to as well")
    texts = {name: parser.description for name, parser in commands.choices.items()}
    parser.epilog = "\n\n".join([
        *("\n".join([f"{title}:", *(f"  {name:<10} {texts[name]}" for name in names)])
          for title, names in GROUPS.items() if texts.keys() >= {*names}),
        EXAMPLES.format(program=program),
    ])  # fmt: skip
    return parser


def command(
    commands: argparse._SubParsersAction, name: str, description: str, function: Callable
) -> argparse.ArgumentParser:
    """Add a command to a parser's subcommands, and return its own parser. function: takes the
    parsed options and returns the exit status."""
    parser = commands.add_parser(name, description=description.splitlines()[0])
    parser.set_defaults(act=function, level=logging.INFO, parser=parser)
    group = parser.add_mutually_exclusive_group()
    quiet = "quiet", logging.WARNING, "print no progress, but warnings and errors"
    for word, level, text in (quiet, ("verbose", logging.DEBUG, "print what each stage takes")):
        options: Any = {"action": "store_const", "const": level, "dest": "level", "help": text}
        group.add_argument(f"-{word[0]}", f"--{word}", **options)
    return parser


class Print(argparse.Action):
    """Prints the text that the function `const` returns, and ends the program."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        function: Any = self.const
        print(function())
        parser.exit()


def _version() -> str:
    """Return the version, also of a checkout that was not installed."""
    details = program()
    return details["program"] + f", commit {details['commit']}" * (details["commit"] != "unknown")


def _run_stage(options: argparse.Namespace) -> int:
    """Run one stage; messages go to the log file too, and errors come without a traceback."""
    log = None
    with suppress(OSError, CampaignError):  # a full disk, say, which the stage tells better
        if options.log:
            options.log.parent.mkdir(parents=True, exist_ok=True)
            log = options.log.open("w", encoding="utf-8")
    notify = MessagePrinter(*filter(None, (sys.stderr, log)))
    values = {key: getattr(options, key) for key in options.stage.options}
    names, folder = [*STAGES], Folder(options.folder)
    first_stage = names.index(values.pop("since", None) or options.stage.name)
    try:
        for name in names[first_stage : names.index(options.stage.name) + 1]:
            sections = STAGES[name].sections_in(options.config, folder)
            stage_values = {key: values[key] for key in STAGES[name].options if key in values}
            STAGES[name].run(folder, notify, **sections, **stage_values)
    except (CampaignError, SceneError) as error:
        notify(f"error: {error}")
    except Exception:  # a fault of the program, which the log should have
        notify(f"error: {traceback.format_exc()}")
    else:
        return 0
    return 1
