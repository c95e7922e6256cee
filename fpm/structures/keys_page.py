"""The reference of all keys of structure files, made from the statements of the language."""

from typing import Any

from fpm.declare import NO_VALUE
from fpm.structures.model import overall
from fpm.structures.statement import Statement
from fpm.structures.statements import STATEMENTS

HEAD = "| key | what it is | allowed | default |\n|---|---|---|---|\n"


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
