"""Every kind of file of a campaign is damaged: told by name, and made again.

`python -m evidence attack --only files` does the same for longer.
"""

from __future__ import annotations

import random

import pytest

from deployable import campaign
from evidence.attack.damage import HARMS, attack_files, kinds_in
from evidence.attack.ledger import Ledger
from evidence.attack.victim import RAW, Victim, silent


def attacked(victim, place, kinds):
    """Each kind of file meets one of the harms; a checksum notices all of them alike."""
    rng, ledger = random.Random(20), Ledger()
    for number, kind in enumerate(kinds):
        harm = list(HARMS)[number % len(HARMS)]
        attack_files(victim, place / "attacked", ledger, rng, kind, harm)
    assert not ledger.bad, ledger.bad[0]
    return sum(ledger.counts.values())


@pytest.mark.slow
def test_damaged_files_are_named_and_made_again(tmp_path):
    whole, short = Victim(tmp_path), Victim(tmp_path, "responses")
    kinds = list(kinds_in(whole.whole / whole.name))
    assert {"plan.json", "samples.nc", "trajectories/*.nc", "batches/*.json"} < set(kinds)
    alone = 3  # JSON, Markdown and a group of runs, with which nothing can be swapped
    assert attacked(whole, tmp_path, kinds) >= len(kinds) - alone
    assert attacked(short, tmp_path, ["responses/*.nc"]) >= 1


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
