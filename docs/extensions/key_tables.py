"""Tables of all keys of configs and structures' files, made from their declarations."""

import json
from collections.abc import Iterator
from typing import Any

from deployable.campaign.config.keys import Rule, docstrings
from fpm.declare import NO_VALUE
from fpm.structures.model import overall
from fpm.structures.statement import Statement
from fpm.structures.statements import STATEMENTS

HEAD = "| key | what it is | allowed | default |\n|---|---|---|---|\n"


_UNIT_TEXTS = {
    "1": "or in %", "parameter": "unit: the parameter's", "response": "unit: the response's",
    "quantity": "unit: the quantity's",
}  # fmt: skip
"""What stands for units in the table."""


def rows(section: Rule, prefix: str = "") -> Iterator[tuple[str, str, str, str]]:
    """Yield the rows of the table of all config keys below a section: full name, description, what
    is allowed and default, as texts. prefix: put before the names, such as `solver.`."""
    texts = docstrings(section.section) if section.section else {}
    entries = {"<name>": section.entry} if section.entry and section.entry.text else {}
    for name, child in (section.children | entries).items():
        unit = child.unit and f" ({_UNIT_TEXTS.get(child.unit, child.unit)})"
        default = "" if name == "<name>" else _default_text(child)
        yield f"{prefix}{name}", texts.get(name, child.text) + unit, child.allowed, default
        yield from rows(child, f"{prefix}{name}.")


def _default_text(key: Rule) -> str:
    """The default in the table: nothing for what is absent, empty, or a section."""
    if key.default is NO_VALUE:
        return "required"
    if key.default in (None, (), "") or key.children or key.entry:
        return ""
    text = key.default if isinstance(key.default, str) else json.dumps(key.default)
    return f"`{text}`"


def table(config: Rule) -> str:
    """Return all keys of a config as Markdown, a heading and a table for each section.

    config: description of a whole config, as `read.whole` returns it."""
    groups: dict[str, list[str]] = {f"`{name}`": [] for name in config.children}
    for key, *row in rows(config):
        groups[f"`{key.partition('.')[0]}`"].append(f"| `{key}` | {' | '.join(row)} |\n")
    singles = {"The campaign": [row for part in groups.values() if len(part) == 1 for row in part]}
    sections = {name: part for name, part in groups.items() if len(part) > 1}
    parts = (singles | sections).items()
    return "\n".join(f"## {name}\n\n{HEAD}{''.join(part)}" for name, part in parts)


def keys_page() -> str:
    """Return all keys of structure files as Markdown, a heading and a table for each statement."""
    return "\n".join(map(_section, (*STATEMENTS, overall)))


def _section(statement: Statement) -> str:
    group = f"`{statement.group}`" if statement.group else "at the top of the file"
    title = f"{group}, `type: {statement.type}`" if statement.type else group
    is_either = any(opening.slides is None for opening in statement.openings.values())
    slide_keys = statement.for_slides(["joint", "watch"] if is_either else [])
    rows = [
        f"| `{name}`{_on_slide(slide_name, name, '`')} | {key.text} | {key.allowed}"
        f"{_on_slide(slide_key.allowed, key.allowed)} | {_default(key.default)} |\n"
        for (name, key), (slide_name, (_, slide_key)) in zip(
            statement.keys.items(), slide_keys.items(), strict=True
        )
    ]
    return f"## {title}\n\n{statement.text}\n\n{HEAD}{''.join(rows)}"


def _on_slide(text: str, usual: str, quote: str = "") -> str:
    """What differs on a slide."""
    return "" if text == usual else f" (on a slide {quote}{text}{quote})"


def _default(value: Any) -> str:
    """A default as the file would have it."""
    match value:
        case _ if value is NO_VALUE:
            return "required"
        case None:
            return ""
        case str():
            return f"`{value or 'none'}`"
        case tuple():
            return "none"
        case float():
            return f"`{value:g}`"
    return f"`[{', '.join(f'{x:g}' for x in value)}]`"
