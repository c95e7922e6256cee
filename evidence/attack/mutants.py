"""Single changes of the code, and whether the tests notice them."""

from __future__ import annotations

import ast
import copy
import os
import random
import shutil
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).parents[2]

TESTS = {
    "intervals/designs/*.py": ["tests/intervals/test_designs.py", "tests/intervals"],
    "intervals/ranges/*.py": ["tests/intervals/test_ranges.py", "tests/intervals"],
    "intervals/models/spline/*.py": ["tests/intervals/test_splines.py", "tests/intervals"],
    "intervals/rounds/*.py": ["tests/intervals/test_decide.py", "tests/intervals"],
    "intervals/models/*.py": ["tests/intervals"],
    "intervals/*.py": ["tests/intervals"],
    "campaign/config/*.py": [
        "tests/campaign/test_config.py", "tests/campaign/test_refused.py",
        "tests/campaign/test_loader.py", "tests/campaign/test_presets.py",
        "tests/campaign/test_structure_files.py", "tests/campaign/test_plan.py",
    ],
    "campaign/plan/*.py": ["tests/campaign/test_plan.py", "tests/campaign/test_rounds.py"],
    "campaign/runs/*.py": ["tests/campaign/test_batch.py", "tests/campaign/test_plan.py"],
    "campaign/results/samples.py": ["tests/campaign/test_batch.py"],
    "campaign/results/*.py": ["tests/campaign/test_results.py"],
    "campaign/files.py": ["tests/campaign/test_results.py", "tests/campaign/test_whole.py"],
    "campaign/workflow.py": ["tests/campaign/test_whole.py", "tests/workflow"],
    "fpm/sealed.py": ["tests/fpm/test_sealed.py"],
    "fpm/trajectory.py": ["tests/fpm/test_trajectory.py", "tests/fpm/test_classic.py"],
    "fpm/classic.py": ["tests/fpm/test_classic.py"],
    "fpm/responses.py": ["tests/fpm/test_trajectory.py", "tests/campaign/test_config.py"],
    "fpm/timestep.py": ["tests/fpm/test_stable_step.py"],
    "fpm/simulate.py": ["tests/fpm/test_time_loop.py", "tests/fpm/test_trajectory.py"],
    "fpm/scenes/bennett_geometry.py": ["tests/fpm/test_bennett_geometry.py"],
}  # fmt: skip
"""Tests that run a file's code, the first that are likely to notice first."""

SLOWEST = 600.0  # s


class Hunt:
    """Mutants made so far: file, line, change, and whether it was noticed."""

    def __init__(self, seed: int):
        self.rng, self.found = random.Random(seed), []

    @property
    def tried(self) -> int:
        """Number of mutants."""
        return len(self.found)

    def one(self, place: Path) -> None:
        """Change one place of the code in a copy of the checkout, and run the tests there."""
        pattern = self.rng.choice(list(TESTS))
        files = [path for path in ROOT.glob(pattern) if path.name != "__init__.py"]
        path = self.rng.choice(sorted(files))
        name = str(path.relative_to(ROOT))
        tests = next(tests for other, tests in TESTS.items() if fnmatch(name, other))
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if not (found := sites(tree)):
            return
        line, what, tree = change_at(tree, self.rng.choice(found))
        make_copy(place)
        (place / name).write_text(ast.unparse(tree), encoding="utf-8")
        self.found.append(
            {"file": name, "line": line, "change": what, "noticed": not passes(place, tests)}
        )
        shutil.rmtree(place)

    def table(self) -> str:
        """The share noticed, and what was not."""
        noticed = sum(one["noticed"] for one in self.found)
        lines = [f"{noticed} of {self.tried} changes of the code were noticed by tests.", ""]
        lines += ["| not noticed | change |", "|---|---|"]
        for one in self.found:
            if not one["noticed"]:
                lines.append(f"| {one['file']}:{one['line']} | {one['change']} |")
        return "\n".join(lines) + "\n"


def make_copy(place: Path) -> None:
    """A copy of what the tests need."""
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    for name in ("fpm", "intervals", "campaign", "evidence", "tests", "config", "workflow"):
        ignored = shutil.ignore_patterns("*.nb?", "numba-*")
        shutil.copytree(ROOT / name, place / name, ignore=ignored)
    for name in ("Snakefile", "pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, place)
    (place / "profiles").symlink_to("workflow/profiles")


def passes(place: Path, tests: list[str]) -> bool:
    """Whether the tests pass in a copy; one that takes too long does not."""
    environment = {**os.environ, "PYTHONPATH": str(place), "PYTHONDONTWRITEBYTECODE": "1"}
    cache = ROOT / "fpm" / "kernels" / "__pycache__"
    environment.setdefault("NUMBA_CACHE_DIR", str(cache))
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-n", "0", "-p", "no:cacheprovider"]
    try:
        done = subprocess.run(
            [*command, *tests], cwd=place, env=environment, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=SLOWEST, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


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


def change_at(tree: ast.Module, number: int) -> tuple[int, str, ast.Module]:
    """A copy of a module with one node changed: line, what, and the changed tree."""
    changed = copy.deepcopy(tree)
    node = next(node for i, node in enumerate(ast.walk(changed)) if i == number)
    before = ast.unparse(node)
    _change(node)
    return node.lineno, f"`{before}` to `{ast.unparse(node)}`".replace("|", "or"), changed


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
