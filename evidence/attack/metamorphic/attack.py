"""The attack by pairs: structures at random, and each in other words."""

import random
from collections.abc import Iterator

from evidence.attack.ledger import Ledger
from evidence.attack.metamorphic.families import DELAY, FAMILIES
from evidence.attack.metamorphic.pairs import Trial, Verdict
from evidence.attack.metamorphic.runs import draw_structure
from evidence.attack.metamorphic.structure_text import as_text

ALL = (*FAMILIES, DELAY)

LIMIT = 600.0
"""Seconds (see `time_limit`): the first structures compile the kernels of their kinds."""

OUTCOMES = {"right": "right", "wrong": "wrong", "sensitive": "open", "failed": "refused"}


def trial(seed: str) -> Trial:
    """The pairs of the structure of a seed."""
    structure, duration = draw_structure(seed)
    return Trial(structure, duration, seed)


def verdicts(seed: str, count: int = len(ALL)) -> Iterator[Verdict]:
    """What so many families come to, drawn by the seed."""
    return trial(seed).verdicts(random.Random(f"{seed} families").sample(ALL, count))


def attack_by_pairs(ledger: Ledger, rng: random.Random) -> None:
    """Run one structure in all other words; both files of a pair that is wrong are told."""
    seed, results = f"{rng.getrandbits(32):08x}", []

    def run() -> str:
        results.extend(verdicts(seed))
        return "right"

    ledger.attempt("structure drawn", f"seed {seed}", LIMIT, run)
    for verdict in results:
        files = as_text(verdict.original), as_text(verdict.image)
        detail = "\n".join([f"seed {seed}: {verdict.what}", *files])
        ledger.note(verdict.family, OUTCOMES[verdict.outcome], detail)
