"""The commands that are about whole campaigns and structures, not about one stage (`cli`)."""

import argparse
import json
import logging
import math
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import fpm
from deployable.campaign.answers.estimate import describe_work, estimate
from deployable.campaign.cli.new import list_starts, make_folder
from deployable.campaign.config import read
from deployable.campaign.config.cases import variants
from deployable.campaign.config.check import load_config, locate
from deployable.campaign.config.measured import measured_warnings
from deployable.campaign.config.plausible import requirement_warnings
from deployable.campaign.config.sections import scene_type
from deployable.campaign.config.units import number_in
from deployable.campaign.convert import convert
from deployable.campaign.errors import CampaignError, ConfigError
from deployable.campaign.export import COLOURS, FORMATS, choose
from deployable.campaign.export import export as write_export
from deployable.campaign.files import read_json, write_text
from deployable.campaign.folder import CAMPAIGN, Folder
from deployable.campaign.pictures.drawing import SUFFIXES, write_structure
from deployable.campaign.plan.plan import errors_of_results
from deployable.campaign.results.figures import overlay
from deployable.campaign.results.templates import doubt_texts, summary_text
from deployable.campaign.runs.progress import MessagePrinter
from deployable.campaign.stages.workflow import Workflow, complete
from fpm.arithmetic.units import number_hint
from fpm.structures.describe import describe
from fpm.structures.text_file import schema

UNMET = 3  # exit status of `run --require` where not all of the box meets all requirements


def add_to(commands: argparse._SubParsersAction, command: Callable, printer: type) -> None:
    """Add the commands on campaigns and structures to a parser's subcommands, by the function
    `command`; printer: action that prints what its `const` returns."""
    new = command(commands, "new", _new.__doc__, _new)
    new.add_argument("folder", type=Path, metavar="FOLDER", help="folder to make, or to fill")
    new.add_argument(
        "--start", default="panel", metavar="NAME",
        help="campaign or structure to begin with, or the file of a structure (%(default)s)",
    )  # fmt: skip
    new.add_argument(
        "--starts", action=printer, nargs=0, const=lambda: "\n".join(list_starts()),
        help="print the names and end",
    )  # fmt: skip
    check = command(commands, "check", _check.__doc__, _check)
    check.add_argument(
        "files", metavar="FILE", nargs="*", default=[CAMPAIGN], help=f"YAML file ({CAMPAIGN})"
    )
    check.add_argument("--json", action="store_true", help="print JSON, for editors")
    whole = command(commands, "run", _run.__doc__, _run)
    whole.add_argument(
        "file", metavar="FILE", nargs="?", default=CAMPAIGN, help="YAML file (%(default)s)"
    )
    whole.add_argument("--results", default="results", help="folder of all results (%(default)s)")
    whole.add_argument("--no-figures", action="store_true", help="draw nothing")
    whole.add_argument(
        "--require", action="store_true",
        help="end with status 3 unless all of the box meets all requirements",
    )  # fmt: skip
    keys = command(commands, "schema", _schema.__doc__ or "", _schema)
    keys.add_argument("of", nargs="?", choices=["campaign", "structure"], default="campaign")
    structure = command(commands, "structure", _structure.__doc__, _structure)
    structure.add_argument("structure", help="a file, .yaml, or the name of one that is shipped")
    structure.add_argument(
        "--duration", type=_seconds, default=1.0, help="of a run (%(default)s s)"
    )
    structure.add_argument(
        "--picture", type=Path, help=".png, .svg or .pdf to draw into (exports/<name>.png)"
    )
    structure.add_argument("--no-picture", action="store_true", help="draw nothing")
    convert = command(commands, "convert", _convert.__doc__, _convert)
    convert.add_argument(
        "model", type=Path, metavar="MODEL", help="file of the model, MJCF or URDF"
    )
    convert.add_argument(
        "--to", required=True, type=Path, metavar="FILE", help="file to make, .yaml"
    )
    convert.add_argument(
        "--keyframe", default="", help="of the model, at which the structure starts"
    )
    compare = command(commands, "compare", _compare.__doc__, _compare)
    compare.add_argument("folders", metavar="RESULTS", nargs="+", help="folders of results")
    compare.add_argument("--json", action="store_true", help="print JSON")
    compare.add_argument("--html", type=Path, metavar="FILE", help="write a page with curves")
    export = command(commands, "export", _export.__doc__, _export)
    export.add_argument(
        "what", metavar="RUN",
        help="folder of a campaign's results, a campaign's config, or a structure's file or name",
    )  # fmt: skip
    kinds = "; ".join(f"{name}: {kind.summary}" for name, kind in FORMATS.items())
    export.add_argument("--to", required=True, choices=FORMATS, help=kinds)
    export.add_argument("--run", default="nominal", help="of a folder: nominal, or a run's id")
    export.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE",
        help="a parameter, in its unit or with one, such as 'k=2 N/mm'; may be repeated",
    )  # fmt: skip
    export.add_argument(
        "--duration", type=_seconds, help="of a config's or structure's run, such as 2, or 2 s"
    )
    export.add_argument("--frames", type=int, help="number of frames, evenly spread")
    export.add_argument(
        "--colour", default="bars", choices=COLOURS, help="of moving pictures (%(default)s)"
    )
    export.add_argument("--output", type=Path, help="folder (exports, beside a campaign's results)")


def _new(options: argparse.Namespace) -> int:
    """Make a folder with a Snakefile, profiles and a campaign to edit."""
    make_folder(options.folder, options.start)
    print(f"Edit {options.folder / CAMPAIGN}, then call snakemake -c2 in {options.folder}")
    return 0


def _check(options: argparse.Namespace) -> int:
    """Check configs without running anything, and say how many runs, how long and how much disk."""
    reports: list[dict[str, Any]] = []
    for path in options.files:
        report: dict[str, Any] = {"file": path, "work": [], "warnings": [], "problems": []}
        reports.append(report)
        try:
            for key, text in _check_texts(path):
                report[key].append(text)
                if not options.json and (key == "warnings" or options.level < logging.WARNING):
                    print(f"{path}: {text}")
        except CampaignError as error:
            report["problems"] = getattr(error, "problems", [str(error)])
            if not options.json:
                prefix = "" if isinstance(error, ConfigError) else f"{path}: "
                print(f"{prefix}{error}", file=sys.stderr)
    if options.json:
        print(json.dumps(reports, indent=2))
    return int(any(report["problems"] for report in reports))


def _check_texts(path: str) -> Iterator[tuple[str, str]]:
    """Yield the kind and text of each line that `check` prints about the config at `path`."""
    campaign = load_config([path])
    if campaign.cases:
        yield "work", f"{campaign.name}, {len(campaign.cases)} cases, {estimate(campaign)}"
    workflow = Workflow(campaign)
    workflow.stale()
    for text in workflow.describe_foreign_results():
        yield "warnings", f"warning: {text}"
    folder = Path("results", campaign.name * bool(campaign.cases))
    for case, variant in variants(campaign):
        experiment = variant.experiment
        yield "work", f"{case}{describe_work(Workflow(variant, folder))}"
        texts = [*experiment.warnings, *requirement_warnings(variant)]
        for text in [*texts, *measured_warnings(variant)]:
            yield "warnings", f"{case}warning: {locate(text, campaign.lines)}"
        for text in doubt_texts(experiment.doubts):
            yield "warnings", f"{case}{text}"


def _run(options: argparse.Namespace) -> int:
    """Run a whole campaign."""
    campaign = load_config([options.file])
    if options.require and not any(variant.requirements for _, variant in variants(campaign)):
        raise CampaignError(f"{options.file} has no requirements; --require needs some")
    folder = Path(options.results, campaign.name * bool(campaign.cases))
    for prefix, variant in variants(campaign):
        with suppress(OSError):  # the run itself reports it in more detail
            text = describe_work(Workflow(variant, folder), not options.no_figures)
            MessagePrinter(sys.stderr)(f"{prefix}{text}")
    complete(campaign, options.results, not options.no_figures)
    answer = Path(
        options.results, campaign.name, f"{'cases' if campaign.cases else 'requirements'}.json"
    )
    return UNMET if options.require and read_json(answer)["together"]["met"] != "all" else 0


def _compare(options: argparse.Namespace) -> int:
    """Compare results side by side, in the units that the first campaign displays; JSON in SI."""
    from deployable.campaign.report.page import render_cases  # 0.1 s, for this command alone
    from deployable.campaign.results.compare import compare

    if options.html and options.html.suffix not in (".html", ".htm"):
        raise CampaignError(f"--html {options.html}; allowed: the name of a page, such as all.html")
    texts = []
    for is_shown in [True] * bool(options.html or not options.json) + [False] * options.json:
        with errors_of_results(*map(Folder, options.folders)):
            facts, curves = compare(options.folders, is_shown)
        for row, path in zip(facts["cases"], options.folders, strict=True):
            row["folder"] = os.path.relpath(path, options.html.parent if options.html else ".")
        if is_shown and options.html:
            write_text(options.html, render_cases(facts, map(overlay, curves.values())))
        texts.append(
            summary_text(facts, "cases.md.jinja") if is_shown else json.dumps(facts, indent=2)
        )
    print(texts[-1])
    return 0


def _schema(options: argparse.Namespace) -> int:
    """Print the JSON Schema of a campaign's config, or of a structure, for editors."""
    print(json.dumps((schema if options.of == "structure" else read.schema)(), indent=1))
    return 0


def _seconds(text: str) -> float:
    with suppress(ValueError, TypeError):
        seconds = float(number_in("s", text))
        if 0 < seconds < math.inf:
            return seconds
    raise argparse.ArgumentTypeError(
        f"{text!r} is not allowed{number_hint(text)}; allowed: a time above 0, as 2 or 2 s"
    )


def _structure(options: argparse.Namespace) -> int:
    """Check a structure, print its parameters, parts, mobility and what a run costs, draw it."""
    name = options.structure
    try:
        structure = scene_type(name, name if Path(name).suffix else "")
    except fpm.SceneError as error:
        text = f"structure {name!r} is not known; allowed: a file, or {error.allowed}"
        print(text if error.key == "scene.name" else error, file=sys.stderr)
        return 1
    print(describe(structure, options.duration))
    if options.no_picture:
        return 0
    path = options.picture or Path("exports", f"{structure.name}.png")
    if path.suffix not in SUFFIXES:
        print(f"--picture {path} is not allowed; allowed: {', '.join(SUFFIXES)}", file=sys.stderr)
        return 1
    with errors_of_results(Folder(path.parent)):
        print(f"\npicture       {write_structure(structure.build(), path)}")
    return 0


def _convert(options: argparse.Namespace) -> int:
    """Write an MJCF or URDF model as the file of a structure, and print what is not taken."""
    print("\n".join([*convert(options.model, options.to, options.keyframe), str(options.to)]))
    return 0


def _export(options: argparse.Namespace) -> int:
    """Write a run for other programs: ParaView, glTF, a moving picture, CSV."""
    settings = dict(pair.partition("=")[::2] for pair in options.set)
    place = options.output or Path("exports")
    with errors_of_results(Folder(place), Folder(Path(options.what))):
        selection = choose(options.what, options.run, settings, options.duration)
        if selection.folder and not options.output:
            place = selection.folder / "exports"
        paths = write_export(selection, options.to, place, options.frames, options.colour)
    print("\n".join(map(str, paths)))
    return 0
