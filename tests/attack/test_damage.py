"""Every kind of file of a campaign is damaged in every way: told by name, and made again.

`python -m evidence attack --only files` does the same for longer.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from deployable import campaign
from evidence.attack.damage import HARMS, attack_files, flip, kinds_in, truncate, zero
from evidence.attack.ledger import Ledger
from evidence.attack.victim import RAW, Victim, list_broken_files, silent
from fpm.files.seals import check


def attacked(victim, place, kinds):
    rng, ledger = random.Random(20), Ledger()
    for kind in kinds:
        for harm in HARMS:
            attack_files(victim, place / "attacked", ledger, rng, kind, harm)
    assert not ledger.bad, ledger.bad[0]
    return sum(ledger.counts.values())


@pytest.mark.slow
def test_damaged_files_are_named_and_made_again(tmp_path):
    whole, short = Victim(tmp_path), Victim(tmp_path, "responses")
    kinds = list(kinds_in(whole.whole / whole.name))
    assert {"plan.json", "samples.nc", "trajectories/*.nc", "batches/*.json"} < set(kinds)
    alone = 3  # JSON, Markdown and a group of runs, with which nothing can be swapped
    count = attacked(whole, tmp_path, kinds)
    assert count >= len(kinds) * len(HARMS) - alone
    assert attacked(short, tmp_path, ["responses/*.nc"]) >= len(HARMS) - 1


@pytest.mark.slow
def test_damaged_figures_pages_and_motions_are_named_and_made_again(tmp_path):
    """All in one folder, since to draw again takes seconds."""
    drawn, rng = Victim(tmp_path, has_figures=True), random.Random(20)
    folder = drawn.copy(tmp_path / "attacked")
    people = ("figures", "motions", "report")
    paths = [files[0] for kind, files in kinds_in(folder).items() if kind.startswith(people)]
    assert len(paths) == 4
    for path in filter(Path.is_file, folder.rglob("*")):
        assert check(path)["name"] in (path.name, f"run {path.stem}")
    for path, harm in zip(paths, (flip, zero, truncate, flip), strict=True):
        harm(path, rng)
    made_again(paths, lambda notify: drawn.run(folder.parent, notify))
    assert not list_broken_files(folder)


def test_one_call_names_results_that_were_cut_off(tmp_path):
    def run(notify):
        campaign.run(RAW, tmp_path, figures=False, notify=notify)

    run(silent)
    folder = tmp_path / RAW["campaign"]
    paths = [folder / name for name in ("plan.json", "samples.nc", "bounds.nc", "summary.json")]
    for path in paths:
        path.write_bytes(path.read_bytes()[:1000])
    made_again(paths, run)


def made_again(paths, run):
    """Whether a run names damaged files, and another one finds nothing to say of them."""
    told, later = [], []
    run(told.append)
    for path in paths:
        (text,) = [text for text in told if str(path) in text and "cannot be used" in text]
        assert text.endswith("it is made again")
    run(later.append)
    assert not any("cannot be used" in text for text in later)
