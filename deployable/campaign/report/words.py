"""The page's sentences that tell the answer, and how people write numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from deployable.campaign.report.data import PageData, Parameter, Response
from deployable.campaign.results.answers import interval
from deployable.campaign.results.budget import parts_text
from deployable.campaign.results.decisions import verdict as decided
from deployable.campaign.results.scan_words import known_error
from deployable.campaign.results.summary import SOFT
from deployable.campaign.results.units import pretty
from deployable.campaign.results.words import doubt_texts, percent, runs_text

_NAMED = 2
"""Quantities, or responses, that the headline names."""

_FIXED = "\N{NO-BREAK SPACE}"
SMALL, LARGE = 0.05, 0.25
"""Shares of the largest difference below which an estimated error is called small, and from which
it is called large."""


@dataclass(frozen=True)
class Verdict:
    """The headline of one response; `grade` is small, noticeable, large or unknown (the error)."""

    response: Response
    time: float
    width: str
    interval: str
    error: str
    share: float | None
    grade: str
    worst_error: str
    published: str
    outside: str
    parts: str


_ANGLES = {"degree": "°", "rad": " rad"}


def number(value: float, digits: int = 3) -> str:
    """A number as people write it: `0.0618`, `1.2e+09` as `1.2 × 10⁹`."""
    text = f"{value:.{digits}g}"
    if "e" not in text:
        return text.replace("-", "−")
    mantissa, exponent = text.split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    head = "" if mantissa == "1" else f"{mantissa} × "
    return f"{head}10{raised}".replace("-", "−")


def quantity(value: float, units: str, digits: int = 3) -> str:
    """A number with its unit."""
    unit = pretty(units)
    return number(value, digits) + ("" if unit == "1" else f" {unit}")


def unbroken(text: str, units: Iterable[str]) -> str:
    """A text in which no line ends between a number and its unit, sign, power of ten or name.

    units: as they are written, such as `m/s`; seconds and shares need not be among them.
    """
    known = "|".join(sorted(map(re.escape, {*units, "s", "rad", "%"}), key=len, reverse=True))
    text = re.sub(rf"(?<=[\d⁰-⁹]) (?=(?:{known})(?!\w))", _FIXED, text)
    for unit in units:
        text = text.replace(_FIXED + unit, _FIXED + unit.replace(" ", _FIXED))
    text = re.sub(r" = (?=[\d−-])", f"{_FIXED}={_FIXED}", text)
    text = re.sub(r"(?<![\w)-])-(?=\d)", "−", text)
    return re.sub(r"(?<=[\d±]) (?=[\d×])|(?<=×) (?=10)", _FIXED, text)


def coded(text: str, units: Iterable[str] = ()) -> Any:
    """A sentence as HTML, with keys of a config, between backticks, as code."""
    from markupsafe import Markup, escape

    return Markup(re.sub("`([^`]+)`", r"<code>\1</code>", str(escape(unbroken(text, units)))))


def spread(parameter: Parameter) -> str:
    """How far a parameter is known: `± 1 %`, else its ends."""
    below, above = parameter.nominal - parameter.lower, parameter.upper - parameter.nominal
    if abs(above - below) < 1e-6 * abs(parameter.nominal):
        if unit := _ANGLES.get(parameter.units):  # a share of an angle says little
            return f"± {number(above)}{unit}"
        return f"± {100 * above / abs(parameter.nominal):.3g} %"
    ends = number(parameter.lower, 4), quantity(parameter.upper, parameter.units, 4)
    return f"{ends[0]} to {ends[1]}"


def headline(data: PageData) -> str:
    """The answer in one sentence; what was asked of quantities comes first."""
    if data.answers:
        return f"With {_given(data.parameters)}, {_answered(data.answers)}."
    first, *others = data.responses
    text = f"With {_given(data.parameters)}, the {first.long_name} is uncertain by up to "
    text += _largest(first)
    if others:
        text += f", and the {others[0].long_name} by up to {_largest(others[0])}"
    if others[1:]:
        text += f" ({_others(len(others) - 1, 'response', 'responses')})"
    return f"{text}.".replace("-", "\N{NON-BREAKING HYPHEN}")


def _answered(answers: Mapping) -> str:
    """Of the first quantities their intervals, how many others there are, and whether the
    requirements are met."""
    rows = [row for row in answers["quantities"] if row["lower"] is not None]
    parts = [
        f"{row['name']} is {interval(row)}" + " (not verified)" * (not row["verified"])
        for row in rows[:_NAMED]
    ]
    if len(rows) > _NAMED:
        parts[-1] += f" ({_others(len(rows) - _NAMED, 'quantity', 'quantities')})"
    if "together" in answers:
        text = decided(answers["together"])
        parts.append(text[0].lower() + text[1:].rstrip("."))
    return ", and ".join(parts) or "none of the quantities happens"


def _others(count: int, one: str, many: str) -> str:
    return f"{count} more {one if count == 1 else many} below"


def _given(parameters: tuple[Parameter, ...]) -> str:
    """`a known to ± 1 %, E to ± 5 % and K from 1 to 2 N/m`; a single one by its long name."""
    parts, verb = [], "known to"
    for parameter in parameters:
        # Several long names would bury the answer.
        single = len(parameters) == 1 and parameter.long_name
        name, how = f"the {single}" if single else parameter.name, spread(parameter)
        if how.startswith("±"):
            parts.append(f"{name} {verb} {how}")
            verb = "to"
        else:
            parts.append(f"{name} from {how}")
    return _listed(parts)


def cautions(data: PageData) -> list[str]:
    """What must be said of a campaign's numbers."""
    doubts = {response.name: response.doubt for response in data.responses if response.doubt}
    rows = data.answers.get("quantities", [])
    doubts |= {row["name"]: row["doubt"] for row in rows if "doubt" in row}
    sentences = [*(f"{text}." for text in doubt_texts(doubts)), *of_all(data)]
    return sentences + [text for each in data.responses for text in of_one(data, each)]


def of_all(data: PageData) -> list[str]:
    """What must be said of all numbers."""
    if data.overlap <= SOFT:
        return []
    most = quantity(data.overlap, "rad", 2)
    return [
        f"Faces that touch pass through each other by up to {most}: the contacts are too soft to "
        "be contacts, and what follows a closure means little. What to do: make them stiffer, "
        "which takes shorter steps."
    ]


def of_one(data: PageData, response: Response) -> list[str]:
    """What must be said of a response whose estimated error is large or unknown."""
    v, sentences = verdict(data, response), []
    if v.grade == "large":
        sentences.append(
            f"Do not rely on the number for {response.name}: either bound may be off by {v.error}, "
            f"{percent(v.share or 0.0)} of the difference. {remedy(data, response)}"
        )
    elif v.grade == "unknown":
        sentences.append(f"There is no error estimate for {response.name}.")
    if response.impossible > 0:
        most = quantity(response.impossible, response.units, 2)
        sentences.append(
            f"The curve fitted to {response.name} falls up to {most} below what is possible; the "
            "bounds do not."
        )
    return sentences


def beside(data: PageData, response: Response) -> list[str]:
    """What must be said beside the numbers of a response."""
    own = {response.name: response.doubt} if response.doubt else {}
    return [*(f"{text}." for text in doubt_texts(own)), *of_one(data, response)]


_ACCURACY = (
    "ask for `accuracy: 0.05` in the place of `design`, `held_out` and `bounds`, which adds runs "
    "until the error is 5 % of the width, or tells what that would cost"
)


def remedy(data: PageData, response: Response) -> str:
    """What to do about a large estimated error of a response."""
    if "asked" in response.errors:
        more = (
            "let `accuracy` have more `runs` and `minutes`, and, where the summary says that a "
            "finer mesh hardly helps, give that response or quantity a larger share of its own "
            "under `of`, or leave it out"
        )
    elif data.bounds_kind.startswith("enclosed"):
        more = f"{_ACCURACY}; or try `bounds: {{model: spline}}`, a curve through the same runs"
    elif data.bounds_kind.startswith("attained"):
        more = _ACCURACY
    else:
        more = "make more `samples`"
    late = data.time[response.widest]
    if not any(event.closing and event.time <= late for run in data.runs for event in run.events):
        return f"What to do: {more}."
    return (
        f"What to do: {more}. By then something has closed, at another time in each run, after "
        "which curves are hard to fit: mostly a number is better known, as the time, a peak or the "
        "value just before (`quantities`)."
    )


def kind_meaning(kind: str) -> str:
    """What the word for a kind of bounds means, where it needs to be said."""
    if not kind.startswith("attained"):
        return ""
    return (
        "Attained: a curve fitted to the runs takes these values somewhere in the box (all "
        "combinations of values within the intervals); that it takes none beyond is not proven."
    )


def _largest(response: Response) -> str:
    """The largest difference of a response's bounds."""
    width = response.upper[response.widest] - response.lower[response.widest]
    return quantity(width, response.units)


def facts(data: PageData) -> str:
    """What the campaign was."""
    duration = quantity(float(data.time[-1] - data.time[0]), "s")
    count = len(data.parameters)
    parameters = "one interval parameter" if count == 1 else f"{count} interval parameters"
    made = data.run_counts if "all" in data.run_counts else {"all": data.run_count}
    runs = runs_text(made)
    about = f": {data.about}" if data.about else ""
    text = f"Structure {data.scene}{about}. {duration} of motion, {parameters}, {runs}."
    known = [f"{p.name} is the {p.long_name}" for p in data.parameters if p.long_name]
    return text if count == 1 or not known else f"{text} Here {_listed(known)}."


def _listed(parts: list[str]) -> str:
    """`one, two and three`."""
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"


def verdict(data: PageData, response: Response) -> Verdict:
    """The headline numbers of a response."""
    at, units = response.widest, response.units
    low, high = float(response.lower[at]), float(response.upper[at])
    width = high - low
    errors, kind = response.error, data.bounds_kind
    error = None if errors is None else known_error(kind, float(errors[at]))
    share = error / width if error is not None and width > 0 else None
    grade = "unknown" if share is None else "large" if share >= LARGE else "noticeable"
    if share is not None and share < SMALL:
        grade = "small"
    worst = ""
    if errors is not None and known_error(kind, float(errors.max())) is not None:
        where = int(errors.argmax())
        worst = f"{quantity(errors[where], units, 2)} at {data.time[where]:.4g} s"
    outside = ""
    if response.outside is not None:
        outside = "none"
        if response.outside > 0:
            outside = f"{percent(response.share_outside)} of their instants, by at most "
            outside += quantity(response.outside, units, 2)
    return Verdict(
        response, float(data.time[at]), quantity(width, units),
        f"{number(low, 4)} to {quantity(high, units, 4)}",
        "" if error is None else quantity(error, units, 2),
        share, grade, worst, _published(response, width, error), outside,
        parts_text(response.errors),
    )  # fmt: skip


def _published(response: Response, width: float, error: float | None) -> str:
    """Ours beside the published number."""
    if not response.published:
        return ""
    text = quantity(response.published, response.units)
    apart = width / response.published - 1
    if abs(apart) < 0.005:
        return f"{text}; the same to half a per cent"
    text += f"; ours is {percent(abs(apart))} {'above' if apart > 0 else 'below'}"
    if error is None:
        return text
    within = abs(width - response.published) <= error
    return f"{text}, {'less' if within else 'more'} than the estimated error"
