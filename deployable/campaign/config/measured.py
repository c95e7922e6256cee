"""Measured curves: the checks of the section `measured`, and the curves of its tests."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from deployable.campaign.config.models import MeasuredTest
from deployable.campaign.config.plausible import LARGEST
from deployable.campaign.config.resolve import allows, parameter_problems, real_names, unknown
from deployable.campaign.config.sections import Campaign, Experiment, ResolvedTest
from deployable.intervals.box import MOST_FULL
from fpm.arithmetic.units import unit
from fpm.reading.responses import Response
from fpm.structures.curves_file import CurvesFile, CurvesFileError
from fpm.structures.plausible import extent

MOST_INSTANTS = 150  # measured instants of a test that are compared, evenly chosen

ODD = 30.0
"""Ratio of a test's times or values to those of the run from which on a unit is questioned: more
than motions differ, and less than degrees from radians, or mm from m."""

_BAND = "_band"
_LEAST_INSTANTS = 51  # recorded ones, between which curves are interpolated


def resolve_tests(
    tests: Mapping[str, MeasuredTest], experiment: Experiment
) -> tuple[dict[str, ResolvedTest], list[str]]:
    """Check the section `measured` (`tests` by name) against an experiment and the files; returns
    the tests with the files' digests, and a sentence for each problem."""
    tests_by_name, problems = {}, []
    for name, test in tests.items():
        try:
            file = CurvesFile.read(test.file)
        except CurvesFileError as error:
            problems.append(f"measured.{name}.file: {error}")
            continue
        faults = [f"measured.{name}.{text}" for text in _test_problems(test, file, experiment)]
        problems += faults
        if not faults:
            tests_by_name[name] = ResolvedTest(**vars(test), digest=file.digest)
    if tests and all(test.use == "check" for test in tests.values()):
        problems.append("measured: all tests are of use check; allowed: at least one to calibrate")
    if tests and experiment.solver.instants < _LEAST_INSTANTS:
        problems.append(
            f"solver.instants: {experiment.solver.instants} instants are too few to have curves "
            f"between them; allowed: {_LEAST_INSTANTS} or more"
        )
    return tests_by_name, problems


def _test_problems(test: MeasuredTest, file: CurvesFile, experiment: Experiment) -> Iterator[str]:
    curves = {curve.name: curve for curve in experiment.response_list if curve.kind != "margin"}
    columns = [name for name in (*file.columns, *file.faults) if not name.endswith(_BAND)]
    keys, names = {*test.columns}, {*test.columns.values()}
    is_swapped = keys <= {*curves} and names <= {*columns}
    if is_swapped and not (keys <= {*columns} and names <= {*curves}):
        pairs = ", ".join(f"{column}: {response}" for response, column in test.columns.items())
        yield f"columns: a column of the file comes first, then its response; allowed: {{{pairs}}}"
        return
    wrong_names = {x for x, response in test.columns.items() if x in test.band and x != response}
    wrong_names -= {*test.columns.values()}
    for column, response in test.columns.items():
        if fault := file.faults.get(column) or file.faults.get(column + _BAND):
            yield f"columns.{column}: {fault}"
        elif column not in file.columns:
            yield f"columns.{column}: {unknown(column, f'column of {test.file}', columns)}"
        elif response not in curves:
            yield f"columns.{column}: {unknown(response, 'response over time', curves)}"
        elif not file.units[column].fits(unit(curves[response].unit)):
            dimension, symbol = file.units[column].dimension, curves[response].unit
            text = f"{test.file} has {dimension}, which does not fit {response}"
            yield f"columns.{column}: {text}; allowed: a unit that fits {symbol}"
        elif column in wrong_names:
            yield f"band.{column}: a band is named after its response; allowed: {response}"
        else:
            yield from _band_problems(test, file, column, curves[response])
    responses = [*test.columns.values()]
    for response in {response for response in responses if responses.count(response) > 1}:
        yield f"columns: {response} stands twice; allowed: each response once"
    sensor = {"unknown.offset": test.unknown.offset, "unknown.gain": test.unknown.gain}
    for key, entries in {"band": test.band, "model": test.model, **sensor}.items():
        for name in entries.keys() - {*responses, *(wrong_names if key == "band" else ())}:
            yield f"{key}.{name}: {unknown(name, 'response in columns', responses)}"
    yield from _instant_problems(test, file, experiment.solver.duration)
    yield from _value_problems(test, experiment)


def _band_problems(
    test: MeasuredTest, file: CurvesFile, column: str, response: Response
) -> Iterator[str]:
    name, band = response.name, column + _BAND
    if (has_column := band in file.columns) == (name in test.band):
        text = "has two bands" if has_column else "has no band"
        yield f"band.{name}: {name} {text}; allowed: one here or as {band}"
    elif has_column and not file.units[band].fits(unit(response.unit)):
        text = f"{test.file}: the unit of {band} is not one of {column}"
        yield f"columns.{column}: {text}; allowed: one of {response.unit}"
    elif has_column and not (file.columns[band] > 0).all():
        text = f"{test.file}: a band of {band} is not above 0"
        yield f"columns.{column}: {text}; allowed: numbers above 0"


def _instant_problems(test: MeasuredTest, file: CurvesFile, duration: float) -> Iterator[str]:
    low, high = file.times[0], file.times[-1]
    least = max(low, test.unknown.delay[1])
    first, last = test.window or (least, high)
    if test.window and not least - 1e-12 <= first < last <= high + 1e-12:
        text = f"[{first:.6g}, {last:.6g}] s, and the file has {low:.6g} to {high:.6g} s"
        delay = f", of which {least:.6g} s, the longest delay, do not count" if least > low else ""
        is_ms = least <= first / 1000 < last / 1000 <= high
        hint = f" (did you mean [{first / 1000:.6g}, {last / 1000:.6g}]?)" if is_ms else ""
        yield f"window: {text}{delay}{hint}; allowed: two times in s from {least:.6g} to {high:.6g}"
    elif (end := last - test.unknown.delay[0]) > duration + 1e-12:
        text = f"it ends {end:.6g} s into the run, at the least delay, the run at {duration:.6g} s"
        hint = _time_hint(file, end, duration)
        text = f"{text}{hint}; allowed: an earlier end, or a longer delay (unknown.delay)"
        yield f"window: {text} or solver.duration"
    elif (count := ((file.times >= first) & (file.times <= last)).sum()) < 3:
        step = np.diff(file.times).min(initial=duration)
        hint = _time_hint(file, high, duration)
        key, span = "window" if test.window else "file", f"from {first:.6g} to {last:.6g} s"
        text = f"{count} instants of {test.file} lie {span}; it ends at {high:.6g} s, and its "
        yield f"{key}: {text}instants are {step:.3g} s apart{hint}; allowed: at least three"


def _time_hint(file: CurvesFile, end: float, duration: float) -> str:
    """A question that names the unit of time in which a file that ends at `end` (s) fits a run."""
    for symbol, seconds in {"us": 1e-6, "ms": 1e-3, "s": 1, "min": 60, "h": 3600}.items():
        if seconds != file.time_unit and 1 / ODD < end * seconds / file.time_unit / duration < 1.01:
            return f" (are its times in {symbol}?)"
    return ""


def _value_problems(test: MeasuredTest, experiment: Experiment) -> Iterator[str]:
    if not set(experiment.intervals) - set(test.scene):
        names = ", ".join(experiment.intervals)
        yield f"scene: it fixes all intervals; allowed: at least one of {names} left"
    structure = experiment.scene_type
    real = real_names(structure)
    for name, (low, high) in test.start.items():
        if name not in real:
            yield f"start.{name}: {unknown(name, 'real parameter', real)}"
        elif name in test.scene:
            yield f"start.{name}: {name} is defined twice, here and in scene; allowed: once"
        elif not low < high or not all(allows(structure.parameters[name], v) for v in (low, high)):
            text = f"[{low:g}, {high:g}] is not allowed; allowed: a lower and a larger value, each "
            yield f"start.{name}: {text}{structure.parameters[name].allowed}"
    yield from parameter_problems("scene", test.scene, structure)
    count = len({*experiment.intervals, *test.start} - set(test.scene))
    if count > MOST_FULL:
        yield f"start: {count} unknown values with the intervals; allowed: {MOST_FULL}"


def measured_warnings(campaign: Campaign) -> Iterator[str]:
    """Yield warnings of measured curves of a `Campaign` whose band exceeds the whole curve, whose
    times or values hardly fit the unit that the file states, or whose time has an odd name."""
    experiment = campaign.experiment
    responses = {curve.name: curve for curve in experiment.response_list}
    for name, test in campaign.measured.items():
        yield from (f"measured.{name}: {text}" for text in CurvesFile.read(test.file).doubts)
        curves, duration = read_test(test), experiment.solver.duration
        is_whole = test.window is None or test.window[0] - curves.start < duration
        if not duration / ODD <= curves.length <= (LARGEST * duration if is_whole else np.inf):
            yield (
                f"measured.{name}: the times of {test.file} span {curves.length:.4g} s, and a run "
                f"{duration:g} s: check their unit, such as s for ms"
            )
        for response, values, bands in zip(
            test.columns.values(), curves.values, curves.bands, strict=True
        ):
            low, high, unit_name = values.min(), values.max(), responses[response].unit
            size = max(abs(low), abs(high))
            if bands.min() > max(high - low, size):
                yield (
                    f"measured.{name}: the band of {response}, {bands.min():.4g} {unit_name}, is "
                    f"larger than all of its curve, {low:.4g} to {high:.4g} {unit_name}, so that "
                    f"it narrows next to nothing: state a band in {unit_name}"
                )
            least, most, source = _usual_sizes(experiment, responses[response])
            if size and most and not least <= size <= most:
                yield (
                    f"measured.{name}: {response} reaches {size:.4g} {unit_name} in {test.file}, "
                    f"and {source}: check the unit in the file"
                )


def _usual_sizes(experiment: Experiment, response: Response) -> tuple[float, float, str]:
    """Between which sizes values of a response are expected, and why; 0, 0: nothing is known."""
    scene = experiment.nominal_scene
    names = response.subjects if response.kind == "opening" else ()
    start = sum(abs(hinge.opening) for hinge in scene.hinges if hinge.name in names)
    if response.unit == "rad" and names:
        return start / ODD, max(start * ODD, 4 * np.pi), f"it is {start:.4g} rad at the start"
    if response.unit == "m":  # a body alone has no extent, but its radius of gyration
        radii = [np.sqrt(scene.inertia[i].max() / scene.mass[i]) for i in scene.bodies.values()]
        size = max(span := extent(scene), start, *radii)
        return (start or span / 100) / ODD, size * ODD, f"the structure's size is {size:.4g} m"
    return 0.0, 0.0, ""


@dataclass(frozen=True)
class MeasuredCurves:
    """Curves (n, T) of a test at T instants, with the `bands` of sensor and model together, both in
    the units of the responses. rows: how many rows of the file lie there; start, length: when the
    file begins, and how long it lasts (s)."""

    times: np.ndarray
    values: np.ndarray
    bands: np.ndarray
    rows: int
    start: float
    length: float


def read_test(test: ResolvedTest) -> MeasuredCurves:
    """Read the curves of a test between its times, thinned to `MOST_INSTANTS`. Raises
    `CurvesFileError`, also if the file is no longer the one that was checked."""
    file = CurvesFile.read(test.file)
    if file.digest != test.digest:
        text = f"{test.file}: it changed since it was checked; allowed: the campaign again"
        raise CurvesFileError(text)
    first, last = test.window or (max(file.times[0], test.unknown.delay[1]), file.times[-1])
    rows = np.flatnonzero((file.times >= first) & (file.times <= last))
    count = len(rows)
    rows = rows[np.linspace(0, count - 1, min(count, MOST_INSTANTS)).round().astype(int)]
    bands = [
        file.columns[column + _BAND][rows] if column + _BAND in file.columns
        else np.full(len(rows), test.band[response])
        for column, response in test.columns.items()
    ]  # fmt: skip
    margins = [[test.model.get(response, 0.0)] for response in test.columns.values()]
    values = np.array([file.columns[column][rows] for column in test.columns])
    span = file.times[0], np.ptp(file.times)
    return MeasuredCurves(file.times[rows], values, np.array(bands) + margins, count, *span)
