"""Whatever a result depends on is compared: edited code and configs find all that they made."""

from __future__ import annotations

import ast
import copy
import inspect
from functools import cache
from pathlib import Path

import pytest

from deployable import campaign
from deployable.campaign.folder import Folder
from deployable.campaign.stages import STAGES, Stage, drawings
from deployable.campaign.workflow import Workflow
from deployable.fpm.scenes import SceneType
from evidence.attack.victim import RAW, results_in

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "deployable"
ASKED = {
    "intervals": {"a": {"relative": 0.01}, "E": {"nominal": 1e10, "relative": 0.05}},
    "design": {"method": "tensor_lobatto", "order": 1},
    "held_out": 1,
    "quantities": {"top": {"largest": "BD"}},
    "requirements": {"short": {"top": {"at_most": 10.0}}},
    "choose": {"parameters": {"E": [1e10, 1.01e10]}, "minimise": "upper(top)", "order": 1},
    "verify": {"rounds": 0},
}


def asked(**changes) -> campaign.config.sections.Campaign:
    return campaign.check_config(copy.deepcopy({**RAW, **ASKED, **changes}))


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Folder:
    """A campaign of which everything was asked, with its figures drawn in this process."""
    results, wanted = tmp_path_factory.mktemp("stale"), asked()
    campaign.run(wanted, results, figures=False, tell=lambda text: None)
    folder = Folder(results / wanted.name)
    for name in (*drawings(wanted), "report"):
        STAGES[name].run(folder, lambda text: None, **STAGES[name].sections_of(wanted))
    return folder


def stale(folder: Folder, wanted) -> set[str]:
    """Names of the results in a folder that are not what is wanted."""
    workflow = Workflow(wanted)
    workflow.folder = folder
    return {str(Path(name).relative_to(folder.path)) for name in workflow.stale()}


def made(folder: Folder) -> set[str]:
    """Names of all results in a folder, but for the runs, whose names say what they are."""
    runs = ("trajectories", "motions")
    paths = [path.relative_to(folder.path) for path in results_in(folder.path)]
    return {str(path) for path in paths if path.parts[0] not in runs}


@pytest.mark.slow
def test_what_was_just_made_is_not_stale(whole):
    assert stale(whole, asked()) == set()


@pytest.mark.slow
def test_edited_code_finds_every_result(whole, monkeypatch):
    monkeypatch.setattr(Stage, "digest", lambda stage: f"another {stage.name}")
    assert stale(whole, asked()) == made(whole)


@pytest.mark.slow
def test_edited_code_of_one_stage_finds_its_own_results(whole, monkeypatch):
    """Those that follow from them are made again by the workflow, since these will be newer."""
    found = {}
    for name in STAGES:
        with monkeypatch.context() as patch:
            digest = Stage.digest
            patch.setattr(
                Stage, "digest", lambda s, n=name, d=digest: f"another {n}" if s.name == n else d(s)
            )
            found[name] = stale(whole, asked())
    assert found.pop("plan_round") == set()  # of campaigns in rounds
    assert all(found.values()), found
    assert set().union(*found.values()) == made(whole)
    assert sum(map(len, found.values())) == len(made(whole))  # every result is of one stage


@pytest.mark.slow
@pytest.mark.parametrize(
    ("section", "changed", "finds"),
    [
        ("solver", {"duration": 0.005, "instants": 9}, "nodes.json"),
        ("scene", {"name": "bennett", "parameters": {"elements_per_link": 3}}, "nodes.json"),
        ("intervals", {**ASKED["intervals"], "a": {"relative": 0.02}}, "nodes.json"),
        ("held_out", 2, "nodes.json"),
        ("responses", {"BD": {"distance": ["B", "D"]}}, "nodes.json"),
        ("quantities", {"top": {"smallest": "BD"}}, "nodes.json"),
        ("jobs", {"group": 3}, "samples.nc"),
        ("bounds", {"model": "spline"}, "bounds.nc"),
        ("verify", {"rounds": 1}, "quantities.nc"),
        ("requirements", {"short": {"top": {"at_most": 9.0}}}, "requirements.json"),
        ("choose", {**ASKED["choose"], "order": 2}, "choice.json"),
        ("error", {"shade_above": 0.2}, "figures/BD.png"),
        ("figures", {"moments": 3}, "figures/campaign/moments.pdf"),
        ("published", {"BD": 0.06}, "summary.json"),
    ],
)
def test_an_edited_config_finds_what_was_made_from_it(whole, section, changed, finds):
    assert finds in stale(whole, asked(**{section: changed}))


@pytest.mark.slow
def test_an_edited_structure_finds_the_plan(whole, monkeypatch):
    monkeypatch.setattr(SceneType, "content", "another")
    assert "nodes.json" in stale(whole, asked())


@pytest.mark.parametrize("name", STAGES)
def test_a_stage_depends_on_all_that_it_imports(name):
    """Of campaign and intervals; the mechanics are part of the names of runs and of plans."""
    known = {path for pattern in STAGES[name].code for path in PACKAGE.glob(pattern)}
    # Names, what is told, and imports ahead.
    known |= {PACKAGE / f"campaign/{name}.py" for name in ("folder", "errors", "stopping")}
    reached, left = set(), imported(inspect.getsource(STAGES[name].work))
    while left:
        path = left.pop()
        if path not in reached and path.name not in ("stages.py", "__init__.py"):
            reached.add(path)
            left |= imported_by(path)
    missing = {str(path.relative_to(PACKAGE)) for path in reached - known}
    assert not {path for path in missing if not path.startswith("fpm/")}


@cache
def imported_by(path: Path) -> frozenset[Path]:
    return frozenset(imported(path.read_text(encoding="utf-8")))


def imported(source: str) -> set[Path]:
    """The files of this checkout that a piece of code imports."""
    tree = ast.parse(inspect.cleandoc(source) if source.startswith(" ") else source)
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    paths = {ROOT.joinpath(*name.split(".")) for name in names}
    return {
        path
        for place in paths
        for path in (place.with_suffix(".py"), place / "__init__.py")
        if path.is_file()
    }
