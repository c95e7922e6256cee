"""Every module can be imported, and no package imports one that it must not know."""

import ast
import importlib
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
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        importlib.import_module(name.removesuffix(".__init__"))


@pytest.mark.parametrize("package", UNKNOWN)
def test_packages_know_only_what_is_below_them(package):
    for path in FILES:
        if path.is_relative_to(ROOT / package):
            assert not set(imported(path)) & set(UNKNOWN[package]), path
