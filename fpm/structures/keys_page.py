"""The reference of all keys of structure files, made from the statements of the language."""

from typing import Any

from fpm.structures.keys import NO_VALUE
from fpm.structures.model import overall
from fpm.structures.statement import Statement
from fpm.structures.statements import STATEMENTS

HEAD = "| key | what it is | allowed | default |\n|---|---|---|---|\n"


def keys_page() -> str:
    """Return all keys of structure files as Markdown, a heading and a table for each statement."""
    return "\n".join(_section(one) for one in (*STATEMENTS, overall))


def _section(one: Statement) -> str:
    what = f"`{one.group}`" if one.group else "at the top of the file"
    title = f"{what}, `type: {one.type}`" if one.type else what
    both = any(opening.slides is None for opening in one.openings.values())
    slides = one.for_slides(["joint", "watch"] if both else [])
    rows = [
        f"| `{name}`{_if(other, name, '`')} | {key.text} | {key.allowed}"
        f"{_if(slid.allowed, key.allowed)} | {_default(key.default)} |\n"
        for (name, key), (other, (_, slid)) in zip(one.keys.items(), slides.items(), strict=True)
    ]
    return f"## {title}\n\n{one.text}\n\n{HEAD}{''.join(rows)}"


def _if(other: str, own: str, quote: str = "") -> str:
    """What is other on a slide."""
    return "" if other == own else f" (on a slide {quote}{other}{quote})"


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
