"""A digest of source code that changes with what the code does, not with how it is written."""

import ast
import hashlib
from collections.abc import Iterable
from pathlib import Path


def syntax_digest(paths: Iterable[Path]) -> str:
    """First 16 hex digits of a SHA-256 of the syntax trees of Python files.

    Comments, formatting and docstrings do not count, nor where the files lie or in which order they
    are given; their names and everything that runs does. SyntaxError for a file that is no Python.
    """
    digest = hashlib.sha256()
    for name, tree in sorted((path.name, _tree(path)) for path in paths):
        digest.update(f"{name}\0{tree}\0".encode())
    return digest.hexdigest()[:16]


def _tree(path: Path) -> str:
    """The syntax tree of a file as text, without bare strings (docstrings)."""
    tree = ast.parse(path.read_bytes(), str(path))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [statement for statement in body if not _is_text(statement)]
    return ast.dump(tree)


def _is_text(statement: ast.AST) -> bool:
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    )
