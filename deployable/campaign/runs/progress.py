"""Messages of a process while it works, and when Ctrl-C ends it."""

import logging
import os
import re
import shutil
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from typing import Any, TextIO

import fpm
from deployable.campaign.text.numbers import duration_text
from fpm.scenes.timestep import compile_seconds

FIRST, PAUSE = 5.0, 20.0
"""Seconds of one step after which a log has a line on it, and the least from then to the next one;
each pause is at least a tenth of the time since the step began."""

TICK = 1.0  # seconds between two looks at a step

EXIT_CODE = 130  # exit status after Ctrl-C

STEPS: list[Callable[[], str]] = []
"""What this process does, the innermost step last: functions that return it in words."""

Notify = Callable[[str], None]

LOGGER = logging.getLogger("deployable")
"""Its level decides which messages are printed: warnings and errors, all, or times of stages."""
LOGGER.setLevel(LOGGER.level or logging.INFO)


class MessagePrinter:
    """Prints each message to text files, flushed at once, or calls functions in their place; `move`
    rewrites one line on terminals, and adds a line to logs now and then."""

    def __init__(self, *files: TextIO | Notify):
        self.files = files
        self.is_open = False  # whether the cursor stands behind a line that moves
        self.shown_text = ""  # its last state in logs
        self.message_time = time.monotonic()
        self.log_time = self.message_time + FIRST  # from which on a log has the next state
        self.lock = threading.Lock()

    def __call__(self, text: str) -> None:
        is_warning = re.search(r"(^|: )(warning|error): ", text)
        if not LOGGER.isEnabledFor(logging.WARNING if is_warning else logging.INFO):
            return
        with self.lock:
            for file in self.files:
                start = "\n" if self.is_open and is_terminal(file) else ""
                self._print(f"{start}{text}\n", file)
            self.is_open, self.message_time = False, time.monotonic()
            self.log_time = self.message_time + FIRST

    def move(self, text: str) -> None:
        """Replace the line that the last call wrote by `text`, or clear it; what is not a terminal
        gets a changed text as a new line, after pauses (`PAUSE`)."""
        if not LOGGER.isEnabledFor(logging.INFO):
            return
        with self.lock:
            clock_time = time.monotonic()
            is_due = clock_time >= self.log_time
            for file in self.files:
                if is_terminal(file):
                    width = shutil.get_terminal_size().columns - 1
                    self._print(f"\r\x1b[2K{text[:width]}", file)
                elif text and is_due and text != self.shown_text:
                    self._print(f"{text}\n", file)
            self.is_open = bool(text)
            if text and is_due:
                self.shown_text = text
                self.log_time = clock_time + max(PAUSE, (clock_time - self.message_time) / 10)

    @staticmethod
    def _print(text: str, file: TextIO | Notify) -> None:
        if callable(file):
            file(text.removesuffix("\n"))
            return
        with suppress(OSError):  # a log on a full disk, which the stage tells better
            file.write(text)
            file.flush()


def is_terminal(file: TextIO | Notify) -> bool:
    """Return whether a text file, or a function in its place, is a terminal."""
    return not callable(file) and file.isatty()


@contextmanager
def report_step(
    find_text: Callable[[float], str], notify: Notify, is_alone: bool = True
) -> Iterator[None]:
    """Report the (innermost) work in progress while the block runs: once a second on a terminal,
    now and then in a log. find_text: of the seconds so far; is_alone: False while processes are
    forked, when no thread may run: only for the message after Ctrl-C."""
    printer = notify if isinstance(notify, MessagePrinter) else MessagePrinter(notify)
    start, end = time.monotonic(), threading.Event()

    def describe() -> str:
        return find_text(time.monotonic() - start)

    def report() -> None:
        while not end.wait(TICK):
            if STEPS[-1] is describe:
                printer.move(describe())

    watch = threading.Thread(target=report, daemon=True)
    STEPS.append(describe)
    if is_alone:
        watch.start()
    try:
        yield
    finally:
        end.set()
        if is_alone:
            watch.join()
        STEPS.remove(describe)
        if printer.is_open:
            printer.move("")


def report_seconds(text: str, notify: Notify) -> AbstractContextManager[None]:
    """Report, while the block runs, what is done (`text`), with the seconds so far."""
    return report_step(lambda seconds: f"{text}, {duration_text(seconds)}", notify)


def progress_of(campaign: str, total: int, count: Callable[[], int]) -> Callable[[float], str]:
    """Return a function of the seconds from now that writes how many of a campaign's runs are done,
    and the time left by those that all jobs finished since. count: how many runs are done."""
    start_count = count()

    def describe(seconds: float) -> str:
        run_count = count()
        text = f"{campaign}: {run_count} of {total} runs done"
        if start_count < run_count < total:
            rest = seconds / (run_count - start_count) * (total - run_count)
            text += f", about {duration_text(rest)} left"
        return text

    return describe


def warm_up(scene: Any, notify: Notify, record: Sequence = ()) -> None:
    """Compile the kernels that a scene needs, or load them from the cache, before runs are timed,
    and report it where it takes long. record: (name, label) pairs as for `fpm.simulate`."""
    total = compile_seconds(fpm.list_kinds_to_compile(scene, record))

    def describe(seconds: float) -> str:
        whole = f" of some {total:.0f}" if seconds < total else f", {total:.0f} were estimated"
        return f"compiling for these kinds of element, once: {seconds:.0f} s{whole}"

    with report_step(describe, notify):
        fpm.warm_up(scene, record)


# -- Ctrl-C: what a process has made is whole, and the next run removes what it had begun ----------

_OWNER = os.getpid()  # the others that it forks say nothing


def end_on_ctrl_c() -> None:
    """Have Ctrl-C end this process at once with one sentence and status 130, unless Ctrl-C is
    ignored or handled otherwise already."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def _end(*rest: object) -> None:
    text = ""
    with suppress(Exception):  # a step that has just ended
        text = f" at: {STEPS[-1]()}"
    # By no file of Python, which may be in the midst of printing.
    end = "what is finished is kept, the same command goes on from there"
    start = "\n" if os.isatty(2) and text else ""  # below the line that moves
    if os.getpid() == _OWNER:
        os.write(2, f"{start}stopped{text}; {end}\n".encode())
    os._exit(EXIT_CODE)
