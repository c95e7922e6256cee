"""A campaign as the program knows it: its config, checked and resolved, as frozen dataclasses.

What a config leaves open (an accuracy, an interval in per cent) is a number here; the other
sections are those of `models`. They become JSON by `as_json`, and come back by `from_data`."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, is_dataclass, replace
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

import fpm
from deployable import intervals
from deployable.campaign import program_data
from deployable.campaign.config.models import (
    BoundsChoice,
    CampaignName,
    ChooseSection,
    DesignSection,
    Display,
    FreeName,
    Jobs,
    MeasuredTest,
    Name,
    Solver,
    Verify,
)
from deployable.campaign.config.own_runs import own_points
from deployable.campaign.config.plausible import experiment_warnings
from deployable.campaign.provenance import program_digest
from fpm import SceneError, structures
from fpm.errors import did_you_mean
from fpm.files.outcome import eventful
from fpm.files.trajectory import POSITION
from fpm.reading.constraint_forces import undetermined_forces
from fpm.reading.quantity_definitions import parse
from fpm.reading.shocks import warn
from fpm.reading.variables import count_values
from fpm.scenes.timestep import find_curve_step
from fpm.structures.plausible import warnings
from fpm.structures.reading import read_text

ADAPTIVE, OWN_RUNS = "adaptive", "own"
"""Methods of designs that no config names: of the rounds of an `accuracy`, and of own runs."""

NAME, FREE_NAME, CAMPAIGN_NAME = (
    re.compile(get_args(kind)[1].pattern) for kind in (Name, FreeName, CampaignName)
)
"""Patterns of the names of quantities, of responses and requirements, and of campaigns."""

_GOAL = re.compile(r"(\w+)\((\w+)\)")


def scene_type(name: str, file: str = "") -> Any:
    """Load the `fpm` structure (`SceneType`) in the text file `file`, or without one the shipped
    structure called `name`. Raises `fpm.SceneError`."""
    if not file:
        if name not in (files := program_data.list_structures()):
            hint = f", or {name}.yaml as a file" if Path(f"{name}.yaml").is_file() else ""
            hint = hint or did_you_mean(name, files)
            raise SceneError("scene.name", name, f"one of {', '.join(files)}{hint}")
        file = str(files[name])
    structure = _structure_of(read_text(file), file)
    return structures.load(file) if structure.files else structure  # the text has not all of it


_structure_of = lru_cache(maxsize=8)(structures.loads)  # once for all stages and rounds

BY_STANDARD = "_by_standard"
"""What ends the name of a margin by its standard's factors, which stands beside one by others."""


@dataclass(frozen=True)
class Interval:
    """Range of an uncertain parameter: `lower` <= `nominal` <= `upper`, in the parameter's unit."""

    lower: float
    nominal: float
    upper: float


def corners(intervals: Mapping[str, Interval]) -> Iterator[dict[str, float]]:
    """Yield parameter values at which to check the structure: the nominal point, then all corners
    of up to four `intervals`, or both ends of each if there are more."""
    nominal = {name: interval.nominal for name, interval in intervals.items()}
    yield nominal
    if len(intervals) <= 4:
        ends = [dict.fromkeys((i.lower, i.upper)) for i in intervals.values()]
        for values in itertools.product(*ends):
            yield dict(zip(intervals, values, strict=True))
    else:
        for name, interval in intervals.items():
            yield {**nominal, name: interval.lower}
            yield {**nominal, name: interval.upper}


@dataclass(frozen=True)
class SceneChoice:
    """Structure of a campaign by name, with the parameter values that differ from its defaults.
    file: path of its text file, "" for one that is shipped."""

    name: str
    parameters: dict[str, Any]
    file: str = ""


@dataclass(frozen=True)
class DesignChoice(DesignSection):
    """Section `design` of the config, and what an `accuracy` adds: polynomial `order`, None for
    none; points: normalized (n, k), of an adaptive design's runs; digest: of the `file`."""

    order: Any = 3
    points: tuple = ()
    digest: str = ""


@dataclass(frozen=True)
class Accuracy:
    """Target and budget of runs that are added until errors are small; without tolerances none are.
    tolerances: of the errors of responses and quantities by name, as fractions of widths; max_runs:
    of all rounds, meshes, checks, further ones and a choice; max_core_minutes: as estimated; mesh:
    name of the parameter that sets the mesh, "" for none; reserve: runs kept for a choice."""

    tolerances: dict[str, float] = field(default_factory=dict)
    max_runs: int = 0
    max_core_minutes: float = 0.0
    mesh: str = ""
    reserve: int = 0


@dataclass(frozen=True)
class Experiment:
    """All settings that determine the runs of a campaign, and what is evaluated of each. held_out:
    number of validation runs; responses, quantities: definitions by name, as in the config;
    display: units in which people see results, which changes no run."""

    name: str
    scene: SceneChoice
    solver: Solver
    intervals: dict[str, Interval]
    design: DesignChoice
    held_out: int
    responses: dict[str, dict]
    quantities: dict[str, dict | str] = field(default_factory=dict)
    accuracy: Accuracy = Accuracy()
    display: Display = field(default_factory=Display)

    @classmethod
    def read(cls, config: str | Mapping) -> Experiment:
        """Make the experiment from its nested dicts, or their JSON, in a result file. Raises
        ValueError for a name after which no file may be called."""
        experiment = from_data(cls, json.loads(config) if isinstance(config, str) else config)
        is_named = all(map(FREE_NAME.fullmatch, experiment.responses))
        is_named = is_named and all(map(NAME.fullmatch, experiment.quantities))
        if not (is_named and CAMPAIGN_NAME.fullmatch(experiment.name)):
            raise ValueError("a name in its config is none of a campaign, response or quantity")
        return experiment

    @property
    def is_adaptive(self) -> bool:
        """Whether the config has an `accuracy`: rounds choose runs, mesh and step."""
        return bool(self.accuracy.tolerances)

    @cached_property
    def scene_type(self) -> Any:
        """The `fpm` structure (`SceneType`), which builds scenes. Raises `fpm.SceneError`."""
        return scene_type(self.scene.name, self.scene.file)

    @property
    def mechanics(self) -> str:
        """Digest of the structure and of the program, part of each run's id."""
        return digest([program_digest(), self.scene_type.digest])

    @cached_property
    def response_list(self) -> list[Any]:
        """Responses (curves over time) as `fpm.responses.Response`; raises `fpm.SceneError`."""
        return [fpm.responses.parse(n, d, self.nominal_scene) for n, d in self.responses.items()]

    @cached_property
    def record(self) -> tuple[tuple[str, str], ...]:
        """Columns that responses need, sorted: pairs of variable and label (element, component)."""
        return tuple(sorted({need for curve in self.response_list for need in curve.needs}))

    @cached_property
    def quantity_list(self) -> list[Any]:
        """Quantities (of a run) as `fpm.reading.quantities.Quantity`; raises `fpm.SceneError`."""
        if not self.quantities:
            return []
        elements = eventful(self.nominal_scene)
        quantities, problems = parse(self.quantities, self.response_list, elements)
        for problem in problems:
            raise problem
        return quantities

    @cached_property
    def peaks(self) -> list[Any]:
        """Quantities that are also read between recorded instants, so no value at one of these."""
        parts = (self.solver.instants - 1) / self.solver.duration
        peaks = [quantity for quantity in self.quantity_list if quantity.peak_column]
        return [
            q for q in peaks if q.kind != "value" or abs(q.instant * parts % 1 - 0.5) < 0.499999
        ]

    def readings(self, step: float) -> int:
        """Return into how many parts the time between two instants is divided to read `peaks` of
        runs with a time step (s); 0: they follow from the instants alone."""
        if not self.peaks:
            return 0
        intervals, duration = self.solver.instants - 1, self.solver.duration
        feature = find_curve_step(self.nominal_scene, duration)
        most = max(self.solver.peak_instants, math.ceil(duration / feature * (1 - 1e-9)))
        most = min(most, most_instants(self)) // intervals
        count = _divide(round(duration / intervals / step), most)
        return count if count > 1 or self.nominal_scene.curves else 0

    @cached_property
    def doubts(self) -> dict[str, str]:
        """Why the model does not determine the value of a response or quantity, and advice, in
        words, by name; without those that it determines. Peaks of shocks depend on mesh and step;
        forces of joints that others make redundant are arbitrary."""
        curves = [(curve.name, curve, True) for curve in self.response_list]
        leaves = [(q.name, leaf) for q in self.quantity_list for leaf in q.leaves if leaf.response]
        quantities = [(name, leaf.response, leaf.is_instantaneous) for name, leaf in leaves]
        redundancies = undetermined_forces(self.nominal_scene, self.response_list)
        reasons = [
            (name, (warn(self.nominal_scene, response) if peak else "")
             or redundancies.get(response.name, ""))
            for name, response, peak in curves + quantities
        ]  # fmt: skip
        return {name: reason for name, reason in reasons if reason}

    @property
    def warnings(self) -> list[str]:
        """Likely mistakes in structure, intervals, instants, levels; raises `fpm.SceneError`."""
        return [*warnings(self.nominal_scene, self.solver.duration), *experiment_warnings(self)]

    @cached_property
    def box(self) -> Any:
        """The `intervals.Box` of the uncertain parameters, in their order."""
        rows = self.intervals.values()
        return intervals.Box(list(self.intervals), [i.lower for i in rows], [i.upper for i in rows])

    @cached_property
    def nominal(self) -> list[float]:
        """Nominal values (k) of the interval parameters, in their order and units."""
        return [interval.nominal for interval in self.intervals.values()]

    @cached_property
    def nominal_scene(self) -> Any:
        """The nominal `fpm.Scene`, shared: do not change it; raises `fpm.SceneError`."""
        return self.build(dict(zip(self.intervals, self.nominal, strict=True)))

    def parameters(self, values: Mapping[str, float]) -> dict[str, Any]:
        """Return the values of all structure parameters by name for one run, each in its unit:
        defaults, replaced by those of the config, then by `values` of the interval parameters."""
        defaults = {name: p.default for name, p in self.scene_type.parameters.items()}
        return {**defaults, **self.scene.parameters, **values}

    def build(self, values: Mapping[str, float]) -> Any:
        """Build the `fpm.Scene` of a run; raises `fpm.SceneError`. values: by name, in its unit."""
        return self.scene_type.build(**self.parameters(values))


@dataclass(frozen=True)
class Choose(ChooseSection):
    """Parameters whose nominal values are to be chosen by the worst case. minimise, maximise:
    goals, texts such as `upper(t)`; relative: parameters whose intervals scale with the nominal
    value; others keep their width; order: of the grid of runs along them."""

    minimise: tuple[str, ...] = ()
    maximise: tuple[str, ...] = ()
    relative: tuple[str, ...] = ()
    order: int = 8

    @property
    def goals(self) -> list[tuple[float, str, str]]:
        """Goals as tuples: 1.0 to minimise or -1.0 to maximise, `upper`, `lower` or `width`, and
        name of the quantity; for a malformed text, that text and "" in place of the last two."""
        goals = []
        for sign, texts in ((1.0, self.minimise), (-1.0, self.maximise)):
            for text in texts:
                match = _GOAL.fullmatch(text.replace(" ", ""))
                goals.append((sign, match[1], match[2]) if match else (sign, text, ""))
        return goals

    def interval(self, name: str, value: float, experiment: Experiment) -> tuple[float, float]:
        """Return the lower and upper end of the interval of parameter `name`, in its unit, if its
        nominal value is `value`; both are `value` if `experiment` gives it no interval."""
        interval = experiment.intervals.get(name)
        if interval is None:
            return value, value
        lower, nominal, upper = interval.lower, interval.nominal, interval.upper
        if name in self.relative:
            return value * lower / nominal, value * upper / nominal
        return value + lower - nominal, value + upper - nominal

    def ends(self, name: str, experiment: Experiment) -> tuple[float, float]:
        """Return the least and largest value of parameter `name` over all nominal values that may
        be chosen, with its uncertainty about each; experiment: has the config's interval."""
        values = [end for v in self.parameters[name] for end in self.interval(name, v, experiment)]
        return min(values), max(values)


@dataclass(frozen=True)
class ResolvedTest(MeasuredTest):
    """A test with measured curves; digest: of the content of its `file` when that was checked."""

    digest: str = ""


@dataclass(frozen=True)
class Campaign:
    """A whole config, checked and resolved. published: largest width in the literature, by
    response; review: name of the standard of the review sheet; requirements: limits by requirement,
    quantity and kind; cases: what each case changes; case_campaigns: run in the place of this one;
    sources: files it was read from; lines: where its keys stand in them, as `line 3: `."""

    experiment: Experiment
    bounds: BoundsChoice
    published: dict[str, float]
    review: str | None
    verify: Verify
    requirements: dict[str, dict]
    choose: Choose
    jobs: Jobs
    cases: dict[str, dict] = field(default_factory=dict)
    case_campaigns: dict[str, Campaign] = field(default_factory=dict)
    measured: dict[str, ResolvedTest] = field(default_factory=dict)
    sources: tuple[str, ...] = ()
    lines: dict[str, str] = field(default_factory=dict, compare=False)

    @property
    def name(self) -> str:
        """Name of the campaign, also of its folder in the folder of results."""
        return self.experiment.name


# -- designs ---------------------------------------------------------------------------------------


def make_design(experiment: Experiment, choice: DesignChoice | None = None) -> Any:
    """Make the `intervals.Design` (points of the runs) that the section `design` of a config asks
    for (another one: `choice`). Raises `intervals.IntervalError`, or `OwnRunsError`."""
    choice, box = choice or experiment.design, experiment.box
    if choice.method in (ADAPTIVE, OWN_RUNS):
        points = np.array(choice.points, dtype=float).reshape(-1, box.dimension)
        points = own_points(experiment) if choice.method == OWN_RUNS else points
        terms = np.zeros((0, box.dimension), dtype=int)
        return intervals.Design(points, terms, choice.method, (0,) * box.dimension)
    has_samples = "samples" in intervals.METHODS[choice.method].options
    options = {"samples": choice.samples} if has_samples else {}
    most = choice.samples if choice.method == "sobol" else intervals.designs.MAX_RUNS
    return intervals.make_design(choice.method, box, choice.order, max_runs=most, **options)


_HELD_OUT = 4  # runs of a choice that test its surrogates


def widen_intervals(experiment: Experiment, choose: Choose) -> Experiment:
    """Return a copy of an experiment in which the interval of each parameter to be chosen spans all
    nominal values that `choose` (section of the config) allows, with the uncertainty about each."""
    intervals = dict(experiment.intervals)
    for name in choose.parameters:
        lower, upper = choose.ends(name, experiment)
        intervals[name] = Interval(lower, (lower + upper) / 2, upper)
    return replace(experiment, intervals=intervals)


def design_points(experiment: Experiment, choose: Choose) -> np.ndarray:
    """Make the points (N, k) of the runs that surrogates over all choices are fitted to: a sparse
    grid and four validation runs. The grid has the `order` of `choose` along chosen parameters, and
    along others that of the experiment's design, at least 2."""
    order, box = experiment.design.order, experiment.box
    if isinstance(order, tuple):
        order = max(order)
    usual = max(order, 2) if isinstance(order, int) else 2
    orders = [choose.order if name in choose.parameters else usual for name in box.names]
    orders = [order if free else 0 for order, free in zip(orders, box.free, strict=True)]
    nodes = intervals.make_design("smolyak", box, orders).points
    return np.concatenate([nodes, intervals.held_out_points(box.free, _HELD_OUT, nodes)])


MOST_STEPS = 10**9  # steps of a run: of the smallest scene, a day


def steps_problems(solver: Solver, step: float) -> Iterator[str]:
    """Check that a run with the time step `step` (s) has at most `MOST_STEPS` steps."""
    if solver.duration / step > MOST_STEPS:
        yield (
            f"solver.{'duration' if solver.step == 'auto' else 'step'}: "
            f"{solver.duration / step:.3g} steps of {step:.3g} s; allowed: at most "
            f"{MOST_STEPS:.0e} steps, a duration of {MOST_STEPS * step:.3g} s"
        )


def count_runs(experiment: Experiment) -> int:
    """Return the largest possible number of runs of a campaign (`experiment`), without further ones
    at bounds and limit-state surfaces; the nominal run counts even if it is one of the design."""
    design = experiment.design
    if experiment.is_adaptive:
        return experiment.accuracy.max_runs
    if design.method == "sobol":  # its points take a while to make, and their number is known
        return design.samples + 1
    return make_design(experiment).run_count + 1 + experiment.held_out


CHECK_POINTS = 8
"""Places at which a check repeats runs for the responses: eight side by side cost what three do."""

_FIRST_RUNS = 8  # of each interval


def count_check_runs(experiment: Experiment) -> int:
    """Return how many runs a check of an `accuracy` repeats with a finer step, or mesh: for the
    responses, and of each quantity those at both ends; one of each again, which tell the order."""
    return CHECK_POINTS + 1 + 3 * len(experiment.quantities)


def count_first_runs(experiment: Experiment) -> int:
    """Return the number of runs of the first round of an `accuracy`: eight for each interval that
    has a width, fewer where `max_runs` would leave none for a check of step and mesh."""
    count = _FIRST_RUNS * max(1, int(experiment.box.free.sum()))
    accuracy = experiment.accuracy
    return min(count, accuracy.max_runs - accuracy.reserve - 2 * count_check_runs(experiment))


# -- sections as files and commands have them ------------------------------------------------------


def as_json(**sections: Any) -> str:
    """Write sections of the config, given by name, as one line of JSON, in the order given."""
    return json.dumps(sections, default=asdict, separators=(",", ":"), allow_nan=False)


def from_data(kind: Any, data: Any) -> Any:
    """Rebuild a section of type `kind` (a dataclass) from nested dicts and lists (made tuples), as
    `dataclasses.asdict` returns them, without checks."""
    if is_dataclass(kind):
        make: Any = kind
        hints = _hints(make)
        return make(**{name: from_data(hints[name], value) for name, value in data.items()})
    if get_origin(kind) is dict:
        return {key: from_data(get_args(kind)[1], value) for key, value in data.items()}
    if isinstance(data, list):
        return tuple(from_data(next(iter(get_args(kind)), None), value) for value in data)
    return data


_hints = cache(get_type_hints)


@cache
def _divide(steps: int, most: int) -> int:
    """Return the largest number, at most `most`, of equal parts of some steps between instants."""
    for count in range(min(steps, most), 1, -1):
        rest = steps // count
        if steps % count == 0 and fpm.divide_time(rest, 2, 1).output_steps == rest:
            return count
    return 1


def digest(data: Any) -> str:
    """Return 16 hex digits (of the SHA-256) that identify data, of sections, say, by its JSON."""
    form: Any = {"sort_keys": True, "separators": (",", ":"), "allow_nan": False}
    text = json.dumps(data, default=asdict, **form)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


# -- what the runs take on disk --------------------------------------------------------------------

LARGE = 100_000  # runs up to which nobody asks whether the disk has room for them

_TRAJECTORY_CURVES = 10  # of a trajectory, beside those of responses and hinges: time, energies


def bytes_of_run(campaign: Campaign) -> float:
    """Estimate the bytes on disk of one run: in the store (by `jobs.keep`) and `samples.nc`."""
    experiment = campaign.experiment
    curves = 0 if campaign.jobs.keep == "responses" else count_curves(experiment)
    return 8.0 * experiment.solver.instants * (curves + len(experiment.responses))


MOST_NUMBERS = 2**27  # numbers recorded of the runs that are integrated side by side: 1 GiB


def most_instants(experiment: Experiment) -> int:
    """Return how many instants of the runs that are integrated side by side memory should hold."""
    scene = experiment.nominal_scene
    count = count_values(scene, experiment.record) if experiment.record else 0
    return MOST_NUMBERS // (8 * (6 * len(scene.points) + len(scene.hinges) + 10 + count))


def count_curves(experiment: Experiment) -> int:
    """Return how many arrays over time the trajectory file of a run has, besides responses."""
    columns = {column for response in experiment.response_list for column in response.reads}
    count = sum(6 if variable == POSITION else 1 for variable, _ in columns)
    return count + len(experiment.nominal_scene.hinges) + _TRAJECTORY_CURVES
