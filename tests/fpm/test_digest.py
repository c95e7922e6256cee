"""The digest of a scene's sources: what changes numbers counts, how it is written does not."""

import importlib
import importlib.util
import os
import shutil
import sys
import time

import pytest

import fpm
from deployable.campaign.config.sections import scene_type
from fpm.errors import ChangedError
from fpm.kernels import sources


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def copied(tmp_path, monkeypatch, cache):
    """A copy of the mechanics, whose files are digested; returns its folder."""
    folder = tmp_path / "fpm_copied"
    shutil.copytree(sources.PACKAGE, folder, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache))
    return folder


def digests(folder) -> tuple[str, str]:
    """Of what computes runs, and of what reads further numbers off them, as a process that starts
    now would have them."""
    code = sources.PackageFiles(folder)
    return code.digest(exclude=sources.READ + sources.DISPLAY), code.digest(include=sources.READ)


def edit(path, old: str, new: str) -> None:
    text = path.read_text()
    assert text.count(old) >= 1
    path.write_text(text.replace(old, new))


def test_comments_and_formatting_do_not_count(copied):
    before = digests(copied)
    edit(copied / "kernels" / "run.py", '"""The time loop:', '# A comment.\n"""The loop of time:')
    edit(copied / "solver" / "pack.py", "MOST_EVENTS = 512", "MOST_EVENTS = (\n    512\n)")
    assert digests(copied) == before


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("kernels/run.py", "NORMALISE_EVERY = 16", "NORMALISE_EVERY = 17"),
        ("elements/bars/lumping.py", "19 / 720", "19 / 721"),
        ("files/trajectory.py", '"response_values"', '"values_of_responses"'),
    ],
)
def test_what_changes_numbers_counts(copied, file, old, new):
    (before, reading), _ = digests(copied), edit(copied / file, old, new)
    assert digests(copied)[0] != before
    assert digests(copied)[1] == reading


def test_every_file_counts_but_those_that_decide_no_number_that_is_kept(copied):
    """Every file there is: one that nobody thought of counts."""
    for path in sorted(copied.rglob("*.py")):
        before, text = digests(copied), path.read_text()
        path.write_text(f"{text}\nMORE = 1\n")
        name = path.relative_to(copied).as_posix()
        words = name.startswith("motions/") or name in (
            "errors.py", "scenes/effort.py", "structures/describe.py", "structures/plausible.py",
            "structures/report.py",
        )  # fmt: skip
        read = name.startswith(("reading/", "travel/"))
        changed = tuple(x != y for x, y in zip(before, digests(copied), strict=True))
        assert changed == (not words and not read, read), name
        path.write_text(text)


# -- names are of what was imported ----------------------------------------------------------------


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A small package that can be imported, noted before it is; its folder, and the note."""
    folder = tmp_path / "package_of_two"
    folder.mkdir()
    for name in ("__init__", "one", "two"):
        (folder / f"{name}.py").write_text("VALUE = 1\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield folder, sources.PackageFiles(folder)
    for name in [name for name in sys.modules if name.partition(".")[0] == folder.name]:
        del sys.modules[name]


def test_a_file_that_changed_between_import_and_naming_is_refused(package):
    folder, code = package
    importlib.import_module("package_of_two.one")
    (folder / "one.py").write_text("VALUE = 2\n")
    with pytest.raises(fpm.SceneError, match=r"^package_of_two/one\.py changed since"):
        code.digest()


def test_a_file_that_is_imported_after_it_changed_is_refused(package):
    folder, code = package
    importlib.import_module("package_of_two.one")
    before = code.digest()
    (folder / "two.py").write_text("VALUE = 2\n")
    assert code.digest() == before  # it is in no memory yet
    importlib.import_module("package_of_two.two")
    with pytest.raises(fpm.SceneError, match=r"two\.py changed since it was imported: start again"):
        code.check()


def test_a_file_that_changes_after_it_was_imported_and_named_does_not_matter(package):
    folder, code = package
    importlib.import_module("package_of_two.one")
    before = code.digest()
    (folder / "one.py").write_text("VALUE = 2\n")
    assert code.digest() == before
    assert sources.PackageFiles(folder).digest() != before
    importlib.reload(sys.modules["package_of_two.one"])  # as notebooks do
    with pytest.raises(fpm.SceneError, match=r"one\.py changed since"):
        code.digest()


def test_a_file_that_changed_before_the_package_was_noted_is_refused(package):
    """As when a part of a program is imported alone, and what notes all of it after an edit."""
    folder, _ = package
    files = {path: path.stat() for path in folder.glob("*.py")}
    importlib.import_module("package_of_two.one")
    sources.PackageFiles(folder, files).check()
    assert sources.PackageFiles(folder, files).digest() == sources.PackageFiles(folder).digest()
    (folder / "one.py").write_text("VALUE = 2\n")
    with pytest.raises(fpm.SceneError, match=r"one\.py changed since"):
        sources.PackageFiles(folder, files).check()


def test_at_the_start_of_a_campaign_files_are_what_is_in_memory(package):
    folder, code = package
    importlib.import_module("package_of_two.one")
    code.digest()
    for text in ("VALUE = 1\n", "VALUE = 1  # m\n"):
        (folder / "one.py").write_text(text)
        code.check(reread=True)
    (folder / "two.py").write_text("VALUE = 2\n")  # in no memory yet
    code.check(reread=True)
    (folder / "one.py").write_text("VALUE = 2\n")
    with pytest.raises(fpm.SceneError, match=r"one\.py changed since"):
        code.check(reread=True)


def test_a_file_that_is_touched_or_new_and_unused_does_not_matter(package):
    folder, code = package
    before = code.digest()
    (folder / "two.py").touch()
    (folder / "three.py").write_text("VALUE = 3\n")
    importlib.import_module("package_of_two.two")
    assert code.digest() == before
    importlib.import_module("package_of_two.three")
    with pytest.raises(fpm.SceneError, match=r"three\.py changed since"):
        code.digest()


def test_a_structure_s_own_file_counts_for_it_alone():
    assert scene_type("bennett").digest != scene_type("pendulum").digest


def test_it_is_quick():
    scene = scene_type("bennett")
    first = scene.digest
    best = float("inf")
    for _ in range(5):
        start = time.perf_counter()
        assert scene.digest == first
        best = min(best, time.perf_counter() - start)
    assert best < 0.02  # less than 1 ms alone


def test_digests_of_files_as_they_were_are_kept(copied, monkeypatch):
    data = copied / "table.json"
    data.write_text("{}")
    before = sources.PackageFiles(copied).digest()
    code = sources.PackageFiles(copied)
    with monkeypatch.context() as patch:
        patch.setattr(sources, "tree_digest", None)  # nothing is read
        assert code.digest() == before
    os.utime(data)
    code.check()
    data.write_text("[]")
    with pytest.raises(ChangedError, match=r"table\.json"):
        code.check()
    assert sources.PackageFiles(copied).digest() != before


def test_a_cache_that_can_not_be_written_does_not_matter(copied, monkeypatch):
    before = digests(copied)
    monkeypatch.setenv("XDG_CACHE_HOME", "/dev/null")
    sources._tree_digest.cache_clear()
    assert digests(copied) == before
    assert len(before[0]) == 16


def test_digests_kept_by_another_version_are_not_met(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    path = tmp_path / "mast.py"
    path.write_text("VALUE = 1")
    first = sources.tree_digest(path)
    other = tmp_path / "fpm" / "kernels" / "sources.py"
    other.parent.mkdir(parents=True)
    (other.parent / ".#edited.py").symlink_to("somebody@somewhere")  # as an editor leaves it
    other.write_text((sources.PACKAGE / "kernels" / "sources.py").read_text())
    edit(other, "return ast.dump(tree)", "return ast.dump(tree, include_attributes=True)")
    spec = importlib.util.spec_from_file_location("other_sources", other)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.tree_digest(path) != first
