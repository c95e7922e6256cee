"""Harm to files of runs that are kept."""

from pathlib import Path


def harm_file(path: Path, other: Path, harm: str) -> None:
    """Lose a file, flip a bit of it (`flipped`), or put another's content under its name."""
    if harm == "lost":
        path.unlink()
    elif harm == "flipped":
        content = path.read_bytes()
        middle = len(content) // 2
        path.write_bytes(content[:middle] + bytes([content[middle] ^ 4]) + content[middle + 1 :])
    else:
        path.write_bytes(other.read_bytes())
