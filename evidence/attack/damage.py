"""Files damaged, cut off and swapped: told by name and made again, never used."""

from __future__ import annotations

import random
import shutil
from collections.abc import Callable
from pathlib import Path

from campaign.config.check import check_config
from campaign.errors import CampaignError
from campaign.folder import Folder
from campaign.stages import STAGES
from campaign.workflow import Workflow
from evidence.attack.ledger import Ledger
from evidence.attack.victim import Victim, broken_in, read_bounds, results_in, silent

PAGE = 4096


def flip(path: Path, rng: random.Random) -> str:
    """Flip one bit."""
    content = bytearray(path.read_bytes())
    place, bit = rng.randrange(len(content)), rng.randrange(8)
    content[place] ^= 1 << bit
    path.write_bytes(content)
    return f"bit {bit} of byte {place}"


def zero(path: Path, rng: random.Random) -> str:
    """Fill a page with zeros, or half of a file that is smaller than two."""
    content = bytearray(path.read_bytes())
    size = min(PAGE, max(1, len(content) // 2))
    start = rng.randrange(0, len(content), size)
    size = min(size, len(content) - start)
    content[start : start + size] = bytes(size)
    path.write_bytes(content)
    return f"{size} zeros at {start}"


def cut(path: Path, rng: random.Random) -> str:
    """Cut a file off."""
    size = rng.randrange(path.stat().st_size)
    with open(path, "r+b") as file:
        file.truncate(size)
    return f"cut at {size}"


def swap(path: Path, rng: random.Random) -> str:
    """Put another file of its kind in its place."""
    others = [p for p in results_in(path.parent) if p.suffix == path.suffix and p != path]
    if not others:
        return "nothing to swap with"
    other = rng.choice(others)
    shutil.copy(other, path)
    return f"{other.name} in its place"


HARMS: dict[str, Callable[[Path, random.Random], str]] = {
    "bit flipped": flip,
    "page zeroed": zero,
    "file cut off": cut,
    "file swapped": swap,
}


def attack_files(victim: Victim, place: Path, ledger: Ledger, rng: random.Random) -> None:
    """Damage one file of a finished campaign in one way."""
    folder = victim.copy(place)
    path = rng.choice(results_in(folder))
    harm = rng.choice(list(HARMS))
    before = path.read_bytes()
    done = HARMS[harm](path, rng)
    if path.read_bytes() == before:
        return
    what = f"{path.relative_to(folder)}, {done}, keep: {victim.keep}"
    ledger.attempt(harm, what, 60.0, lambda: _lead_on(victim, folder, path))


def _lead_on(victim: Victim, folder: Path, path: Path) -> str:
    """What the stages make of a damaged folder, then what a whole run makes of it."""
    stages, refused = Folder(folder), False
    sections = check_config(victim.raw)
    workflow = Workflow(sections)
    workflow.folder = stages
    if path.parent in (folder, stages.figures) and str(path) not in workflow.stale():
        return "wrong"
    for name in ("gather", "bounds", "summary"):
        try:
            STAGES[name].run(stages, silent, **STAGES[name].sections_of(sections))
        except CampaignError:
            refused = True
            break
        if name == "bounds" and not victim.is_true(read_bounds(folder)):
            return "wrong"
    if not victim.is_true(victim.run(folder.parent)):
        return "wrong"
    if broken_in(folder):
        return "stuck"
    return "refused" if refused else "made again"
