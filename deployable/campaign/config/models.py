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
OrAuto = Literal["auto"]
StructureFile = Annotated[str, Rule("the path of a `.yaml` file", pattern=r"[^\0]*")]
SceneValues = Annotated[
    dict[str, Annotated[Any, Rule("a number", unit="parameter")]],
    Rule("a mapping from the scene's parameter names to values"),
]
Definitions = Rule("a mapping from names (letters, digits, `_`, starting with a letter) to "
                   "definitions")  # fmt: skip
Pair = tuple[float, float]
PAIR = "`[lower, upper]`, two numbers"
"""Type and words of a range."""
ABSENT: Any = None
"""Of a key without a default; a config cannot say it."""


@dataclass(frozen=True)
class Aim:
    """How wrong the bounds may be, as a share of the width of each response and quantity: the
    estimated error of surrogate, mesh and step together. It chooses mesh, step, runs and model, so
    leave out `design`, `bounds` and `held_out`; a mesh that the config gives is kept, and a step
    while it is stable (docs/choosing-accuracy.md). A number is `tolerance` alone."""

    tolerance: Share = 0.05
    """Share of the width, for all responses and quantities that `tolerance_by_name` does not
    name."""
    tolerance_by_name: Annotated[
        dict[str, Annotated[float, Rule(text="Share of the width of one response or quantity.",
                                       least=1e-4, most=1, unit="1")]],
        Rule("a mapping from names of `responses` and `quantities` to numbers from 0.0001 to 1"),
    ] = field(default_factory=dict)  # fmt: skip
    """Other shares for some responses and quantities, by their names."""
    max_runs: Annotated[int, Rule(least=1, most=4000)] = 1000
    """Most runs that may be spent, of all meshes, with those of checks, of the ends of quantities
    and of a choice, but not those for measured curves; in each case as many. It must allow two
    runs for each interval and two more, a check of step and mesh, and the grid of a choice (`check`
    says how many that is)."""
    max_core_minutes: Annotated[float, Rule(above=0, unit="min")] = 60.0
    """Most minutes of one core that may be spent on runs, as estimated from steps and elements, so
    that every machine decides alike."""


@dataclass(frozen=True)
class SceneSection:
    """What is simulated: a structure that is shipped, by its `name`, or that of a `file`."""

    name: Annotated[str, Rule("the name of a structure, e.g. `bennett`")] = ABSENT
    """Name of a structure that is shipped (docs/library)."""
    file: StructureFile = ABSENT
    """A structure's text file (docs/structures.md), sought from the folder of the config."""
    parameters: SceneValues = field(default_factory=dict)
    """Values that differ from the scene's defaults, by the scene's own parameter names; numbers and
    options such as `elements`."""

    def __post_init__(self):
        if (self.name is None) == (self.file is None):
            raise RefusedError


@dataclass(frozen=True)
class Solver:
    """How each run is integrated and recorded."""

    duration: Annotated[float, Rule(least=1e-9, most=1e6, unit="s")] = 1.0
    """Simulated time."""
    instants: Annotated[int, Rule(least=2, most=1_000_000)] = 2001
    """Number of recorded instants, equally spaced, with t = 0 and t = `duration` among them."""
    step: Annotated[float | OrAuto, Rule("`auto` or a number above 0", unit="s", above=0)] = "auto"
    """Time step. `auto` takes the largest that is stable over the whole box, times `safety`, but no
    longer one than the time in which a curve of time rises or falls; either way it is shortened
    until the recording interval is a whole number of steps. One step serves all runs of a campaign,
    so that a run does not depend on its neighbours; with `auto` one whose energy does not balance
    is repeated with half of it, up to three times."""
    safety: Annotated[float, Rule(above=0, most=1, unit="1")] = 0.9
    """Share of the stable step that `auto` uses."""
    energy_tolerance: Annotated[float, Rule(above=0, unit="1")] = 0.005
    """A run stops as unstable when the error of its energy balance exceeds this share of its energy
    scale."""
    failures: Annotated[float, Rule(least=0, most=1, unit="1")] = 0.1
    """Share of the runs that may fail. Up to it failed runs are left out of the fits, and count as
    failing every requirement; beyond it the campaign ends. The nominal run may not fail."""

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
    "`{lower: 1, upper: 3}`, perhaps with `nominal`")]  # fmt: skip


@dataclass(frozen=True)
class DesignSection:
    """Where in the box the runs are, and what is fitted to them."""

    method: Literal["tensor_roots", "tensor_lobatto", "smolyak", "sobol", "screening"] = (
        "tensor_roots"
    )
    """`tensor_roots`: Chebyshev roots, the paper's. `tensor_lobatto`: Chebyshev-Lobatto points,
    nested when the order doubles, with the box's corners. `smolyak`: sparse grid. `sobol`: a
    scan, that is a Sobol sequence with the corners and no surrogate; a longer one reuses the runs
    of a shorter one. All of them for up to 8 intervals. `screening`, for up to 60: the centre, both
    ends of each interval alone, and a two-level design with its fold-over; for quantities a search
    by further runs goes on from there (docs/quantities.md)."""
    order: Annotated[int, Rule(least=1, most=64)] = 3
    """Order of the surrogate, in each direction or, for `smolyak`, in total. `sobol` has none
    unless it is given; then a surrogate of that total degree is fitted to its samples.
    `screening` has none."""
    samples: Annotated[int, Rule(least=2, most=10_000_000)] = 1024
    """Number of runs of `sobol`, corners of the box included; of `screening` the most in all, with
    further ones at the bounds of quantities. Beyond 100,000 they are allowed with
    `jobs.keep: extremes`; otherwise as many as the disk has room for."""
    seed: Annotated[int, Rule(least=0, most=2**32 - 1)] = 0
    """Seed of the Sobol sequence of `sobol`."""
    file: Annotated[str, Rule("the path of a CSV file", pattern=r"[^\0]*")] = ABSENT
    """A CSV file with runs of your own instead: a row for each, a column for each parameter that is
    not at its nominal value, in its unit or one stated (`k [N mm/rad]`). Bounds are by the models
    that take all runs. The nominal run is added."""
    values: Annotated[tuple[float, ...], Rule("a list of numbers", least=1)] = ABSENT
    """The values of the only interval in runs of your own, in its unit, instead of a file."""


@dataclass(frozen=True)
class BoundsChoice:
    """How bounds are taken from the runs."""

    model: Literal["auto", "polynomial", "spline", "aligned"] = "auto"
    """`auto`: for each response and stretch of time the one of the following that predicts left-out
    runs best (docs/intervals.md). `polynomial`: of the design's order through the design's runs,
    the paper's way; its range is enclosed. `spline`: one cubic spline through all runs, held-out
    ones and those of a scan included; its range is attained, not enclosed. `aligned`: splines over
    time that is mapped so that latches, stops and contacts of all runs coincide. `sobol` without
    order has no polynomial: with `auto` and `polynomial` its bounds are its extreme samples.
    Sensitivities and `surrogate.nc` are of the polynomial in any case."""


@dataclass(frozen=True)
class ErrorDisplay:
    """How the error of the bounds is shown."""

    shade_above: Annotated[float, Rule(above=0, unit="1")] = 0.1
    """Figures shade the instants at which the error estimate exceeds this share of the largest
    width of the bounds."""


@dataclass(frozen=True)
class Verify:
    """How the intervals of quantities are verified."""

    max_iterations: Annotated[int, Rule(least=0, most=50)] = 6
    """Most iterations of further runs: where the surrogate of a quantity has the ends of its
    interval, until it exceeds the runs by no more than 0.1 % of the width, where
    requirements are decided, and about where something ceases to happen, eight in each. 0 makes
    none; a quantity takes one or two runs in most campaigns. Of more than eight intervals four
    times as many."""
    discretization: bool = False
    """Tell the whole error, of surrogate, step and mesh: repeat the runs at the ends of the
    quantities' intervals, and eight at which bounds of the responses are attained, with half and a
    quarter of the step and on a mesh half and twice as fine, which takes up to eight times as long
    for each. What all further halvings would change is added to the surrogate's error."""


@dataclass(frozen=True)
class Limits:
    """Limits of one quantity, at least one. `at_least` and `at_most` are broken where it has no
    value, as its event does not happen; `happens: false` stands alone."""

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

Goals = Annotated[
    str | Annotated[tuple[str, ...], Rule(most=2)],
    Rule("one or two of `upper(q)`, `lower(q)`, `width(q)`"),
]


@dataclass(frozen=True)
class ChooseSection:
    """The nominal values that are best in the worst case: over choices and the box about each,
    surrogates of quantities tell which keeps all requirements and has the best goal, and its worst
    case is simulated."""

    parameters: Annotated[
        dict[
            str, Annotated[Pair, Rule(PAIR, text="Range of the nominal value.", unit="parameter")]
        ],
        Rule("a mapping from 1 to 3 parameter names to `[lower, upper]`", most=3),
    ] = field(default_factory=dict)
    """Ranges of the nominal values, by the scene's parameter names. An interval that is given as
    `relative` grows with the choice, any other keeps its width; a parameter without an interval is
    chosen exactly."""
    minimise: Goals = ()
    """What is to be small: `upper(q)`, `lower(q)` or `width(q)` of the interval of a quantity q.
    With a second goal, the trade-off of the two is drawn; the best choice is that of the first."""
    maximise: Goals = ()
    """What is to be large, in the same form."""
    order: Annotated[int, Rule(least=1, most=64)] = 8
    """Order of the sparse grid of runs along the chosen parameters; along others it is that of the
    design."""


@dataclass(frozen=True)
class CaseSolver:
    """What of the solver differs in a case."""

    duration: Annotated[float, Rule(least=1e-9, most=1e6, unit="s")] = ABSENT
    """Simulated time."""


@dataclass(frozen=True)
class CaseSection:
    """One case: what differs from the campaign, which has the rest; `{}` is the campaign itself."""

    scene: SceneValues = field(default_factory=dict)
    """Values of scene parameters that are no intervals."""
    file: StructureFile = ABSENT
    """File of another structure, in the place of the campaign's."""
    solver: CaseSolver = CaseSolver()
    intervals: Annotated[
        dict[str, OneInterval], Rule("a mapping from parameter names to intervals", most=60)
    ] = field(default_factory=dict)
    """Intervals that stand in the place of the campaign's, or are further ones, as there."""


@dataclass(frozen=True)
class FigureChoice:
    """What the figures show."""

    moments: Annotated[int, Rule(least=2, most=12)] = 5
    """Number of moments at which the structure is drawn, from its start to its first closure."""


@dataclass(frozen=True)
class Jobs:
    """How the runs are grouped. Only `keep: responses` changes numbers: to single precision."""

    runs_per_job: Annotated[
        int | OrAuto, Rule("a whole number of at least 1, or `auto`", least=1)
    ] = "auto"
    """Most runs in one job. A job is one process; it starts in about 1 s, the time of some 50 runs,
    so few jobs are best, but there should be one for each core. `auto`: 512, or more where that
    makes more than eight jobs, or one for each core of this machine; 4,096, or more where that
    makes more than 64; and more where there would be more jobs for some cores of this machine than
    for others."""
    group: Annotated[int, Rule(least=1)] = 32
    """Runs that are integrated side by side; they are written while the next ones are integrated,
    so this bounds memory and what a killed job loses."""
    keep: Literal["trajectories", "responses", "extremes"] = "trajectories"
    """`trajectories` writes everything recorded of a group of runs into a netCDF file, from which
    other responses can be taken later without simulating again. `responses` keeps the responses
    alone, in single precision (6e-8 of a value), in far less disk space; another design, size of
    group or response simulates again. `extremes`, for `sobol` without order, keeps the least and
    largest value of each response at each instant, with where they are attained, and of every run
    its parameters, quantities and events: a million runs take some 100 MB
    (docs/larger-campaigns.md)."""
    minutes: Annotated[float, Rule(least=0, unit="min")] = 0.0
    """How long a job shall take on its `processes`, in place of `runs_per_job`: clusters want jobs
    of 15 minutes or more. How many runs that is follows from `run_seconds`, or else from an
    estimate that is accurate to a factor of about two. 0: as many runs as `runs_per_job` says."""
    run_seconds: Annotated[float, Rule(least=0, unit="s")] = 0.0
    """Seconds of one core that a run takes, where they were measured; the log of a job tells them
    if there are `minutes`. 0: estimated."""
    processes: Annotated[int, Rule(least=1, most=1024)] = 1
    """Processes of a job, one for each core that it shall have; they share one compiled time loop.
    On a cluster as many as a node has cores, so that a job fills it."""


Times = Annotated[Pair, Rule(PAIR, unit="s")]
_ByResponse = Rule("a mapping from names of responses in `columns` to numbers above 0")
_Size = Annotated[float, Rule(above=0, unit="response")]


@dataclass(frozen=True)
class UnknownSensor:
    """What is not known of the sensor, and eliminated within this test."""

    delay: Times = (0.0, 0.0)
    """How much later than the structure's the file's times are, at least and at most."""
    offset: Annotated[dict[Name, _Size], _ByResponse] = field(default_factory=dict)
    """Half width about 0 of what the sensor adds, in the response's unit, by response."""
    gain: Annotated[dict[Name, Annotated[float, Rule(above=0, unit="1")]], _ByResponse] = field(
        default_factory=dict
    )
    """Half width about 1 of the factor on the response, by response."""

    def __post_init__(self):
        if self.delay[0] > self.delay[1]:
            text = f"{list(self.delay)} is not allowed; allowed: a lower and an upper delay"
            raise RefusedError("delay", text)


@dataclass(frozen=True)
class MeasuredTest:
    """Measured curves of one test, and what held in it (docs/measured.md)."""

    file: Annotated[str, Rule("the path of a CSV file", pattern=r"[^\0]*")]
    """A CSV file, sought from the folder of the config: names with units, such as
    `t [s],angle [rad]`, above rows of numbers; one column is the time."""
    columns: Annotated[
        dict[str, Name], Rule("a mapping from names of columns to names of responses", least=1)
    ]
    """Which column measures which response; the unit of the column may be any that fits."""
    band: Annotated[dict[Name, _Size], _ByResponse] = field(default_factory=dict)
    """By how much the sensor may be wrong, beyond what `unknown` says, in the response's unit, by
    response; or the file has a column `<column>_band`."""
    model: Annotated[dict[Name, _Size], _ByResponse] = field(default_factory=dict)
    """By how much the model may be wrong, which is added to the band."""
    unknown: UnknownSensor = UnknownSensor()
    start: Annotated[
        dict[str, Annotated[Pair, Rule(PAIR, text="Interval in this test.", unit="parameter")]],
        Rule("a mapping from the scene's parameter names to `[lower, upper]`"),
    ] = field(default_factory=dict)
    """Parameters of the scene that only this test does not know, such as the angle and the rate at
    its start: they are eliminated within it."""
    window: Times = ABSENT
    """First and last time of the file that count. Default: all behind the longest delay."""
    scene: SceneValues = field(default_factory=dict)
    """Values that held in this test, by the scene's parameter names; an interval parameter among
    them is not narrowed by it."""
    use: Literal["calibrate", "check"] = "calibrate"
    """`check`: it may refute what the other tests leave, and narrows nothing."""


def _definition(noun: str, example: str, **units: str) -> Rule:
    """The rule of a response's or quantity's definition, which the mechanics read; units: of its
    numbers, by key."""
    text, pairs = f"Definition of one {noun}.", tuple(units.items())
    return Rule(f"a mapping such as {example}", text=text, units=pairs, least=1)


_OF_MARGINS = {"specified_acceleration": "rad/s2", "output_torque": "N m"}


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
        Rule("a mapping from 1 to 60 parameter names to intervals", least=1, most=60),
    ]
    """The uncertain parameters, by the scene's parameter names."""
    design: DesignSection = DesignSection()
    bounds: BoundsChoice = BoundsChoice()
    held_out: Annotated[int, Rule(least=0, most=10_000)] = 4
    """Extra runs that no surrogate is fitted to; the error estimate comes from them. Not used by
    `sobol`."""
    responses: Annotated[
        dict[
            Name,
            Annotated[dict[str, Any], _definition(
                "response", "`{distance: [B, D]}` or `{velocity: B, component: z}`",
                at="1", **_OF_MARGINS)],
        ],
        Rule("a mapping from at least one name (letters, digits, `_`, starting with a letter) to "
            "definitions"),
    ]  # fmt: skip
    """The curves to bound, by names of your own: distances, positions, velocities, openings,
    tensions, energies, forces, stresses and others (docs/responses.md); at least one, unless there
    are `margins`."""
    quantities: Annotated[
        dict[
            Name,
            Annotated[
                dict[str, Any] | str,
                _definition(
                    "quantity",
                    "`{largest: vB}` or `{event: closes, number: 1}`, or an expression of others "
                    "such as `t1 - t2`",
                    at="s",
                    **dict.fromkeys(("level", "about", "within"), "response"),
                ),
            ],
        ],
        Definitions,
    ] = field(default_factory=dict)
    """Numbers of a run whose intervals are wanted, by names of your own: peaks, final and mean
    values, values at a time, times of crossings and events and others, and arithmetic of these
    (docs/quantities.md). A run in which it does not happen has none."""
    margins: Annotated[
        dict[
            Name,
            Annotated[
                dict[str, Any],
                _definition(
                    "margin",
                    "`{along: root, to: 90 deg, standard: ecss-e-st-33-01c}`",
                    **_OF_MARGINS,
                ),
            ],
        ],
        Definitions,
    ] = field(default_factory=dict)
    """Torque or force margins over the travel of an opening moved quasi-statically, by names of
    your own (docs/review-sheet.md). Each is a response over the opening, the quantity
    `<name>_least`, and, unless `requirements` say otherwise, the requirement that this is at least
    0. With margins and no other response or quantity, `duration` is 1 ms if nothing is said: it
    moves no margin."""
    published: Annotated[
        dict[str, Annotated[float, Rule(text="Published largest difference.", unit="response")]],
        Rule("a mapping from names of `responses` to numbers"),
    ] = field(default_factory=dict)
    """Largest differences of the bounds that somebody has published, by response; the summary puts
    ours beside them. Where a later file or `--config` changes `scene` or `intervals`, they are left
    out: they are of another box."""
    review: Literal["ecss-e-st-33-01c"] = ABSENT
    """Standard of which a review sheet is made, in summary and page and as `review.csv` and
    `review.md`: each clause with what was shown of it (docs/review-sheet.md)."""
    error: ErrorDisplay = ErrorDisplay()
    verify: Verify = Verify()
    requirements: Annotated[
        dict[FreeName, Annotated[
            dict[str, Annotated[Limits, Rule("a mapping with `at_least`, `at_most` or "
                "`happens`, by quantity as in `{t_shut: {at_most: 0.32}}`")]],
            Rule("a mapping such as `{t_shut: {at_least: 0.3, at_most: 0.32}}`", least=1,
                text="The limits of one requirement, by quantity; all of them must be kept. A "
                "list `cases: [on ground]` beside them: it is of these cases alone."),
        ]],
        Rule("a mapping from names to limits of quantities, such as `{in_time: {t_shut: {at_most: "
            "0.32}}}`"),
    ] = field(default_factory=dict)  # fmt: skip
    """What must hold all over the box, by names of your own: limits of quantities. The campaign
    tells whether all, some or none of the box meets each and all together, with which margin, and
    where it fails (docs/quantities.md)."""
    choose: Annotated[
        ChooseSection, Rule("a mapping with `parameters`, and `minimise` or `maximise`")
    ] = ChooseSection()
    measured: Annotated[
        dict[
            FreeName, Annotated[MeasuredTest, Rule("a mapping with `file`, `columns` and `band`")]
        ],
        Rule("a mapping from names of tests to mappings"),
    ] = field(default_factory=dict)
    """Tests whose measured curves tell which part of the box is left, or that none is, by names of
    your own."""
    figures: FigureChoice = FigureChoice()
    jobs: Jobs = Jobs()
    cases: Annotated[
        dict[
            CaseName,
            Annotated[
                CaseSection, Rule("a mapping with `scene`, `file`, `solver` and `intervals`")
            ],
        ],
        Rule("a mapping from names to what differs, such as `{on ground: {scene: {g: 9.81}}}`"),
    ] = field(default_factory=dict)
    """Variants of the campaign, by names of your own, such as `on ground` or `one spring out`: each
    is run over the whole box, with results in `results/<campaign>/<name>/`, and a page tells which
    requirement is met in all of them and which case decides (docs/cases.md)."""
