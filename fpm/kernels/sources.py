"""A digest of source code that changes with what the code does, not with how it is written."""

import ast
import hashlib
import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path

from fpm.errors import SceneError

HERE = Path(__file__).parents[1]

UNCOUNTED = ("files", "motions", "reading", "structures")
"""Rooms of the mechanics that change no run's numbers: how runs are kept and what is read off them.
Of the language of structures a structure's own digest says what counts (structures).
"""

VERSION = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:8]
"""Of this file, so that digests kept on disk by another one are not met."""


def mechanics_sources() -> list[Path]:
    """The files of the mechanics that can change a run's numbers, but for the structures'."""
    paths = [path.relative_to(HERE) for path in HERE.rglob("*.py")]
    return [HERE / path for path in paths if path.parts[0] not in UNCOUNTED]


def own_sources(*starts: Path) -> set[Path]:
    """Python files, those beside and below them that they import, packages too, and so on; and of
    kinds of elements the kernels: the file beside with `_kernels` behind its name.

    Only files count, not what is imported when. SceneError for a start that is none.
    """
    found: set[Path] = set()
    left = [path.resolve() for path in starts]
    for path in left:
        if not path.is_file():
            raise _no_file(str(path))
    while left:
        path = left.pop()
        if path not in found:
            found.add(path)
            roots = {start.resolve().parent for start in starts}
            near = (*_imported(path, roots), path.with_name(f"{path.stem}_kernels.py"))
            others = (other.resolve() for other in near if other.is_file())
            left += [other for other in others if HERE not in other.parents]
    return found


def file_of(thing: Callable) -> Path:
    """The file in which a function or class was written; SceneError if it was typed in."""
    try:
        return Path(inspect.getfile(inspect.unwrap(thing))).resolve()
    except (OSError, TypeError):
        raise _no_file(repr(thing)) from None


def _no_file(found: str) -> SceneError:
    allowed = "code in a Python file: results and compiled code are named after its content"
    return SceneError("source of a structure or kind", found, allowed)


def _imported(path: Path, roots: Iterable[Path] = ()) -> Iterator[Path]:
    """Files beside a file, or below the folders `roots`, that its imports would name, whether they
    exist or not; of a package `__init__.py`, too."""
    for name, level in _names_imported(path.read_bytes(), str(path)):
        parts = name.split(".")
        yield from _beside(path.parent, parts, level)
        for root in [path.parent, *path.parents][level : level + 1] if level else roots:
            for count in range(1, len(parts) + 1):
                place = root.joinpath(*parts[:count])
                if count > 1 or (place / "__init__.py").is_file():
                    yield place.with_suffix(".py")
                    yield place / "__init__.py"


@cache
def _names_imported(content: bytes, path: str) -> list[tuple[str, int]]:
    """Names in the imports of a file with this content, each with its number of leading dots."""
    found = []
    for node in ast.walk(ast.parse(content, path)):
        if isinstance(node, ast.Import):
            found += [(alias.name, 0) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            names = [base, *(f"{base}.{alias.name}".strip(".") for alias in node.names)]
            found += [(name, node.level) for name in names if name]
    return found


def _beside(folder: Path, parts: list[str], level: int) -> Iterator[Path]:
    """The files in a folder that an imported name, or a part of it from the left, may stand for."""
    for count in range(1, len(parts) + 1):
        *packages, name = parts[:count]
        if level:  # from the folder itself, or those above it
            right = folder.parents[level - 2] if level > 1 else folder
            fits = right.joinpath(*packages) == folder
        else:
            fits = list(folder.parts[len(folder.parts) - len(packages) :]) == packages
        if fits and name != "__init__":
            yield folder / f"{name}.py"


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
    return _tree_digest(content, str(path))


@cache
def _tree_digest(content: bytes, path: str) -> str:
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    memo = user_cache() / "syntax" / f"{hashlib.sha256(content).hexdigest()}-{version}-{VERSION}"
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


def user_cache() -> Path:
    """The folder of the user's in which may be kept what can be made again."""
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "deployable-intervals"


def _tree(content: bytes, path: str) -> str:
    """The syntax tree of a file as text, without bare strings (docstrings)."""
    tree = ast.parse(content, path)
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
