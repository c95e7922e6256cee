"""Arguments of the public interface are documented; a class name stands in one module."""

import ast
import importlib
import inspect
import re
from collections import defaultdict
from dataclasses import fields
from pathlib import Path

import pytest

from deployable.campaign.stages import OPTIONS, STAGES
from fpm.elements import KINDS

ROOT = Path(__file__).parents[2]
ENTRY = re.compile(r"\.\. auto(module|function|class|exception):: (\S+)\n(?: +:members:(.*)\n)?")
OBVIOUS = {
    "name",
    "hinge",
    "hinges",
    "particles",
}  # of an element: its own, and the indices of these
LONG = 3  # arguments from which on each has a line of its own


def interface():
    """Name and object of what docs/api.md lists, and of the functions that make stages."""
    for kind, name, members in ENTRY.findall((ROOT / "docs" / "api.md").read_text("utf-8")):
        module, _, last = name.rpartition(".")
        listed = [member.strip() for member in members.split(",") if member.strip()]
        if kind == "module":
            owner = importlib.import_module(name)
        else:
            owner = getattr(importlib.import_module(module), last)
            yield name, owner
            if kind == "class" and members and not listed:
                listed = [n for n, v in vars(owner).items() if inspect.isroutine(v) and n[0] != "_"]
        yield from ((f"{name}.{member}", getattr(owner, member)) for member in listed)


def documented(thing):
    """The docstring of a function, or of a class and those it inherits from."""
    classes = thing.__mro__[:-1] if inspect.isclass(thing) else [thing]
    return "\n".join(inspect.getdoc(one) or "" for one in classes)


def arguments(thing):
    if not callable(thing) or (inspect.isclass(thing) and issubclass(thing, BaseException)):
        return []
    return [name for name in inspect.signature(thing).parameters if name not in ("self", "cls")]


@pytest.mark.parametrize(("name", "thing"), [pytest.param(*row, id=row[0]) for row in interface()])
def test_arguments_of_the_interface_are_documented(name, thing):
    text, names = documented(thing), arguments(thing)
    assert text, name
    missing = [one for one in names if not re.search(rf"\b{one}\b", text)]
    assert not missing, f"{name}: {missing}"
    has_section = re.search(r"^(Parameters|Attributes)\n-+$", text, re.MULTILINE)
    assert len(names) < LONG or has_section, f"{name}: no section of arguments"


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_values_of_element_types_are_documented(kind):
    text = documented(kind)
    specs = {f.name: f.metadata.get("fpm") for f in fields(kind) if f.init}
    names = [
        name
        for name, spec in specs.items()
        if not (getattr(spec, "text", "") or getattr(spec, "unit", ""))
    ]
    missing = [
        name for name in names if name not in OBVIOUS and not re.search(rf"\b{name}\b", text)
    ]
    assert inspect.getdoc(kind) and not missing, missing


@pytest.mark.parametrize("stage", STAGES.values(), ids=list(STAGES))
def test_options_of_stages_are_documented(stage):
    assert stage.text and stage.text[0].isupper() and stage.text.endswith(".")
    assert all(OPTIONS[option]["help"] for option in stage.options)


def test_a_class_name_stands_in_one_module():
    modules = defaultdict(set)
    for path in (*ROOT.glob("fpm/**/*.py"), *ROOT.glob("deployable/**/*.py")):
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.ClassDef):
                modules[node.name].add(path.relative_to(ROOT).as_posix())
    assert len(modules) > 200
    assert not {name: paths for name, paths in modules.items() if len(paths) > 1}
