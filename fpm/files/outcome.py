"""Outcome of a run: the curves of one sample, its events, and its failure if it has one."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fpm.elements import kinds_of
from fpm.elements.kind import ElementType, Energy, Eventful, Series
from fpm.errors import InstabilityError, SceneError
from fpm.files.trajectory import Column, Curves, to_dataset
from fpm.scenes.scene import Scene
from fpm.scenes.timestep import StableStep

if TYPE_CHECKING:
    import xarray

KINETIC = Energy("kinetic", "kinetic_energy", "kinetic energy")
BALANCE = Energy("balance", "energy_balance", "error of the energy balance since the start")


class Motion(NamedTuple):
    """Positions and velocities of a scene's n particles at one time, in global axes. position (n,
    3): m; frame (n, 3, 3): own axes as columns; velocity (n, 3): m/s; spin (n, 3): rad/s."""

    position: np.ndarray
    frame: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray


def eventful(
    scene: Scene, kinds: Iterable[type[ElementType]] | None = None
) -> tuple[Eventful, ...]:
    """Return the elements of a scene that have events (latches, contacts, ...), in the order in
    which Curves.events numbers them. kinds: element types to look at, None: all of the scene."""
    kinds = kinds_of([scene]) if kinds is None else kinds
    return tuple(element for kind in kinds for element in kind.eventful(scene))


@dataclass(frozen=True)
class Outcome(Curves):
    """Result of one run: curves and events (`Curves`), final motion, and failure.

    Attributes
    ----------
    scene: the simulated scene.
    energy_kinds: names and texts (Energy) of each of `energies`, in their order.
    records: all recorded series (Series), `columns` among them, by variable, as "cable_tension".
    steps: number of time steps.
    limit: the scene's stable step (StableStep); None if the time step was given and the run did not
        fail.
    failure: None, the InstabilityError of a run whose numbers mean nothing, or the SceneError of an
        opening moved slowly (fpm/travel) that finds no balance.
    largest: largest values of the failure criteria by name (`bend`, the largest sine of the angle
        between an element's chord and its ends, or of its twist; `strain` at its surface; ...).
    final: motion of all particles at the end (Motion)."""

    scene: Scene
    energy_kinds: tuple[Energy, ...]
    records: dict[str, Series]
    steps: int
    limit: StableStep | None
    failure: InstabilityError | SceneError | None
    largest: dict[str, float]
    final: Motion = field(repr=False)

    def _repr_html_(self) -> str:
        head = f"{self.scene.name}: {self.time[-1]:.4g} s in {self.steps} steps"
        events = f"{len(self.events)} events" if self.failure is None else str(self.failure)
        openings = [f"{n}: {x.min():.4g} to {x.max():.4g}" for n, x in self.openings.items()]
        return import_module("fpm.structures.describe").to_html(head, events, *openings)

    def dataset(self) -> "xarray.Dataset":
        """Return the trajectory as an xarray.Dataset; raises the failure of a run that failed."""
        return to_dataset(self)


def columns_of(records: Mapping[str, Series]) -> dict[Column, np.ndarray]:
    """Return the columns (t,) of recorded series (t, k) by (variable, label), one for each label.
    records: series by variable; those without labels are left out."""
    return {
        (name, label): record.values[:, i]
        for name, record in records.items()
        for i, label in enumerate(record.labels)
    }
