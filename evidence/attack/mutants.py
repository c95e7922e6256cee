"""Single changes of the code, and whether the tests notice them."""

from __future__ import annotations

import ast
import copy
import os
import random
import shutil
import subprocess
import sys
import tempfile
from fnmatch import fnmatch
from pathlib import Path

from evidence.attack.reach import PACKAGES, Reach

ROOT = Path(__file__).parents[2]
MUTATED = (
    "deployable/intervals/**/*.py", "deployable/campaign/**/*.py", "fpm/*.py",
    "fpm/[afmrs]*/**/*.py",
)  # fmt: skip
"""What is changed: all that numba does not compile, which would take minutes for each change."""
LEFT_OUT = (
    "*/__init__.py", "*/__main__.py", "*/cli.py", "*/table.py", "*/progress.py", "*/warming.py",
    "*/campaign/pictures/*", "*/campaign/drawing.py", "*/campaign/results/figures.py",
)  # fmt: skip
"""Command lines, drawings, progress: nothing there changes a number."""
TESTS = ("intervals", "campaign", "structures", "fpm", "golden", "export", "report")
LONGEST = 300.0  # s, of the tests of one change, as they were measured without coverage's share


class Hunt:
    """Mutants made so far: file, line, change, and by what it was noticed (None: not)."""

    def __init__(self, seed: int, reach: Path | None = None):
        self.rng, self.found = random.Random(seed), []
        self._place: Path | None = None
        self._reach = Reach.read(reach) if reach else None

    @property
    def tried(self) -> int:
        """Number of mutants."""
        return len(self.found)

    def one(self, place: Path) -> None:
        """Change one place of the code in a copy of the checkout, and run the tests there.

        place: the folder of the copy, made once and kept.
        """
        if self._place != place:
            make_copy(place)
            self._place = place
        self._reach = self._reach or measured(place)
        name, number = self.rng.choice(all_sites())
        line, last, what, tree = change_at(parsed(name), number)
        path = place / name
        before = path.read_bytes()
        path.write_text(ast.unparse(tree), encoding="utf-8")
        try:
            noticed = noticed_by(place, self._tests(name, line, last))
        finally:
            path.write_bytes(before)
        self.found.append({"file": name, "line": line, "change": what, "noticed": noticed})

    def _tests(self, name: str, first: int, last: int) -> list[str]:
        """The tests of a change, as long as they take no longer than they may."""
        chosen, spent = [], 0.0
        for test in self._reach.tests(name, first, last):
            if (spent := spent + self._reach.cost(test)) > LONGEST:
                break
            chosen.append(test)
        return chosen

    def table(self) -> str:
        """The share noticed, and what was not."""
        noticed = sum(one["noticed"] is not None for one in self.found)
        lines = [f"{noticed} of {self.tried} changes of the code were noticed by tests.", ""]
        lines += ["| not noticed | change |", "|---|---|"]
        for one in self.found:
            if one["noticed"] is None:
                lines.append(f"| {one['file']}:{one['line']} | {one['change']} |")
        return "\n".join(lines) + "\n"


def parsed(name: str) -> ast.Module:
    """The syntax tree of a file of the checkout."""
    return ast.parse((ROOT / name).read_text(encoding="utf-8"))


def all_sites() -> list[tuple[str, int]]:
    """Every place that can be changed: file, and number in it."""
    files = {path for pattern in MUTATED for path in ROOT.glob(pattern)}
    names = sorted(str(path.relative_to(ROOT)) for path in files)
    mutated = [name for name in names if not any(fnmatch(name, out) for out in LEFT_OUT)]
    return [(name, number) for name in mutated for number in sites(parsed(name))]


def make_copy(place: Path) -> None:
    """A copy of what the tests need."""
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    for name in (*PACKAGES, "evidence", "tests", "config", "workflow", "docs"):
        ignored = shutil.ignore_patterns("*.nb?", "numba-*", "__pycache__")
        shutil.copytree(ROOT / name, place / name, ignore=ignored)
    for name in ("Snakefile", "pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, place)
    (place / "profiles").symlink_to("workflow/profiles")


def measured(place: Path) -> Reach:
    """Which tests run what, measured in a copy; takes some minutes."""
    left = place / "reach.json"
    folders = [f"tests/{name}" for name in TESTS]
    run_tests(place, ["-p", "evidence.attack.reach", *folders], 3600.0, REACH=str(left))
    return Reach.read(left)


def noticed_by(place: Path, tests: list[str]) -> str | None:
    """What notices that something is wrong in a copy: the first test that fails, or the time."""
    if not tests:
        return None
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as chosen:
        chosen.write("\n".join(tests))
        chosen.flush()
        try:
            done = run_tests(place, ["-x", f"@{chosen.name}"], 60.0 + 5.0 * LONGEST)
        except subprocess.TimeoutExpired:
            return "time"
    if done.returncode == 0:
        return None
    failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0].split(" - ")[0] if failed else done.stdout[-300:]


def run_tests(
    place: Path, words: list[str], limit: float, **more: str
) -> subprocess.CompletedProcess:
    """Run pytest in a copy; what it compiles is kept there."""
    environment = {**os.environ, "PYTHONPATH": str(place), "PYTHONDONTWRITEBYTECODE": "1", **more}
    environment["NUMBA_CACHE_DIR"] = str(place / "numba")
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider"]
    return subprocess.run(
        [*command, *words], cwd=place, env=environment, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=limit, check=False, text=True,
    )  # fmt: skip


_COMPARED = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
}  # fmt: skip
_COUNTED = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
_CALLED = {"min": "max", "max": "min", "argmin": "argmax", "argmax": "argmin", "any": "all",
           "all": "any", "minimum": "maximum", "maximum": "minimum", "lower": "upper",
           "upper": "lower", "floor": "ceil", "ceil": "floor"}  # fmt: skip


def sites(tree: ast.Module) -> list[int]:
    """Numbers, in the order of `ast.walk`, of the nodes that can be changed."""
    return [
        number
        for number, node in enumerate(ast.walk(tree))
        if isinstance(node, ast.expr) and _change(copy.deepcopy(node))
    ]


def change_at(tree: ast.Module, number: int) -> tuple[int, int, str, ast.Module]:
    """A copy of a module with one node changed: its lines, what, and the changed tree."""
    changed = copy.deepcopy(tree)
    node = next(node for i, node in enumerate(ast.walk(changed)) if i == number)
    before = ast.unparse(node)
    _change(node)
    what = f"`{before}` to `{ast.unparse(node)}`".replace("|", "or")
    return node.lineno, node.end_lineno or node.lineno, what, changed


def _change(node: ast.AST) -> bool:
    """Change a node itself; whether it was changed."""
    if isinstance(node, ast.Compare) and type(node.ops[0]) in _COMPARED:
        node.ops[0] = _COMPARED[type(node.ops[0])]()
    elif isinstance(node, ast.BinOp) and type(node.op) in _COUNTED and not _is_text(node):
        node.op = _COUNTED[type(node.op)]()
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
    elif isinstance(node, ast.Attribute) and node.attr in _CALLED:
        node.attr = _CALLED[node.attr]
    elif isinstance(node, ast.Name) and node.id in _CALLED and isinstance(node.ctx, ast.Load):
        node.id = _CALLED[node.id]
    else:
        return False
    return True


def _is_text(node: ast.BinOp) -> bool:
    return any(isinstance(n, ast.JoinedStr) or isinstance(getattr(n, "value", None), str)
               for n in ast.walk(node))  # fmt: skip
