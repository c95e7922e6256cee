"""Table of keys of docs/structures.md: `python -m fpm.structures.table` prints it."""

from fpm.structures.keys import REQUIRED, Key, Opening
from fpm.structures.model import overall
from fpm.structures.statement import Statement
from fpm.structures.statements import STATEMENTS

HEAD = "| key | what it is | allowed | default |\n|---|---|---|---|\n"


def markdown() -> str:
    """One heading and table for each kind of statement."""
    return "\n".join(_section(one) for one in (*STATEMENTS, overall))


def _section(one: Statement) -> str:
    what = f"`{one.group}`" if one.group else "at the top of the file"
    title = f"{what}, `type: {one.type}`" if one.type else what
    slides = one.sliding(["joint", "watch"] if _slides(one) else [])
    rows = [
        f"| `{name}`{_if(other, name)} | {key.about} | {key.allowed}"
        f"{_if(slid.allowed, key.allowed)} | {_default(key)} |\n"
        for (name, key), (other, (_, slid)) in zip(one.keys.items(), slides.items(), strict=True)
    ]
    return f"### {title}\n\n{one.about}\n\n{HEAD}{''.join(rows)}"


def _slides(one: Statement) -> bool:
    """Whether it may act on slides, and on others."""
    return any(isinstance(k, Opening) and len(k.types) == 3 for k in one.keys.values())


def _if(other: str, own: str) -> str:
    """What is other on a slide."""
    return (
        "" if other == own else f" (on a slide {f'`{other}`' if other.isidentifier() else other})"
    )


def _default(key: Key) -> str:
    """The default as the file would have it."""
    value = key.default
    if value is REQUIRED:
        return "required"
    if value is None:
        return ""
    if isinstance(value, str):
        return f"`{value or 'none'}`"
    if isinstance(value, tuple):
        return "none"
    return (
        f"`{value:g}`" if isinstance(value, float) else f"`[{', '.join(f'{x:g}' for x in value)}]`"
    )


if __name__ == "__main__":
    print(markdown(), end="")
