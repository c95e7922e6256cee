"""Volume fractions of boxes whose numbers are closed forms: what the answers say, and what is true.

The runs are evaluations of the closed form; all else is the program's: where further runs are made,
the fits, and what is said of requirements, alone and together, and of halved intervals."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.stats import qmc

from deployable.campaign.answers.evaluations import ModelEvaluator
from deployable.campaign.answers.limits import judge, list_limits
from deployable.campaign.answers.quantity_bounds import converge_bounds
from deployable.campaign.plan.plan import RunAccount
from deployable.intervals import make_design
from deployable.intervals.box import Box, held_out_points
from evidence.results import Report, table
from evidence.rows import Row, at_least, at_most, set_group
from evidence.search.mechanisms_slides import crossing, swing

DRAWS, CHUNK = 2**18, 2**13
RESOLUTION = 5e-4
"""Of true fractions: below it neither a miss nor its ratio counts."""
TOLERANCE, MAX_RUNS = 0.05, 200
MISS = 1e-3  # from which a stated uncertainty is held against it


@dataclass(frozen=True)
class ClosedBox:
    """A box of `k` parameters in [-1, 1] whose quantities are closed forms.

    function: values (P) by quantity at points (P, k), NaN where it does not happen; limits: by
    requirement, its limits by quantity; margins: as the values, by how much a quantity happens, of
    those of which runs tell it; latest: end of the runs, where quantities are times."""

    name: str
    k: int
    function: Callable[[np.ndarray], Mapping[str, np.ndarray]]
    limits: Mapping[str, Mapping[str, Mapping[str, Any]]]
    margins: Callable[[np.ndarray], Mapping[str, np.ndarray]] = lambda x: {}
    latest: float | None = None

    def columns(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values and margins (P, q) of all quantities."""
        values, margins = self.function(x), self.margins(x)
        rows = [np.broadcast_to(margins.get(name, np.nan), len(x)) for name in values]
        return np.column_stack([*values.values()]), np.column_stack(rows)

    def masks(self, x: np.ndarray) -> dict[str, np.ndarray]:
        """Masks (P) of where each requirement is kept, and all are (`together`)."""
        values, masks = self.function(x), {}
        for name, limits in self.limits.items():
            mask = np.ones(len(x), dtype=bool)
            for quantity, bounds in limits.items():
                number = values[quantity]
                for kind, level in bounds.items():
                    mask &= (
                        np.isfinite(number) == bool(level) if kind == "happens"
                        else number <= level if kind == "at_most" else number >= level
                    )  # fmt: skip
            masks[name] = mask
        return {**masks, "together": np.all([*masks.values()], axis=0)}

    def truth(self) -> dict[str, float]:
        """True fractions by requirement, of all together, and, by parameter's number, of all with
        its interval halved, and what that gains."""
        x = 2 * qmc.Sobol(self.k, seed=0).random(DRAWS) - 1
        masks = self._masks(x)
        shares = {name: float(mask.mean()) for name, mask in masks.items()}
        for j in range(self.k):
            row = self._masks(np.where(np.arange(self.k) == j, x / 2, x))["together"]
            shares[f"halved {j}"] = float(row.mean())
            shares[f"gain {j}"] = float(row.mean() - masks["together"].mean())
        return shares

    def _masks(self, x: np.ndarray) -> dict[str, np.ndarray]:
        with np.errstate(all="ignore"):
            parts = [self.masks(x[i : i + CHUNK]) for i in range(0, len(x), CHUNK)]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


class ClosedEvaluator(ModelEvaluator):
    """An evaluator whose runs are evaluations of a `ClosedBox`."""

    def __init__(self, box: ClosedBox, points: np.ndarray, most: float) -> None:
        names, k = list(box.function(np.zeros((1, box.k)))), box.k
        self.form, self.account = box, RunAccount()
        quantities = [
            SimpleNamespace(
                name=name, long_name=name, unit="1", kind="largest", is_time=False,
                limits=(-np.inf, np.inf),
                response=SimpleNamespace(kind="sum", long_name=name, subjects=()),
                number=1, instant=None,
                always_exists=not (box.latest or self._comes_and_goes(name)),
            ) for name in names
        ]  # fmt: skip
        for quantity in quantities:
            quantity.is_time = bool(box.latest) and not quantity.always_exists
        self.setup = SimpleNamespace(
            box=Box([f"p{j}" for j in range(k)], -np.ones(k), np.ones(k)), intervals={}, name="",
            quantity_list=quantities, quantities={name: {} for name in names}, nominal=[],
            solver=SimpleNamespace(duration=box.latest),
        )  # fmt: skip
        self.points = points
        self.numbers, self.margins = box.columns(points)
        self.refinements, self.rest_count, self.max_refinements = [], 0, most

    def _comes_and_goes(self, name: str) -> bool:
        x = 2 * qmc.Sobol(self.form.k, seed=1).random(1024) - 1
        return not np.isfinite(self.form.function(x)[name]).all()

    @property
    def experiment(self) -> Any:
        return self.setup

    @property
    def nominal(self) -> np.ndarray:
        return np.zeros(self.form.k)

    def add(self, points: Iterable[np.ndarray]) -> np.ndarray:
        points = list(points)
        for point in points:
            is_new = np.abs(self.points - point).max(axis=1).min() > 1e-6
            if is_new and len(self.refinements) < self.max_refinements:
                numbers, margins = self.form.columns(np.asarray(point)[None])
                self.points = np.concatenate([self.points, np.asarray(point)[None]])
                self.numbers = np.concatenate([self.numbers, numbers])
                self.margins = np.concatenate([self.margins, margins])
                self.refinements.append(point)
        return np.array([self.nearest(point)[0] for point in points], dtype=int)


def play(box: ClosedBox, mode: str, truth: Mapping[str, float]) -> list[dict[str, Any]]:
    """What is said of a box, beside the truth: by a sparse grid ("default") or "accuracy"."""
    k, tolerances = box.k, []
    if mode == "default":
        nodes = make_design("smolyak", k, 2 if k < 6 else 1).points
        points = np.concatenate([nodes, held_out_points(np.ones(k, dtype=bool), 4, nodes)])
        model = ClosedEvaluator(box, points, np.inf)
    else:
        points = make_design("sobol", k, samples=8 * k - 1).points
        points = np.concatenate([np.zeros((1, k)), points])
        model = ClosedEvaluator(box, points, MAX_RUNS - len(points))
        tolerances = [TOLERANCE] * len(model.experiment.quantity_list)
    specs = list_limits(box.limits, list(model.experiment.quantities))
    converge_bounds(model, 4, specs, tolerances)
    rows = judge(model, box.limits)
    answers = {row["name"]: row for row in rows["requirements"]}
    if all(truth["together"] != truth[name] for name in box.limits):
        answers["together"] = rows["together"]
    fractions = [
        {"fraction": name, "true": truth[name], "said": row["share"],
         "open": row["share_uncertainty"], "met": row["met"], "kind": "fraction"}
        for name, row in answers.items()
    ]  # fmt: skip
    halved = rows["together"]["halved"]
    for j, row in enumerate(halved.values()):
        fractions += [
            {"fraction": f"halved {j}", "true": truth[f"halved {j}"], "said": row["share"],
             "open": row["share_uncertainty"], "met": "some", "kind": "halved"},
            {"fraction": f"gain {j}", "true": truth[f"gain {j}"], "said": row["gain"],
             "open": row["gain_uncertainty"], "met": "some", "kind": "gain"},
        ]  # fmt: skip
    return [{"box": box.name, "by": mode, "runs": len(model.points), **row}
            for row in fractions]  # fmt: skip


def truths() -> dict[str, dict[str, float]]:
    """The stored true fractions, by box."""
    return json.loads(Path(__file__).with_suffix(".json").read_text())


def measure(quick: bool = False) -> list[dict[str, Any]]:
    """What is said of all boxes, both by a sparse grid and with `accuracy`; of two with `quick`."""
    references = truths()
    boxes = [box for box in BOXES if box.name in ("both", "step 1")] if quick else BOXES
    modes = "default", "accuracy"
    return [row for box in boxes for mode in modes for row in play(box, mode, references[box.name])]


def is_covered(row: Mapping[str, Any]) -> bool:
    """Whether a true fraction lies within what is said of it: of what no run breaks, or none keeps,
    what so many runs in any places miss with a chance of 5 % counts, as the verdict tells it."""
    blind_share = 3 / row["runs"] if row["met"] in ("all", "none") else 0.0
    return bool(abs(row["said"] - row["true"]) <= row["open"] + blind_share + RESOLUTION)


def report(answers: Sequence[Mapping[str, Any]]) -> Report:
    """How many fractions lie within their uncertainty, and a table of all."""
    rows: list[Row] = []
    for kind, name in (
        ("fraction", "fractions"), ("halved", "fractions with one interval halved"),
        ("gain", "gains by halving one interval"),
    ):  # fmt: skip
        group = [row for row in answers if row["kind"] == kind]
        pairs = [(row["open"], abs(row["said"] - row["true"])) for row in group]
        ratios = [open_ / miss for open_, miss in pairs if miss > MISS]
        successes = [is_covered(row) for row in group]
        note = f"{sum(successes)} of {len(successes)}"
        rows += [
            at_least(
                f"{name} within their uncertainty", float(np.mean(successes)), 0.95, note=note
            ),
            at_most(
                f"{name}: uncertainty over error, median", float(np.median(ratios or [0.0])), 3
            ),
        ]
    lines = [
        (row["box"], row["by"], row["runs"], row["fraction"], row["met"],
         *(f"{row[key]:.4f}" for key in ("true", "said", "open")), is_covered(row))
        for row in answers
    ]  # fmt: skip
    header = ("box", "by", "runs", "fraction", "met", "true", "said", "open", "within")
    text = "\n## Fractions\n\n" + table(header, lines)
    return Report(set_group("closed forms", rows), {"fractions": answers}, text)


# -- boxes ----------------------------------------------------------------------------------------


def scale(x: np.ndarray, *ends: tuple[float, float]) -> list[np.ndarray]:
    """Parameters (P) from their least and largest values."""
    return [
        low + (column + 1) / 2 * (high - low) for column, (low, high) in zip(x.T, ends, strict=True)
    ]


def one_number(name: str, k: int, function: Callable, *levels: float, **options: Any) -> ClosedBox:
    """A box of one number q with requirements that it is at most each level; +inf: it happens."""
    limits = {
        f"at most {level:g}" if np.isfinite(level) else "happens": {
            "q": {"at_most": level} if np.isfinite(level) else {"happens": True}
        }
        for level in levels
    }
    margin = options.pop("margin", None)
    margins = (lambda x: {"q": margin(x)}) if margin else (lambda x: {})
    return ClosedBox(name, k, lambda x: {"q": function(x)}, limits, margins, **options)


def race(x: np.ndarray) -> dict[str, np.ndarray]:
    """When two damped hinges reach 90 of 120 degrees, and where the second is at the first time."""
    k1, c1, k2, c2 = (
        p[:, None] for p in scale(x, (0.8, 1.2), (0.21, 0.39), (0.72, 1.08), (0.21, 0.39))
    )
    rest, times = np.radians(120), np.linspace(0, 4.0, 41)

    def angle(k: np.ndarray, c: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        return lambda t: rest + swing(t, -rest, 0.0, np.sqrt(k), c / 2)

    first, second = angle(k1, c1), angle(k2, c2)
    t1, t2 = (crossing(lambda t, f=f: f(t) - np.pi / 2, times) for f in (first, second))
    lag = np.where(t2 <= t1, np.pi / 2, second(t1[:, None])[:, 0])
    return {"t1": t1, "t2": t2, "lag": lag, "last": np.fmax(t1, t2)}


def brake(x: np.ndarray) -> np.ndarray:
    """Square of the rate at which a hinge slowed by friction comes upon its latch."""
    inertia, speed, moment = scale(x, (0.8, 1.2), (1.12, 2.08), (1.8, 2.2))
    return speed**2 - 2 * moment * 0.6 / inertia


def rare(x: np.ndarray) -> dict[str, np.ndarray]:
    """When it comes upon a latch that catches up to 0.4 rad/s."""
    inertia, speed, moment = scale(x, (0.8, 1.2), (1.12, 2.08), (1.8, 2.2))
    square = brake(x)
    time = (speed - np.sqrt(np.maximum(square, 0.0))) / (moment / inertia)
    return {"t": np.where((square > 0) & (square <= 0.16), time, np.nan)}


def rare_margin(x: np.ndarray) -> dict[str, np.ndarray]:
    square = brake(x)
    return {
        "t": np.minimum(np.sqrt(np.abs(square)) * np.sign(square), 0.4 - np.sqrt(np.abs(square)))
    }


def sail(x: np.ndarray) -> dict[str, np.ndarray]:
    """Rate and time at the end of a stroke that springs push, a brake and friction hold."""
    a, b, oil, rub = scale(x, (0.9, 1.1), (0.9, 1.1), (0.48, 0.72), (0.05, 0.25))
    ends = []
    for strength in (a, b):
        push, tau = 1.0 * strength - rub, 0.12 / oil
        # x = v_end (t - tau (1 - exp(-t/tau))), at 1.5 m
        end = push / oil
        time = np.full(len(x), 1.0)
        for _ in range(60):
            wrong = end * (time - tau * (1 - np.exp(-time / tau))) - 1.5
            time = time - wrong / (end * (1 - np.exp(-time / tau)))
        ends.append((time, 0.12 * end * (1 - np.exp(-time / tau))))
    (t1, hit), (t2, _) = ends
    return {"hit": hit, "last": np.maximum(t1, t2), "uneven": np.abs(t1 - t2)}


def needle(x: np.ndarray) -> np.ndarray:
    return 0.1 * x[:, 0] + np.exp(-((x[:, 0] - 0.63) ** 2 + (x[:, 1] + 0.41) ** 2) / 0.0016)


def peaks(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    k, c, inertia, rest = scale(x, (0.7, 1.3), (0.05, 0.15), (0.7, 1.3), (0.72, 0.88))
    d = c / (2 * inertia)
    w = np.sqrt(k / inertia - d * d)
    delay = np.minimum(np.pi / w, 2.8)
    value = rest * (1 - np.exp(-d * delay) * (np.cos(w * delay) + d / w * np.sin(w * delay)))
    return value, delay


def third(x: np.ndarray) -> dict[str, np.ndarray]:
    value, delay = peaks(x)
    value = value - 0.02 * x[:, 0]
    exists = value > 1.38
    return {"t": np.where(exists, delay - np.sqrt(np.maximum(value - 1.38, 0)), np.nan)}


def plane(x: np.ndarray) -> np.ndarray:
    """A number along a direction that no parameter has: of unit range over any box."""
    slope = 1.0 / (1.0 + np.arange(x.shape[1]))
    return x @ slope / slope.sum()


def margin_of(function: Callable[[np.ndarray], np.ndarray]) -> Callable:
    """The time of an event where a function is above 0: like a root beside the border."""
    return lambda x: np.where(
        function(x) > 0, 2.0 - np.sqrt(np.maximum(function(x), 0.0)) + 0.1 * x[:, 0], np.nan
    )


def catch(function: Callable[[np.ndarray], np.ndarray]) -> Callable:
    """A number that exists where a function is above 0, and does not tell how near that is."""
    return lambda x: np.where(function(x) > 0, 1.0 + 0.2 * x[:, -1] - 0.1 * x[:, 0] ** 2, np.nan)


def ball(x: np.ndarray) -> np.ndarray:
    return (x**2).sum(axis=1)


INF = np.inf
REACH = lambda x: plane(x) + 0.5 - 0.1 * ball(x)  # noqa: E731
STEP = lambda x: np.interp(x[:, 0] + x[:, 1], [0.3, 0.3001], [0, 1]) + 0.05 * x[:, 0]  # noqa: E731
BOXES = [
    *(
        one_number(f"plane {k}", k, plane, *levels)
        for k, levels in (
            (1, (0.2, 0.97)),
            (3, (-0.3, 0.8)),
            (6, (0.2, 0.6)),
            (8, (0.0, -0.45)),
        )
    ),
    one_number("ball 3", 3, ball, 1.0, 0.05),
    one_number("ball 5", 5, ball, 1.21),
    one_number("wave", 2, lambda x: x[:, 1] - 0.3 * np.sin(5 * x[:, 0]), 0.3),
    one_number("kink 3", 3, lambda x: x.max(axis=1), 0.7, 0.0),
    one_number("roof 2", 2, lambda x: np.abs(x.sum(axis=1)), 0.5, 1.8),
    one_number("kink 5", 5, lambda x: np.maximum(plane(x), 0.3 * x[:, 4]), 0.15, 0.4),
    one_number("step 1", 1, lambda x: np.where(x[:, 0] > 0.37, 1.0, 0.0) + 0.3 * x[:, 0], 0.5),
    one_number("step 3", 3, lambda x: np.where(plane(x) > 0.2, 1.0, 0.0) + 0.2 * x[:, 1], 0.5),
    one_number("small step", 3, lambda x: plane(x) + 0.1 * (x[:, 0] > 0.25), 0.2, 0.5),
    one_number("needle", 2, needle, 0.5),
    one_number("latch 1", 1, catch(lambda x: x[:, 0] + 0.43), INF, 1.05),
    one_number("latch 3", 3, catch(lambda x: plane(x) + 0.15), INF, 0.95),
    one_number("latch ball", 3, catch(lambda x: 1.6**2 - ball(x - [-0.8, 0.6, 0.3])), INF),
    one_number("latch rare", 3, catch(lambda x: plane(x) - 0.78), INF),
    one_number("reach 4", 4, margin_of(REACH), INF, 1.4, margin=REACH),
    one_number(
        "late 2",
        2,
        lambda x: np.where((t := 2 + x[:, 0] * x[:, 1] + x[:, 0]) <= 2.5, t, np.nan),
        INF,
        2.2,
        latest=2.5,
    ),
    ClosedBox(
        "race", 4, race, {"order": {"lag": {"at_most": 1.5707}}, "soon": {"last": {"at_most": 2.0}}}
    ),
    ClosedBox("rare", 3, rare, {"caught": {"t": {"happens": True}}}, rare_margin, latest=3.0),
    ClosedBox(
        "sail",
        4,
        sail,
        {
            "gentle": {"hit": {"at_most": 0.185}},
            "in_time": {"last": {"at_most": 1.3}},
            "even": {"uneven": {"at_most": 0.15}},
        },
    ),
    ClosedBox(
        "third", 4, third, {"again": {"t": {"happens": True}}, "not": {"t": {"happens": False}}}
    ),
    ClosedBox(
        "both",
        2,
        lambda x: {"a": x.sum(axis=1), "b": x @ [1.0, -0.5]},
        {"up": {"a": {"at_most": 1.5, "at_least": -1.0}}, "down": {"b": {"at_most": 0.5}}},
    ),
    ClosedBox(
        "joint jump",
        3,
        lambda x: {"a": STEP(x), "b": plane(x), "c": ball(x)},
        {
            "a": {"a": {"at_most": 0.5}},
            "b": {"b": {"at_least": -0.3}},
            "c": {"c": {"at_most": 1.6}},
        },
    ),
    ClosedBox(
        "joint event",
        3,
        lambda x: {"t": catch(lambda y: plane(y) + 0.15)(x), "m": np.maximum(x[:, 0], x[:, 1])},
        {"t": {"t": {"happens": True}}, "m": {"m": {"at_most": 0.5}}},
    ),
    ClosedBox(
        "four",
        2,
        lambda x: {"a": x[:, 0], "b": x[:, 1], "m": np.maximum(abs(x[:, 0]), abs(x[:, 1]))},
        {
            "four": {
                "a": {"at_most": 0.6, "at_least": -0.6},
                "b": {"at_most": 0.6, "at_least": -0.6},
            },
            "min": {"m": {"at_most": 0.6}},
        },
    ),
]
