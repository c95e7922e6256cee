"""Files damaged, cut off and swapped: told by name and made again, never used."""

import random
import shutil
from collections.abc import Callable
from pathlib import Path

from deployable.campaign.config.check import check_config
from deployable.campaign.errors import CampaignError
from deployable.campaign.folder import Folder
from deployable.campaign.stages import STAGES
from deployable.campaign.stages.workflow import Workflow
from evidence.attack.ledger import Ledger
from evidence.attack.victim import Victim, list_broken_files, read_bounds, results_in, silent

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


def truncate(path: Path, rng: random.Random) -> str:
    """Cut a file off."""
    size = rng.randrange(path.stat().st_size)
    with open(path, "r+b") as file:
        file.truncate(size)
    return f"cut at {size}"


def swap(path: Path, rng: random.Random) -> str:
    """Put another file of its kind in its place."""
    candidates = [p for p in results_in(path.parent) if p.suffix == path.suffix and p != path]
    if not candidates:
        return "nothing to swap with"
    source = rng.choice(candidates)
    shutil.copy(source, path)
    return f"{source.name} in its place"


HARMS: dict[str, Callable[[Path, random.Random], str]] = {
    "bit flipped": flip,
    "page zeroed": zero,
    "file cut off": truncate,
    "file swapped": swap,
}


def kinds_in(folder: Path) -> dict[str, list[Path]]:
    """The sealed files of a campaign by what they are: of those in its folder each is a kind."""
    files: dict[str, list[Path]] = {}
    for path in results_in(folder):
        name = path.relative_to(folder)
        kind = name.name if name.parent == Path() else f"{name.parts[0]}/*{name.suffix}"
        files.setdefault(kind, []).append(path)
    return files


def attack_files(
    victim: Victim,
    place: Path,
    ledger: Ledger,
    rng: random.Random,
    kind: str | None = None,
    harm: str | None = None,
) -> None:
    """Damage one file of a finished campaign in one way; both by chance if they are not given."""
    folder = victim.copy(place)
    kinds = kinds_in(folder)
    path = rng.choice(kinds[kind or rng.choice(list(kinds))])
    harm = harm or rng.choice(list(HARMS))
    content = path.read_bytes()
    change = HARMS[harm](path, rng)
    if path.read_bytes() == content:
        return
    is_whole = rng.random() < 0.5
    detail = f"{path.relative_to(folder)}, {change}, keep: {victim.keep}, at once: {is_whole}"
    ledger.attempt(harm, detail, 60.0, lambda: _finish_run(victim, folder, path, is_whole))


def _finish_run(victim: Victim, folder: Path, path: Path, is_whole: bool) -> str:
    """What a whole run makes of a damaged folder, at once or after single stages.

    Whoever reads the file first has to name it."""
    stages, is_refused = Folder(folder), False
    sections = check_config(victim.raw)
    workflow = Workflow(sections, folder.parent)
    workflow.stale()
    if path.parent.name != victim.keep and str(path) not in workflow.damage:
        return "wrong"
    for name in () if is_whole else ("bounds", "answers"):
        try:
            STAGES[name].run(stages, silent, **STAGES[name].sections_of(sections))
        except CampaignError:
            is_refused = True
            break
        if name == "bounds" and not victim.is_true(read_bounds(folder)):
            return "wrong"
    messages: list[str] = []
    if not victim.is_true(victim.run(folder.parent, messages.append)):
        return "wrong"
    if is_whole and not any(str(path) in text for text in messages):
        return "wrong"
    if list_broken_files(folder):
        return "stuck"
    return "refused" if is_refused else "made again"
