"""Every module can be imported, none in a circle, and no room one that it must not know."""

import ast
import importlib
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from deployable.campaign.stages import STAGES

ROOT = Path(__file__).parents[2]
UNKNOWN = {
    "fpm": ("deployable", "evidence"),
    "deployable.intervals": ("fpm", "deployable.campaign", "evidence"),
    "deployable.campaign": ("evidence",),
}
FILES = sorted(
    path for top in ("deployable", "evidence", "fpm") for path in (ROOT / top).rglob("*.py")
)


def name_of(path):
    """The name of a module."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imported(path):
    """Full names of what a file imports, wherever in it."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_every_module_can_be_imported():
    for path in FILES:
        if path.stem.endswith("_script") or path.name == "__main__.py":
            continue  # for a peer's environment, or run when imported
        importlib.import_module(name_of(path))


@pytest.mark.parametrize("room", UNKNOWN)
def test_rooms_know_only_what_is_below_them(room):
    inside = [path for path in FILES if name_of(path).startswith(f"{room}.")]
    assert len(inside) > 10
    for path in inside:
        for name in imported(path):
            assert not f"{name}.".startswith(tuple(f"{other}." for other in UNKNOWN[room])), path


def modules_in(tree, path, known, *, annotations=False):
    """Modules of `known` that a tree imports, wherever; for annotations only if they count."""
    package = name_of(path) if path.name == "__init__.py" else name_of(path).rpartition(".")[0]
    left = [tree]
    while left:
        node = left.pop()
        typing = isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING"
        if typing and not annotations:
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


def graph_of(known, *, annotations=False):
    """The modules that each of some imports, by name."""
    names = set(known)
    return {
        name: set(modules_in(ast.parse(path.read_bytes()), path, names, annotations=annotations))
        - {name}
        for name, path in known.items()
    }


@pytest.mark.parametrize(
    ("package", "upper", "lower", "flat"),
    [
        ("fpm", "elements", "kernels", {"declare", "errors"}),
        ("deployable.campaign", "runs", "plan", {"errors", "folder", "provenance"}),
    ],
)
def test_rooms_of_a_package_stand_in_eight_floors(package, upper, lower, flat):
    """Nothing in them is in a circle, not by annotations, either."""
    folder = ROOT.joinpath(*package.split("."))
    known = {name_of(path): path for path in FILES if path.is_relative_to(folder)}
    modules = graph_of(known, annotations=True)
    TopologicalSorter(modules).prepare()

    def room(name):
        return ".".join(name.split(".")[: package.count(".") + 2])

    rooms = {room(name): set() for name in modules}
    for name, others in modules.items():
        rooms[room(name)] |= {room(other) for other in others} - {room(name)}
    floors = {}
    for name in TopologicalSorter(rooms).static_order():  # CycleError where rooms are in a circle
        floors[name] = 1 + max((floors[other] for other in rooms[name]), default=0)
    assert floors[f"{package}.{upper}"] > floors[f"{package}.{lower}"]
    assert max(floors.values()) <= 8, floors
    own = {name for name, path in known.items() if path.parent == folder}
    assert own == {package, *(f"{package}.{name}" for name in flat)}


def test_no_module_imports_itself_in_a_circle():
    """Nor by imports inside functions."""
    graph = graph_of({name_of(path): path for path in FILES})
    assert "fpm.elements.bars.beam" in graph["fpm.elements"]
    assert "deployable.intervals.errors" in graph["deployable.intervals.box"]
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


HEAVY = {
    "plan": {"matplotlib", "xarray", "numba", "netCDF4"},
    "rounds": {"matplotlib", "numba"},
    "simulate": {"matplotlib", "xarray", "numba"},
    "bounds": {"matplotlib", "numba"},
    "answers": {"matplotlib", "xarray", "numba"},
    "figures": {"xarray", "numba"},
    "page": {"numba"},
    "cases": {"numba"},
}
"""Packages that the module of a stage does not load; its work may, as a run loads numba."""


def test_a_stage_loads_what_its_work_needs():
    """Each in a process of its own, after what the command loads."""
    assert {*HEAVY} == {*STAGES}
    others = [f"deployable.campaign.{room}" for room in ("commands", "config.check")]
    without = {name: sorted(heavy) + others for name, heavy in HEAVY.items()}
    code = f"""
import importlib, os, sys
import deployable.campaign.cli
for name, without in {without}.items():
    if not os.fork():
        importlib.import_module(f"deployable.campaign.stages.{{name}}")
        print(name, [other for other in without if other in sys.modules], flush=True)
        os._exit(0)
    os.wait()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [f"{name} []" for name in HEAVY]
