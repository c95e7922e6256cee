"""What is wrong with a structure's file: all at once, each with line, key and what is allowed."""

import re
from collections.abc import Iterable
from typing import NamedTuple

from fpm.errors import SceneError


class Problem(NamedTuple):
    """One thing that is wrong: its line (0: none), a sentence that starts with the key.

    size: how far a value is off, by which the worst of several samples is told.
    """

    line: int
    text: str
    size: float = 0.0

    @property
    def where(self) -> tuple[int, str]:
        """Line and key."""
        return self.line, self.text.partition(":")[0]

    def __str__(self) -> str:
        return f"line {self.line}: {self.text}" if self.line else self.text


class StructureError(SceneError):
    """A structure that cannot be built; `problems` are all things that are wrong with it.

    `source` names the file. As a `SceneError` it has `key`, `value` and `allowed` too.
    """

    def __init__(self, source: str, problems: list[Problem]):
        self.source, self.problems = source, list(problems)
        super().__init__("structure", source, "a file without problems")
        count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
        self.args = (f"{source} has {count}:\n" + "\n".join(f"  {p}" for p in problems),)

    def __reduce__(self):
        return type(self), (self.source, self.problems)


class SkippedError(Exception):
    """Something is left out because what it refers to is wrong, or is no neighbour of the last."""


class Problems:
    """What is wrong with one file; the same sentence once."""

    def __init__(self, source: str):
        self.source = source
        self._found: dict[Problem, None] = {}

    def __bool__(self) -> bool:
        return bool(self._found)

    def refuse(self, line: int, key: str, value: object, allowed: str, size: float = 0.0) -> None:
        """Note that `key` has a value which is not allowed."""
        self.say(line, f"{key}: {show(value)} is not allowed; allowed: {allowed}", size)

    def say(self, line: int, sentence: str, size: float = 0.0) -> None:
        """Note a sentence, which starts with its key, about a line."""
        sentence = re.sub(r"\S{100,}", lambda word: f"{word[0][:97]}...", sentence)
        self._found[Problem(line, sentence, size)] = None

    def stop(self) -> None:
        """Raise them as one StructureError, by lines, if there are any."""
        if self._found:
            raise StructureError(self.source, sorted(self._found))


def show(value: object) -> str:
    """A value as short text."""
    text = f"{value:.9g}" if isinstance(value, float) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def among(names: Iterable[str], most: int = 12) -> str:
    """Names as a list in a sentence, cut short."""
    names = list(names)
    text = ", ".join(names[:most]) or "(there is none)"
    return text if len(names) <= most else f"{text}, and {len(names) - most} more"
