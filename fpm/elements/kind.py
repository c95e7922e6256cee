"""Base class of all element types: the interface that the rest of the mechanics relies on.

An element type is a frozen dataclass by which a scene states its elements, one object each (for
beams, one for a group of elements), and a kernel file (fpm/kernels/hooks.py). Everything has a
neutral default. `docs/mechanics.md` shows how to add an element type.
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
    """A failure criterion: a watched quantity, and the value `most` above which a run fails.

    unconditional: whether it counts also where the energy does not balance, as nothing else would
    explain that. of_size: whether `most` is a fraction of the scene's size (m), World.size.
    failure(values) -> (cause, remedy): in words, from the largest values of the element type's
    watches. unbalanced(element) -> remedy: where the energy does not balance and this element of
    the type is the worst; "" where the type knows none of its own.
    """

    name: str
    most: float
    unconditional: bool
    failure: Callable[[dict[str, float]], tuple[str, str]]
    of_size: bool = False
    unbalanced: Callable[[str], str] | None = None


class Series(NamedTuple):
    """A recorded series: values (t,), or (t, k) along a dimension with k labels, in a unit.

    time_dim: the dimension of t; code: digest of the code that read it off the run, where that does
    not count in the run's name.
    """

    values: np.ndarray
    unit: str
    long_name: str
    dimension: str | None = None
    labels: tuple[str, ...] = ()
    time_dim: str = "time"
    code: str = ""

    def merge(self, series: "Series") -> "Series":
        """The columns of another series, then those of this one."""
        values = np.concatenate([series.values, self.values], axis=1)
        return self._replace(values=values, labels=series.labels + self.labels)


class Eventful(NamedTuple):
    """An element that has events: its name, names of its events in the order of their numbers, and
    the name of the joint that it is on, "" for none."""

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
    """Base class of an element type. A subclass overrides what it provides; every attribute has a
    neutral default."""

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
        """Check the element's fields against their limits; raises SceneError if it does not fit
        into the scene."""
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
        """Check that a field's index exists in the scene; raises SceneError if not."""
        count = len(getattr(scene, field.of))
        if not (isinstance(value, Integral) and field.least <= value < count):
            raise SceneError(self.subject(scene, field), value, f"{field.least} to {count - 1}")

    def subject(self, scene: SceneData, field: FieldSpec) -> str:
        """Name in messages of a field of this element, as "stiffness of latch A"."""
        words = field.words or field.name.replace("_", " ") + " of {title}"
        title = self.title(scene) if "{title}" in words else ""
        return words.format(called=self.called, title=title)

    def title(self, scene: SceneData) -> str:
        """Name of this element in messages, as "latch A"."""
        return self.called

    def unit_in(self, scene: SceneData, unit: str) -> str:
        """Unit of a number of the element, by the one its field states: on slides N for N m."""
        return unit

    def topology(self) -> Hashable:
        """What must be equal, of this element, in all scenes that run side by side."""
        return tuple(getattr(self, n) for n, field in specs(type(self)).items() if field.same)

    def acts_on(self) -> tuple[int, ...]:
        """Indices of the hinges on whose openings the element acts."""
        return ()

    # -- of all elements of the kind in a scene -------------------------------------------------

    @classmethod
    def of(cls, scene: SceneData) -> list[Any]:
        """Elements of this type in a scene."""
        return scene.kinds.get(cls, [])

    @classmethod
    def led(cls, scene: SceneData) -> list["ElementType"]:
        """Elements by which those of the type are represented where an opening is moved slowly, in
        static balance, to find what resists it (fpm/travel)."""
        return cls.of(scene)

    @classmethod
    def topology_of(cls, scene: SceneData) -> Hashable:
        """What must be equal, of all elements of the type, in scenes that run side by side; None:
        even whether there are any may differ."""
        return tuple(element.topology() for element in cls.of(scene))

    @classmethod
    def names(cls, scene: SceneData) -> list[str]:
        """Names of the elements, for messages; those of a group one by one."""
        return [f"{cls.called or cls.__name__} {i}" for i in range(len(cls.of(scene)))]

    @classmethod
    def eventful(cls, scene: SceneData) -> list[Eventful]:
        """Elements of the type with their events, if they have any."""
        return [Eventful(name, cls.events) for name in cls.names(scene) if cls.events]

    @classmethod
    def moved(cls, scene: SceneData) -> list[int]:
        """Indices of particles that the type's own kernels move (hooks `prepare` and `move`)."""
        return []

    @classmethod
    def deformations(cls, scene: SceneData) -> Deformations | None:
        """Deformations of the elements with their stiffness, for the stable step; None: the type
        has no stiffness."""
        return None

    @classmethod
    def dampings(cls, scene: SceneData) -> Deformations | None:
        """Deformations with damping (N m s/rad) in place of stiffness, for the stable step; None:
        the type has no dampers.

        For dampers whose rate is extrapolated from the last two steps (losses_kernels.py).
        """
        return None

    @classmethod
    def shut(cls, scene: SceneData, inverse: np.ndarray) -> Any:
        """Motions that are ruled out in the one position in which the type acts, as orthonormal
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
        """The named tuple of arrays for the type's kernels, filled by `array`. batch: of scenes."""
        arrays = _arrays_in(cls.kernels())
        return arrays(**{name: cls.array(name, batch) for name in arrays._fields})

    @classmethod
    def array(cls, name: str, batch: Batch) -> Any:
        """The array that stands under `name` in the tuple of the type's kernels; by default the
        integers of the field of that name. batch: the scenes being packed.

        `numbers`: constants of every element, in the order of NUMBERS in the kernels' file;
        `state`, `track`: zeros, STATE for each element, and TRACK for each at every instant;
        `account`: index of the account of the work it gives, else of the energy it takes; SHARED.
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
        """Moment (N m) that exact holds of openings may have to bear at rest, where rounding moves
        the scene a little."""
        return 0.0

    @classmethod
    def reads_impulses(cls, scene: SceneData) -> bool:
        """Whether elements of the type need the impulses of joints summed over each step."""
        return False

    @classmethod
    def weight(cls, scene: SceneData, particle: int, time: np.ndarray) -> np.ndarray:
        """Force (3,) or (t, 3) N on a particle at times (t,) s that is there because of its mass.

        The ground has a mass that means nothing: its reaction leaves this force out.
        """
        return np.zeros(3)

    @classmethod
    def recorded(cls, part: Any, scene: SceneData, lane: int) -> dict[str, Series]:
        """Recorded series of one sample, by names of variables in a trajectory file. part: arrays
        of the type's kernels after the run; lane: index of the sample in the batch."""
        return {}

    @classmethod
    def prescribe(cls, scene: SceneData, time: float, motion: Any) -> None:
        """Put the prescribed motion at a time (s) into `motion`, a Motion (fpm/files/outcome.py) of
        all particles, in place."""


def _row(element: ElementType, columns: list) -> list[float]:
    """Constants of an element in the order of columns, (name, field spec)."""
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
