"""Every module can be imported, none in a circle, and no package one that it must not know."""

import ast
import importlib
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("fpm", "intervals", "campaign", "evidence")
UNKNOWN = {
    "fpm": ("intervals", "campaign", "evidence"),
    "intervals": ("fpm", "campaign", "evidence"),
    "campaign": ("evidence",),
}
FILES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))


def name_of(path):
    """The name of a module."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imported(path):
    """First names of what a file imports, wherever in it."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module.split(".")[0]


def test_every_module_can_be_imported():
    for path in FILES:
        if path.stem.endswith("_script") or path.name == "__main__.py":
            continue  # for a peer's environment, or run when imported
        importlib.import_module(name_of(path))


@pytest.mark.parametrize("package", UNKNOWN)
def test_packages_know_only_what_is_below_them(package):
    for path in FILES:
        if path.is_relative_to(ROOT / package):
            assert not set(imported(path)) & set(UNKNOWN[package]), path


def modules_in(tree, path, known):
    """Modules of `known` that a tree imports, wherever, but not for type checkers only."""
    package = name_of(path) if path.name == "__init__.py" else name_of(path).rpartition(".")[0]
    left = [tree]
    while left:
        node = left.pop()
        if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
            left += node.orelse
            continue
        left += ast.iter_child_nodes(node)
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: package.count(".") + 2 - node.level] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            for alias in node.names:
                inner = f"{base}.{alias.name}"
                yield from {inner if inner in known else base} & known


def test_no_module_imports_itself_in_a_circle():
    """Nor by imports inside functions."""
    known = {name_of(path): path for path in FILES}
    graph = {
        name: set(modules_in(ast.parse(path.read_bytes()), path, set(known))) - {name}
        for name, path in known.items()
    }
    assert "fpm.kinds.beam" in graph["fpm.kinds"] and "intervals.errors" in graph["intervals.box"]
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))
