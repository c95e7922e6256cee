"""What every kind of element has in common: the contract that the rest of the mechanics relies on.

A kind is a frozen dataclass by which a scene states its elements, one object each (for beams, one
for a group of elements), and a kernel file (kernels/hooks.py). What it does not override, it
does not have. `docs/mechanics.md` shows how to add one.
"""

from collections.abc import Callable, Hashable
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from numbers import Integral
from types import ModuleType
from typing import Any, ClassVar, NamedTuple

import numpy as np

from fpm.elements.batch import Batch, SceneData
from fpm.elements.fields import FieldSpec, Index, Number, Word, check_number, numbers_in, specs
from fpm.errors import SceneError

AXES = "xyz"
"""Names of the global axes."""


class Energy(NamedTuple):
    """An energy of the balance (J): its name, its variable in a trajectory file, and in words."""

    name: str
    variable: str
    long_name: str


class Watch(NamedTuple):
    """A quantity that is watched, and above which value (`most`) a run fails.

    always: it counts also where the energy does not balance, as nothing else would explain that.
    of_size: `most` is a share of the scene's size (m), World.size.
    failure(values) -> (found, remedy): in words, from the largest values of the kind's watches.
    unbalanced(element) -> remedy: where the energy does not balance and this element of the kind is
    the worst; "" where the kind knows none of its own.
    """

    name: str
    most: float
    unconditional: bool
    failure: Callable[[dict[str, float]], tuple[str, str]]
    of_size: bool = False
    unbalanced: Callable[[str], str] | None = None


class Series(NamedTuple):
    """Something recorded: values (t,), or (t, k) along a dimension with k labels, in a unit; over:
    the dimension of t; code: digest of what read it off the run, where that does not count in the
    run's name."""

    values: np.ndarray
    unit: str
    long_name: str
    dimension: str | None = None
    labels: tuple[str, ...] = ()
    time_dim: str = "time"
    code: str = ""

    def merge(self, series: "Series") -> "Series":
        """The same of the elements of another kind, and of these."""
        values = np.concatenate([series.values, self.values], axis=1)
        return self._replace(values=values, labels=series.labels + self.labels)


class Eventful(NamedTuple):
    """An element that has events: its name, theirs in the order of their numbers, and the name of
    the joint that it is on, "" for none."""

    name: str
    events: tuple[str, ...]
    joint: str = ""


class Deformations(NamedTuple):
    """Rows of the deformations of elements at the start, in the particles' own axes (timestep.py).

    dofs (r, 12): degrees of freedom of two particles, 6 p .. 6 p + 5 for particle p; values (r, 12)
    for the deformation's derivatives by them; stiffness (r,), of energy 1/2 k d²; element (r,).
    """

    dofs: np.ndarray
    values: np.ndarray
    stiffness: np.ndarray
    element: np.ndarray


SHARED = {
    "rows": Batch.rows_of,
    "log": Batch.log_of,
    "watched": Batch.watched_by,
    "given": Batch.given_by,
    "taken": Batch.taken_by,
}
"""What stands under some names in the tuples of all kernels: shares of what is common."""


class ElementType:
    """A kind of element. Everything has a default: what is not stated, the kind does not have."""

    stores: ClassVar[Energy | None] = None  # the energy it stores (hook `stored`)
    gives: ClassVar[Energy | None] = None  # the work it gives; kinds with the same share an account
    takes: ClassVar[Energy | None] = None  # the energy it takes out
    events: ClassVar[tuple[str, ...]] = ()  # names of its events, in the order of their numbers
    watches: ClassVar[tuple[Watch, ...]] = ()  # of several that are too large, the last counts
    reads: ClassVar[
        tuple[type["ElementType"], ...]
    ] = ()  # kinds whose arrays it needs in every step
    acts_as: ClassVar[str] = ""  # which part of the moment on openings is its own (opening.py)
    joins: ClassVar[bool] = False  # whether each holds its `particles` together by a `name`
    moves_free: ClassVar[bool] = False  # whether it moves all particles that no other kind does

    resists_as: ClassVar[str] = "HA"  # class of its part in slow travel (fpm/travel); "": none

    called: ClassVar[str] = ""  # in messages; kinds that are called alike are one to a user

    # -- of one element -----------------------------------------------------------------------

    def add_to(self, scene: SceneData) -> None:
        """Add the element to a scene; SceneError if it does not fit (`check`)."""
        self.check(scene)
        scene.kinds.setdefault(type(self), []).append(self)

    def check(self, scene: SceneData) -> None:
        """SceneError if the element does not fit into the scene as it is: what its fields say."""
        for name, field in specs(type(self)).items():
            value = getattr(self, name)
            if isinstance(field, Index):
                for index in value if isinstance(value, tuple) else (value,):
                    self.check_index(scene, field, index)
            elif isinstance(field, Number):
                unit = self.unit_in(scene, field.unit)
                check_number(self.subject(scene, field), value, field, unit)
            elif isinstance(field, Word) and value not in field.values:
                raise SceneError(self.subject(scene, field), value, ", ".join(field.values))

    def check_index(self, scene: SceneData, field: Index, value: int) -> None:
        """SceneError unless a field has the index of something that there is."""
        count = len(getattr(scene, field.of))
        if not (isinstance(value, Integral) and field.least <= value < count):
            raise SceneError(self.subject(scene, field), value, f"{field.least} to {count - 1}")

    def subject(self, scene: SceneData, field: FieldSpec) -> str:
        """What messages call a field."""
        words = field.words or field.name.replace("_", " ") + " of {title}"
        title = self.title(scene) if "{title}" in words else ""
        return words.format(called=self.called, title=title)

    def title(self, scene: SceneData) -> str:
        """What messages about its numbers call it."""
        return self.called

    def unit_in(self, scene: SceneData, unit: str) -> str:
        """The unit of one of its numbers."""
        return unit

    def topology(self) -> Hashable:
        """What of it must be equal in all scenes that run side by side."""
        return tuple(getattr(self, n) for n, field in specs(type(self)).items() if field.same)

    def acts_on(self) -> tuple[int, ...]:
        """Indices of the hinges on whose openings it acts."""
        return ()

    # -- of all elements of the kind in a scene -------------------------------------------------

    @classmethod
    def of(cls, scene: SceneData) -> list[Any]:
        """The scene's elements of this kind."""
        return scene.kinds.get(cls, [])

    @classmethod
    def led(cls, scene: SceneData) -> list["ElementType"]:
        """What stands for each of the scene's elements where an opening is led slowly."""
        return cls.of(scene)

    @classmethod
    def topology_of(cls, scene: SceneData) -> Hashable:
        """What of all of them must be equal; None: even whether there are any may differ."""
        return tuple(element.topology() for element in cls.of(scene))

    @classmethod
    def names(cls, scene: SceneData) -> list[str]:
        """Names of the elements, for messages; those of a group one by one."""
        return [f"{cls.called or cls.__name__} {i}" for i in range(len(cls.of(scene)))]

    @classmethod
    def eventful(cls, scene: SceneData) -> list[Eventful]:
        """Its elements, if they have events."""
        return [Eventful(name, cls.events) for name in cls.names(scene) if cls.events]

    @classmethod
    def moved(cls, scene: SceneData) -> list[int]:
        """Particles that the kind moves itself (hooks `prepare` and `move`)."""
        return []

    @classmethod
    def deformations(cls, scene: SceneData) -> Deformations | None:
        """Their part in the stable step."""
        return None

    @classmethod
    def dampings(cls, scene: SceneData) -> Deformations | None:
        """The part of their dampers, with damping (N m s/rad) in place of stiffness.

        For dampers whose rate is extrapolated from the last two steps (losses_kernels.py).
        """
        return None

    @classmethod
    def shut(cls, scene: SceneData, inverse: np.ndarray) -> Any:
        """Motions that are ruled out in the one position in which the kind acts, as orthonormal
        sparse columns (dofs, c); None: it always acts.

        inverse (dofs,): inverse masses; the columns are in coordinates scaled with their roots.
        """
        return None

    @classmethod
    def kernels(cls) -> ModuleType:
        """The module of its kernels: that of the kind, or of one that it derives from, with
        `_kernels` behind its name."""
        for kind in cls.__mro__[:-1]:
            if find_spec(name := f"{kind.__module__}_kernels"):
                return import_module(name)
        raise NotImplementedError(
            f"kind {cls.__name__} has no kernels: no {cls.__module__}_kernels"
        )

    @classmethod
    def pack(cls, batch: Batch) -> NamedTuple:
        """The arrays that its kernels work on: the named tuple in their file, filled by `array`."""
        arrays = _arrays_in(cls.kernels())
        return arrays(**{name: cls.array(name, batch) for name in arrays._fields})

    @classmethod
    def array(cls, name: str, batch: Batch) -> Any:
        """What stands under a name in the tuple of its kernels; other names are those of fields
        with integers.

        `numbers`: those of every element that NUMBERS in the kernels' file names, in that order;
        `state`, `track`: zeros, STATE for each element, and TRACK for each at every instant;
        `account`: that of the work it gives, else of the energy it takes; SHARED.
        """
        elements = cls.of(batch.scene)
        match name:
            case "numbers":
                columns = [(n, specs(cls).get(n)) for n in cls.kernels().NUMBERS]
                count = len(_row(elements[0], columns))
                return batch.table(cls, count, lambda element: _row(element, columns))
            case "state":
                return batch.blank(len(elements), cls.kernels().STATE)
            case "track":
                return batch.blank((batch.instants + 1) * len(elements), cls.kernels().TRACK)
            case "account":
                return (batch.given_by if cls.gives else batch.taken_by)(cls)
            case _ if name in SHARED:
                return SHARED[name](batch, cls)
        return batch.integers(getattr(element, name) for element in elements)

    @classmethod
    def held_up(cls, scene: SceneData) -> float:
        """Force (N) that the scene may have to bear at rest, where rounding moves it a little."""
        return 0.0

    @classmethod
    def held_round(cls, scene: SceneData) -> float:
        """The same of moments (N m), which what holds openings exactly may bear."""
        return 0.0

    @classmethod
    def reads_impulses(cls, scene: SceneData) -> bool:
        """Whether its elements need the impulses of joints summed over each step."""
        return False

    @classmethod
    def weight(cls, scene: SceneData, particle: int, time: np.ndarray) -> np.ndarray:
        """Force (3,) or (t, 3) N on a particle at times (t,) s that is there because of its mass.

        The ground has a mass that means nothing: its reaction leaves this force out.
        """
        return np.zeros(3)

    @classmethod
    def recorded(cls, part: Any, scene: SceneData, lane: int) -> dict[str, Series]:
        """What was recorded of one lane, by the names of its variables in a trajectory file."""
        return {}

    @classmethod
    def prescribe(cls, scene: SceneData, time: float, motion: Any) -> None:
        """Put what the kind prescribes at a time (s) into a Motion (fpm.simulate), in place."""


def _row(element: ElementType, columns: list) -> list[float]:
    """The numbers of an element, from the names of its fields and what is stated of them."""
    numbers = []
    for name, field in columns:
        value = getattr(element, name)
        numbers.extend(numbers_in(field.values[value] if isinstance(field, Word) else value))
    return numbers


@cache
def _arrays_in(kernels: ModuleType) -> type:
    """The named tuple that a file of kernels states."""
    own = [x for x in vars(kernels).values() if getattr(x, "__module__", "") == kernels.__name__]
    (array_type,) = [x for x in own if isinstance(x, type) and issubclass(x, tuple)]
    return array_type
