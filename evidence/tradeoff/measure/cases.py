"""The cases of the study "error against cost": which scene, box, meshes, steps and designs.

A level is one discretisation; all designs of a level share its runs. The reference of a case is its
finest level, with a dense scan."""

from dataclasses import dataclass, field, replace

BENNETT = {"BD": {"distance": ["B", "D"]}, "vBz": {"velocity": "B", "component": "z"}}
PENDULUM = {"x": {"position": "T", "component": "x"}, "vz": {"velocity": "T", "component": "z"}}


@dataclass(frozen=True)
class Choice:
    """How bounds are taken: the design and the model.

    `order` is None for a scan, which has `samples` runs. `model` is "polynomial" (none for a plain
    scan) or "spline"."""

    method: str
    order: int | None = None
    samples: int | None = None
    model: str = "polynomial"

    @property
    def label(self) -> str:
        """Short name for tables and plots."""
        name = "scan" if self.method == "sobol" else self.method
        text = f"{name} {self.samples if self.order is None else self.order}"
        return text if self.model == "polynomial" else f"{text}, {self.model}"


@dataclass(frozen=True)
class Level:
    """A discretisation: elements (per link), share of the stable step, and what is run with it.

    `scan` runs of a dense scan judge the choices of this level; 0: the reference alone does. In
    `rounds` more rounds, runs are sought that widen the scan's bounds (reference.py)."""

    elements: int
    safety: float
    scan: int
    choices: tuple[Choice, ...]
    rounds: int = 0

    @property
    def label(self) -> str:
        """Short name for tables and plots."""
        suffix = "" if self.safety == 0.9 else f", step x{self.safety}"
        return f"{self.elements} elements{suffix}"


@dataclass(frozen=True)
class Case:
    """A scene with a box, its levels from coarse to fine, the last the reference.

    `intervals` maps a parameter to its half width relative to the scene's default, `fixed` others
    to values that differ from it; `mesh` is the scene's parameter for the number of elements.
    `trajectories` are the discretisations (elements, safety) whose single runs are compared, the
    last the reference."""

    name: str
    title: str
    scene: str
    mesh: str
    responses: dict
    intervals: dict[str, float]
    held_out: int
    levels: tuple[Level, ...]
    trajectories: tuple[tuple[int, float], ...] = ()
    fixed: dict[str, float] = field(default_factory=dict)
    duration: float = 1.0
    instants: int = 2001


def _grids(method: str, orders, **options) -> tuple[Choice, ...]:
    return tuple(Choice(method, n, **options) for n in orders)


def _scans(*samples: int, **options) -> tuple[Choice, ...]:
    return tuple(Choice("sobol", samples=n, **options) for n in samples)


def _splines(*choices: Choice) -> tuple[Choice, ...]:
    return tuple(replace(choice, model="spline") for choice in choices)


_LINE = (
    *_grids("tensor_roots", (3, 5, 9, 17, 33)),
    *_grids("tensor_lobatto", (2, 4, 8, 16, 32)),
    *_scans(4, 8, 16, 32, 64),
    *_splines(*_grids("tensor_roots", (3,)), *_grids("tensor_lobatto", (2, 4, 8))),
    *_scans(4, 8, 16, 32, 64, model="spline"),
)
_LINE_SHORT = (
    *_grids("tensor_roots", (3,)),
    *_grids("tensor_lobatto", (4, 8, 16)),
    *_scans(8, 16, 32),
    *_splines(*_grids("tensor_lobatto", (4, 8)), *_scans(8, 16, 32)),
)
_SPACE = (
    *_grids("tensor_roots", (3,)),
    *_grids("tensor_lobatto", (2, 4)),
    *_grids("smolyak", (2, 4)),
    *_scans(16, 32, 64, 128, 256),
    *_splines(*_grids("smolyak", (2, 4))),
    *_scans(16, 32, 64, 128, 256, model="spline"),
)
_SPACE_SHORT = (
    *_grids("smolyak", (2, 4)),
    *_grids("tensor_lobatto", (2,)),
    *_scans(16, 32, 64),
    *_splines(*_grids("smolyak", (2, 4)), *_scans(16, 32, 64)),
)
_BENNETT = {"scene": "bennett", "mesh": "elements", "responses": BENNETT}

CASES = (
    Case(
        "one", "Bennett linkage, a ± 1 %", **_BENNETT, intervals={"a": 0.01}, held_out=4,
        levels=(
            Level(4, 0.9, 201, _LINE),
            Level(8, 0.45, 0, _LINE_SHORT),
            Level(8, 0.9, 401, _LINE),
            Level(16, 0.9, 201, _LINE),
            Level(32, 0.9, 201, _LINE_SHORT),
        ),
        trajectories=(
            (2, 0.9), (4, 0.9), (8, 0.9), (8, 0.45), (8, 0.225), (16, 0.9), (32, 0.9), (64, 0.9),
        ),
    ),
    Case(
        "three", "Bennett linkage, a ± 1 %, E ± 5 %, K_C ± 10 %", **_BENNETT,
        intervals={"a": 0.01, "E": 0.05, "K_C": 0.10}, held_out=8,
        levels=(
            Level(4, 0.9, 512, _SPACE_SHORT, rounds=2),
            Level(8, 0.9, 768, _SPACE, rounds=4),
            Level(16, 0.9, 768, _SPACE_SHORT + _grids("smolyak", (8,)), rounds=5),
        ),
    ),
    Case(
        "spring", "Bennett linkage, K_F ± 5 %", **_BENNETT, intervals={"K_F": 0.05}, held_out=4,
        levels=(Level(8, 0.9, 401, _LINE),),
    ),
    Case(
        "smooth", "Pendulum of a stiff bar, L ± 1 %, g ± 1 %", "pendulum", "elements", PENDULUM,
        intervals={"L": 0.01, "g": 0.01}, fixed={"E": 2e10}, held_out=6, instants=1001,
        levels=tuple(Level(n, 0.9, 2048, _SPACE_SHORT) for n in (2, 4, 8)),
        trajectories=((2, 0.9), (4, 0.9), (4, 0.45), (8, 0.9), (16, 0.9)),
    ),
)  # fmt: skip
