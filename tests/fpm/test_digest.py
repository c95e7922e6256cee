"""The digest of a scene's sources: what changes numbers counts, how it is written does not."""

import importlib.util
import shutil
import time

import pytest

import fpm
from deployable.campaign.config.sections import scene_type
from fpm.kernels import sources


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def copied(tmp_path, monkeypatch, cache):
    """A copy of the mechanics, whose files are digested; returns its folder."""
    folder = tmp_path / "fpm"
    shutil.copytree(sources.HERE, folder, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(sources, "HERE", folder)
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache))
    return folder


def edit(path, old: str, new: str) -> None:
    text = path.read_text()
    assert text.count(old) >= 1
    path.write_text(text.replace(old, new))


def test_comments_and_formatting_do_not_count(copied):
    before = scene_type("bennett").digest
    edit(copied / "kernels" / "run.py", '"""The time loop:', '# A comment.\n"""The loop of time:')
    edit(copied / "solver" / "pack.py", "MOST_EVENTS = 512", "MOST_EVENTS = (\n    512\n)")
    edit(copied / "files" / "trajectory.py", '"response_values"', '"values_of_responses"')
    assert scene_type("bennett").digest == before


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("kernels/run.py", "NORMALISE_EVERY = 16", "NORMALISE_EVERY = 17"),
        ("elements/bars/beam_kernels.py", "slope + 4.0", "slope + 4.1"),
        ("elements/bars/lumping.py", "19 / 720", "19 / 721"),
        ("scenes/timestep.py", "SAFETY = 0.9", "SAFETY = 0.8"),
        ("assembly/__init__.py", "CLOSED = 1e-11", "CLOSED = 1e-9"),
        ("elements/openings/contact.py", "> 1e-10 * size", "> 1e-9 * size"),
    ],
)
def test_what_changes_numbers_counts(copied, file, old, new):
    before = [scene_type(name).digest for name in ("bennett", "pendulum")]
    edit(copied / file, old, new)
    after = [scene_type(name).digest for name in ("bennett", "pendulum")]
    assert all(x != y for x, y in zip(before, after, strict=True))


def test_responses_motions_and_other_structures_do_not_count(copied):
    before = [scene_type(name).digest for name in ("bennett", "pendulum")]
    for name in ("reading/responses", "reading/recording", "motions/motion", "files/trajectory"):
        with open(copied / f"{name}.py", "a") as file:
            file.write("\nMORE = 1\n")
    for name in ("structures/builder", "structures/other"):
        (copied / f"{name}.py").write_text("MORE = 1\n")
    assert [scene_type(name).digest for name in ("bennett", "pendulum")] == before


def test_a_structure_s_own_file_counts_for_it_alone():
    assert scene_type("bennett").digest != scene_type("pendulum").digest


def test_it_is_kept_on_disk_and_quick(copied):
    scene = scene_type("bennett")
    first = scene.digest
    best = float("inf")
    for _ in range(5):
        start = time.perf_counter()
        assert scene.digest == first
        best = min(best, time.perf_counter() - start)
    assert best < 0.1  # some 10 ms alone; without the files on disk some 300


def test_a_cache_that_can_not_be_written_does_not_matter(copied, monkeypatch):
    before = scene_type("pendulum").digest
    monkeypatch.setenv("XDG_CACHE_HOME", "/dev/null")
    assert scene_type("pendulum").digest == before
    assert len(before) == 16


@pytest.mark.parametrize(
    "imports",
    [
        "import numpy, helper",
        "import helper as other",
        "from helper import VALUE",
        "from . import helper",
        "from .helper import VALUE",
        "from ..room import helper",
        "import house.room.helper",
        "from house.room import helper",
        "from house.room.helper import VALUE",
        "def build():\n    from helper import VALUE",
        "import between",
    ],
)
def test_own_sources_are_the_files_beside_that_are_imported(tmp_path, imports):
    room = tmp_path / "house" / "room"
    room.mkdir(parents=True)
    others = {"helper": "VALUE = 1", "between": "import helper", "numpy_": "", "__init__": ""}
    for name, text in others.items():
        (room / f"{name}.py").write_text(text)
    (room / "mast.py").write_text(imports)
    found = {path.name for path in sources.own_sources(room / "mast.py")}
    assert found - {"between.py", "__init__.py"} == {"mast.py", "helper.py"}


@pytest.mark.parametrize(
    "imports", ["from elsewhere import helper", "import elsewhere.helper", "from .. import helper"]
)
def test_a_file_beside_of_the_same_name_is_not_one_from_elsewhere(tmp_path, imports):
    (tmp_path / "helper.py").write_text("")
    (tmp_path / "mast.py").write_text(imports)
    assert sources.own_sources(tmp_path / "mast.py") == {(tmp_path / "mast.py").resolve()}


def test_kernels_beside_a_kind_count_with_it(tmp_path):
    for name in ("spring", "spring_kernels", "other_kernels"):
        (tmp_path / f"{name}.py").write_text("")
    found = {path.name for path in sources.own_sources(tmp_path / "spring.py")}
    assert found == {"spring.py", "spring_kernels.py"}


def test_code_that_is_in_no_file_is_refused(tmp_path):
    names = {"__name__": "typed_in"}
    exec("def build(): pass\nclass Arrays: pass", names)
    for thing in (names["build"], names["Arrays"]):
        with pytest.raises(fpm.SceneError, match="expected code in a Python file"):
            sources.own_sources(sources.file_of(thing))
    with pytest.raises(fpm.SceneError, match="expected code in a Python file"):
        sources.own_sources(tmp_path)


def test_digests_kept_by_another_version_are_not_met(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    path = tmp_path / "mast.py"
    path.write_text("VALUE = 1")
    first = sources.tree_digest(path)
    other = tmp_path / "sources.py"
    other.write_text((sources.HERE / "kernels" / "sources.py").read_text())
    edit(other, "return ast.dump(tree)", "return ast.dump(tree, include_attributes=True)")
    spec = importlib.util.spec_from_file_location("other_sources", other)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.tree_digest(path) != first
