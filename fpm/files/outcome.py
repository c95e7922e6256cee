"""What a run gives back: the curves of one sample, its events, and why it failed if it did."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
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
BALANCE = Energy("balance", "energy_balance", "energy that came from nowhere since the start")


class Motion(NamedTuple):
    """Where all particles are and how they move, in the form in which a Scene keeps its start.

    position (n, 3) m; frame (n, 3, 3) axes as columns; velocity (n, 3) m/s; spin (n, 3) rad/s.
    """

    position: np.ndarray
    frame: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray


def eventful(
    scene: Scene, kinds: Iterable[type[ElementType]] | None = None
) -> tuple[Eventful, ...]:
    """The elements of a scene that have events, or those of these kinds of it."""
    kinds = kinds_of([scene]) if kinds is None else kinds
    return tuple(element for kind in kinds for element in kind.eventful(scene))


@dataclass(frozen=True)
class Outcome(Curves):
    """What one sample did: its curves and events, and

    energy_kinds, by name as in `energies`; recorded: what else was recorded, by the names of the
    variables in a trajectory file; steps; limit: the stable step; largest: of everything that is
    watched (`bend`, the largest sine of the angle between an element's chord and its ends, or of
    its twist; `strain` at the surface of an element; ...); final: the motion of all particles at
    the end; failure: None or why this sample has none of these that mean something, its
    InstabilityError, or the SceneError of a travel that it cannot make.
    """

    scene: Scene
    energy_kinds: tuple[Energy, ...]
    recorded: dict[str, Series]
    steps: int
    limit: StableStep | None
    failure: InstabilityError | SceneError | None
    largest: dict[str, float]
    final: Motion = field(repr=False)

    @property
    def tensions(self) -> dict[str, np.ndarray]:
        """Tensions (t,) in N by the names of the cables."""
        return self.labelled("cable_tension")

    @property
    def gap(self) -> np.ndarray:
        """Largest gap (t,) in m of all hinges."""
        return self._recorded_or_zero("hinge_gap")

    @property
    def axis_gap(self) -> np.ndarray:
        """Largest angle (t,) in rad between the axes of a hinge."""
        return self._recorded_or_zero("hinge_axis_gap")

    def _recorded_or_zero(self, name: str) -> np.ndarray:
        return self.recorded[name].values if name in self.recorded else np.zeros(len(self.time))

    def dataset(self, responses=(), attributes=None, parameters=None) -> "xarray.Dataset":
        """The trajectory as an xarray Dataset; raises the failure if there is one.

        responses: sequence of fpm.responses.Response; the others as in fpm.trajectory.contents.
        """
        return to_dataset(self, responses, attributes, parameters)


def columns_of(records: Mapping[str, Series]) -> dict[Column, np.ndarray]:
    """The columns (t,) of what was recorded along a dimension."""
    return {
        (name, label): record.values[:, i]
        for name, record in records.items()
        for i, label in enumerate(record.labels)
    }
