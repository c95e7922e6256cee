"""The documentation as a site: built strictly, from its own machine alone."""

import os
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "docs/extensions"))


@pytest.mark.slow
def test_the_site_is_built_without_a_warning_and_asks_no_network(tmp_path):
    """SITE: the folder of one that was built so already, as .ci/run does."""
    build = pytest.importorskip("sphinx.cmd.build", reason="in the extra `docs`")
    site = Path(os.environ.get("SITE") or tmp_path / "site")
    if not site.exists():
        arguments = ["-W", "-q", "-E", "-D", "gallery_moves=0", "-d", str(tmp_path / "trees")]
        assert build.main([*arguments, str(ROOT / "docs"), str(site)]) == 0
    pages = {path.name for path in site.glob("*.html")}
    assert {"index.html", "first-campaign.html", "config.html", "api.html"} <= pages
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(r'<(?:script|img|link)[^>]+(?:src|href)="(https?:[^"]+)"', text)
        assert not loaded, page.name
    api = (site / "api.html").read_text(encoding="utf-8")
    assert "fpm.solver.motion.whole_motion" in api and "deployable.intervals.bounds_dataset" in api
    assert "<math" in (site / "intervals.html").read_text(encoding="utf-8")
    # The gallery shows every structure of the library.
    made = ROOT / "docs/made"
    text = (made / "gallery.md").read_text(encoding="utf-8")
    for path in (ROOT / "config/structures").glob("*.yaml"):
        assert f"`config/structures/{path.name}`" in text
    pictures = re.findall(r"\(made/([^)]+)\)", text)
    count = len(list((ROOT / "config/structures").glob("*.yaml")))
    assert len(pictures) == 2 * count and text.count("](#") == count  # thumbnails, and pictures
    assert all((made / name).stat().st_size > 1000 for name in pictures)


def test_all_pages_are_in_the_contents():
    index = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    for page in (ROOT / "docs").glob("*.md"):
        if page.name != "index.md":
            assert re.search(rf"^{re.escape(page.stem)}$", index, re.M), page.name


def test_docstrings_become_text_with_code():
    import docstrings

    line = "values `a_` of |y - s| <= e, `x * y`, keep_"
    assert docstrings.as_rst(line) == r"values ``a_`` of \|y - s\| <= e, ``x * y``, keep\_"
    lines = ["Text:", "", "    code = 1", "", "More"]
    docstrings.process(None, "module", "", None, None, lines)
    assert lines == ["Text:", "", "::", "", "    code = 1", "", "More"]


def test_the_readmes_pictures_are_small_and_begin_with_bounds():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^]]+\]\((docs/images/[^)]+)\)", readme)
    assert sum((ROOT / picture).stat().st_size for picture in pictures) < 1_000_000
    assert "bounds" in pictures[0]
    assert readme.index(pictures[0]) < readme.index("git clone") < 2000
