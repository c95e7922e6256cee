"""What attacks lead to, counted: nothing may be wrong, stuck, a traceback or a hang."""

import signal
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

GOOD = ("right", "refused", "made again", "open")
BAD = ("wrong", "stuck", "traceback", "hang")
WORDS = {
    "right": "no harm done",
    "refused": "refused cleanly",
    "made again": "told and made again",
    "open": "hangs on rounding",
    "wrong": "wrong result",
    "stuck": "stuck",
    "traceback": "traceback",
    "hang": "hang",
}


class HangError(Exception):
    """Something took longer than it may."""


@dataclass
class Ledger:
    """Counts of (attack, what it led to), and what to know of the bad ones."""

    counts: Counter = field(default_factory=Counter)
    bad: list[tuple[str, str, str]] = field(default_factory=list)

    def note(self, attack: str, outcome: str, detail: str = "") -> None:
        """Count one; `detail` tells how to do a bad one again."""
        self.counts[attack, outcome] += 1
        if outcome in BAD:
            self.bad.append((attack, outcome, detail))

    def attempt(self, attack: str, detail: str, limit: float, act: Callable[[], str]) -> None:
        """Count what an attack leads to: what `act` says, or its exception, or the time limit (s).

        In the main thread only."""
        try:
            with time_limit(limit):
                outcome = act()
        except HangError:
            self.note(attack, "hang", detail)
        except Exception:
            self.note(attack, "traceback", f"{detail}\n{traceback.format_exc()}")
        else:
            self.note(attack, outcome, detail)

    @property
    def count_bad(self) -> int:
        """Number of bad outcomes."""
        return len(self.bad)

    def table(self) -> str:
        """The counts as Markdown."""
        outcomes = (*GOOD, *BAD)
        head = ["attack", "tried", *(WORDS[outcome] for outcome in outcomes)]
        lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
        for attack in dict.fromkeys(attack for attack, _ in self.counts):
            row = [self.counts[attack, outcome] for outcome in outcomes]
            lines.append(f"| {attack} | {sum(row)} | {' | '.join(map(str, row))} |")
        return "\n".join(lines) + "\n"


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise `HangError` in the block after so much cpu time, or ten times as long by the clock:
    on a busy machine, waiting is not hanging."""

    def stop(*rest: object) -> None:
        raise HangError

    clocks = {
        signal.SIGPROF: (signal.ITIMER_PROF, seconds),
        signal.SIGALRM: (signal.ITIMER_REAL, 10 * seconds),
    }
    handlers = {number: signal.signal(number, stop) for number in clocks}
    for timer, most in clocks.values():
        signal.setitimer(timer, most)
    try:
        yield
    finally:
        for number, (timer, _) in clocks.items():
            signal.setitimer(timer, 0.0)
            signal.signal(number, handlers[number])
