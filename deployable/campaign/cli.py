"""Campaigns in a shell: check them, run them, or one of their stages.

    python -m deployable new FOLDER                     make a folder with a campaign to edit
    python -m deployable check config/paper.yaml        check a file without running anything
    python -m deployable run config/paper.yaml          plan, simulate, bound, draw; no Snakemake
    python -m deployable structure mast.yaml            check a structure, print what it is, draw it
    python -m deployable page results/paper --config config/paper.yaml   make the page again
    python -m deployable export results/paper --to glb  a run for ParaView, viewers, spreadsheets
    python -m deployable attack --minutes 60            in a checkout: attack it

`deployable-intervals` is the same command, where the package is installed.

A stage takes the folder of a campaign's results, `results/<campaign>`, or of one of its rounds, and
the config as a YAML file (or the sections that it needs, as JSON). `keys` prints docs/config.md.
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from inspect import signature
from pathlib import Path

import fpm
from deployable.campaign.config.check import load_config
from deployable.campaign.config.keys import table
from deployable.campaign.config.read import whole
from deployable.campaign.config.sections import scene_type
from deployable.campaign.errors import CampaignError, ConfigError, of_files
from deployable.campaign.export import COLOURS, KINDS, choose, export
from deployable.campaign.files import read_json, refuse_links, unforeseen
from deployable.campaign.folder import CAMPAIGN, Folder
from deployable.campaign.new import make_folder, starts
from deployable.campaign.pictures.still import SUFFIXES, write_structure
from deployable.campaign.plan.estimate import estimate, runs_there
from deployable.campaign.provenance import program
from deployable.campaign.runs.progress import Teller
from deployable.campaign.stages import STAGES
from deployable.campaign.text.templates import doubt_texts
from deployable.campaign.workflow import run

PROGRAM = "deployable-intervals"
UNMET = 3
"""Exit status of `run --require` where not all of the box meets all requirements."""


def main(arguments: list[str]) -> int:
    """Do what the arguments ask for; the exit status, 0 when all went well."""
    if arguments[:1] == ["attack"] and _evidence_is_there():
        return _attack(arguments[1:])
    if arguments and arguments[0].endswith((".yaml", ".yml")):
        arguments = ["check", *arguments]
    options = _parser().parse_args(arguments or ["--help"])
    return options.act(options)


def _parser() -> argparse.ArgumentParser:

    started = Path(sys.argv[0]).name
    program = PROGRAM if started.startswith(PROGRAM) else "python -m deployable"
    parser = argparse.ArgumentParser(
        program, description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and end")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    def command(name: str, function: Callable) -> argparse.ArgumentParser:
        text = function.__doc__.splitlines()[0]
        made = commands.add_parser(name, help=text, description=text)
        made.set_defaults(act=function)
        return made

    new = command("new", _new)
    new.add_argument("folder", type=Path, metavar="FOLDER", help="folder to make, or to fill")
    new.add_argument(
        "--start", default="panel", metavar="NAME",
        help="campaign or structure to begin with, or the file of a structure (%(default)s)",
    )  # fmt: skip
    new.add_argument("--starts", action=_Starts, nargs=0, help="print the names and end")
    check = command("check", _check)
    check.add_argument(
        "files", metavar="FILE", nargs="*", default=[CAMPAIGN], help=f"YAML file ({CAMPAIGN})"
    )
    whole = command("run", _run)
    whole.add_argument(
        "file", metavar="FILE", nargs="?", default=CAMPAIGN, help="YAML file (%(default)s)"
    )
    whole.add_argument("--results", default="results", help="folder of all results (%(default)s)")
    whole.add_argument("--no-figures", action="store_true", help="draw nothing")
    whole.add_argument(
        "--require", action="store_true",
        help="end with status 3 unless all of the box meets all requirements",
    )  # fmt: skip
    command("keys", _keys)
    structure = command("structure", _structure)
    structure.add_argument("structure", help="file, .yaml or .py (which is run), or known name")
    structure.add_argument("--duration", type=float, default=1.0, help="of a run (%(default)s s)")
    structure.add_argument(
        "--picture", type=Path, help=".png, .svg or .pdf to draw into (exports/<name>.png)"
    )
    structure.add_argument("--no-picture", action="store_true", help="draw nothing")
    _add_export(command("export", _export))
    for name, stage in STAGES.items():
        one = command(name, stage.work)
        one.set_defaults(act=_run_stage, stage=stage)
        one.add_argument("folder", type=Path, help="folder of the results")
        if stage.sections:
            one.add_argument("--config", required=True, help="YAML file, or sections as JSON")
        if name == "simulate":
            one.add_argument("--batch", type=int, default=0, help="number of the batch, from 0")
            one.add_argument("--batches", type=int, default=1, help="number of batches")
            one.add_argument("--processes", type=int, default=1, help="that share the runs")
            one.add_argument(
                "--bundle", type=Path, help="file for the runs, if no folder is shared"
            )
        elif name == "page":
            words = "frames of the runs that move, evenly spread (%(default)s)"
            default = signature(stage.work).parameters["frames"].default
            one.add_argument("--frames", type=int, default=default, help=words)
        elif stage.has_threads:
            one.add_argument("--threads", type=int, default=1, help="that share the runs")
        if name == "bounds":
            one.add_argument("--bundles", nargs="*", type=Path, default=[], help="runs, as files")
        one.add_argument("--log", type=Path, help="file that messages go to as well")
    if _evidence_is_there():
        command("attack", _attack)  # its words never come here
    return parser


def _evidence_is_there() -> bool:
    """Whether there is what judges the program, on which nothing else depends."""
    return all(find_spec(name) is not None for name in ("evidence", "evidence.attack"))


def _attack(arguments: list[str]) -> int:
    """Attack the program with damaged files, kills, full disks and wrong configs, for a time."""
    return import_module("evidence.attack.attack").main(arguments)


def _add_export(export: argparse.ArgumentParser) -> None:
    export.add_argument(
        "what", metavar="RUN",
        help="folder of a campaign's results, a campaign's config, or a structure's file or name",
    )  # fmt: skip
    kinds = "; ".join(f"{name}: {kind.about}" for name, kind in KINDS.items())
    export.add_argument("--to", required=True, choices=KINDS, help=kinds)
    export.add_argument("--run", default="nominal", help="of a folder: nominal, or a run's id")
    export.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE",
        help="a parameter of a config or structure, in its unit; may be repeated",
    )  # fmt: skip
    export.add_argument("--duration", type=float, help="s, of a config's or structure's run")
    export.add_argument("--frames", type=int, help="number of frames, evenly spread")
    export.add_argument(
        "--colour", default="bars", choices=COLOURS, help="of moving pictures (%(default)s)"
    )
    export.add_argument(
        "--trust", action="append", default=[], metavar="FILE",
        help="structure that results may name, and that is read, or run, then; may be repeated",
    )  # fmt: skip
    export.add_argument("--output", type=Path, help="folder (exports, beside a campaign's results)")


class _Version(argparse.Action):
    """Prints the version, also of a checkout that was not installed."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:

        made = program()
        known = made["commit"] != "unknown"
        print(made["program"] + (f", commit {made['commit']}" if known else ""))
        parser.exit()


class _Starts(argparse.Action):
    """Prints what a new folder can start from."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:

        print("\n".join(starts()))
        parser.exit()


def _new(options: argparse.Namespace) -> int:
    """Make a folder with a Snakefile, profiles and a campaign to edit."""
    try:
        make_folder(options.folder, options.start)
    except CampaignError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print(f"Edit {options.folder / CAMPAIGN}, then call snakemake -c2 in {options.folder}")
    return 0


def _check(options: argparse.Namespace) -> int:
    """Check configs without running anything, and say how many runs, how long and how much disk."""
    status = 0
    for path in options.files:
        try:
            campaign = load_config([path])
            takes = estimate(campaign)
        except CampaignError as error:
            print(error if isinstance(error, ConfigError) else f"{path}: {error}", file=sys.stderr)
            status = 1
        else:
            there = runs_there(campaign, Folder(Path("results", campaign.name)))
            print(f"{path}: {campaign.name}, {takes}{there and '; '}{there}")
            for text in campaign.experiment.warnings:
                print(f"{path}: warning: {text}")
            for text in doubt_texts(campaign.experiment.doubts):
                print(f"{path}: {text}")
            if campaign.experiment.scene.file.endswith(".py"):
                print(f"{path}: {campaign.experiment.scene.file} is a program, which was run")
    return status


def _run(options: argparse.Namespace) -> int:
    """Run a whole campaign."""
    try:
        campaign = load_config([options.file])
        if options.require and not campaign.requirements:
            raise CampaignError(f"{options.file} has no requirements; --require needs some")
        run(campaign, options.results, not options.no_figures)
        if options.require and not _are_met(Path(options.results, campaign.name)):
            return UNMET
    except (CampaignError, fpm.SceneError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


def _are_met(path: Path) -> bool:
    """Whether all of the box meets all requirements."""
    return read_json(Folder(path).requirements)["together"]["met"] == "all"


def _keys(options: argparse.Namespace) -> int:
    """Print all keys of a config as a page of Markdown."""
    print(table(whole()), end="")
    return 0


def _structure(options: argparse.Namespace) -> int:
    """Check a structure, print its parameters, parts, mobility and what a run costs, draw it."""
    from fpm.structures.describe import describe

    name = options.structure
    try:
        found = scene_type(name, name if Path(name).suffix else "")
    except fpm.SceneError as error:
        print(error, file=sys.stderr)
        return 1
    if name.endswith(".py"):
        print(f"{name} is a program, which was run")
    print(describe(found, options.duration))
    if options.no_picture:
        return 0

    path = options.picture or Path("exports", f"{found.name}.png")
    if path.suffix not in SUFFIXES:
        print(f"--picture {path} is not allowed; allowed: {', '.join(SUFFIXES)}", file=sys.stderr)
        return 1
    try:
        print(f"\npicture       {write_structure(found.build(), path)}")
    except OSError as error:
        print(f"error: {of_files(error, path.parent)}", file=sys.stderr)
        return 1
    return 0


def _export(options: argparse.Namespace) -> int:
    """Write a run for other programs: ParaView, glTF, a moving picture, CSV."""
    settings = dict(pair.partition("=")[::2] for pair in options.set)
    place = options.output or Path("exports")
    try:
        chosen = choose(options.what, options.run, settings, options.duration, options.trust)
        if chosen.folder and not options.output:
            place = chosen.folder / "exports"
        paths = export(chosen, options.to, place, options.frames, options.colour)
    except (CampaignError, fpm.SceneError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except Exception as error:  # a damaged result, a full disk
        if (told := of_files(error, place) or unforeseen(error)) is None:
            raise
        print(f"error: {told}", file=sys.stderr)
        return 1
    print("\n".join(map(str, paths)))
    return 0


def _run_stage(options: argparse.Namespace) -> int:
    """Run one stage; messages go to the log file too, and errors come without a traceback."""
    log = None
    with suppress(OSError, CampaignError):  # a full disk, say, which the stage tells better
        if options.log:
            refuse_links(Folder(options.folder).whole)
            options.log.parent.mkdir(parents=True, exist_ok=True)
            log = options.log.open("w", encoding="utf-8")

    tell = Teller(*filter(None, (sys.stderr, log)))
    keys = ("batch", "batches", "processes", "threads", "bundle", "bundles", "frames")
    more = {key: getattr(options, key) for key in keys if hasattr(options, key)}
    try:
        sections = _sections(options)
        options.stage.run(Folder(options.folder), tell, **sections, **more)
    except (CampaignError, fpm.SceneError) as error:
        tell(f"error: {error}")
    except Exception as error:  # a fault of the program, which the log should have
        where = traceback.format_exc()
        if (told := unforeseen(error)) is not None and log:
            log.write(where)
        tell(f"error: {told}" if told else where)
    else:
        return 0
    return 1


def _sections(options: argparse.Namespace) -> dict:
    """The stage's sections: from JSON as the workflow passes it, or from a YAML file."""
    if not options.stage.sections:
        return {}
    if options.config.lstrip().startswith("{"):
        try:
            return options.stage.typed(json.loads(options.config))
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            text = f"--config is no JSON of the sections that the stage needs: {error!r}"
            raise CampaignError(text) from None

    return options.stage.sections_of(load_config([options.config]))
