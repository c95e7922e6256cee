"""Processes killed and disks full: nothing half written is published, and all goes on."""

import os
import random
import resource
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import yaml

from evidence.attack.ledger import Ledger
from evidence.attack.victim import Victim, list_broken_files, list_leftovers

ROOT = Path(__file__).parents[2]
LIMIT = 30.0
"""Seconds (see `time_limit`) for a run of some three, and once more."""


def command(victim: Victim, place: Path, figures: bool = False) -> list[str]:
    """The command line that runs the victim into `place`."""
    place.mkdir(parents=True, exist_ok=True)
    config = place / "victim.yaml"
    config.write_text(yaml.safe_dump(victim.raw), encoding="utf-8")
    quiet = [] if figures else ["--no-figures"]
    return [sys.executable, "-m", "deployable", "run", str(config), "--results", str(place), *quiet]


def start(words: list[str], limit: int | None = None) -> subprocess.Popen:
    """Start a process of its own group; `limit`: the largest file (bytes) that it may write."""

    def prepare() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a shell's background jobs ignore it
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    return subprocess.Popen(
        words,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        preexec_fn=prepare,
        text=True,
    )


def attack_by_kill(victim: Victim, place: Path, ledger: Ledger, rng: random.Random) -> None:
    """Kill, or interrupt, a run somewhere in its work; what is published must be whole."""
    number = rng.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGINT])
    name = "killed" if number == signal.SIGKILL else "interrupted (Ctrl-C)"
    delay = rng.uniform(0.2, 4.0)
    process = start(command(victim, place, figures=rng.random() < 0.3))
    if number == signal.SIGINT:  # while Python itself still starts, it tells of itself
        process.stdout.readline()
    time.sleep(delay if number == signal.SIGKILL else 0.3 * delay)
    with suppress(ProcessLookupError):  # it was faster
        os.killpg(process.pid, number)
    detail = f"after {delay:.2f} s, keep: {victim.keep}"
    ledger.attempt(name, detail, LIMIT, lambda: _after_death(victim, place, process))


def attack_by_full_disk(victim: Victim, place: Path, ledger: Ledger, rng: random.Random) -> None:
    """Run where no file may grow beyond a size."""
    limit = int(10 ** rng.uniform(1.0, 5.2))
    process = start(command(victim, place), limit)
    detail = f"no file above {limit} bytes, keep: {victim.keep}"
    ledger.attempt("full disk", detail, LIMIT, lambda: _after_death(victim, place, process))


def _after_death(victim: Victim, place: Path, process: subprocess.Popen) -> str:
    """What a process said and left, then what the next run makes of it."""
    output, _ = process.communicate()
    folder = place / victim.name
    if "Traceback" in output:
        raise RuntimeError(output)
    if folder.exists() and list_broken_files(folder):
        return "wrong"
    if process.returncode == 1 and "no room" not in output and "error" not in output:
        raise RuntimeError(f"no word of why: {output}")
    if not victim.is_true(victim.run(place)):
        return "wrong"
    if list_broken_files(folder) or list_leftovers(folder):
        return "stuck"
    return "right" if process.returncode == 0 else "made again"
