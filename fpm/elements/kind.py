"""Base class of all element types: the interface that the rest of the mechanics relies on.

An element type is a frozen dataclass by which a scene states its elements, one object each (for
beams, one for a group of elements), and a kernel file (fpm/kernels/hooks.py). Everything has a
neutral default. `docs/mechanics.md` shows how to add an element type."""

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from numbers import Integral
from types import ModuleType
from typing import Any, ClassVar, NamedTuple

import numpy as np

from fpm.declare import Index, Key, Number, Word, numbers_in, specs
from fpm.elements.batch import Batch, SceneData
from fpm.errors import SceneError


@dataclass(frozen=True)
class VirtualBeam:
    """Rigid, massless `arm` (3,), m, in a particle's own axes, from it to a point. The paper uses
    stiff beams; the limit of infinite stiffness costs no element, and does not shorten the step."""

    particle: int
    arm: np.ndarray

    def end_in(self, places) -> np.ndarray:
        """Return the position (3,), m, global, of the arm's free end. places: object with position
        and frame of all particles, as a scene."""
        return places.position[self.particle] + places.frame[self.particle] @ self.arm


AXES = "xyz"
"""Names of the global axes."""


class Energy(NamedTuple):
    """An energy in the balance of a run (J). name: key by which types and outcome find it;
    variable: its name in a trajectory file (netCDF); long_name: what it is, in words."""

    name: str
    variable: str
    long_name: str


class Watch(NamedTuple):
    """A failure criterion: a quantity whose largest value over a run is watched; above a limit the
    run fails. name: its key; most: the limit, in the quantity's unit, or with of_size=True as a
    fraction of the scene's size (m); unconditional: whether it is named as the cause even where the
    energy balance is wrong, too (else that is the cause); failure(values): returns cause and
    remedy, two texts; values: largest value of each criterion of the element type, by name, `step`
    (s), and, of a joint, `turn`, by which its bodies turn in a step (rad); dead_end(scene, element,
    values): returns both texts for where shorter steps fail at the same time, and whether that is
    sure without these; None: no shorter step is tried;
    remedy(element): returns the remedy where the energy does not balance and the element of
    that name is the worst; None: there is none."""

    name: str
    most: float
    unconditional: bool
    failure: Callable[[dict[str, float]], tuple[str, str]]
    of_size: bool = False
    remedy: Callable[[str], str] | None = None
    dead_end: Callable[[Any, str, dict[str, float]], tuple[str, str, bool]] | None = None


class Series(NamedTuple):
    """A recorded series of one sample, for a trajectory file. values: (t,), or (t, k) for k
    labelled elements, in `unit` (as "N m"), over t instants or, if time_dim is "travel_position",
    over positions along a joint's travel; long_name: what it is, in words; dimension, labels: name
    of the dimension of the k columns (None: values are (t,)), and the name of each; time_dim: name
    of the dimension of t."""

    values: np.ndarray
    unit: str
    long_name: str
    dimension: str | None = None
    labels: tuple[str, ...] = ()
    time_dim: str = "time"


class Gate(NamedTuple):
    """The opening (joint coordinate) at which an element's event occurs, as a latch's. opening: rad
    or m; side: 1: as it rises, -1: as it falls, 0: either; reach: by how much earlier (rad or m);
    largest_rate: above which it does not occur (rad/s or m/s), 0: none; slides: whether it is on a
    slide."""

    opening: float
    side: float
    reach: float = 0.0
    largest_rate: float = 0.0
    slides: bool = False

    @property
    def is_sharp(self) -> bool:
        """Whether it occurs here or never; with reach and largest rate it catches later, too."""
        return not (self.reach and self.largest_rate)


class Eventful(NamedTuple):
    """An element that has events. name: the element's; events: names of its events, at the index by
    which kernels note each; joint: name of the joint on which it is, "": none; gate: where that is
    when it latches, hits or closes, None: not known by an opening."""

    name: str
    events: tuple[str, ...]
    joint: str = ""
    gate: Gate | None = None


class Deformations(NamedTuple):
    """Linear strains d (m or rad) of r springs by small motions of particles from the start, for
    the stable time step (timestep.py). Rotations are about the particles' own axes. dofs (r, 12):
    degrees of freedom that strain each spring, of two particles: 6 p to 6 p + 5 of particle p;
    values (r, 12): derivatives of d by them; stiffness (r,): k (N/m or N m/rad), of energy k d²/2;
    element (r,): index, in its type, of the element to which the spring belongs."""

    dofs: np.ndarray
    values: np.ndarray
    stiffness: np.ndarray
    element: np.ndarray


BATCH_ARRAYS = {
    "rows": Batch.rows_of,
    "log": Batch.log_of,
    "peaks": Batch.peaks_of,
    "work_account": Batch.work_account,
    "loss_account": Batch.loss_account,
}
"""What stands under some names in the tuples of all kernels: shares of what is common."""


class ElementType:
    """Base class of an element type. A subclass overrides what it provides; every attribute has a
    neutral default."""

    stores: ClassVar[Energy | None] = None  # the energy it stores (hook `sum_energies`)
    gives: ClassVar[Energy | None] = None  # the work it gives; kinds with the same share an account
    takes: ClassVar[Energy | None] = None  # the energy it takes out
    events: ClassVar[tuple[str, ...]] = ()  # names of its events, in the order of their numbers
    watches: ClassVar[tuple[Watch, ...]] = ()  # of several that are too large, the last counts
    reads: ClassVar[tuple[type, ...]] = ()  # kinds whose arrays it needs in every step
    acts_as: ClassVar[str] = ""  # which part of the moment on openings is its own (opening.py)
    joins: ClassVar[bool] = False  # whether each holds its `particles` together by a `name`
    moves_free: ClassVar[bool] = False  # whether it moves all particles that no other kind does

    resists_as: ClassVar[str] = "HA"  # class of its part in slow travel (fpm/travel); "": none
    has_memory: ClassVar[bool] = True  # whether forces depend on the way to where they act

    # Of recorded variables, the columns of `track` in their order: unit, long name, dimension.
    series: ClassVar[dict[str, tuple[str, str, str]]] = {}
    noun: ClassVar[str] = ""  # in messages; kinds that are called alike are one to a user
    name_field: ClassVar[str] = ""  # field with the name of each in messages and files
    cost: ClassVar[float] = 100.0  # ns, of one element in a step of eight runs (timestep.py)

    # -- of one element -----------------------------------------------------------------------

    def add_to(self, scene: SceneData) -> None:
        """Check the element and add it to the scene; raises SceneError if it does not fit."""
        self.check(scene)
        scene.kinds.setdefault(type(self), []).append(self)

    def check(self, scene: SceneData) -> None:
        """Check the element's fields against their limits, and that indices exist in the scene,
        before it is added; raises SceneError if one does not fit. The scene is not changed."""
        for name, key in specs(type(self)).items():
            value = getattr(self, name)
            if isinstance(key, Index):
                for index in value if isinstance(value, tuple) else (value,):
                    self.check_index(scene, key, index)
            elif isinstance(key, Number) and not key.fits(value):
                noun = f"{'finite ' * key.finite}number"
                noun = f"a {noun}" if key.count == 1 else f"{key.count} {noun}s"
                allowed = key.describe(noun, self.unit_in(scene, key.unit))
                raise SceneError(self.subject(scene, key), value, allowed)
            elif isinstance(key, Word) and value not in key.values:
                raise SceneError(self.subject(scene, key), value, key.allowed)

    def check_index(self, scene: SceneData, field: Index, value: int) -> None:
        """Check that an index is in the scene's list `field.group`, or `field.least`."""
        count = len(getattr(scene, field.group))
        if not (isinstance(value, Integral) and field.least <= value < count):
            raise SceneError(self.subject(scene, field), value, f"{field.least} to {count - 1}")

    def subject(self, scene: SceneData, field: Key) -> str:
        """Return what messages call a field of this element, as "stiffness of latch A". scene: has
        the element's hinge, which may be named; field: the field's spec, with name or words."""
        words = field.words or field.name.replace("_", " ") + " of {title}"
        title = self.title(scene) if "{title}" in words else ""
        return words.format(noun=self.noun, title=title)

    def title(self, scene: SceneData) -> str:
        """Return what a message calls this element, as "cable A": its type's word (`noun`), with
        its name if it has a `name_field`. scene: with what it acts on."""
        return f"{self.noun} {getattr(self, self.name_field)}" if self.name_field else self.noun

    def unit_in(self, scene: SceneData, unit: str) -> str:
        """Return the unit of one of the element's fields in this scene: by default `unit`, which
        the field states; types on joints turn "N m" into "N" where the joint is a slide."""
        return unit

    def topology(self) -> Hashable:
        """Return, as a tuple, those of this element's fields (stated with is_topology, or indices)
        that must be equal in scenes whose runs are computed together, side by side."""
        fields = specs(type(self)).items()
        return tuple(getattr(self, name) for name, field in fields if field.is_topology)

    def acts_on(self) -> tuple[int, ...]:
        """Return the indices of the hinges on whose openings the element acts."""
        return ()

    # -- of all elements of the kind in a scene -------------------------------------------------

    @classmethod
    def reads_in(cls, scene: SceneData) -> tuple[type["ElementType"], ...]:
        """Return the types whose arrays its kernels need in every step of a scene."""
        return cls.reads

    @classmethod
    def find(cls, scene: SceneData) -> list[Any]:
        """Elements of this type in a scene, in the order in which they were added."""
        return scene.kinds.get(cls, [])

    @classmethod
    def sweep_elements(cls, scene: SceneData) -> list["ElementType"]:
        """Return the elements that replace this type's where a joint coordinate is moved slowly
        through static equilibria, to find what resists it (fpm/travel); by default its own."""
        return cls.find(scene)

    @classmethod
    def topology_of(cls, scene: SceneData) -> Hashable:
        """Return, as a hashable value, what of this type's elements in a scene, as their indices,
        must be equal in scenes simulated side by side; None: nothing, not even their number."""
        return tuple(element.topology() for element in cls.find(scene))

    @classmethod
    def names(cls, scene: SceneData) -> list[str]:
        """Return the names of the type's elements in a scene, for messages: one for each row in
        which kernels note who fails; a group of beams has several."""
        if cls.name_field:
            return [element.title(scene) for element in cls.find(scene)]
        return [f"{cls.noun or cls.__name__} {i}" for i in range(len(cls.find(scene)))]

    @classmethod
    def eventful(cls, scene: SceneData) -> list[Eventful]:
        """Return the type's elements in a scene that have events, each with the names of these
        (Eventful), in the order by which kernels note them; empty if the type has none."""
        return [Eventful(name, cls.events) for name in cls.names(scene) if cls.events]

    @classmethod
    def moved_particles(cls, scene: SceneData) -> list[int]:
        """Return the particles of a scene that the type's kernels move themselves."""
        return []

    @classmethod
    def deformations(cls, scene: SceneData) -> Deformations | None:
        """Return how small motions of particles strain the type's springs, with their stiffness,
        from which the scene's stable time step is computed; None: the type has no stiffness."""
        return None

    @classmethod
    def dampings(cls, scene: SceneData) -> Deformations | None:
        """Return how small motions of particles move the type's dampers: Deformations whose field
        `stiffness` holds the damping (N s/m or N m s/rad), for the scene's stable time step; None:
        it has none. For dampers whose rate is extrapolated from the last two steps."""
        return None

    @classmethod
    def kernels(cls) -> ModuleType:
        """Return the module with the type's kernels: that named as the module of the type, or of a
        class it derives from, followed by `_kernels`. Else NotImplementedError."""
        for kind in cls.__mro__[:-1]:
            if find_spec(name := f"{kind.__module__}_kernels"):
                return import_module(name)
        text = f"kind {cls.__name__} has no kernels: no {cls.__module__}_kernels"
        raise NotImplementedError(text)

    @classmethod
    def pack(cls, batch: Batch) -> NamedTuple:
        """Return the arrays of all elements of the type, a named tuple that its kernels take as
        `part`; each field is made by `array`. batch: the scenes that are simulated side by side."""
        arrays = _arrays_in(cls.kernels())
        return arrays(**{name: cls.array(name, batch) for name in arrays._fields})

    @classmethod
    def array(cls, name: str, batch: Batch) -> Any:
        """Return the array for a field `name` of the kernels' tuple: "numbers": constants of each
        element, as NUMBERS lists them; "state": zeros, STATE for each; "track": zeros, TRACK for
        each at every instant; "account": index in World.accounts of the work that it gives, else of
        what it takes; those of BATCH_ARRAYS; else the elements' own field, as whole numbers. batch:
        the scenes side by side."""
        elements = cls.find(batch.scene)
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
                return (batch.work_account if cls.gives else batch.loss_account)(cls)
            case _ if name in BATCH_ARRAYS:
                return BATCH_ARRAYS[name](batch, cls)
        return batch.integers(getattr(element, name) for element in elements)

    @classmethod
    def held_up(cls, scene: SceneData) -> float:
        """Return the sum (N) of the forces that joints may have to bear at rest because of a
        scene's elements; by default 0. The tolerance of the energy balance follows from it."""
        return 0.0

    @classmethod
    def held_round(cls, scene: SceneData) -> float:
        """Return the sum (N m) of the moments that exactly held coordinates may have to bear at
        rest because of a scene's elements; by default 0, as `held_up`."""
        return 0.0

    @classmethod
    def cost_in(cls, scene: SceneData) -> float:
        """Return the core time (ns) of all elements of the type in a time step of eight runs of the
        scene side by side, to estimate run times (scenes/timestep.py): `cost` for each."""
        return cls.cost * len(cls.names(scene))

    @classmethod
    def reads_impulses(cls, scene: SceneData) -> bool:
        """Return whether elements of this type in the scene need the impulses by which joints are
        closed, summed over each step; they are summed only where some type does."""
        return False

    @classmethod
    def read_records(cls, part: Any, scene: SceneData, lane: int) -> dict[str, Series]:
        """Return the recorded Series of one sample, by variable of its trajectory file: by default
        the columns of `track`, as `series` names them. part: the kernels' arrays; scene: the
        sample's; lane: its index."""
        if not cls.series:
            return {}
        labels = tuple(cls.names(scene))
        if cls.name_field:
            labels = tuple(getattr(element, cls.name_field) for element in cls.find(scene))
        columns = part.track[:, :, lane].T.reshape(len(cls.series), -1, len(labels))
        table = zip(cls.series.items(), columns, strict=True)
        return {name: Series(values, *words, labels) for (name, words), values in table}


def _row(element: ElementType, columns: list) -> list[float]:
    """Constants of an element in the order of columns, (name, field spec)."""
    numbers: list[float] = []
    for name, field in columns:
        value = getattr(element, name)
        value = 0.0 if value is None else value
        numbers.extend(numbers_in(field.values[value] if isinstance(field, Word) else value))
    return numbers


@cache
def _arrays_in(kernels: ModuleType) -> type[Any]:
    """Return the named tuple that a file of kernels states."""
    items = [x for x in vars(kernels).values() if getattr(x, "__module__", "") == kernels.__name__]
    (array_type,) = [x for x in items if isinstance(x, type) and issubclass(x, tuple)]
    return array_type
