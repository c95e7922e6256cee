"""Links of the glossary's terms: each at its first use in the text of a page, to its row of
docs/terms.md, with its meaning as the title."""

import re
from pathlib import Path
from typing import Any

from docutils import nodes

GLOSSARY = Path(__file__).parents[1] / "terms.md"
EVERYDAY = {"action", "class"}
"""Terms that pages also use as everyday words, and that are not linked."""
NO_TEXT = nodes.literal, nodes.literal_block, nodes.reference, nodes.title, nodes.math, nodes.image


def read_terms(text: str) -> dict[str, str]:
    """Return the meaning of each term (singular, as written) of a glossary's rows, in order; that
    of a term of several rows by what they say in brackets."""
    terms: dict[str, str] = {}
    for cell, meaning in re.findall(r"^\| (?!here|---)(.+?) \| (.+?) \|", text, re.M):
        use = re.search(r"\((of .*?)\)", cell)
        for term in set(re.sub(r" \(.*?\)", "", cell).split(", ")) - EVERYDAY:
            meaning = f"{use[1]}: {meaning}" if use else meaning
            terms[term] = f"{terms[term]}; {meaning}" if term in terms else meaning
    return terms


def anchor(term: str) -> str:
    """Return the id of a term's row."""
    return "term-" + re.sub(r"[^a-z]+", "-", term.lower()).strip("-")


def link_terms(app: Any, doctree: nodes.document, docname: str) -> None:
    """Link the first use of each term in a page's text; give the glossary's rows their ids."""
    terms = read_terms(GLOSSARY.read_text(encoding="utf-8"))
    if docname == GLOSSARY.stem:
        for row in doctree.findall(nodes.row):
            for term in re.sub(r" \(.*?\)", "", row[0].astext()).split(", "):
                row["ids"] += [anchor(term)] if term in terms else []
        return
    url = app.builder.get_relative_uri(docname, GLOSSARY.stem)
    longest_first = sorted(terms, key=len, reverse=True)
    pattern = "|".join(re.escape(term).replace("`", "") for term in longest_first)
    words = re.compile(rf"(?<![\w-])({pattern})(?=s?(?![\w-]))", re.I)
    names = {term.casefold().replace("`", ""): term for term in terms}
    for paragraph in list(doctree.findall(nodes.paragraph)):
        for text in list(paragraph.findall(nodes.Text)):
            if any(isinstance(node, NO_TEXT) for node in _ancestors(text)):
                continue
            parts, end = [], 0
            for match in words.finditer(text):
                term = names.pop(match[1].casefold(), None)
                if term is None:
                    continue
                link = nodes.reference("", match[1], refuri=f"{url}#{anchor(term)}",
                                       reftitle=terms[term], classes=["term"])  # fmt: skip
                parts += [nodes.Text(text[end : match.start()]), link]
                end = match.end()
            if parts:
                text.parent.replace(text, [*parts, nodes.Text(text[end:])])


def _ancestors(node: nodes.Node) -> list[nodes.Node]:
    """The nodes in which a node of a document lies, the innermost first."""
    return [] if node.parent is None else [node.parent, *_ancestors(node.parent)]


def setup(app: Any) -> dict[str, bool]:
    """Register the links with Sphinx."""
    app.connect("doctree-resolved", link_terms)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
