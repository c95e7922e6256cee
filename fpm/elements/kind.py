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
    """An energy of the balance (J). name: key; variable: in a trajectory file; long_name: words."""

    name: str
    variable: str
    long_name: str


class Watch(NamedTuple):
    """A failure criterion: a quantity, watched during a run, whose largest value lets the run fail.
    name: its key; most: the limit; of_size: whether that is a fraction of the scene's size (m);
    unconditional: whether it counts even where the energy does not balance, as nothing else
    explains it; failure(values): cause and remedy in words, from the largest values of the element
    type's watches by name; unbalanced(element): remedy where the energy does not balance and the
    element of that name is the worst, "": none."""

    name: str
    most: float
    unconditional: bool
    failure: Callable[[dict[str, float]], tuple[str, str]]
    of_size: bool = False
    unbalanced: Callable[[str], str] | None = None


class Series(NamedTuple):
    """A recorded series. values (t,), or (t, k) for k labelled elements; unit; long_name: in words;
    dimension, labels: of the k columns; time_dim: name of the dimension of t; code: digest of the
    code that read it off the run, where that does not count in the run's name."""

    values: np.ndarray
    unit: str
    long_name: str
    dimension: str | None = None
    labels: tuple[str, ...] = ()
    time_dim: str = "time"
    code: str = ""

    def merge(self, series: "Series") -> "Series":
        """A series with the columns and labels of `series`, then those of this one."""
        values = np.concatenate([series.values, self.values], axis=1)
        return self._replace(values=values, labels=series.labels + self.labels)


class Eventful(NamedTuple):
    """An element that has events. name: the element's; events: names of its events, in the order of
    the numbers that kernels note; joint: name of the joint that it is on, "": none."""

    name: str
    events: tuple[str, ...]
    joint: str = ""


class Deformations(NamedTuple):
    """How springs of elements are strained by small motions of particles from the start, for the
    stable step, in the particles' own axes (timestep.py): r springs, one or more for each element.
    dofs (r, 12): degrees of freedom of two particles, 6 p .. 6 p + 5 for particle p; values (r,
    12): derivatives of the strain d (m, rad) by them; stiffness (r,): k, of energy 1/2 k d²;
    element (r,): index of the element in its type."""

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
    neutral default. stores, gives, takes: energies that its elements store, give as work, take out
    (Energy; None: none; types with the same share an account); events: names of its events;
    watches: failure criteria (Watch); reads: types whose arrays its kernels need in every step;
    acts_as: component of the moments on openings, in recordings, that is its own; joins: whether
    each element joins its `particles`; moves_free: whether it moves all particles that no other
    type moves; resists_as: class of its part in what resists a slow motion (fpm/travel), "": none;
    called: its word in messages; cost: core time of
    an element in a step (ns)."""

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
    cost: ClassVar[float] = 100.0  # core time of one of its elements in a step (ns; effort.py)

    # -- of one element -----------------------------------------------------------------------

    def add_to(self, scene: SceneData) -> None:
        """Check the element and add it to the scene; raises SceneError if it does not fit."""
        self.check(scene)
        scene.kinds.setdefault(type(self), []).append(self)

    def check(self, scene: SceneData) -> None:
        """Check the element's fields against their limits, and indices against the scene, which is
        not changed; raises SceneError if it does not fit."""
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
        """Check that an index exists in the scene's list; raises SceneError if not. field: spec of
        the field (the list's name, the least index); value: the index."""
        count = len(getattr(scene, field.of))
        if not (isinstance(value, Integral) and field.least <= value < count):
            raise SceneError(self.subject(scene, field), value, f"{field.least} to {count - 1}")

    def subject(self, scene: SceneData, field: FieldSpec) -> str:
        """Name for messages of a field of this element, as "stiffness of latch A"; field: spec."""
        words = field.words or field.name.replace("_", " ") + " of {title}"
        title = self.title(scene) if "{title}" in words else ""
        return words.format(called=self.called, title=title)

    def title(self, scene: SceneData) -> str:
        """What a message calls this element: here the word of its type, `called`; types override it
        to add a name, as "latch A", from the scene that holds the element."""
        return self.called

    def unit_in(self, scene: SceneData, unit: str) -> str:
        """Unit of one of the element's numbers in this scene: `unit`, which its field states,
        unless the element is on a slide, where N stands for N m."""
        return unit

    def topology(self) -> Hashable:
        """What of this element (fields with `same`) must be equal in scenes run side by side."""
        return tuple(getattr(self, n) for n, field in specs(type(self)).items() if field.same)

    def acts_on(self) -> tuple[int, ...]:
        """Indices of the hinges on whose openings (angles, lengths) the element acts."""
        return ()

    # -- of all elements of the kind in a scene -------------------------------------------------

    @classmethod
    def of(cls, scene: SceneData) -> list[Any]:
        """Elements of this type in a scene, in the order in which they were added."""
        return scene.kinds.get(cls, [])

    @classmethod
    def led(cls, scene: SceneData) -> list["ElementType"]:
        """Elements that stand for those of the type where an opening is moved slowly, always in
        static balance, to find what resists it (fpm/travel); by default the elements themselves."""
        return cls.of(scene)

    @classmethod
    def topology_of(cls, scene: SceneData) -> Hashable:
        """What of all elements of the type must be equal in scenes that run side by side, as a
        hashable value; None: nothing, not even whether there are any."""
        return tuple(element.topology() for element in cls.of(scene))

    @classmethod
    def names(cls, scene: SceneData) -> list[str]:
        """Names of the type's elements in a scene, for messages, one for each row of measures of
        failure; elements of a group are named one by one."""
        return [f"{cls.called or cls.__name__} {i}" for i in range(len(cls.of(scene)))]

    @classmethod
    def eventful(cls, scene: SceneData) -> list[Eventful]:
        """Names of the type's elements in a scene, each with the names of its events, if any."""
        return [Eventful(name, cls.events) for name in cls.names(scene) if cls.events]

    @classmethod
    def moved(cls, scene: SceneData) -> list[int]:
        """Indices of particles that the type's own kernels move in place of the time loop."""
        return []

    @classmethod
    def deformations(cls, scene: SceneData) -> Deformations | None:
        """How the type's springs are strained by motions of particles, with their stiffness, for
        the stable step of the scene; None: it has no stiffness."""
        return None

    @classmethod
    def dampings(cls, scene: SceneData) -> Deformations | None:
        """How the type's dampers are moved by motions of particles, with damping (N m s/rad) in the
        field for stiffness, for the stable step; None: it has none. For dampers whose rate is
        extrapolated from the last two steps (losses_kernels.py)."""
        return None

    @classmethod
    def kernels(cls) -> ModuleType:
        """The module with the type's kernels: named as the module of the type, or of one that it
        derives from, with `_kernels` behind. Raises NotImplementedError where there is none."""
        for kind in cls.__mro__[:-1]:
            if find_spec(name := f"{kind.__module__}_kernels"):
                return import_module(name)
        raise NotImplementedError(
            f"kind {cls.__name__} has no kernels: no {cls.__module__}_kernels"
        )

    @classmethod
    def pack(cls, batch: Batch) -> NamedTuple:
        """Pack all elements of the type into the named tuple of arrays that its kernels take, each
        field by `array`. batch: the scenes being packed, side by side."""
        arrays = _arrays_in(cls.kernels())
        return arrays(**{name: cls.array(name, batch) for name in arrays._fields})

    @classmethod
    def array(cls, name: str, batch: Batch) -> Any:
        """Array for the field `name` of the named tuple that the type's kernels take; by default
        whole numbers, the elements' field of that name. batch: the scenes being packed. "numbers":
        constants of each element, in the order of NUMBERS in the kernels' module; "state": zeros,
        STATE for each; "track": zeros, TRACK for each at every instant; "account": index in
        World.accounts of the work it gives, else of the energy it takes; SHARED has further
        ones."""
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
        """Force (N) that joints of the scene may bear at rest because of this type: its work on
        ways by rounding sets the least energy by which the energy balance is judged."""
        return 0.0

    @classmethod
    def held_round(cls, scene: SceneData) -> float:
        """Moment (N m) that exact holds of openings may bear at rest because of this type: its work
        on ways by rounding sets the least energy by which the energy balance is judged."""
        return 0.0

    @classmethod
    def cost_in(cls, scene: SceneData) -> float:
        """Core time (ns) of all elements of the type in a time step of eight runs of the scene side
        by side (scenes/effort.py): `cost` for each."""
        return cls.cost * len(cls.names(scene))

    @classmethod
    def reads_impulses(cls, scene: SceneData) -> bool:
        """Whether elements of the type in the scene need the impulses of joints in each step."""
        return False

    @classmethod
    def recorded(cls, part: Any, scene: SceneData, lane: int) -> dict[str, Series]:
        """Recorded series of one sample after a run, by names of variables in a trajectory file.
        part: arrays of the type's kernels; scene: the sample's; lane: its index in the batch."""
        return {}


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
