"""Messages of a batch while it runs."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, TextIO

import fpm
from deployable.campaign.text.numbers import duration_text
from fpm.scenes.effort import compile_seconds

PAUSE = 5.0
"""Seconds between two words while kernels are compiled."""

Notify = Callable[[str], None]


class MessagePrinter:
    """Prints each message it is called with to text files, flushed at once; `move` rewrites one
    line on terminals, and on other files prints each new text as a line of its own."""

    def __init__(self, *files: TextIO):
        self.files = files
        self.is_open = False  # whether the cursor stands behind a line that moves
        self.shown_text = ""  # its last state

    def __call__(self, text: str) -> None:
        for file in self.files:
            start = "\n" if self.is_open and file.isatty() else ""
            self._print(f"{start}{text}\n", file)
        self.is_open = False

    def move(self, text: str, last: bool = False) -> None:
        """Replace the line that the last call wrote by `text`, on terminals; other files get each
        new text as a line of its own. last: whether to end the line."""
        end = "\n" if last else ""
        for file in self.files:
            if file.isatty():
                self._print(f"\r\x1b[2K{text}{end}", file)
            elif text != self.shown_text:
                self._print(f"{text}\n", file)
        self.is_open, self.shown_text = not last, text

    @staticmethod
    def _print(text: str, file: TextIO) -> None:
        with suppress(OSError):  # a log on a full disk, which the stage tells better
            file.write(text)
            file.flush()


class Progress:
    """Reports how many runs of a campaign are done, and the time left, estimated from those that
    all jobs finished since this object was made. campaign: its name; total: number of runs; count:
    function that returns how many are done; notify: called with each message."""

    def __init__(self, campaign: str, total: int, count: Callable[[], int], notify: Notify):
        self.campaign, self.total, self.count, self.notify = campaign, total, count, notify
        self.start_time, self.start_count = time.monotonic(), count()
        self.report_time = -math.inf

    def report(self, last: bool = True) -> None:
        """Tell how many runs are done and the time left; at most once a second unless `last`."""
        clock_time = time.monotonic()
        if not last and clock_time < self.report_time + 1.0:
            return
        self.report_time, count = clock_time, self.count()
        new_count = count - self.start_count
        text = f"{self.campaign}: {count} of {self.total} runs done"
        if count < self.total and new_count > 0:
            seconds = (clock_time - self.start_time) / new_count * (self.total - count)
            text += f", about {duration_text(seconds)} left"
        if isinstance(self.notify, MessagePrinter):
            self.notify.move(text, last)
        else:
            self.notify(text)


def warm_up(scene: Any, notify: Notify, record: Sequence = ()) -> None:
    """Compile the kernels that a scene needs, or load them from the cache, before runs are timed;
    `notify` is called with a message after five seconds, then each five on a terminal, or elsewhere
    when the time has doubled. record: (name, label) pairs as for `fpm.simulate`."""
    start, end, total = time.monotonic(), threading.Event(), compile_seconds(scene)
    is_printer = isinstance(notify, MessagePrinter)
    move = notify.move if is_printer else notify
    is_live = is_printer and any(file.isatty() for file in notify.files)

    def report() -> None:
        pause = PAUSE
        while not end.wait(pause):
            seconds = time.monotonic() - start
            whole = f" of some {total:.0f}" if seconds < total else f", {total:.0f} were estimated"
            move(f"compiling for these kinds of element, once: {seconds:.0f} s{whole}")
            pause = PAUSE if is_live else seconds

    watch = threading.Thread(target=report, daemon=True)
    watch.start()
    try:
        fpm.warm_up(scene, record)
    finally:
        end.set()
        watch.join()
