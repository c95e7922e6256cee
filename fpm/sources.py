"""A digest of source code that changes with what the code does, not with how it is written."""

import ast
import hashlib
import inspect
import os
import re
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

IMPORTED = re.compile(r"^\s*(?:from|import) ([\w.]+)", re.MULTILINE)

HERE = Path(__file__).parent

OTHER = {"classic.py", "compiled.py", "errors.py", "sources.py", "trajectory.py", "warming.py"}
"""Files of the mechanics that do not change a run's numbers: how code and files are kept."""


def mechanics_sources() -> list[Path]:
    """The files of the mechanics that can change a run's numbers, but for the structures'."""
    folders = (HERE, HERE / "kernels", HERE / "kinds")
    paths = [path for folder in folders for path in folder.glob("*.py") if path.name not in OTHER]
    return [*paths, HERE / "scenes" / "__init__.py"]


def own_sources(module: str) -> set[Path]:
    """The file of an imported module, and those beside it that it imports, and so on."""
    found: set[Path] = set()
    left = [module]
    while left:
        module = sys.modules.get(left.pop())
        path = Path(getattr(module, "__file__", None) or "")
        if path in found or (found and path.parent not in {p.parent for p in found}):
            continue
        found.add(path)
        if path.name == "__init__.py":
            continue  # all its modules hang on it
        left += IMPORTED.findall(path.read_text())
        left += [value.__name__ for value in vars(module).values() if inspect.ismodule(value)]
    return found


def syntax_digest(paths: Iterable[Path]) -> str:
    """First 16 hex digits of a SHA-256 of the syntax trees of Python files.

    Comments, formatting and docstrings do not count, nor where the files lie or in which order they
    are given; their names and everything that runs does, and every byte of other files. SyntaxError
    for a `.py` that is no Python.
    """
    digest = hashlib.sha256(repr(sorted((path.name, tree_digest(path)) for path in paths)).encode())
    return digest.hexdigest()[:16]


def tree_digest(path: Path) -> str:
    """Digest of the syntax tree of a file, without bare strings (docstrings), or of its bytes.

    To parse takes a hundred times longer than to read, so the digest for a file's bytes is kept on
    disk. A cache that can not be written is done without.
    """
    content = path.read_bytes()
    if path.suffix != ".py":
        return hashlib.sha256(content).hexdigest()
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    memo = _cache() / f"{hashlib.sha256(content).hexdigest()}-{version}"
    with suppress(OSError):
        kept = memo.read_text()
        if len(kept) == 64:
            return kept
    found = hashlib.sha256(_tree(content, path).encode()).hexdigest()
    with suppress(OSError):
        memo.parent.mkdir(parents=True, exist_ok=True)
        part = memo.with_name(f"{memo.name}.{os.getpid()}")
        part.write_text(found)
        os.replace(part, memo)
    return found


def _cache() -> Path:
    user = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return user / "fpm" / "syntax"


def _tree(content: bytes, path: Path) -> str:
    """The syntax tree of a file as text, without bare strings (docstrings)."""
    tree = ast.parse(content, str(path))
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
