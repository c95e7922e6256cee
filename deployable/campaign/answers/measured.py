"""From measured curves to what of the box explains them, `measured.json`, whose keys
`summary.schema.json` describes."""

import itertools
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from deployable.campaign.answers.discretization import halved
from deployable.campaign.answers.evaluations import ModelEvaluator, runs_at
from deployable.campaign.answers.limits import describe_limit, list_limits
from deployable.campaign.config.measured import MeasuredCurves, read_test
from deployable.campaign.config.sections import Accuracy, Interval, ResolvedTest, Verify
from deployable.campaign.errors import CampaignError
from deployable.campaign.files import write_result
from deployable.campaign.plan.plan import choose_step
from deployable.campaign.results.quantity_results import QuantityResults, number
from deployable.campaign.results.response_bounds import read_bounds
from deployable.intervals.calibration import (
    Calibration,
    Measurement,
    TestRuns,
    calibrate,
    calibrate_together,
    no_runs,
)
from deployable.intervals.scalars.fits import choose_fit
from fpm.structures.curves_file import CurvesFileError

_LEAST_MOVE = 0.005  # of a parameter's width, by which a side must move
_STRONG = 0.9  # correlation from which two parameters are said to trade off
_MOST_LEFT = 32  # runs of what is left, of which quantities are taken


def answer(
    model: ModelEvaluator, measured: Mapping[str, ResolvedTest],
    requirements: Mapping[str, Mapping], verify: Verify,
) -> None:  # fmt: skip
    """Find the part of a campaign's box that explains its measured curves, with further runs, and
    write `measured.json` into the folder of `model`, which has the planned runs. measured,
    requirements, verify: sections of the config. Raises `CampaignError`, also if a file of measured
    curves has changed."""
    tests = [_Test(name, test, model) for name, test in measured.items()]
    sources = [test for test in tests if test.settings.use == "calibrate"]
    cube = np.array([-1.0, 1.0])[:, None] * model.experiment.box.free
    result, singles = _calibrate(sources, cube, verify)
    checks = []
    for test in tests:
        if test not in sources:
            # Beside tests that nothing explains, the check alone, about what comes nearest to them.
            group = [test] if result.is_refuted else [*sources, test]
            data = () if result.is_refuted else result.data
            check, _ = _calibrate(group, result.hull, verify, data)
            bands = np.abs(check.residuals[-1]) / test.curves.bands
            i, instant = map(int, np.unravel_index(bands.argmax(), bands.shape))
            checks.append({
                "name": test.name,
                "inside": False if check.is_refuted else True if check.attained <= 1.0 else None,
                **_misfits(check),
                "worst": _worst(check, group, len(group) - 1, i, instant),
            })  # fmt: skip
    misfits = result.misfits()
    hulls = [(test.name, single.hull) for test, single in zip(sources, singles, strict=True)
             if not single.is_refuted]  # fmt: skip
    rows = {
        **_misfits(result),
        "explained": result.fractions[0],
        "left": result.fractions[1],
        "hull": float(np.prod(np.ptp(result.hull, axis=0)[model.experiment.box.free] / 2.0)),
        "worst": _worst(result, sources, *result.worst),
        "singles": [
            {"name": test.name, **_misfits(single)}
            for test, single in zip(sources, singles, strict=True)
        ],
        "disjoint": [
            [name, peer] for (name, a), (peer, b) in itertools.combinations(hulls, 2)
            if (np.maximum(a[0], b[0]) > np.minimum(a[1], b[1])).any()
        ],
        **_parameters(model, result, sources),
        **_describe_left(model, result, requirements, sources),
        "checks": checks,
        "tests": [t.describe(result, sources.index(t) if t in sources else None) for t in tests],
        "misfits": {"points": misfits[:, :-1].tolist(), "values": misfits[:, -1].tolist()},
        "runs": sum(test.runs for test in tests),
    }  # fmt: skip
    write_result(model.folder.measured, json.dumps(rows, indent=1) + "\n")


class _Test:
    """A test of a campaign: its measured curves, and the runs that are compared with them."""

    def __init__(self, name: str, settings: ResolvedTest, model: ModelEvaluator):
        self.name, self.settings = name, settings
        try:
            self.curves: MeasuredCurves = read_test(settings)
        except CurvesFileError as error:
            raise CampaignError(f"measured.{name}.file: {error}") from None
        base, starts = model.experiment, settings.start
        intervals = {
            key: interval
            for key, interval in base.intervals.items()
            if key not in settings.scene and key not in starts
        }
        axes = [list(base.intervals).index(key) for key in intervals]
        intervals |= {
            key: Interval(low, (low + high) / 2, high) for key, (low, high) in starts.items()
        }
        scene = replace(base.scene, parameters=base.scene.parameters | settings.scene)
        experiment = replace(
            base, scene=scene, intervals=intervals, quantities={}, accuracy=Accuracy()
        )
        self.plan = replace(
            model.plan, experiment=experiment, time=choose_step(experiment), adaptive=None
        )
        self.model = model.for_plan(self.plan)
        self.responses = list(settings.columns.values())
        self.instants = np.linspace(0.0, base.solver.duration, base.solver.instants)
        self.rows = [list(base.responses).index(response) for response in self.responses]
        self.units = [base.response_list[row].unit for row in self.rows]
        sensor = settings.unknown
        limits = [list(sensor.delay)]
        for center, widths in ((1.0, sensor.gain), (0.0, sensor.offset)):
            limits += [
                [center - widths.get(response, 0.0), center + widths.get(response, 0.0)]
                for response in self.responses
            ]
        data = self.curves.times, self.curves.values, self.curves.bands
        self.measurement = Measurement(*data, np.array(limits).T, np.array(axes), len(starts))
        self.runs = 0
        self.envelope: Any = np.array([np.inf, -np.inf])[:, None, None]
        count, rows = len(self.curves.times), self.curves.rows
        if count < rows:
            model.notify(f"{name}: {count} of {rows} measured instants are compared, evenly chosen")

    def evaluate(self, points: np.ndarray, halvings: int) -> np.ndarray:
        """Curves (N, n, R) of runs at coordinates (N, p), of the test's responses, with a step that
        is halved so often; NaN of those that fail."""
        plan = self.plan
        for _ in range(halvings):
            plan = halved(plan)
        records = self.model.records(plan, runs_at(plan, points))
        self.runs += len(points)
        blank = np.full((len(self.rows), len(self.instants)), np.nan)
        curves = np.array([blank if r is None else r.values[self.rows] for r in records])
        least, largest = self.envelope
        lower, upper = np.fmin.reduce(curves), np.fmax.reduce(curves)
        self.envelope = np.fmin(least, lower), np.fmax(largest, upper)
        return curves

    def describe(self, result: Calibration, index: int | None) -> dict:
        """Return the test and its curves as plain data; index: of its fit, None if only checked."""
        times, settings = self.curves.times, self.settings
        rows = {
            "name": self.name, "file": settings.file, "digest": settings.digest,
            "use": settings.use, "rows": self.curves.rows, "instants": len(times),
            "window": [float(times[0]), float(times[-1])],
        }  # fmt: skip
        described_curves = {}
        if index is not None:  # its runs in the narrowed box and start
            axes, runs = self.measurement.axes, result.data[index]
            low, high = np.concatenate([result.hull[:, axes], result.starts[index]], axis=1)
            is_inside = ((runs.points >= low - 1e-9) & (runs.points <= high + 1e-9)).all(axis=1)
            inner_curves = runs.curves[is_inside & (not result.is_refuted)]
        for i, (response, unit) in enumerate(zip(self.responses, self.units, strict=True)):
            described_curves[response] = {
                "units": unit, "times": times.tolist(), "values": self.curves.values[i].tolist(),
                "bands": self.curves.bands[i].tolist(),
                **{name: np.interp(times, self.instants, curves[i]).tolist()
                   for name, curves in zip(("lower", "upper"), self.envelope, strict=True)},
            }  # fmt: skip
            if index is not None:
                best = self.curves.values[i] + result.residuals[index][i]
                remainder = inner_curves[:, i]
                ends = (remainder.min(axis=0), remainder.max(axis=0)) if len(remainder) else ()
                described_curves[response] |= {
                    "best": best.tolist(), "rates": np.gradient(best, times).tolist(),
                    "left": [np.interp(times, self.instants, end).tolist() for end in ends],
                }  # fmt: skip
        return {**rows, "curves": described_curves}


def _calibrate(
    tests: Sequence[_Test], hull: np.ndarray, verify: Verify,
    data: Sequence[TestRuns] | None = None,
) -> tuple[Calibration, list[Calibration]]:  # fmt: skip
    """Find the part of `hull` that explains the tests together and each of them alone. With `data`,
    the runs of the first tests made before, only all of them together."""
    times = np.linspace(0.0, (solver := tests[0].plan.experiment.solver).duration, solver.instants)

    def notify_of(indices: Sequence[int], text: str) -> None:
        tests[0].model.notify(f"{', '.join(tests[t].name for t in indices)}: {text}")

    def evaluate(t: int, points: np.ndarray, halvings: int) -> np.ndarray:
        return tests[t].evaluate(points, halvings)

    arguments = [test.measurement for test in tests], times, evaluate, hull
    waves = max(1, verify.max_iterations)
    if data is None:
        return calibrate_together(*arguments, waves, notify_of)
    data = [*data, *no_runs(arguments[0][len(data) :], times)]
    return calibrate(*arguments, data, waves, notify=partial(notify_of, range(len(tests)))), []


def _misfits(result: Calibration) -> dict:
    """Return whether tests are refuted, and their least misfits."""
    return {
        "refuted": bool(result.is_refuted),
        "least": float(result.least),
        "attained": float(result.attained),
    }


def _worst(result: Calibration, tests: Sequence[_Test], t: int, i: int, instant: int) -> dict:
    test, residual = tests[t], float(result.residuals[t][i, instant])
    bands = residual / test.curves.bands[i, instant]
    return {
        "test": test.name, "response": test.responses[i], "units": test.units[i],
        "time": float(test.curves.times[instant]), "bands": float(bands), "residual": residual,
    }  # fmt: skip


def _parameters(model: ModelEvaluator, result: Calibration, tests: Sequence[_Test]) -> dict:
    """Intervals before and after, and what trades off."""
    axes = {axis for test in tests for axis in test.measurement.axes}
    experiment, box = model.experiment, model.experiment.box
    units = {name: parameter.unit for name, parameter in experiment.scene_type.parameters.items()}
    low, high = box.from_unit(result.hull)
    rows, words = [], {(True, True): "both", (True, False): "lower", (False, True): "upper"}
    for j, (name, interval) in enumerate(experiment.intervals.items()):
        sides = result.hull[0, j] > -1 + 2 * _LEAST_MOVE, result.hull[1, j] < 1 - 2 * _LEAST_MOVE
        rows.append({
            "name": name, "units": units[name], "before": [interval.lower, interval.upper],
            "after": None if result.is_refuted else [float(low[j]), float(high[j])],
            "best": float(box.from_unit(result.best)[j]) if j in axes else None,
            "seen": words.get((bool(sides[0]), bool(sides[1])), "none") if box.free[j] else "none",
        })  # fmt: skip
    trade_offs = []
    values = box.from_unit(result.samples) if len(result.samples) > 8 else np.zeros((0, len(rows)))
    columns = [*zip(experiment.intervals, values.T, strict=True)] if len(values) else []
    for i, (rival, rivals) in enumerate(columns):
        for name, column in columns[:i]:
            if np.ptp(column) and np.ptp(rivals):
                correlation = float(np.corrcoef(column, rivals)[0, 1])
                slope = float(correlation * rivals.std() / column.std())
                row = {"names": [name, rival], "correlation": correlation, "slope": slope}
                trade_offs += [row] if abs(correlation) >= _STRONG else []
    return {"parameters": rows, "trade_offs": trade_offs}


def _describe_left(
    model: ModelEvaluator, result: Calibration, requirements: Mapping[str, Mapping],
    tests: Sequence[_Test],
) -> dict:  # fmt: skip
    """Quantities, limits and the next test, by runs of what is left in the campaign's own case."""
    rows: dict[str, list] = {"quantities": [], "limits": [], "next": []}
    if result.is_refuted or not len(result.samples):
        return rows
    samples = result.samples
    order = [*samples.argmin(axis=0), *samples.argmax(axis=0), *range(len(samples))]
    unit = samples[[*dict.fromkeys(order)][:_MOST_LEFT]]
    records: list = model.records(model.plan, runs_at(model.plan, unit))
    is_sound = [record is not None for record in records]
    unit, records = unit[is_sound], [*itertools.compress(records, is_sound)]
    rows["next"] = _next_tests(model, np.array([r.values for r in records]), tests)
    if not model.experiment.quantities:
        return rows
    intervals = QuantityResults.read(model.folder).rows
    numbers = np.array([record.numbers for record in records])
    center, half = result.hull.mean(axis=0), np.maximum(np.ptp(result.hull, axis=0) / 2, 1e-9)
    bounds = []
    for q, quantity in enumerate(model.experiment.quantity_list):
        happens = np.isfinite(numbers[:, q])
        lower, upper, error = np.nan, np.nan, np.nan
        if happens.any():
            fit = choose_fit((unit[happens] - center) / half, numbers[happens, q])
            values = fit.evaluate((result.samples - center) / half)
            ends = result.samples[[values.argmin(), values.argmax()]]
            extra = model.evaluate(model.plan, ends)[0][:, q]
            quantity_values = np.concatenate([numbers[happens, q], extra[np.isfinite(extra)]])
            lower, upper, error = quantity_values.min(), quantity_values.max(), fit.error
        bounds.append((lower, upper, error if np.isfinite(error) else np.inf, happens))
        rows["quantities"].append({
            "name": quantity.name, "units": quantity.unit,
            "before": [intervals[q]["lower"], intervals[q]["upper"]],
            "after": [number(lower), number(upper)], "error": number(error),
            "happens": "all" if happens.all() else "some" if happens.any() else "none",
        })  # fmt: skip
    for spec in list_limits(requirements, list(model.experiment.quantities)):
        row = {"requirement": spec.requirement, **describe_limit(model, spec)}
        rows["limits"].append({**row, "met": _judge_limit(spec, *bounds[spec.quantity])})
    return rows


def _judge_limit(spec: Any, lower: float, upper: float, error: float, happens: np.ndarray) -> str:
    """Return in which part of the remaining box a limit is met: all, some, none, or undecided."""
    if spec.kind == "happens":
        share = np.mean(happens == bool(spec.level))
        return "all" if share == 1 else "some" if share else "none"
    if not happens.all():
        return "some" if happens.any() else "none"
    sign = 1.0 if spec.kind == "at_least" else -1.0
    slack = sorted((sign * (lower - spec.level), sign * (upper - spec.level)))
    if slack[0] >= error:
        return "all"
    if slack[1] < -error:
        return "none"
    return "some" if slack[0] < 0 <= slack[1] else "undecided"


def _next_tests(model: ModelEvaluator, curves: np.ndarray, tests: Sequence[_Test]) -> list[dict]:
    """Find where the remaining runs (R, n, T) differ most: a row for each response, most first."""
    bounds = read_bounds(model.folder, of_design=True)
    bands: dict = {}
    for test in tests:
        for response, band in zip(test.responses, test.curves.bands, strict=True):
            bands[response] = min(band.min(), bands.get(response, np.inf))
    rows = []
    for i, curve in enumerate(model.experiment.response_list):
        if curve.kind == "margin":
            continue
        spread = np.ptp(curves[:, i], axis=0)
        instant = int(spread.argmax())
        band, width = bands.get(curve.name), bounds.responses[i].width.max()
        rows.append({
            "response": curve.name, "units": curve.unit, "time": float(bounds.time[instant]),
            "spread": float(spread[instant]), "measured": band is not None,
            "bands": None if band is None else float(spread[instant] / band),
            "fraction": float(spread[instant] / width) if width > 0 else 0.0,
        })  # fmt: skip
    return sorted(rows, key=lambda row: -row["fraction"])
