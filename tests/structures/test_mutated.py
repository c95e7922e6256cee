"""Files that went wrong somewhere are refused, or are structures; nothing else happens, quickly."""

import math
import random
import time
from contextlib import suppress

import numpy as np
import pytest
import yaml
from structures_for_tests import FOLDER, SMALL

from fpm.errors import SceneError
from fpm.scenes.scene_type import Parameter, SceneType
from fpm.structures import StructureError, loads
from fpm.structures.model import KEYS

MUTANTS = 500
NAMES = ("zfold.yaml", "panel.yaml", "pendulum.yaml", "tensegrity.yaml")
NASTY = (
    "", "0", "-1", "nan", ".nan", ".inf", "1e400", "1e-400", "1e200", "-0.0", "null", "~", "true",
    "[", "]", "{}", "[]", "[[[]]]", "{a: {b: c}}", "'", '"', "&a x", "*a", "!!python/name:os.x",
    "__import__('os')", "().__class__", "9**9**9**9", "1/0", "L/0", "sqrt(-1)", "x" * 3000, "1;2",
    "\u0000", "\ufeff", "\u2028", "é", "½", "1_000", "0x10", "2 mm", "90 deg", "5 N m/rad", "1 /s",
    "next.bar", "previous.A", "bay.last.rising", "bay0.rising", "ground", "[ground, ground]", "pi",
    "A - B", "cross(x, y)", "[L, 0, 0]", "unit(A - A)", "A*B", "rod", "A.x", "A.w", "A", "y",
    "-y", "xyz", "none", "revolute", "latch", "1000000000", "10**18",
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
    scissor = (FOLDER / "scissor.yaml").read_text().replace("{value: 3", "{value: 2")
    return [SMALL, forced, *small, scissor]


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


def leaves(node, path=()):
    """The places of all values in tables and lists."""
    if isinstance(node, dict | list):
        items = node.items() if isinstance(node, dict) else enumerate(node)
        for key, item in items:
            yield from leaves(item, (*path, key))
    else:
        yield path


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", ["1/0", "1" * 400, "1e20", "1e308 km", "1e-320"])
def test_no_number_anywhere_ends_in_a_traceback(value):
    """Each value of a file in turn: what has none, is too large for a float, or next to zero."""
    for path in leaves(yaml.load(SMALL, yaml.BaseLoader)):
        data = part = yaml.load(SMALL, yaml.BaseLoader)
        for key in path[:-1]:
            part = part[key]
        part[path[-1]] = value
        with suppress(StructureError):
            loads(yaml.safe_dump(data, sort_keys=False)).build()


@pytest.mark.parametrize("length", [0.0, -1.0])
def test_a_structure_that_cannot_be_computed_says_at_which_values(length):
    """In Python, whose arithmetic is the user's: a quotient by zero, a root of less."""
    parameters = {"L": Parameter(1.0, "length", unit="m")}
    found = SceneType("mast", "", parameters, (), (), lambda L: math.sqrt(L) / L)
    with pytest.raises(SceneError, match=rf"scene mast = .*'L': {length}.* at which it can be bui"):
        found.build(L=length)
