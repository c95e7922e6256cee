"""All attacks for a time, and what they came to."""

import argparse
import json
import random
import shutil
import sys
import tempfile
import time
from pathlib import Path

from deployable.campaign.files import write_text
from evidence.attack.damage import attack_files
from evidence.attack.ledger import Ledger
from evidence.attack.metamorphic.attack import attack_by_pairs
from evidence.attack.mutants import Hunt
from evidence.attack.processes import attack_by_full_disk, attack_by_kill
from evidence.attack.victim import Victim

KINDS = ("files", "kills", "disks", "pairs", "mutants")


def attack(
    kinds: tuple[str, ...], minutes: float, seed: int, folder: Path, code: tuple[str, ...] = ("*",)
) -> tuple[Ledger, Hunt]:
    """Attack in turn, each kind with the same share of the time; code: the files of mutants."""
    rng, ledger, hunt = random.Random(seed), Ledger(), Hunt(seed, code)
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        victims = [Victim(place), Victim(place, "responses"), Victim(place, has_figures=True)]
        for kind in kinds:
            end = time.monotonic() + 60.0 * minutes / len(kinds)
            while time.monotonic() < end:
                _attack_once(kind, rng.choice(victims), place, ledger, hunt, rng)
            print(f"{kind} done, {ledger.count_bad} bad so far", flush=True)
            write_text(folder / "table.md", table(ledger, hunt))
    return ledger, hunt


def _attack_once(
    kind: str, victim: Victim, place: Path, ledger: Ledger, hunt: Hunt, rng: random.Random
) -> None:
    target = place / "attacked"
    shutil.rmtree(target, ignore_errors=True)
    if kind == "files":
        attack_files(victim, target, ledger, rng)
    elif kind == "kills":
        attack_by_kill(victim, target, ledger, rng)
    elif kind == "disks":
        attack_by_full_disk(victim, target, ledger, rng)
    elif kind == "pairs":
        attack_by_pairs(ledger, rng)
    else:
        hunt.try_mutant(place / "mutant")


def table(ledger: Ledger, hunt: Hunt) -> str:
    """What came out, as Markdown."""
    return ledger.table() + ("\n" + hunt.table() if hunt.count else "")


def main(arguments: list[str]) -> int:
    """Attack from the command line; status 1 if anything went wrong."""
    parser = argparse.ArgumentParser(prog="python -m evidence attack", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0, help="%(default)s")
    parser.add_argument("--seed", type=int, default=1, help="%(default)s")
    parser.add_argument("--only", nargs="+", choices=KINDS, default=KINDS, help="these kinds")
    parser.add_argument("--code", nargs="+", default=("*",), help="files that mutants change")
    parser.add_argument("--output", type=Path, default=Path("results", "attack"))
    options = parser.parse_args(arguments)
    values = options.minutes, options.seed, options.output, tuple(options.code)
    ledger, hunt = attack(tuple(options.only), *values)
    summary = {
        "minutes": options.minutes,
        "seed": options.seed,
        "counts": [[*key, count] for key, count in ledger.counts.items()],
        "bad": ledger.bad,
        "mutants": hunt.mutants,
        "left_out": hunt.left_out,
    }
    write_text(options.output / "attack.json", json.dumps(summary, indent=1) + "\n")
    print(table(ledger, hunt))
    for name, outcome, detail in ledger.bad:
        print(f"{name}: {outcome}: {detail}\n", file=sys.stderr)
    return 1 if ledger.bad else 0
