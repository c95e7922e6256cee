"""Texts of results are nobody's markup: every text of every result becomes a hostile one, and
summary, review sheet and page have the tags, lines and columns that they have without."""

from __future__ import annotations

import json
import re
import shutil
from html.parser import HTMLParser

import netCDF4
import numpy as np
import pytest

from deployable.campaign.cli import main
from deployable.campaign.folder import Folder
from deployable.campaign.results.templates import summary_text
from fpm.files.seals import check, seal, unseal

EVIL = (
    "<script>alert(1)</script>",
    "[a](javascript:alert(1))",
    "x\n\n# head\n\n| a | b |\n|---|---|\n",
    "`code` ``` ```\n<img src=x onerror=alert(1)>",
    '"\' onload=alert(1) x="',
    "&lt;script&gt; &#60;b&#62; \\<b\\> \x1b[31m\u202e~~s~~ **b** $x$",
    "--> <!-- </style></svg></pre><iframe>",
)
WORDS = {"met", "grade", "kind", "end", "sense", "bounds", "predicted_ends", "config_hash", "state"}
"""Keys of texts by which templates decide; others are no results (`contents.py`)."""


def hostile(data, evil, names=frozenset(), key=""):
    """Data with hostile text for all text in it, but for names that are checked."""
    if isinstance(data, dict):
        return {k: hostile(v, evil, names, k) for k, v in data.items()}
    if isinstance(data, list):
        return [hostile(one, evil, names, key) for one in data]
    is_text = isinstance(data, str) and key not in WORDS and data not in names
    return f"{evil}{data}{evil}" if is_text else data


def names_of(facts) -> set[str]:
    rows = (*facts["responses"], *facts["quantities"], *facts["parameters"])
    named = {row["name"] for row in rows} | {facts["campaign"]}
    return named | {row["name"] for row in facts.get("requirements", ())}


def raw_in(text: str) -> list[str]:
    """What of Markdown is markup that the program never writes."""
    bare = re.sub(r"\\[^\w\s]", "", text)
    return re.findall(r"<\w+|</|<!--|\]\(|```|&#?\w+;|[\x00-\x09\x0b-\x1f\u202e]", bare)


@pytest.mark.parametrize("evil", EVIL)
@pytest.mark.parametrize("template", ["summary.md.jinja", "review.md.jinja"])
def test_markdown_of_hostile_texts_has_the_lines_that_it_has(rich, evil, template):
    facts = json.loads((rich[0] / "summary.json").read_text(encoding="utf-8"))
    facts["review"] = {
        "title": "standard", "head": ["first", "second"], "heads": {"clause": "clause"},
        "rows": [{"clause": "4.7", "state": "met"}],
        "budgets": [{"title": "budget", "heads": ["part"], "rows": [["spring"]], "sum": "sum"}],
    }  # fmt: skip
    clean = summary_text(facts, template)
    text = summary_text(hostile(facts, evil, names_of(facts)), template)
    assert not raw_in(text)
    bars = [re.sub(r"\\.", "", line).count("|") for line in text.splitlines()]
    assert bars == [re.sub(r"\\.", "", line).count("|") for line in clean.splitlines()]


class Tags(HTMLParser):
    """Tags of a page, with the names of their attributes."""

    def __init__(self, text: str):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, [name for name, _ in attrs]))


def test_a_page_of_hostile_texts_has_the_tags_that_it_has(rich, tmp_path):
    whole, sections = rich
    clean = Tags(whole.report.read_text(encoding="utf-8")).found
    place = Folder(tmp_path / "rich")
    shutil.copytree(whole.path, place.path)
    facts = json.loads((place / "summary.json").read_text(encoding="utf-8"))
    evil = "".join(EVIL)
    path = place / "summary.json"
    changed = hostile({k: v for k, v in facts.items() if k != "seal"}, evil, names_of(facts))
    path.write_text(json.dumps(changed, indent=1) + "\n", encoding="utf-8")
    seal(path, {"name": path.name, "plan": f"-->{EVIL[0]}"})
    for path in place.path.glob("*.nc"):
        known = check(path)
        path.write_bytes(unseal(path))
        with netCDF4.Dataset(path, "a") as file:
            for name, variable in file.variables.items():
                if variable.dtype is str and re.search("units|long_name|contact|fit", name):
                    variable[:] = np.array([evil + t for t in variable[:]], dtype=object)
            for name in ("limiting_element", "design_method", "scene", "title"):
                if name in file.ncattrs():
                    file.setncattr(name, evil)
            if "provenance" in file.ncattrs():
                made = json.loads(file.provenance)
                file.provenance = json.dumps({**hostile(made, evil), evil: evil})
        facts = {key: evil for key in known if key not in ("name", "digest")}
        seal(path, {**facts, "name": path.name, "plan": f"-->{EVIL[0]}"})
    assert main(["page", str(place.path), "--config", sections["page"], "--frames", "2"]) == 0
    text = place.report.read_text(encoding="utf-8")
    shown = [tag for tag in Tags(text).found if tag[0] not in ("path", "wbr", "code")]
    assert shown == [tag for tag in clean if tag[0] not in ("path", "wbr", "code")]
    assert "alert(1)" in text and "<script>alert" not in text
