"""How a process ends. In a shell Ctrl-C ends it at once, with one sentence: what it has made is
whole, and the next run removes what it had begun."""

import os
import signal
from collections.abc import Callable
from contextlib import suppress

EXIT_CODE = 130  # exit status after Ctrl-C

STEPS: list[Callable[[], str]] = []
"""What this process does, the innermost step last: functions that return it in words."""

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
