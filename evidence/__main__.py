"""Run a study: ``python -m evidence NAME [--output results/NAME]``; `attack` attacks the program.

The exit status tells whether the study ran, not whether all rows passed: a row that fails stays in
summary.json and table.md as a failing row. ``--strict`` makes failing rows an exit status of 1."""

import argparse
import importlib
import json
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from deployable.campaign.files import write_text
from evidence import results
from evidence.registry import STUDIES, Study


def parser() -> argparse.ArgumentParser:
    """The command line."""
    command = argparse.ArgumentParser(prog="python -m evidence", description=__doc__)
    command.add_argument("study", choices=STUDIES)
    command.add_argument("--output", type=Path, help="folder to write to; results/NAME by default")
    command.add_argument("--quick", action="store_true", help="coarser meshes or shorter runs")
    command.add_argument("--strict", action="store_true", help="fail if a row fails")
    group = command.add_mutually_exclusive_group()
    group.add_argument("--only", nargs="+", metavar="PART", help="measure and tell these parts")
    group.add_argument("--part", help="only measure this part, into OUTPUT/parts/PART.json")
    group.add_argument("--measured", action="store_true", help="tell what OUTPUT/parts/ holds")
    return command


def parse(arguments: list[str]) -> tuple[argparse.Namespace, dict[str, Callable[[bool], Any]]]:
    """The options of a command and the parts of its study that it is about, by name."""
    options = parser().parse_args(arguments)
    study = STUDIES[options.study]
    available = importlib.import_module(f"evidence.{study.name}.study").PARTS
    if options.quick and not study.quick:
        parser().error(f"{study.name} has no quick form")
    names = options.only or ([options.part] if options.part else list(available))
    unknown = [name for name in names if name not in available]
    if unknown:
        parser().error(f"unknown part {unknown[0]!r}; known are: {', '.join(available)}")
    return options, {name: available[name] for name in names}


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line, run, write; returns the exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    if words[:1] == ["attack"]:
        from evidence.attack.attack import main as attack

        return attack(words[1:])
    options, parts = parse(words)
    study = STUDIES[options.study]
    module = importlib.import_module(f"evidence.{study.name}.study")
    folder = options.output or Path("results", study.name)
    answers = read_parts(study, folder) if options.measured else measure(parts, options.quick)
    if options.part:
        text = results.as_json(answers[options.part])
        write_text(folder / "parts" / f"{options.part}.json", text)
        return 0
    return notify(study, module.report(answers), folder, options.strict)


def measure(parts: Mapping[str, Callable[[bool], Any]], quick: bool = False) -> dict[str, Any]:
    """What the parts measure, by name; prints how long each takes."""
    import fpm
    from evidence.linkage.runs import build

    fpm.warm_up(build())  # so that no part is charged for compiling
    answers = {}
    for name, part in parts.items():
        start = time.perf_counter()
        answers[name] = part(quick)
        print(f"{name}: {time.perf_counter() - start:.1f} s", flush=True)
    return answers


def read_parts(study: Study, folder: Path) -> dict[str, Any]:
    """What processes of their own have measured."""
    return {
        name: json.loads((folder / "parts" / f"{name}.json").read_text(encoding="utf-8"))
        for name in study.parts
    }


def notify(study: Study, report: results.Report, folder: Path, strict: bool) -> int:
    """Write the files, print the failing rows; returns the exit status."""
    results.write(folder, study.name, report)
    failures = [row for row in report.rows if row.is_failed]
    for row in failures:
        print(f"failed: {row.name}: {results.cell(row.value)}, {results.expected(row)}")
    print(f"{len(report.rows)} rows, {len(failures)} failed: {folder / 'table.md'}")
    return 1 if strict and failures else 0


if __name__ == "__main__":
    sys.exit(main())
