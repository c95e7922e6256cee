"""The glossary, docs/terms.md: every term of it is used on a page, and pages link to it."""

import re
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

DOCS = Path(__file__).parents[2] / "docs"
sys.path.append(str(DOCS / "extensions"))
PAGES = [p for p in sorted(DOCS.rglob("*.md")) if p.name != "terms.md" and "made" not in p.parts]
NO_PROSE = re.compile(
    r"^ *```.*?^ *```$|^[#|].*?$|!?\[[^\]]*\]\((?!\S*terms)[^)]*\)|`[^`\n]*`|\$[^$\n]*\$",
    re.M | re.S,
)


def terms() -> list[str]:
    cells = re.findall(r"^\| (?!here|---)(.+?) \|", (DOCS / "terms.md").read_text("utf-8"), re.M)
    return [term for cell in cells for term in re.sub(r" \(.*?\)", "", cell).split(", ")]


def uses(text: str, term: str) -> bool:
    """Whether a text has a term, singular or plural, in any case."""
    return re.search(rf"(?<![\w-]){re.escape(term)}s?(?![\w-])", text, re.I) is not None


def prose(page: Path) -> str:
    return " ".join(NO_PROSE.sub(" ", page.read_text("utf-8")).split())


def test_every_term_is_used_on_a_page():
    pages = [" ".join(page.read_text("utf-8").split()) for page in PAGES]
    assert not [term for term in terms() if not any(uses(page, term) for page in pages)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_that_uses_a_term_links_the_glossary(page):
    links = re.findall(r"\[([^\]]+)\]\((?:\.\./)?terms\.md\)", page.read_text("utf-8"))
    assert len(links) <= 3
    assert links or not [term for term in terms() if uses(prose(page), term)]


def test_the_site_links_a_term_at_its_first_use_and_nowhere_else():
    term_links = pytest.importorskip("term_links", reason="in the extra `docs`")
    from docutils.core import publish_doctree

    builder = SimpleNamespace(get_relative_uri=lambda source, target: f"{target}.html")
    page = publish_doctree(
        "Box\n===\n\nA ``box`` of nodes: every BOX, margins, sandbox, bounds, box\n"
    )
    term_links.link_terms(SimpleNamespace(builder=builder), page, "page")
    links = [(x["refuri"], x.astext()) for x in page.findall() if x.tagname == "reference"]
    assert links == [
        (f"terms.html#term-{anchor}", word)
        for anchor, word in (
            ("node", "node"),
            ("box", "BOX"),
            ("margin", "margin"),
            ("bounds", "bounds"),
        )
    ]
    meanings = term_links.read_terms((DOCS / "terms.md").read_text("utf-8"))
    assert meanings["margin"].startswith("of a run: ") and "; of a joint: " in meanings["margin"]
