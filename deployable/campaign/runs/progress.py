"""What a batch tells while it runs."""

from __future__ import annotations

import fcntl
import hashlib
import json
import math
import os
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, TextIO

from fpm.kernels.sources import user_cache

Tell = Callable[[str], None]

_IDLE = 120.0  # s without a job at work, after which the next one begins anew


class Teller:
    """Prints messages to files; `move` is one line that changes, on files that are terminals.

    Elsewhere every state of the line is a line of its own.
    """

    def __init__(self, *files: TextIO):
        self.files = files
        self.is_open = False  # whether the cursor stands behind a line that moves

    def __call__(self, text: str) -> None:
        for file in self.files:
            start = "\n" if self.is_open and file.isatty() else ""
            self._print(f"{start}{text}\n", file)
        self.is_open = False

    def move(self, text: str, last: bool = False) -> None:
        """Say how things stand; `last`: and go on to the next line."""
        end = "\n" if last else ""
        for file in self.files:
            self._print(f"\r\x1b[2K{text}{end}" if file.isatty() else f"{text}\n", file)
        self.is_open = not last

    @staticmethod
    def _print(text: str, file: TextIO) -> None:
        with suppress(OSError):  # a log on a full disk, which the stage tells better
            file.write(text)
            file.flush()


class Progress:
    """Tells how many runs of the campaign are done and how long the rest will take.

    Counts what all jobs have written to `folder` since the first of them began, so that all
    of them foretell the same.
    """

    def __init__(
        self, campaign: str, total: int, count: Callable[[], int], tell: Tell, folder: Path
    ):
        self.campaign, self.total, self.count, self.tell = campaign, total, count, tell
        self.note = note_of(folder)
        self.start_time, self.start_count = _beginning(self.note, count())
        self.told = -math.inf

    def report(self, last: bool = True) -> None:
        """Tell; not more than once a second unless it is the last time."""
        if not last and time.monotonic() < self.told + 1.0:
            return
        self.told = time.monotonic()
        done = self.count()
        gained = done - self.start_count
        text = f"{self.campaign}: {done} of {self.total} runs done"
        if done < self.total and gained > 0:
            left = (time.time() - self.start_time) / gained * (self.total - done)
            text += f", about {duration_text(left)} left"
        if isinstance(self.tell, Teller):
            self.tell.move(text, last)
        else:
            self.tell(text)
        with suppress(OSError):
            if done < self.total:
                os.utime(self.note, (time.time(),) * 2)
            else:
                self.note.unlink(missing_ok=True)


def note_of(folder: Path) -> Path:
    """The file by which this machine's jobs that write to a folder know when they began; not among
    the results, which may be carried elsewhere as they are."""
    key = hashlib.sha256(str(folder.resolve()).encode()).hexdigest()[:16]
    return user_cache() / f"progress-{key}.json"


def _beginning(note: Path, count: int) -> tuple[float, int]:
    """When (s since 1970) the jobs that work at this began, and how many runs there were then: as
    the first of them noted it for the others.

    A note that none has touched for long is of jobs that were killed. Where files have no locks,
    each job goes by its own.
    """
    own = time.time(), count
    with suppress(OSError):
        note.parent.mkdir(parents=True, exist_ok=True)
    with suppress(OSError, ValueError, TypeError), note.open("a+", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        known = os.fstat(file.fileno())
        if known.st_size and own[0] - known.st_mtime < _IDLE:
            file.seek(0)
            began, before = json.load(file)
            return float(began), int(before)
        file.truncate(0)
        file.write(json.dumps(own))
    return own


def duration_text(seconds: float) -> str:
    """`95` s as `1 min 35 s`."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def warm_up(scene: Any, tell: Tell, record: Sequence = ()) -> None:
    """Compile the kernels for a scene, or load them, and tell if that takes a while.

    record: as for `fpm.simulate`.
    """
    import fpm

    slow = threading.Timer(5.0, tell, ["compiling the kernels, once; this takes about a minute"])
    slow.daemon = True
    slow.start()
    fpm.warm_up(scene, record)
    slow.cancel()
