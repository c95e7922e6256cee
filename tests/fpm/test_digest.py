"""The digest of a scene's sources: what changes numbers counts, how it is written does not."""

import shutil
import time

import pytest

import fpm
from fpm import sources


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
    before = fpm.scenes.get("bennett").digest
    edit(copied / "kernels" / "run.py", '"""The time loop:', '# A comment.\n"""The loop of time:')
    edit(copied / "pack.py", "MOST_EVENTS = 512", "MOST_EVENTS = (\n    512\n)")
    edit(copied / "trajectory.py", '"response_values"', '"values_of_responses"')
    assert fpm.scenes.get("bennett").digest == before


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("kernels/run.py", "NORMALISE_EVERY = 16", "NORMALISE_EVERY = 17"),
        ("kinds/beam_kernels.py", "1.0 / 6.0", "1.0 / 6.1"),
        ("kinds/lumping.py", "19 / 720", "19 / 721"),
        ("timestep.py", "SAFETY = 0.9", "SAFETY = 0.8"),
        ("kinds/contact.py", "always_acts = False", "always_acts = True"),
    ],
)
def test_what_changes_numbers_counts(copied, file, old, new):
    before = [fpm.scenes.get(name).digest for name in fpm.scenes.names()]
    edit(copied / file, old, new)
    after = [fpm.scenes.get(name).digest for name in fpm.scenes.names()]
    assert all(x != y for x, y in zip(before, after, strict=True))


def test_a_structure_s_own_files_count_for_it_alone():
    bennett, pendulum = (
        {path.name for path in sources.own_sources(f"fpm.scenes.{name}")}
        for name in ("bennett", "pendulum")
    )
    assert {"bennett.py", "bennett_geometry.py"} <= bennett
    assert "pendulum.py" in pendulum
    assert not pendulum & {"bennett.py", "bennett_geometry.py"}
    assert fpm.scenes.get("bennett").digest != fpm.scenes.get("pendulum").digest


def test_it_is_kept_on_disk_and_quick(copied):
    scene = fpm.scenes.get("bennett")
    first = scene.digest
    best = float("inf")
    for _ in range(5):
        start = time.perf_counter()
        assert scene.digest == first
        best = min(best, time.perf_counter() - start)
    assert best < 0.1  # some 10 ms alone; without the files on disk some 300


def test_a_cache_that_can_not_be_written_does_not_matter(copied, monkeypatch):
    before = fpm.scenes.get("pendulum").digest
    monkeypatch.setenv("XDG_CACHE_HOME", "/dev/null")
    assert fpm.scenes.get("pendulum").digest == before
    assert len(before) == 16
