"""Edits of single places of the program or of a structure's own files, after which a campaign that
was run before is run again: it must be the campaign that is run from scratch.

Edits are those of `mutants`, in functions that the campaign calls, and in a copy of the program."""

import ast
import json
import os
import random
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any

from evidence.attack.mutants import change_at, make_copy, sites

RAW = {
    "solver": {"duration": 0.004, "instants": 9},
    "intervals": {"a": {"nominal": 0.035, "relative": 0.01}},
    "responses": {
        "BD": {"distance": ["B", "D"]},
        "acceleration": {"acceleration": "B", "component": "z"},
        "opening": {"opening": "A"},
        "rate": {"opening_rate": "A"},
        "moment": {"joint_moment": "A"},
        "force": {"section_force": "AB", "at": 0.5, "component": "axial"},
        "constraint": {"constraint_force": "A", "component": "norm"},
        "stress": {"stress": "all"},
        "clearance": {"clearance": ["AB", "CD"]},
    },
    "quantities": {"top": {"largest": "BD"}, "worst": {"largest": "stress"}},
}
FIT_SECTIONS = {"design": {"method": "tensor_roots", "order": 1}, "held_out": 1}
SCAN_SECTIONS = {"design": {"method": "sobol", "samples": 3}, "held_out": 0}
CAMPAIGNS = {
    "kept-whole": {**RAW, **FIT_SECTIONS, "jobs": {"group": 2}},
    "kept-responses": {**RAW, **FIT_SECTIONS, "jobs": {"keep": "responses", "group": 2}},
    "kept-extremes": {**RAW, **SCAN_SECTIONS, "jobs": {"keep": "extremes", "group": 2}},
}
"""Each way to keep runs, with what is always recorded and what is recorded on request."""


class Edits:
    """A copy of the program at `place`, and campaigns that it has run. Of an edit there comes file,
    line, change, how many runs were simulated again, whether numbers changed, and `stale`, where
    they were not those from scratch."""

    def __init__(self, place: Path, seed: int):
        self.place, self.rng = place, random.Random(seed)
        make_copy(place)
        self.structure = place / "structure"
        self.structure.mkdir()
        shutil.copy(place / "config/structures/bennett.yaml", self.structure)
        child = [sys.executable, str(Path(__file__).with_name("edits_child.py"))]
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        self._child = subprocess.Popen(
            [*child, str(place)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
            env=environment,
        )  # fmt: skip
        _, functions = self._run("first", compiled=True)
        (self.base,), calls = self._run("base", calls=True)
        if "failed" in self.base["numbers"]:
            raise RuntimeError(self.base["numbers"]["failed"])
        self._executed_code = {tuple(item) for item in functions + calls}

    def close(self) -> None:
        """End the process that runs campaigns."""
        self._child.stdin.close()
        self._child.wait(60)

    def _run(
        self, *folders: str, prefix: str = "", cache: str = "numba", **options: Any
    ) -> tuple[list[dict[str, Any]], list]:
        """What the campaigns give in some folders, and the functions that were called or compiled.

        cache: the folder for what is compiled; options: what else is asked of the process."""
        values = {"elements": 2, "E": 1e9}
        scene = {"file": str(self.structure / "bennett.yaml"), "parameters": values}
        raws = [
            {**raw, "campaign": name, "scene": scene}
            for name, raw in CAMPAIGNS.items()
            if name.startswith(prefix)
        ]
        places = [str(self.place / folder) for folder in folders]
        request = {"folders": places, "raws": raws, "cache": str(self.place / cache), **options}
        self._child.stdin.write(json.dumps(request) + "\n")
        self._child.stdin.flush()
        answer = json.loads(self._child.stdout.readline())
        return answer["found"], answer["calls"]

    @cached_property
    def places(self) -> dict[str, list[tuple[str, int]]]:
        """Places that can be changed, by folder, in files of which something is called: file, and
        number in it."""
        places: dict[str, list[tuple[str, int]]] = {}
        for name in sorted({name for name, _ in self._executed_code}):
            if name.startswith(ROOMS):
                tree = ast.parse((self.place / name).read_text(encoding="utf-8"))
                lines = self._lines(name, tree)
                nodes = dict(enumerate(ast.walk(tree)))
                numbers = [(name, n) for n in sites(tree) if nodes[n].lineno in lines]
                if numbers:
                    places.setdefault(str(Path(name).parent), []).extend(numbers)
        return places

    def _lines(self, name: str, tree: ast.Module) -> set[int]:
        """Lines of functions that were called, or of none."""
        inner, lines = set(), set()
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.Lambda):
                span = set(range(node.lineno, node.end_lineno + 1))
                inner |= span
                first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))])
                lines |= span if (name, first) in self._executed_code else set()
        return lines | (set(range(tree.body[-1].end_lineno + 1)) - inner)

    def draw(self, is_kernel: bool = False) -> tuple[str, int]:
        """A place of any folder, each as likely; is_kernel: of KERNELS, else of none of these."""
        rooms = [room for room in sorted(self.places) if room.startswith(KERNELS) == is_kernel]
        return self.rng.choice(self.places[self.rng.choice(rooms)])

    def text(self, name: str, number: int) -> tuple[str, dict[str, Any]]:
        """The text of a file in which a place is changed; file, line and change."""
        line, change, tree = change_at(ast.parse((self.place / name).read_bytes()), number)
        return ast.unparse(tree), {"file": name, "line": line, "change": change}

    def try_edit(self, name: str, number: int) -> dict[str, Any]:
        """Change a place, and compare what a campaign, any of them, gives that was run before with
        what it gives from scratch."""
        text, record = self.text(name, number)
        return record | self.compare_texts({name: text}, self.rng.choice(sorted(CAMPAIGNS)))

    def compare_texts(self, texts: dict[str, str], prefix: str = "") -> dict[str, Any]:
        """The same for files that have other texts; prefix: of one campaign."""
        shutil.rmtree(self.place / "again", ignore_errors=True)
        shutil.copytree(self.place / "base", self.place / "again")
        with self._restore(texts):
            for name, text in texts.items():
                (self.place / name).write_text(text, encoding="utf-8")
            old, new = self._compare("again", texts, prefix=prefix)
        return {
            "simulated": old["simulated"],
            "changed": not new["numbers"].items() <= self.base["numbers"].items(),
            # A program that fails where a folder is, or is not, there yet left nothing old.
            "stale": [] if _has_only_errors(old, new) else _changed_names(old, new),
        }

    def session(
        self, texts: dict[str, str], imports: Sequence[str], runs: int, holds: bool = False
    ) -> dict[str, Any]:
        """One Python session in which files get other texts, after modules were imported and a
        campaign was run so many times, and that runs it once more; `holds` its config, checked.

        `says` is what that gives: "new", as from scratch, the error that refuses it, or "old".
        `stale` is what a fresh process does not make anew after that."""
        whole, folders = {"prefix": "kept-whole", "whole": True}, ["session"] * (runs + 1)
        for name in ("session", "numba-session"):
            shutil.rmtree(self.place / name, ignore_errors=True)
        shutil.copytree(self.place / "numba", self.place / "numba-session")
        edits = {str(self.place / name): text for name, text in texts.items()}
        with self._restore(texts):
            answers, _ = self._run(
                *folders, **whole, cache="numba-session", texts=edits, after=runs,
                imports=imports, holds=holds,
            )  # fmt: skip
            old, new = self._compare("session", texts, cache="numba-session", **whole)
        last = (answers or [NO_ANSWER])[-1]
        says = last["numbers"].get("failed", "old") if _changed_names(last, new) else "new"
        return {"says": says, "stale": _changed_names(old, new)}

    @contextmanager
    def _restore(self, names: Iterable[str]) -> Iterator[None]:
        """Have some files as they were in the end, whoever changes them."""
        paths = [self.place / name for name in names]
        originals = [(path, path.read_bytes(), path.stat()) for path in paths]
        try:
            yield
        finally:
            for path, content, stat in originals:
                path.write_bytes(content)
                os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))

    def _compare(
        self, folder: str, names: Iterable[str], cache: str = "numba", **options: Any
    ) -> list[dict[str, Any]]:
        """What campaigns give in a folder that has been, and in one from scratch, after files of
        these names were edited.

        From scratch means that nothing is compiled, too, if one of them is. What is compiled then
        serves the other one as well, but never in the place of what has been compiled before."""
        shutil.rmtree(self.place / "scratch", ignore_errors=True)
        if not any(name.startswith(KERNELS) for name in names):
            return self._run(folder, "scratch", cache=cache, **options)[0] or [NO_ANSWER] * 2
        for name in ("numba-old", "numba-new"):
            shutil.rmtree(self.place / name, ignore_errors=True)
        new, _ = self._run("scratch", cache="numba-new", **options)
        shutil.copytree(self.place / cache, self.place / "numba-old")
        for cache_folder in (self.place / "numba-new").glob("numba-*"):  # named after a digest
            if not (self.place / "numba-old" / cache_folder.name).exists():
                shutil.copytree(cache_folder, self.place / "numba-old" / cache_folder.name)
        answers, _ = self._run(folder, cache="numba-old", **options)
        (old,), (new,) = answers or [NO_ANSWER], new or [NO_ANSWER]
        if _changed_names(old, new):  # an index may be beyond an array now, where anything may lie
            shutil.rmtree(self.place / "scratch", ignore_errors=True)
            (repeat,) = self._run("scratch", cache="numba-new", **options)[0] or [NO_ANSWER]
            for name in _changed_names(new, repeat):
                old["numbers"].pop(name, None), new["numbers"].pop(name, None)
        return [old, new]


def _has_only_errors(old: dict, new: dict) -> bool:
    """Whether nothing comes from scratch but an error, and runs that were there were made again."""
    fails = set(new["numbers"]) == {"failed"}
    return fails and bool(old["simulated"]) and all(old["simulated"].values())


def _changed_names(first: dict, second: dict) -> list[str]:
    """Names of the numbers that differ."""
    return sorted({key for key, _ in first["numbers"].items() ^ second["numbers"].items()})


NO_ANSWER = {"numbers": {}, "simulated": {}}
"""Of a process that did not end."""

ROOMS = (
    "fpm/", "deployable/intervals/", "deployable/campaign/config/",
    "deployable/campaign/plan/", "deployable/campaign/runs/", "deployable/campaign/samples/",
)  # fmt: skip
"""Where something decides about runs, or what is kept of them."""

KERNELS = ("fpm/kernels", "fpm/elements")
"""Where something is compiled: anew for every edit."""
