"""`keep: extremes`: of a scan the least and largest values over time, and a few numbers a run.

A share of the scan has one netCDF file, `<digest of its runs>.<runs in it>.nc`, which grows while
its runs are made (`campaign.runs.share`). There are as many shares as the scan's size asks for,
whatever the jobs, and the quarters of the scan consist of whole shares.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import islice, pairwise
from pathlib import Path

import numpy as np

from deployable.campaign.config.sections import Experiment
from deployable.campaign.files import whole_file
from deployable.campaign.plan.runs import Runs
from deployable.campaign.runs import results as common
from deployable.campaign.runs.share import Share
from fpm.files.sealed import DamagedError, check

FEWEST, MOST = 4, 128
"""Shares of a scan; quarters consist of whole ones."""

LARGE = 512
"""Runs of a share from which there are more shares, as long as there are not `MOST`."""

PAUSE = 2.0
"""Seconds, at least, from one time that a share is written to the next, but for its end."""

_AT_ONCE = 32  # runs that are taken in side by side


class Extremes:
    """One netCDF file per share of a scan; the methods of `store.Responses`, but for `load` in the
    place of `read`."""

    def __init__(self, folder: Path, experiment: Experiment):
        self.folder = folder
        self.responses, self.quantities = experiment.curves, experiment.numbers
        self.damaged: dict[Path, DamagedError] = {}
        self.lacking: dict[str, set] = {}  # of what is asked, as in the other stores: nothing
        asked = common.asked_of(self.responses, self.quantities)
        self._named = partial(common.group_digest, ["extremes", *asked], experiment)

    def groups(self, runs: Runs, size: int) -> list[Runs]:
        """The shares of a scan; they do not depend on the size of groups."""
        count = FEWEST
        while count < MOST and len(runs) > count * LARGE:
            count *= 2
        ends = [-(-len(runs) * share // count) for share in range(count + 1)]
        return [runs[a:b] for a, b in pairwise(ends) if b > a]

    def had(self, runs: Runs) -> set:
        """Nothing: files hold extremes only."""
        return set()

    def counter(self, groups: Sequence[Runs]) -> Callable[[], int]:
        """A function that tells how many runs of groups are there, by the names of files alone."""
        names = {self._named(group) for group in groups}

        def count() -> int:
            done: dict[str, int] = {}
            for name in common.listed(self.folder):
                share = name.split(".")[0]
                if share in names:
                    done[share] = max(_runs_in(Path(name)), done.get(share, 0))
            return sum(done.values())

        return count

    def missing(self, group: Runs) -> Runs:
        """The runs of the share that are still to be simulated."""
        found = self.load(group)
        return group if found is None else group[np.flatnonzero(~found.done)]

    def write(self, group: Runs, results: Iterable[common.Result]) -> None:
        """Take in the results of runs of a share as they come, in the order of its runs.

        It is written whenever `PAUSE` has passed, and at the end; ValueError if a number is not
        finite.
        """
        share = self.load(group) or Share(len(group), self.responses, self.quantities)
        rows = {values: row for row, values in enumerate(map(tuple, group.values.tolist()))}
        results, written = iter(results), time.monotonic()
        while some := list(islice(results, _AT_ONCE)):
            share.take([rows[result.run.values] for result in some], some)
            if time.monotonic() > written + PAUSE:
                self._save(group, share)
                written = time.monotonic()
        if share.done.any():
            self._save(group, share)

    def load(self, group: Runs) -> Share | None:
        """What is there of a share: of several files the one with most runs that is whole."""
        for path in sorted(self._files(group), key=_runs_in, reverse=True):
            try:
                check(path, _title(path))
            except DamagedError as error:
                self.damaged[path] = error
            except FileNotFoundError:  # replaced by a larger one since it was listed
                pass
            else:
                return Share.read(path, self.responses, self.quantities)
        return None

    def _files(self, group: Runs) -> list[Path]:
        return list(self.folder.glob(f"{self._named(group)}.*.nc"))

    def _save(self, group: Runs, share: Share) -> None:
        path = self.folder / f"{self._named(group)}.{share.done.sum()}.nc"
        with whole_file(path, {"name": _title(path)}) as temporary:
            share.write(temporary)
        for other in self._files(group):
            if other != path:
                other.unlink(missing_ok=True)


def _title(path: Path) -> str:
    """What the file of a share is called in its seal."""
    return f"runs {path.stem}"


def _runs_in(path: Path) -> int:
    """How many runs the file of a share has, by its name."""
    return int(path.stem.rsplit(".", 1)[1])
