"""Results are named after the bytes of every source file."""

import shutil
from pathlib import Path

from deployable.campaign import provenance
from fpm.kernels import sources

ROOT = Path(__file__).parents[2]


def test_every_source_file_counts(tmp_path):
    """Those of both packages, one by one; what is shipped along does not decide."""
    nothing = shutil.ignore_patterns("__pycache__", "program_data")
    places = [shutil.copytree(ROOT / name, tmp_path / name, ignore=nothing)
              for name in ("fpm", "deployable")]  # fmt: skip
    (places[0] / ".#edited.py").symlink_to("somebody@somewhere")  # as an editor leaves it
    digests = {sources.digest(*places)}
    assert len(next(iter(digests))) == 16
    paths = [p for place in places for p in place.rglob("*") if p.suffix in sources.CODE]
    paths = [path for path in paths if path.is_file()]
    assert {p.suffix for p in paths} > {".py", ".html", ".json"}
    for path in paths[::10]:
        with path.open("a") as file:
            file.write("\n")
        sources.digest.cache_clear()
        digests.add(sources.digest(*places))
    assert len(digests) == 1 + len(paths[::10])
    (places[1] / "program_data" / "config").mkdir(parents=True)
    (places[1] / "program_data" / "config" / "mine.yaml").touch()
    sources.digest.cache_clear()
    assert sources.digest(*places) in digests


def test_the_program_is_both_packages_and_is_digested_once(monkeypatch):
    expected = sources.digest(ROOT / "fpm", ROOT / "deployable")
    assert provenance.program_digest() == expected
    monkeypatch.setattr(Path, "read_bytes", None)
    assert provenance.program_digest() == expected
