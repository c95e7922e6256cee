"""What stores of runs share: results as they come, what is read of them, and names of files."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment, digest
from deployable.campaign.errors import CampaignError
from deployable.campaign.plan.runs import Run, Runs

# Contact events as the interval side gets them, in the order of the columns of `Record.events`.
EVENT_VARIABLES = ("event_time", "event_contact", "event_closing")


@dataclass(frozen=True)
class Result:
    """A run that went well: its `fpm.Outcome`, the values of its parameters, and what its file
    tells beside these, the same of all runs of a plan."""

    run: Run
    outcome: Any
    parameters: Mapping[str, Any]
    common: Mapping[str, Any]

    @property
    def id(self) -> str:
        """Name of the run."""
        return self.run.id

    @property
    def attributes(self) -> dict[str, Any]:
        """Of the run's file."""
        own = {f"parameter_{name}": v for name, v in self.parameters.items() if v is not None}
        return {"run_id": self.id, **self.common, **own}


@dataclass(frozen=True)
class Record:
    """What the interval side needs of a run: time (t,) s, the values (n, t) of its n responses,
    contact events (e, 3): time (s), contact index, 1 if it closes, names of contacts, numbers (q,)
    of its quantities, NaN where what is asked for does not happen, and by how much (rad) the faces
    of a contact overlap at most, at the instants."""

    time: np.ndarray
    values: np.ndarray
    events: np.ndarray
    contacts: Sequence[str]
    numbers: np.ndarray
    overlap: float


def groups_of(runs: Runs, size: int) -> list[Runs]:
    """Runs in groups of `size`; only the last group may be smaller."""
    return [runs[first : first + size] for first in range(0, len(runs), size)]


def numbers_of(quantities: Sequence[Any], curves: Any) -> np.ndarray:
    """Numbers (q,) of one run; raises `CampaignError` where they cannot be told."""
    try:
        return np.array([quantity.evaluate(curves) for quantity in quantities], dtype=float)
    except ValueError as error:
        raise CampaignError(str(error)) from None


def asked_of(responses: Sequence[Any], quantities: Sequence[Any]) -> list:
    """What a file depends on that holds responses and quantities and not what they are made of:
    their definitions, and the code that reads them."""
    import fpm.reading
    from fpm.kernels.sources import syntax_digest

    code = syntax_digest(Path(fpm.reading.__file__).parent.glob("*.py"))
    return [code, *(asdict(one) for one in (*responses, *quantities))]


def group_digest(asked: list, experiment: Experiment, group: Runs) -> str:
    """What the file of a group of runs is named after: all that its contents depend on."""
    values = hashlib.sha256(group.values.tobytes()).hexdigest()
    return digest([asked, list(experiment.intervals), group[0].id, values])


def padded(events: Sequence[np.ndarray]) -> np.ndarray:
    """Tables (e, 3) of events of several runs as one (r, most, 3), filled with NaN."""
    out = np.full((len(events), max(map(len, events)), len(EVENT_VARIABLES)), np.nan)
    for row, table in zip(out, events, strict=True):
        row[: len(table)] = table
    return out


def listed(folder: Path) -> list[str]:
    """Names of the files in a folder that may not be there yet."""
    return os.listdir(folder) if folder.is_dir() else []


def largest_overlap(openings: Mapping[str, np.ndarray], contacts: Sequence[str]) -> float:
    """Largest overlap (rad) of the faces of the contacts on hinges, from their openings (t,)."""
    return max((float(-openings[name].min()) for name in contacts if name in openings), default=0.0)


def write_dimension(file: Any, dimension: str, names: Sequence[str], long_name: str) -> None:
    """Define a dimension whose coordinate are names."""
    file.createDimension(dimension, len(names))
    variable = file.createVariable(dimension, str, (dimension,))
    variable.long_name = long_name
    if len(names):
        variable[:] = np.array([str(name) for name in names], dtype=object)
