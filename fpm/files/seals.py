"""Files that tell what they are, and whether they are still as they were written.

A sealed file ends with a line of facts as JSON: a digest of all the bytes before it and of the
facts, and what the file is (`name`, what its writer adds). Readers of netCDF, PNG and PDF overlook
that line; in Markdown, HTML and SVG it is a comment, in JSON it is the first key. Files appear
whole or not at all: written under a temporary name, which says whose it is, and renamed."""

import hashlib
import json
import os
import re
import socket
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path

_CHUNK = 1 << 20
_LARGE = 16 << 20  # bytes that take a while to read
_LONGEST = 1 << 20  # bytes of a seal, at most
_MOST = 1 << 30  # bytes of a file that is read at once
_COMMENT = {".md", ".html", ".svg"}
_KEY = re.compile(rb'^\{\n "seal": (\{[^\n]*\}),\n')
_LINE = re.compile(rb'(?:\A|\n)(?:<!-- )?\{"seal": (\{[^\n]*\})\}(?: -->)?\n\Z')
_TEMPORARY = re.compile(r"^\..*\.(?P<host>[^.]+)-(?P<process>\d+)\.part(\.\w+)?$")


class DamagedError(OSError):
    """Raised for a file that exists, but is not as it was written, or not the expected one. path:
    of the file; reason: why, in words."""

    def __init__(self, path: str | os.PathLike, reason: str):
        self.path, self.reason = Path(path), reason
        super().__init__(f"{os.fspath(path)} cannot be used: {reason}")

    def __reduce__(self):
        return type(self), (self.path, self.reason)


def seal(path: str | os.PathLike, facts: Mapping[str, str]) -> None:
    """Append a seal to the complete file at `path` (in JSON, an object over several lines: insert
    it as first key): a line of JSON, in an HTML comment in pages, SVG and Markdown, with `facts`
    (text by key, with `name`, what the file is) and a digest of both."""
    path = Path(path)
    if path.suffix == ".json":
        content = read_bytes(path)
        line = _json(_with_digest(hashlib.sha256(content), facts))
        path.write_bytes(f'{{\n "seal": {line},\n'.encode() + content.removeprefix(b"{\n"))
        return
    line = _json({"seal": _with_digest(_digest(path, path.stat().st_size), facts)})
    line = f"<!-- {line} -->" if path.suffix in _COMMENT else line
    with open(path, "ab") as file:
        file.write(f"\n{line}\n".encode())


def _json(data: Mapping) -> str:
    """JSON on one line that ends no comment and begins no tag, whatever facts say."""
    return json.dumps(data).replace("<", "\\u003c").replace(">", "\\u003e")


def check(path: str | os.PathLike, name: str | None = None) -> dict[str, str]:
    """Check that a sealed file is as it was written, and what `name` says (None: anything); return
    the facts in its seal. DamagedError, or FileNotFoundError."""
    path = Path(path)
    if path.suffix == ".json":
        return check_content(path, read_bytes(path), name)
    facts, size = read_seal(path)
    _compare(path, facts, _digest(path, size), name)
    return facts


def read_seal(path: Path) -> tuple[dict[str, str], int]:
    """Return the facts in the seal of a file that is not JSON, unchecked, and the number of bytes
    before it. Raises DamagedError without a seal, FileNotFoundError without a file."""
    if not stat.S_ISREG(os.stat(path).st_mode):  # a pipe would be waited for
        raise DamagedError(path, "it is not a plain file")
    size = path.stat().st_size
    with open(path, "rb") as file:
        file.seek(max(0, size - _LONGEST))
        end = file.read()
    end = end[max(0, end.rfind(b"\n", 0, -1)) :]
    facts, rest = _split(path, end)
    return facts, size - len(end) + len(rest)


def read_bytes(path: str | os.PathLike, most: int = _MOST) -> bytes:
    """Return the content of the plain file at `path`; raises DamagedError if it is none, or longer
    than `most` bytes. Devices and pipes are refused at once."""
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | _NONBLOCK)) as file:
        state = os.fstat(file.fileno())
        if not stat.S_ISREG(state.st_mode):
            raise DamagedError(path, "it is not a plain file but a device or a pipe")
        if state.st_size > most:
            raise DamagedError(path, f"it is too long; allowed: at most {most} bytes")
        return file.read(most)


_NONBLOCK = getattr(os, "O_NONBLOCK", 0)


def unseal(path: str | os.PathLike) -> bytes:
    """Return the sealed file at `path` without its seal; DamagedError if not as it was written."""
    facts, rest = _split(path, read_bytes(path))
    _compare(path, facts, hashlib.sha256(rest), None)
    return rest


def check_content(path: str | os.PathLike, content: bytes, name: str | None = None) -> dict:
    """Check a sealed file by its bytes, `content`; return the facts in its seal. path: its ending
    tells the format; name: as in `check`. DamagedError."""
    facts, rest = _split(path, content)
    _compare(path, facts, hashlib.sha256(rest), name)
    return facts


def _split(path: str | os.PathLike, content: bytes) -> tuple[dict[str, str], bytes]:
    """Return the facts in the seal of a file's content, and what is left without the seal."""
    if Path(path).suffix == ".json":
        match = _KEY.match(content)
        text, rest = (match[1], b"{\n" + content[match.end() :]) if match else (b"", b"")
    else:
        match = _LINE.search(content, max(0, content.rfind(b"\n", 0, -1)))
        text, rest = (match[1], content[: match.start()]) if match else (b"", b"")
    with suppress(ValueError, RecursionError):
        facts = json.loads(text)
        if isinstance(facts, dict) and {"name", "digest"} <= facts.keys():
            return {str(key): str(value) for key, value in facts.items()}, rest
    raise DamagedError(path, "it was cut off or edited, or is not a file of this program")


def _compare(path: str | os.PathLike, facts: dict[str, str], content, name: str | None) -> None:
    header = {key: value for key, value in facts.items() if key != "digest"}
    if _with_digest(content, header)["digest"] != facts["digest"]:
        raise DamagedError(path, "its contents have changed: run the campaign again")
    if name is not None and facts["name"] != name:
        raise DamagedError(path, f"it is {facts['name']}, not {name}")


def _with_digest(content, facts: Mapping[str, str]) -> dict[str, str]:
    content.update(json.dumps(dict(facts), sort_keys=True).encode())
    return {**facts, "digest": content.hexdigest()[:32]}


def _digest(path: Path, size: int):
    """Hash of the first `size` bytes of a file, which may be larger than memory; a large one is
    read once for several checks by one process, as long as it is the same."""
    if size < _LARGE:
        return _hash(path, size)
    st = path.stat()
    return _cached_hash(path, size, st.st_dev, st.st_ino, st.st_mtime_ns, st.st_ctime_ns).copy()


@lru_cache(8)
def _cached_hash(path: Path, size: int, *state: int):
    return _hash(path, size)


def _hash(path: Path, size: int):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while size > 0 and (part := file.read(min(size, _CHUNK))):
            digest.update(part)
            size -= len(part)
    return digest


@contextmanager
def whole_file(path: str | os.PathLike, facts: Mapping[str, str] | None = None) -> Iterator[Path]:
    """Return a context manager that gives a temporary path, renamed to `path` when the block ends,
    removed after an error. facts: of the file's seal, None: no seal."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    # Some writers need the ending, but a listing of netCDF files must not find an unfinished one.
    suffix = "" if path.suffix == ".nc" else path.suffix
    temporary = path.with_name(f".{path.stem}.{_host()}-{os.getpid()}.part{suffix}")
    try:
        yield temporary
        if facts is not None:
            seal(temporary, facts)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def remove_temporary(folder: str | os.PathLike) -> list[Path]:
    """Remove from a folder what ended processes here left of `whole_file`; returns the paths."""
    paths = []
    with suppress(FileNotFoundError, NotADirectoryError):
        for entry in os.scandir(os.fspath(folder)):
            match = _TEMPORARY.match(entry.name)
            if match and match["host"] == _host() and not _is_alive(int(match["process"])):
                with suppress(FileNotFoundError):
                    os.unlink(entry.path)
                    paths.append(Path(entry.path))
    return paths


def _host() -> str:
    return socket.gethostname().replace(".", "_") or "host"


def _is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # somebody else's
        return True
    with suppress(OSError, IndexError):  # one that was killed, which its parent has not noticed yet
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    return True
