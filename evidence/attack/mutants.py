"""Single changes of the code, and whether the tests notice them."""

import ast
import copy
import os
import random
import re
import shutil
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROOMS = {
    "fpm": ("fpm", "structures", "golden"),
    "deployable/intervals": ("intervals", "golden"),
    "deployable/campaign": ("campaign", "report", "export"),
}
"""The code that is changed, and the folders of its tests."""
LEFT_OUT = (
    "*/__main__.py", "*/cli/*", "*/table.py", "*/progress.py",
    "*/campaign/pictures/*", "*/campaign/drawing.py", "*/campaign/results/figures.py",
)  # fmt: skip
"""Command lines, drawings, progress: nothing there changes a number."""
ALL_KINDS = "tests/golden/test_all_kinds.py"
NEAREST = 3
"""Files of tests whose slow ones judge a change, too; kernels are compiled anew for each."""
LIMIT = 900.0
"""Seconds for the tests of a change; one that takes them all is noticed."""


class Hunt:
    """Mutants made so far: file, line, change, and by what it was noticed (None: not)."""

    def __init__(self, seed: int, patterns: tuple[str, ...] = ("*",)):
        self.rng, self.mutants, self._patterns = random.Random(seed), [], patterns
        self._place: Path | None = None
        self._passes: dict[tuple[str, str], bool] = {}

    @property
    def left_out(self) -> list[str]:
        """Files of tests that fail without a change, and so notice none."""
        return sorted({name for (_, name), passes in self._passes.items() if not passes})

    @property
    def count(self) -> int:
        """Number of mutants."""
        return len(self.mutants)

    def try_mutant(self, place: Path) -> None:
        """Change one place of the code in a copy of the checkout, and run the tests there.

        place: the folder of the copy, made once and kept."""
        if self._place != place:
            make_copy(place)
            self._place = place
        name, number = self.rng.choice(all_sites(self._patterns))
        line, change, tree = change_at(parse_file(name), number)
        detectors = self.find_detector(place, place / name, ast.unparse(tree), nearest(name))
        self.mutants.append({"file": name, "line": line, "change": change, "noticed": detectors})

    def find_detector(self, place: Path, path: Path, text: str, tests: list[str]) -> str | None:
        """What notices another text of a file in a copy: the first test that fails, or the time.

        Only files of tests count that pass as the code is."""
        content = path.read_bytes()
        for mark, files in stages(tests):
            self._try_original(place, mark, files)
            sound = [name for name in files if self._passes[mark, name]]
            path.write_text(text, encoding="utf-8")
            try:
                if sound and (detectors := failed_of(place, mark, sound, first=True)):
                    return detectors[0]
            finally:
                path.write_bytes(content)
        return None

    def _try_original(self, place: Path, mark: str, tests: list[str]) -> None:
        """Run files of tests of which it is not known whether they pass as the code is."""
        if new := [name for name in tests if (mark, name) not in self._passes]:
            failures = failed_of(place, mark, new)
            for name in new:
                fails = any(failure == TIME or name in failure for failure in failures)
                self._passes[mark, name] = not fails

    def table(self) -> str:
        """The share noticed, and what was not."""
        detectors = sum(mutant["noticed"] is not None for mutant in self.mutants)
        lines = [f"{detectors} of {self.count} changes of the code were noticed by tests.", ""]
        if self.left_out:
            names = ", ".join(self.left_out)
            lines += [f"Not counted, as they fail without a change: {names}.", ""]
        lines += ["| not noticed | change |", "|---|---|"]
        for mutant in self.mutants:
            if mutant["noticed"] is None:
                lines.append(f"| {mutant['file']}:{mutant['line']} | {mutant['change']} |")
        return "\n".join(lines) + "\n"


def nearest(name: str) -> list[str]:
    """The files of tests for a file of code, those first that mention it most."""
    (folders,) = [tests for room, tests in ROOMS.items() if name.startswith(f"{room}/")]
    stem = Path(name).stem.removesuffix("_kernels")
    words = {stem, stem.title().replace("_", ""), stem.replace("_", " ")}
    rows = []
    for path in (path for folder in folders for path in (ROOT / "tests" / folder).glob("test_*")):
        text = path.read_text(encoding="utf-8")
        count = sum(len(re.findall(re.escape(word), text)) for word in words)
        rows.append((stem not in path.stem, -count, str(path.relative_to(ROOT))))
    return [test for *_, test in sorted(rows)]


def parse_file(name: str) -> ast.Module:
    """The syntax tree of a file of the checkout."""
    return ast.parse((ROOT / name).read_text(encoding="utf-8"))


def all_sites(patterns: tuple[str, ...] = ("*",)) -> list[tuple[str, int]]:
    """Every place that can be changed, in files of these patterns: file, and number in it."""
    names = sorted(str(p.relative_to(ROOT)) for room in ROOMS for p in (ROOT / room).rglob("*.py"))
    files = [
        name
        for name in names
        if any(fnmatch(name, pattern) for pattern in patterns)
        and not any(fnmatch(name, glob) for glob in LEFT_OUT)
    ]
    return [(name, number) for name in files for number in sites(parse_file(name))]


def make_copy(place: Path) -> None:
    """A copy of what the tests need."""
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    for name in ("deployable", "fpm", "evidence", "tests", "config", "workflow", "docs"):
        patterns = shutil.ignore_patterns("*.nb?", "numba-*", "__pycache__")
        shutil.copytree(ROOT / name, place / name, ignore=patterns)
    for name in ("Snakefile", "pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, place)
    (place / "profiles").symlink_to("workflow/profiles")


def stages(tests: list[str]) -> list[tuple[str, list[str]]]:
    """Which tests (a mark of pytest, and files) judge a change, one group after another."""
    groups = [("not slow", tests[:NEAREST]), ("not slow", tests[NEAREST:]),
              ("slow", tests[:NEAREST])]  # fmt: skip
    if ALL_KINDS in tests:  # nothing is compiled for it
        groups.insert(0, ("slow", [ALL_KINDS]))
    return [group for group in groups if group[1]]


TIME = "time"


def failed_of(place: Path, mark: str, tests: list[str], first: bool = False) -> list[str]:
    """Which tests fail in a copy, or only the first; `TIME` where they take too long."""
    option = "-x" if first else "--continue-on-collection-errors"
    try:
        process = run_tests(place, [option, "-m", mark, *tests])
    except subprocess.TimeoutExpired:
        return [TIME]
    if process.returncode in (0, NO_TESTS):
        return []
    failures = [x for x in process.stdout.splitlines() if x.startswith(("FAILED", "ERROR"))]
    text = f"{' '.join(tests)}: {process.stdout[-300:]}"
    return [line.split(" - ")[0] for line in failures] or [text]


NO_TESTS = 5
"""Pytest's status where it finds none."""


def run_tests(place: Path, words: list[str]) -> subprocess.CompletedProcess:
    """Run pytest in a copy; what it compiles is kept there."""
    environment = {**os.environ, "PYTHONPATH": str(place), "PYTHONDONTWRITEBYTECODE": "1"}
    environment["NUMBA_CACHE_DIR"] = str(place / "numba")
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider"]
    return subprocess.run(
        [*command, *words], cwd=place, env=environment, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT, check=False, text=True,
    )  # fmt: skip


_COMPARISONS = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
}  # fmt: skip
_OPERATIONS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
_FUNCTIONS = {"min": "max", "max": "min", "argmin": "argmax", "argmax": "argmin", "any": "all",
           "all": "any", "minimum": "maximum", "maximum": "minimum", "lower": "upper",
           "upper": "lower", "floor": "ceil", "ceil": "floor"}  # fmt: skip


def sites(tree: ast.Module) -> list[int]:
    """Numbers, in the order of `ast.walk`, of the nodes that can be changed."""
    return [
        number
        for number, node in enumerate(ast.walk(tree))
        if isinstance(node, ast.expr) and _change(copy.deepcopy(node))
    ]


def change_at(tree: ast.Module, number: int) -> tuple[int, str, ast.Module]:
    """A copy of a module with one node changed: its line, what, and the changed tree."""
    mutant = copy.deepcopy(tree)
    node = next(node for i, node in enumerate(ast.walk(mutant)) if i == number)
    source = ast.unparse(node)
    _change(node)
    description = f"`{source}` to `{ast.unparse(node)}`".replace("|", "or")
    return node.lineno, description, mutant


def _change(node: ast.AST) -> bool:
    """Change a node itself; whether it was changed."""
    if isinstance(node, ast.Compare) and type(node.ops[0]) in _COMPARISONS:
        node.ops[0] = _COMPARISONS[type(node.ops[0])]()
    elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATIONS and not _is_text(node):
        node.op = _OPERATIONS[type(node.op)]()
    elif isinstance(node, ast.BoolOp):
        node.op = ast.And() if isinstance(node.op, ast.Or) else ast.Or()
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        node.op = ast.UAdd() if isinstance(node.op, ast.USub) else ast.Not()
        if isinstance(node.op, ast.Not):
            node.operand = ast.UnaryOp(ast.Not(), node.operand)
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        node.value = node.value + 1 if node.value in (0, 1) else node.value * 2
    elif isinstance(node, ast.Constant) and type(node.value) is bool:
        node.value = not node.value
    elif isinstance(node, ast.Attribute) and node.attr in _FUNCTIONS:
        node.attr = _FUNCTIONS[node.attr]
    elif isinstance(node, ast.Name) and node.id in _FUNCTIONS and isinstance(node.ctx, ast.Load):
        node.id = _FUNCTIONS[node.id]
    else:
        return False
    return True


def _is_text(node: ast.BinOp) -> bool:
    return any(isinstance(n, ast.JoinedStr) or isinstance(getattr(n, "value", None), str)
               for n in ast.walk(node))  # fmt: skip
