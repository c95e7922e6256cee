"""Docstrings of this program as reStructuredText: they are prose, with code in `backticks`."""

import re

_CODE = re.compile(r"(`+[^`]+`+)")
_MARKS = re.compile(r"([*|])")
_NAME = re.compile(r"\b(\w+)_(?=\W|$)")


def as_rst(line: str) -> str:
    """A line whose code is literal, and whose stars, bars and trailing underscores are text."""
    parts = _CODE.split(line)
    for i, part in enumerate(parts):
        if i % 2:
            parts[i] = f"``{part.strip('`')}``"
        else:
            parts[i] = _NAME.sub(r"\1\\_", _MARKS.sub(r"\\\1", part))
    return "".join(parts)


def process(app, what, name, obj, options, lines):
    """Before napoleon reads the sections; an indented block after an empty line is a listing."""
    out, literal = [], False
    for before, line in zip(["", *lines], lines, strict=False):
        indented = line.startswith("    ")
        if indented and not before.strip() and out and not literal:
            if not out[-2:][0].rstrip().endswith("::"):
                out += ["::", ""]
            literal = True
        elif line.strip() and not indented:
            literal = False
        out.append(line if literal else as_rst(line))
    lines[:] = out


def setup(app):
    """Listen before napoleon does."""
    app.connect("autodoc-process-docstring", process, priority=100)
    return {"parallel_read_safe": True}
