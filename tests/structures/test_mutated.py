"""Files that went wrong somewhere are refused, or are structures; nothing else happens, quickly."""

import random
import time

import numpy as np
import pytest
from structures_for_tests import FOLDER, SMALL

from deployable.fpm.structures import StructureError, loads
from deployable.fpm.structures.model import KEYS

MUTANTS = 500
NAMES = ("zfold.yaml", "panel.yaml", "pendulum.yaml", "tensegrity.yaml")
NASTY = (
    "", "0", "-1", "nan", ".nan", ".inf", "1e400", "1e-400", "1e200", "-0.0", "null", "~", "true",
    "[", "]", "{}", "[]", "[[[]]]", "{a: {b: c}}", "'", '"', "&a x", "*a", "!!python/name:os.x",
    "__import__('os')", "().__class__", "9**9**9**9", "1/0", "L/0", "sqrt(-1)", "x" * 3000, "1;2",
    "\u0000", "\ufeff", "\u2028", "é", "½", "1_000", "0x10", "2 mm", "90 deg", "5 N m/rad", "1 /s",
    "next.bar", "previous.A", "bay.last.rising", "bay0.rising", "ground", "[ground, ground]", "pi",
    "A.x", "A.w", "A", "y", "-y", "xyz", "none", "revolute", "latch", "1000000000", "10**18",
)  # fmt: skip


def mutated(text: str, rng: random.Random) -> str:
    """The text with one to three changes of the kinds that people and editors make."""
    for _ in range(rng.randint(1, 3)):
        lines = text.split("\n")
        at = rng.randrange(len(lines))
        kind = rng.randrange(8)
        if kind == 0:  # a line goes
            del lines[at]
        elif kind == 1:  # a line comes twice
            lines.insert(at, lines[at])
        elif kind == 2:  # lines change places
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == 3:  # the indent slips
            lines[at] = " " * rng.randint(0, 6) + lines[at].lstrip()
        elif kind == 4:  # a character changes
            spot = rng.randrange(len(text) + 1)
            lines = (text[:spot] + chr(rng.randint(32, 126)) + text[spot + 1 :]).split("\n")
        elif kind == 5:  # a value becomes something else
            head, colon, _ = lines[at].partition(":")
            lines[at] = f"{head}{colon} {rng.choice(NASTY)}"
        elif kind == 6:  # a word becomes another of the file, a key, or something nasty
            words = text.replace(",", " ").replace(":", " ").split()
            new = rng.choice([*words, *KEYS, *NASTY])
            lines = text.replace(rng.choice(words), new, 1).split("\n")
        else:  # an end gets lost
            lines = text[: rng.randrange(len(text)) + 1].split("\n")
        text = "\n".join(lines)
        text = text if text.strip() else "a: b"
    return text


def sources() -> list[str]:
    """Structures with few particles, so that building them takes no time."""
    small = [(FOLDER / name).read_text() for name in NAMES]
    forced = SMALL.replace("mesh: n", "mesh: n\nassemble: {hold: [root]}", 1)
    return [
        SMALL,
        forced,
        *small,
        (FOLDER / "scissor.yaml").read_text().replace("{value: 3", "{value: 2"),
    ]


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
def test_mutated_files_are_refused_or_are_structures():
    rng = random.Random(2)
    refused, slowest = 0, 0.0
    for _ in range(MUTANTS):
        text = mutated(rng.choice(sources()), rng)
        start = time.process_time()
        try:
            scene = loads(text).build()
        except StructureError as error:
            refused += 1
            lines = text.count("\n") + 1 + 2 * text.count("\u2028")
            assert error.problems
            for problem in error.problems:
                assert 0 <= problem.line <= lines
                assert problem.text
                assert len(problem.text) < 2000
        else:
            assert np.isfinite(scene.position).all()
            assert (scene.mass > 0).all()
        slowest = max(slowest, time.process_time() - start)
    assert refused > 0.5 * MUTANTS
    assert slowest < 5


def test_the_files_that_are_mutated_are_right():
    for text in sources():
        loads(text).build()
