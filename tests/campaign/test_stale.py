"""Whatever a result depends on is compared: edited code and configs find all that they made."""

from __future__ import annotations

import copy
from pathlib import Path

import pytest
import yaml

from deployable import campaign
from deployable.campaign import stages
from deployable.campaign.config import sections
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import results_of, write_result
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import make_plan, write_plan
from deployable.campaign.stages import STAGES, Stage
from deployable.campaign.stages.workflow import Workflow
from evidence.attack.victim import RAW, results_in

ROOT = Path(__file__).parents[2]
ASKED = {
    "intervals": {"a": {"relative": 0.01}, "E": {"nominal": 1e10, "relative": 0.05}},
    "design": {"method": "tensor_lobatto", "order": 1},
    "held_out": 1,
    "quantities": {"top": {"largest": "BD"}},
    "requirements": {"short": {"top": {"at_most": 10.0}}},
    "choose": {"parameters": {"E": [1e10, 1.01e10]}, "minimise": "upper(top)"},
    "verify": {"max_iterations": 0},
}


def asked(**changes) -> campaign.config.sections.Campaign:
    return campaign.check_config(copy.deepcopy({**RAW, **ASKED, **changes}))


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Folder:
    """A campaign of which everything was asked, with its figures drawn in this process."""
    results, wanted = tmp_path_factory.mktemp("stale"), asked()
    campaign.run(wanted, results, figures=False, notify=lambda text: None)
    folder = Folder(results / wanted.name)
    for name in ("figures", "page"):
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
    monkeypatch.setattr(stages, "program_digest", lambda: "another")
    assert stale(whole, asked()) == made(whole)


@pytest.mark.slow
def test_every_result_is_of_one_stage(whole, monkeypatch):
    """Those that follow from it are made again by the workflow, since it will be newer."""
    found, basis = {}, Stage.basis
    for name in STAGES:

        def another(stage, sections, name=name):
            return "another" if stage.name == name else basis(stage, sections)

        with monkeypatch.context() as patch:
            patch.setattr(Stage, "basis", another)
            found[name] = stale(whole, asked())
    assert found.pop("rounds") == found.pop("cases") == set()  # of other campaigns
    assert all(found.values()), found
    assert set().union(*found.values()) == made(whole)
    assert sum(map(len, found.values())) == len(made(whole))  # every result is of one stage


@pytest.mark.slow
@pytest.mark.parametrize(
    ("section", "changed", "finds"),
    [
        ("solver", {"duration": 0.005, "instants": 9}, "plan.json"),
        ("scene", {"name": "bennett", "parameters": {"elements": 3}}, "plan.json"),
        ("intervals", {**ASKED["intervals"], "a": {"relative": 0.02}}, "plan.json"),
        ("held_out", 2, "plan.json"),
        ("responses", {"BD": {"distance": ["B", "D"]}}, "plan.json"),
        ("quantities", {"top": {"smallest": "BD"}}, "plan.json"),
        ("jobs", {"group": 3}, "samples.nc"),
        ("bounds", {"model": "spline"}, "design_bounds.nc"),
        ("verify", {"max_iterations": 1}, "quantities.nc"),
        ("requirements", {"short": {"top": {"at_most": 9.0}}}, "requirements.json"),
        ("choose", {**ASKED["choose"], "minimise": "lower(top)"}, "choice.json"),
        ("published", {"BD": 0.06}, "summary.json"),
    ],
)
def test_an_edited_config_finds_what_was_made_from_it(whole, section, changed, finds):
    assert finds in stale(whole, asked(**{section: changed}))


@pytest.mark.slow
def test_edited_mechanics_find_the_plan(whole, monkeypatch):
    monkeypatch.setattr(sections, "program_digest", lambda: "another")
    assert "plan.json" in stale(whole, asked())


def test_no_stage_takes_the_results_of_another_config(tmp_path, monkeypatch):
    """Edits of what the stage itself depends on are its own matter; those of the structure's file
    are not."""
    monkeypatch.chdir(tmp_path)
    structure = (ROOT / "config/structures/bennett.yaml").read_text()
    Path("s.yaml").write_text(structure)
    raw = {**RAW, "scene": {"file": "s.yaml", "parameters": {"elements": 2}}}
    others = {
        "b": {"responses": {"BD": {"distance": ["B", "D"]}, "AC": {"distance": ["A", "C"]}}},
        "d": {"solver": {**RAW["solver"], "duration": 0.02}},
        "e": {"solver": {**RAW["solver"], "safety": 0.4}},
    }
    same = {"a": {}, "c": {"published": {"BD": 0.1}}}
    for name, more in {**others, **same}.items():
        Path(f"{name}.yaml").write_text(yaml.safe_dump({**raw, **more}))
    first = Workflow.from_files(["a.yaml"])
    write_plan(make_plan(first.campaign.experiment), first.folder.plan)
    for name in same:
        assert STAGES["answers"].sections_in(f"{name}.yaml", first.folder)

    def refuse(stage, name, cause="the results in {} belong to another config than {}"):
        cause = cause.format(first.folder.path, file := f"{name}.yaml")
        with pytest.raises(CampaignError, match=cause):
            STAGES[stage].sections_in(file, first.folder)

    for stage in ("bounds", "answers", "figures", "page"):
        refuse(stage, "b")
    for name in others:
        refuse("page", name)
    Path("s.yaml").write_text(structure.replace("E: {value: 1e9", "E: {value: 2e9"))
    refuse("page", "a", "the structure of {1} has changed since {0} was made")


def test_results_of_another_config_are_named_before_they_are_replaced(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, top in (("a.yaml", 10.0), ("b.yaml", 9.0)):
        raw = {**RAW, **ASKED, "requirements": {"short": {"top": {"at_most": top}}}}
        Path(name).write_text(yaml.safe_dump(raw))
    first, other = (Workflow.from_files([name]) for name in ("a.yaml", "b.yaml"))
    with results_of({"config": first.config}):
        write_result(first.folder.plan, "{\n}\n", basis="of the first")

    def texts(workflow: Workflow) -> list[str]:
        workflow.stale()
        return [*workflow.describe_foreign_results()]

    (text,) = texts(other)
    assert f"results in {first.folder.path} belong to another config, a.yaml, and" in text
    assert texts(first) == []
    Path("a.yaml").rename("renamed.yaml")  # which is no other one
    assert texts(Workflow.from_files(["b.yaml"])) == []
