"""How a process ends, and imports beside the work, which Ctrl-C must not meet.

An exception that Ctrl-C raises amid an import, while a thread imports as well, can leave Python's
lock of imports held for ever: the process then hangs. In a shell the process ends at once instead:
what it has published is whole, and the next run removes what it had begun.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
from importlib import import_module
from threading import Thread
from typing import NoReturn

STOPPED = 130
"""Exit status after Ctrl-C."""
_WORDS = "stopped; finished runs are kept, the same command goes on from there\n"


def end_on_ctrl_c() -> None:
    """Have Ctrl-C end this process with one sentence; where it is ignored, it stays so."""
    if _raises():
        signal.signal(signal.SIGINT, _end)


def leave(status: int) -> NoReturn:
    """End this process, whose work is done and whose other threads may be stopped.

    Python would take apart first what is loaded, which takes longer than a short stage.
    """
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def import_ahead(name: str) -> None:
    """Import a module in a thread, while others integrate; not where Ctrl-C raises."""
    if not _raises():
        Thread(target=import_module, args=(name,), daemon=True).start()


def _raises() -> bool:
    return signal.getsignal(signal.SIGINT) is signal.default_int_handler


def _end(*rest: object) -> None:
    os.write(2, _WORDS.encode())  # whatever is in the midst of printing
    os._exit(STOPPED)
