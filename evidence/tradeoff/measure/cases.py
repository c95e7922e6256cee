"""The cases of the study "error against cost": which box, meshes and designs of the linkage.

A level is a mesh; all designs of a level share its runs. The reference of a case is its finest
level, with a dense scan."""

from dataclasses import dataclass, replace

RESPONSES = {"BD": {"distance": ["B", "D"]}, "vBz": {"velocity": "B", "component": "z"}}


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
        """Short name for tables."""
        name = "scan" if self.method == "sobol" else self.method
        text = f"{name} {self.samples if self.order is None else self.order}"
        return text if self.model == "polynomial" else f"{text}, {self.model}"

    @property
    def kind(self) -> str:
        """What the bounds are of."""
        if self.model == "spline":
            return "splines"
        return "scans" if self.order is None else "polynomials"


@dataclass(frozen=True)
class Level:
    """A mesh (elements per link), the runs of the dense scan that judges it, and its choices.

    In `rounds` more rounds, runs are sought that widen the scan's bounds."""

    elements: int
    scan: int
    choices: tuple[Choice, ...]
    rounds: int = 0


@dataclass(frozen=True)
class Case:
    """A box of the linkage and its levels from coarse to fine, the last the reference.

    `intervals` maps a parameter to its half width relative to the default."""

    name: str
    title: str
    intervals: dict[str, float]
    held_out: int
    levels: tuple[Level, ...]
    duration: float = 1.0
    instants: int = 2001


def _scans(*samples: int, **options) -> tuple[Choice, ...]:
    return tuple(Choice("sobol", samples=n, **options) for n in samples)


def _spline(choice: Choice) -> Choice:
    return replace(choice, model="spline")


_LINE = (
    Choice("tensor_roots", 3),
    *(Choice("tensor_lobatto", n) for n in (4, 8, 16)),
    _spline(Choice("tensor_lobatto", 4)),
    *_scans(16),
    *_scans(8, 16, model="spline"),
)
_SPACE = (
    Choice("tensor_roots", 3),
    Choice("tensor_lobatto", 4),
    *(Choice("smolyak", n) for n in (2, 4)),
    _spline(Choice("smolyak", 4)),
    *_scans(64, 256),
    *_scans(32, 64, 128, model="spline"),
)
CASES = (
    Case(
        "one", "Bennett linkage, a ± 1 %", {"a": 0.01}, held_out=4,
        levels=tuple(Level(n, 201, _LINE) for n in (4, 8, 16, 32)),
    ),
    Case(
        "three", "Bennett linkage, a ± 1 %, E ± 5 %, K_C ± 10 %",
        {"a": 0.01, "E": 0.05, "K_C": 0.10}, held_out=8, levels=(Level(8, 768, _SPACE, rounds=4),),
    ),
)  # fmt: skip
