"""What a config says: a class for each section, whose fields are its keys.

Types and `Rule`s are the limits; the texts below the fields are those of docs/config.md; what
fields of a section must be together is in `__post_init__`. A section is a
mapping with these keys and no others."""

from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from deployable.campaign.config.keys import RefusedError, Rule

_STABLE = "(?!.*[ªº²³¹ſﬁﬂ])"  # in expressions these signs are others
Name = Annotated[str, Rule("a name of up to 64 letters, digits and `_` that starts with a letter",
    pattern=rf"{_STABLE}[^\W\d_]\w{{0,63}}")]  # fmt: skip
FreeName = Annotated[str, Rule("a name of up to 64 letters, digits and `_`",
    pattern=rf"{_STABLE}[^\W_]\w{{0,63}}")]  # fmt: skip
CampaignName = Annotated[str, Rule(
    "up to 64 letters, digits, `_` and `-`, starting with a letter or digit, and not the name of "
    "a study",
    pattern=r"(?!(accuracy|benchmark|calibration|extremes|measured|scaling|search|tradeoff|"
    r"verification)$)[^\W_][\w-]{0,63}")]  # fmt: skip
CaseName = Annotated[str, Rule(
    "a name of up to 64 letters, digits, spaces, `_` and `-` that starts with a letter or "
    "digit, and not that of a folder of results, or `all`",
    pattern=r"(?!(all|batches|exports|extremes|figures|logs|motions|responses|rounds|trajectories)"
    r"$)[^\W_][\w -]{0,63}")]  # fmt: skip
Share = Annotated[float, Rule(least=1e-4, most=1, unit="1")]
_ShareOfOne = Annotated[
    float,
    Rule(text="Share of the width of one response or quantity.", least=1e-4, most=1, unit="1"),
]
OrAuto = Literal["auto"]
StructureFile = Annotated[str, Rule("the path of a `.yaml` file", pattern=r"[^\0]*")]
SceneValues = Annotated[
    dict[str, Annotated[Any, Rule("a number", unit="parameter")]],
    Rule("a mapping from the scene's parameter names to values"),
]
Definitions = Rule("a mapping from names (letters, digits, `_`, starting with a letter) to "
                   "definitions")  # fmt: skip
Pair = tuple[float, float]
MOST_INSTANTS = 1_000_000
PAIR = "`[lower, upper]`, two numbers"
"""Type and words of a range."""
ABSENT: Any = None
"""Of a key without a default; a config cannot say it."""


@dataclass(frozen=True)
class Aim:
    """Largest allowed error of the bounds (surrogate, mesh and step together), as a share of the
    width of each response and quantity. The program then chooses mesh, step, runs and model, so
    leave out `design`, `bounds` and `held_out`. It keeps a stated mesh, and a stated step while
    this is stable (docs/choosing-accuracy.md). A number is `tolerance` alone."""

    tolerance: Share = 0.05
    """Share of the width, for all responses and quantities that `tolerance_by_name` does not
    name."""
    tolerance_by_name: Annotated[
        dict[str, _ShareOfOne],
        Rule("a mapping from names of `responses` and `quantities` to numbers from 0.0001 to 1"),
    ] = field(default_factory=dict)
    """Other shares for some responses and quantities, by their names."""
    max_runs: Annotated[int, Rule(least=1, most=4000)] = 1000
    """Most runs, of all meshes, including those of checks, of the ends of quantities and of a
    choice, but not those for measured curves. Each case has as many. It must allow two runs for
    each interval and two more, a check of step and mesh, and the grid of a choice (`check` prints
    this number)."""
    max_core_minutes: Annotated[float, Rule(above=0, unit="min")] = 60.0
    """Most minutes of one core for runs. They are estimated from steps and elements, so that every
    machine makes the same runs."""


@dataclass(frozen=True)
class SceneSection:
    """The simulated structure: a shipped one by its `name`, or that of a `file`."""

    name: Annotated[str, Rule("the name of a structure, e.g. `bennett`")] = ABSENT
    """Name of a structure that is shipped (docs/library)."""
    file: StructureFile = ABSENT
    """A structure's text file (docs/structures.md). Its path starts at the folder of the config."""
    parameters: SceneValues = field(default_factory=dict)
    """Values that replace the scene's defaults, by the names of its parameters, such as
    `elements`."""

    def __post_init__(self):
        if (self.name is None) == (self.file is None):
            raise RefusedError


@dataclass(frozen=True)
class Solver:
    """How each run is integrated and recorded."""

    duration: Annotated[float, Rule(least=1e-9, most=1e6, unit="s")] = 1.0
    """Simulated time."""
    instants: Annotated[int, Rule(least=2, most=MOST_INSTANTS)] = 2001
    """Number of recorded instants, equally spaced, with t = 0 and t = `duration` among them."""
    peak_instants: Annotated[int, Rule(least=2, most=MOST_INSTANTS)] = 5001
    """Quantities of curves, such as peaks and crossings, are also read between recorded instants:
    at every time step, or at an equal share of the steps, if there are more than this.
    Curves of time get more instants if their pulses and kinks need them."""
    step: Annotated[float | OrAuto, Rule("`auto` or a number above 0", unit="s", above=0)] = "auto"
    """Time step. `auto` uses the largest step that is stable over the whole box, times `safety`,
    but at most a quarter of the time in which a curve rises or falls. The step is always shortened
    until the recording interval is a whole number of steps. All runs of a campaign have the same
    step, so that a run does not depend on its neighbours. With `auto` a run whose energy does not
    balance is repeated with half the step, up to three times, or nine if it has few steps."""
    safety: Annotated[float, Rule(above=0, most=1, unit="1")] = 0.9
    """Share of the stable step that `auto` uses."""
    energy_tolerance: Annotated[float, Rule(above=0, unit="1")] = 0.005
    """A run stops as unstable when the error of its energy balance exceeds this share of its energy
    scale."""
    failures: Annotated[float, Rule(least=0, most=1, unit="1")] = 0.1
    """Largest share of runs that may fail. Up to this share, failed runs are left out of the fits
    and count as failing every requirement. If more runs of the design fail, the campaign ends; if
    more do with the further runs, no others are made. The nominal run may not fail."""

    def __post_init__(self):
        if self.step != "auto" and self.step > self.duration:
            text = f"{self.step:.6g} s is longer than the duration; allowed: auto, or at most "
            raise RefusedError("step", f"{text}{self.duration:.6g}")


@dataclass(frozen=True)
class IntervalSpec:
    """One interval: `relative` or `absolute` half width about `nominal`, or `lower` and `upper`."""

    nominal: Annotated[float, Rule("a number inside the interval", unit="parameter")] = ABSENT
    """Value of the nominal run. Default: the scene's value with `relative` and `absolute`, the
    middle with `lower` and `upper`."""
    relative: Annotated[float, Rule(least=0, unit="1")] = ABSENT
    """Half width as a share of the nominal value; 0.01 is ± 1 %."""
    absolute: Annotated[float, Rule(least=0, unit="parameter")] = ABSENT
    """Half width."""
    lower: Annotated[float, Rule("a number, at most `upper`", unit="parameter")] = ABSENT
    """Lower end; needs `upper`."""
    upper: Annotated[float, Rule("a number, at least `lower`", unit="parameter")] = ABSENT
    """Upper end; needs `lower`."""

    def __post_init__(self):
        keys = ("relative", "absolute", "lower", "upper")
        keys = [key for key in keys if getattr(self, key) is not None]
        if keys not in (["relative"], ["absolute"], ["lower", "upper"]):
            text = f"it gives {' and '.join(keys) or 'none of them'}; allowed: relative, absolute, "
            raise RefusedError("", text + "or lower with upper")
        if self.lower is None:
            return
        lower, upper, nominal = self.lower, self.upper, self.nominal
        if lower > upper:
            text = f"{lower:.12g} is above upper {upper:.12g}; allowed: at most upper"
            raise RefusedError("lower", text)
        if nominal is not None and not lower <= nominal <= upper:
            text = f"{nominal:.12g} is outside; allowed: {lower:.12g} to {upper:.12g}"
            raise RefusedError("nominal", text)


OneInterval = Annotated[IntervalSpec, Rule(
    "a mapping such as `{relative: 0.1}`, `{absolute: 2}` or "
    "`{lower: 1, upper: 3}`, and optionally `nominal`")]  # fmt: skip


@dataclass(frozen=True)
class DesignSection:
    """The design: where in the box the runs are, and the order of the fit."""

    method: Literal["tensor_roots", "tensor_lobatto", "smolyak", "sobol", "screening"] = (
        "tensor_roots"
    )
    """Up to 8 intervals: `tensor_roots` has Chebyshev roots, as the paper. `tensor_lobatto` has
    Chebyshev-Lobatto points, nested when the order doubles, with the box's corners. `smolyak` is a
    sparse grid. `sobol` is a scan, a Sobol sequence with the corners and without surrogate; a
    longer one reuses the runs of a shorter one. Up to 60 intervals: `screening` has the centre,
    both ends of each interval alone, and a two-level design with its fold-over, from which further
    runs search for the bounds of quantities (docs/quantities.md)."""
    order: Annotated[int, Rule(least=1, most=64)] = 3
    """Order of the surrogate, in each direction or, for `smolyak`, in total. With a stated order,
    `sobol` gets a surrogate of that total degree, otherwise none. `screening` has no order."""
    samples: Annotated[int, Rule(least=2, most=10_000_000)] = 1024
    """Number of runs of `sobol`, including the corners of the box; or the most runs of `screening`,
    including those at the bounds of quantities. More than 100,000 need enough room on the disk."""
    file: Annotated[str, Rule("the path of a CSV file", pattern=r"[^\0]*")] = ABSENT
    """A CSV file with runs of your own, instead of a method: a row for each run, and a column for
    each parameter that is not at its nominal value, in its unit or a stated one (`k [N mm/rad]`).
    Bounds come from the models that take all runs. The nominal run is added."""
    values: Annotated[tuple[float, ...], Rule("a list of numbers", least=1, unit="parameter")] = (
        ABSENT
    )
    """Runs of your own for a single interval: its values, in its unit or a stated one, instead of a
    file."""


@dataclass(frozen=True)
class BoundsChoice:
    """How bounds are computed from the runs."""

    model: Literal["auto", "polynomial", "spline", "aligned"] = "auto"
    """`auto` chooses, for each response and stretch of time, the following model that predicts
    left-out runs best (docs/intervals.md). `polynomial` has the design's order and is fitted to the
    design's runs, as in the paper; its range is enclosed. `spline` is one cubic spline through all
    runs, including held-out ones and scans; its range is attained, not enclosed. `aligned` maps
    time so that latches, stops and contacts of all runs coincide, and uses splines. `sobol` without
    order has no polynomial: with `auto` and `polynomial` its bounds are its extreme samples.
    Sensitivities and `surrogate.nc` always use the polynomial."""


@dataclass(frozen=True)
class Verify:
    """How the intervals of quantities are verified."""

    max_iterations: Annotated[int, Rule(least=0, most=50)] = 6
    """Most iterations of further runs, eight in each. They are made at the ends of quantities'
    intervals, until the surrogate exceeds the runs by no more than 0.1 % of the width, where
    requirements are decided, and about the border of an event. 0 makes none. With more than eight
    intervals there may be four times as many."""
    discretization: bool = False
    """Whether to estimate the errors of step and mesh too. The runs at the ends of the quantities'
    intervals, and eight at the bounds of the responses, are repeated with half and a quarter of the
    step, and on a mesh half and twice as fine. Each takes up to eight times as long. The
    extrapolated change is added to the surrogate's error."""


@dataclass(frozen=True)
class Limits:
    """Limits of one quantity, at least one. Where the quantity does not happen, `at_least` and
    `at_most` are broken. `happens: false` stands alone."""

    at_least: Annotated[float, Rule(unit="quantity")] = ABSENT
    """Least value."""
    at_most: Annotated[float, Rule(unit="quantity")] = ABSENT
    """Largest value."""
    happens: bool = ABSENT
    """Whether it must happen, or must not."""

    @property
    def by_name(self) -> dict[str, Any]:
        """The limits that are given, by name: at_least, at_most, happens."""
        return {name: limit for name, limit in vars(self).items() if limit is not None}

    def __post_init__(self):
        numbers = [limit for limit in (self.at_least, self.at_most) if limit is not None]
        if not self.by_name:
            raise RefusedError
        if numbers != sorted(numbers):
            text = f"no value is both at least {self.at_least:.12g} and at most {self.at_most:.12g}"
            text += f"; allowed: at most {self.at_most:g}"
            raise RefusedError("at_least", text)
        if numbers and self.happens is False:
            text = "false allows no other limit; allowed: true, or happens alone"
            raise RefusedError("happens", text)


LIMITS = tuple(Limits.__dataclass_fields__)
"""Names of the limits of a quantity."""

_Range = Annotated[Pair, Rule(PAIR, text="Range of the nominal value.", unit="parameter")]
Goals = Annotated[
    str | Annotated[tuple[str, ...], Rule(most=2)],
    Rule("one or two of `upper(q)`, `lower(q)`, `width(q)`"),
]


@dataclass(frozen=True)
class ChooseSection:
    """Search for the nominal values with the best worst case. Surrogates of quantities find the
    choice that meets all requirements in the box about it and has the best goal; its worst case is
    simulated."""

    parameters: Annotated[
        dict[str, _Range], Rule("a mapping of 1 to 3 parameter names to `[lower, upper]`", most=3)
    ] = field(default_factory=dict)
    """Ranges of the nominal values, by the scene's parameter names. An interval that is given as
    `relative` grows with the choice, any other keeps its width; a parameter without an interval is
    chosen exactly."""
    minimise: Goals = ()
    """The goal to minimise: `upper(q)`, `lower(q)` or `width(q)` of the interval of a quantity q.
    With a second goal, the trade-off of the two is drawn; the best choice is that of the first."""
    maximise: Goals = ()
    """The goal to maximise, in the same form."""


@dataclass(frozen=True)
class CaseSolver:
    """Settings of the solver that differ in a case."""

    duration: Annotated[float, Rule(least=1e-9, most=1e6, unit="s")] = ABSENT
    """Simulated time."""


@dataclass(frozen=True)
class CaseSection:
    """One case, by its differences from the campaign; `{}` is the campaign itself."""

    scene: SceneValues = field(default_factory=dict)
    """Values of scene parameters that are not intervals."""
    file: StructureFile = ABSENT
    """File of another structure, instead of the campaign's."""
    solver: CaseSolver = CaseSolver()
    intervals: Annotated[
        dict[str, OneInterval], Rule("a mapping from parameter names to intervals", most=60)
    ] = field(default_factory=dict)
    """Intervals that replace the campaign's for the same parameters or are added to them, in the
    same form."""


@dataclass(frozen=True)
class Display:
    """Units in which summary, page, figures and CSV tables show results, and with them speeds and
    accelerations: `mm/s` beside `mm`. Moments, stiffnesses and areas keep their units, and so do
    netCDF, JSON and the review sheet. By default all are in SI units, parameters in their own."""

    angle: Literal["deg", "mrad", "rad"] = ABSENT
    """Unit of angles."""
    length: Literal["m", "cm", "mm", "um", "km"] = ABSENT
    """Unit of lengths."""
    force: Literal["N", "kN", "MN"] = ABSENT
    """Unit of forces."""
    stress: Literal["Pa", "kPa", "MPa", "GPa"] = ABSENT
    """Unit of stresses and moduli."""


@dataclass(frozen=True)
class Jobs:
    """How the runs are grouped. Only `keep: responses` changes results, to single precision."""

    runs_per_job: Annotated[
        int | OrAuto, Rule("a whole number of at least 1, or `auto`", least=1)
    ] = "auto"
    """Most runs in one job. A job is one process, which starts in about 1 s, the time of some 50
    runs. Few jobs are best, but at least one for each core. `auto` makes eight jobs, or one for
    each core of this machine: fewer if a job had less than 512 runs, up to 64 if it had more than
    4,096. It also gives all cores of this machine as many jobs."""
    group: Annotated[int, Rule(least=1)] = 64
    """Runs that are integrated together. They are written while the next ones are integrated, so
    this limits memory and the loss of a killed job."""
    keep: Literal["trajectories", "responses"] = "trajectories"
    """`trajectories` writes all records of a group of runs into a netCDF file, from which other
    responses can be computed later without new runs. `responses` keeps only the responses, in
    single precision (6e-8 of a value), in far less disk space; another design, group size or
    response needs new runs."""
    minutes: Annotated[float, Rule(least=0, unit="min")] = 0.0
    """Duration of a job on its `processes`, instead of `runs_per_job`; clusters want jobs of 15
    minutes or more. The number of runs follows from an estimate that is accurate to a factor of
    about two. 0: use `runs_per_job`."""
    processes: Annotated[int, Rule(least=1, most=1024)] = 1
    """Processes of a job, one for each of its cores; they share one compiled time loop. On a
    cluster use as many as a node has cores, so that a job fills it."""


Times = Annotated[Pair, Rule(PAIR, unit="s")]
_ByResponse = Rule("a mapping from names of responses in `columns` to numbers above 0")
_Size = Annotated[float, Rule(above=0, unit="response")]


@dataclass(frozen=True)
class UnknownSensor:
    """Unknown properties of the sensor, which are eliminated within this test."""

    delay: Times = (0.0, 0.0)
    """Least and largest delay of the file's times after the structure's."""
    offset: Annotated[dict[FreeName, _Size], _ByResponse] = field(default_factory=dict)
    """Half width about 0 of the sensor's offset, in the response's unit, by response."""
    gain: Annotated[dict[FreeName, Annotated[float, Rule(above=0, unit="1")]], _ByResponse] = field(
        default_factory=dict
    )
    """Half width about 1 of the factor on the response, by response."""

    def __post_init__(self):
        if self.delay[0] > self.delay[1]:
            text = f"{list(self.delay)} is not allowed; allowed: a lower and an upper delay"
            raise RefusedError("delay", text)


@dataclass(frozen=True)
class MeasuredTest:
    """Measured curves of one test, and its conditions (docs/measured.md)."""

    file: Annotated[str, Rule("the path of a CSV file", pattern=r"[^\0]*")]
    """A CSV file, with its path from the folder of the config. Names with units, such as `t
    [s],angle [rad]`, stand above rows of numbers; one column is the time."""
    columns: Annotated[
        dict[str, FreeName], Rule("a mapping from names of columns to names of responses", least=1)
    ]
    """The response that each column measures. A column may have any unit that fits."""
    band: Annotated[dict[FreeName, _Size], _ByResponse] = field(default_factory=dict)
    """Largest error of the sensor besides `unknown`, in the response's unit, by response. Instead,
    the file may have a column `<column>_band`."""
    model: Annotated[dict[FreeName, _Size], _ByResponse] = field(default_factory=dict)
    """Largest error of the model, which is added to the band."""
    unknown: UnknownSensor = UnknownSensor()
    start: Annotated[
        dict[str, Annotated[Pair, Rule(PAIR, text="Interval in this test.", unit="parameter")]],
        Rule("a mapping from the scene's parameter names to `[lower, upper]`"),
    ] = field(default_factory=dict)
    """Parameters of the scene that are unknown in this test alone, such as the angle and the rate
    at its start. They are eliminated within it."""
    window: Times = ABSENT
    """First and last time of the file to use. Default: all after the longest delay."""
    scene: SceneValues = field(default_factory=dict)
    """Values of the scene's parameters in this test, by name. The test does not narrow an interval
    parameter among them."""
    use: Literal["calibrate", "check"] = "calibrate"
    """A `check` can refute what the other tests leave, but narrows nothing."""


def _definition(noun: str, example: str, **units: str) -> Rule:
    """Return the rule of a response's or quantity's definition, which the mechanics read. units:
    units of its numbers, by key."""
    text, pairs = f"Definition of one {noun}.", tuple(units.items())
    return Rule(f"a mapping such as {example}", text=text, units=pairs, least=1)


_OF_MARGINS = {"specified_acceleration": "rad/s2", "output_torque": "N m"}
_RESPONSE = "`{distance: [B, D]}` or `{velocity: B, component: z}`"
OneResponse = Annotated[dict[str, Any], _definition("response", _RESPONSE, at="1", **_OF_MARGINS)]
_QUANTITY = (
    "`{largest: vB}` or `{event: closes, number: 1}`, or an expression of others such as `t1 - t2`"
)
OneQuantity = Annotated[
    dict[str, Any] | str,
    _definition(
        "quantity", _QUANTITY, at="s", **dict.fromkeys(("level", "about", "within"), "response")
    ),
]
_MARGIN = "`{along: root, to: 90 deg, standard: ecss-e-st-33-01c}`"
OneMargin = Annotated[dict[str, Any], _definition("margin", _MARGIN, **_OF_MARGINS)]
OneTest = Annotated[MeasuredTest, Rule("a mapping with `file`, `columns` and `band`")]
OneCase = Annotated[CaseSection, Rule("a mapping with `scene`, `file`, `solver` and `intervals`")]


@dataclass(frozen=True, kw_only=True)
class Config:
    """A campaign's config as a user gives it in YAML, a field for each key (see docs/config.md)."""

    campaign: CampaignName
    """Name of the campaign; its results go to `results/<campaign>/`."""
    accuracy: Annotated[Share | Aim, Rule("a number from 0.0001 to 1, or a mapping", unit="1")] = (
        ABSENT
    )
    scene: Annotated[
        SceneSection,
        Rule("a mapping with the key `name` or the key `file`, not both, and `parameters`"),
    ]
    solver: Solver = Solver()
    intervals: Annotated[
        dict[str, OneInterval],
        Rule("a mapping of 1 to 60 parameter names to intervals", least=1, most=60),
    ]
    """The uncertain parameters, by the scene's parameter names."""
    design: DesignSection = DesignSection()
    bounds: BoundsChoice = BoundsChoice()
    held_out: Annotated[int, Rule(least=0, most=10_000)] = 4
    """Extra runs that are kept out of the fit, to estimate its error. `sobol` does not use them."""
    responses: Annotated[
        dict[FreeName, OneResponse],
        Rule("a mapping from at least one name (letters, digits, `_`) to definitions"),
    ]
    """The curves to bound, by names of your own: distances, positions, velocities, openings,
    tensions, energies, forces, stresses and others (docs/responses.md). At least one is needed,
    unless there are `margins`."""
    quantities: Annotated[dict[Name, OneQuantity], Definitions] = field(default_factory=dict)
    """Numbers of a run to bound, by names of your own: peaks, final and mean values, values at a
    time, times of crossings and events, and arithmetic of these (docs/quantities.md). A run in
    which an event does not happen has no such number."""
    margins: Annotated[dict[Name, OneMargin], Definitions] = field(default_factory=dict)
    """Torque or force margins over the travel of an opening moved quasi-statically, by names of
    your own (docs/review-sheet.md). Each adds a response over the opening, the quantity
    `<name>_least`, and, unless `requirements` name it, the requirement that this is at least 0.
    If a campaign has only margins, the default `duration` is 1 ms, since margins do not depend on
    it."""
    published: Annotated[
        dict[str, Annotated[float, Rule(text="Published largest difference.", unit="response")]],
        Rule("a mapping from names of `responses` to numbers"),
    ] = field(default_factory=dict)
    """Published largest differences of the bounds, by response; the summary compares ours with
    them. If a later file or `--config` changes `scene` or `intervals`, they are left out, because
    the box is another."""
    review: Literal["ecss-e-st-33-01c"] = ABSENT
    """Standard of the review sheet in summary, page, `review.csv` and `review.md`, which has the
    verdict on each clause (docs/review-sheet.md)."""
    verify: Verify = Verify()
    requirements: Annotated[
        dict[FreeName, Annotated[
            dict[str, Annotated[Limits, Rule("a mapping from quantities to `at_least`, "
                "`at_most` or `happens`, such as `{t_shut: {at_most: 0.32}}`")]],
            Rule("a mapping such as `{t_shut: {at_least: 0.3, at_most: 0.32}}`", least=1,
                text="The limits of one requirement, by quantity; all of them must hold. A list "
                "`cases: [on ground]` beside them restricts it to these cases."),
        ]],
        Rule("a mapping from names to limits of quantities, such as `{in_time: {t_shut: {at_most: "
            "0.32}}}`"),
    ] = field(default_factory=dict)  # fmt: skip
    """Limits of quantities that must hold in the whole box, by names of your own. The campaign
    reports whether all, some or none of the box meets each and all together, with which margin, and
    where it fails (docs/quantities.md)."""
    choose: Annotated[
        ChooseSection, Rule("a mapping with `parameters`, and `minimise` or `maximise`")
    ] = ChooseSection()
    measured: Annotated[
        dict[FreeName, OneTest], Rule("a mapping from names of tests to mappings")
    ] = field(default_factory=dict)
    """Tests with measured curves, by names of your own. They narrow the box, or refute the
    model."""
    display: Display = Display()
    jobs: Jobs = Jobs()
    cases: Annotated[
        dict[CaseName, OneCase],
        Rule("a mapping from names to what differs, such as `{on ground: {scene: {g: 9.81}}}`"),
    ] = field(default_factory=dict)
    """Variants of the campaign, by names of your own, such as `on ground` or `one spring out`. Each
    is run over the whole box, with results in `results/<campaign>/<name>/`. A page shows which
    requirement is met in all cases, and which case decides (docs/cases.md)."""
