"""The review sheet: each clause of a standard with what a campaign showed of it, as rows of text.

Nothing in it claims compliance: it says what an analysis of a model showed, of what was stated. A
row is met only where the numbers that it prints show it, with their errors."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from deployable.campaign.config.sections import BY_STANDARD
from deployable.campaign.files import csv_text
from deployable.campaign.results.facts import decisive, fitted_width, has_effect, keeps
from deployable.campaign.results.quantity_results import whole_error
from deployable.campaign.results.templates import sentence
from deployable.campaign.text import numbers
from fpm.reading.margins import MOST
from fpm.reading.standards import CLASSES, STANDARDS

HEADS = {
    "clause": "clause", "asks": "what it asks", "analysed": "how it was analysed",
    "value": "value, with its interval", "verdict": "verdict", "nearest": "nearest to failing",
}  # fmt: skip
COLUMNS = ("standard", *HEADS, "state")
"""Of the sheet as CSV: the edition, what people read, and the verdict as one of the states."""

MET, UNMET, OPEN = "met", "not met", "undecided"
PARTIAL, NOT_ANALYSED, REPORT = "partly analysed", "not analysed", "reported"
STATES = (UNMET, OPEN, PARTIAL, NOT_ANALYSED, MET, REPORT)


Verdict = tuple[str, str]
"""One of `STATES`, and the same in a sentence."""

SOME_FAIL = UNMET, "not met in at least a part of the box"
ALL_FAIL = UNMET, "not met anywhere in the box"

_TABLES = json.loads(Path(__file__).with_name("clauses.json").read_text(encoding="utf-8"))
CLAUSES: dict[str, list[list[str]]] = _TABLES["clauses"]
"""By standard, as in `fpm.reading.standards`, of each clause its number, what it asks in our own
words, and the topic that decides it: a subject of quantities such as `stress`, or a key of
`ANALYSES` for clauses about no quantity; empty where nothing does."""

TOPICS = {kind: set(topics) for kind, topics in _TABLES["topics"].items()}
"""Topics by kinds of response and by events of which quantities are."""

ALLOWABLES = ("stress", "stop", "latch shock")
"""Topics that only an allowable, which the campaign states, decides."""

MIN_EXCHANGE = 20.0
"""Energies must change by this many times the balance's allowed error for a balance to count."""


def rows_of(facts: Mapping[str, Any], experiment: Any, standard: str) -> list[dict[str, str]]:
    """Make all rows of the review sheet of a standard: dicts of texts with the keys `HEADS`,
    `state` (the verdict as one of `STATES`) and `of` (the quantity). facts: with `mechanism`."""
    sheet = _Sheet(facts, experiment, standard)
    rows = [
        {"clause": number, "asks": asks} | row
        for number, asks, topic in CLAUSES[standard] for row in sheet.answer(topic) or [_row("")]
    ]  # fmt: skip
    for row in facts["quantities"]:  # which answer no clause
        if row["name"] not in sheet.row_names:
            margin = sheet.margins.get(row["name"])
            asks = "a margin of at least 0 over the full range of travel"
            names = {"clause": STANDARDS[margin["standard"]].title, "asks": asks} if margin else {}
            rows += [
                names | own_row for own_row in sheet.quantity_rows(row, "margin" * bool(margin))
            ]
    return rows


def head_of(facts: Mapping[str, Any], rows: Sequence[Mapping], standard: str) -> list[str]:
    """Write the paragraphs above a review sheet: how many rows have which verdict, the box of
    parameters, and how to read the numbers."""
    arguments = facts, rows, STATES, edition_of(standard)
    return sentence("sheet_head", *arguments, escapes=False).strip().split("\n\n")


def edition_of(standard: str) -> str:
    """Write title and edition of a standard, for headings; standard: a key of `STANDARDS`."""
    return f"{STANDARDS[standard].title} ({STANDARDS[standard].edition})"


def as_csv(rows: Iterable[Mapping[str, str]], standard: str) -> str:
    """Write a review sheet as CSV text, headings first, with the edition in the first column."""
    heads = {**HEADS, "standard": "standard", "state": "state"}
    sheet_rows = ({**row, "standard": edition_of(standard)} for row in rows)
    return csv_text([row[name] for name in COLUMNS] for row in (heads, *sheet_rows))


BUDGET_HEADS = ("part", "class", "acts", "moment", "factor", "weighted")


def budgets_of(facts: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Make a table for each torque margin of what drives and what resists where it is least: dicts
    of `title`, `heads`, `rows` (six texts each) and `sum`, a sentence."""
    for name, margin in facts["mechanism"]["margins"].items():
        budget = margin["budget"]
        unit = "N m" if margin["unit"] == "rad" else "N"
        rows = [
            (row["part"], f"{row['class_']}, {CLASSES[row['class_']]}",
             "drives" if row["moment"] > 0 else "resists" if row["moment"] < 0 else "none",
             *(numbers.number(row[key], 6) for key in ("moment", "factor", "weighted")))
            for row in budget["rows"]
        ]  # fmt: skip
        place = numbers.place(margin["at"], facts["parameters"])
        title = f"{name}: {edition_of(margin['standard'])}, {margin['evidence']}, "
        title += f"own factors {', '.join(margin['own'])}, " * bool(margin["own"])
        title += f"at {numbers.quantity(budget['opening'], margin['unit'], 4)}"
        quotient = f"is {MOST:g} or more and counts as {MOST:g}"
        if budget["margin"] < MOST:
            quotient = f"= {numbers.number(budget['margin'], 4)}"
        yield {
            "title": ", ".join(filter(None, [title, place])),
            "heads": [
                head + f" ({unit})" * (head in ("moment", "weighted")) for head in BUDGET_HEADS
            ],
            "rows": rows,
            "sum": f"T = {numbers.quantity(budget['drives'], unit, 6)} (the sum of the positive "
            f"weighted moments), Tmin = {numbers.quantity(budget['requirement'], unit, 6)} (that "
            f"of the negative ones, without sign): T/Tmin − 1 {quotient}.",
        }


class _Sheet:
    def __init__(self, facts: Mapping[str, Any], experiment: Any, standard: str):
        self.facts, self.standard = facts, standard
        self._numbers = {number.name: number for number in experiment.quantity_list}
        self._tolerance = experiment.solver.energy_tolerance
        self._mechanism = facts["mechanism"]
        self.margins = self._mechanism["margins"]
        self._quantities = {row["name"]: row for row in facts["quantities"]}
        self._limits: dict[str, list] = {}  # of each quantity: requirements and their limits
        for row in facts.get("requirements", ()):
            for limit in row["limits"]:
                self._limits.setdefault(limit["quantity"], []).append((row["name"], limit))
        self._free = [p["name"] for p in facts["parameters"] if p["upper"] > p["lower"]]
        runs = facts["runs"]["all"]
        self._met = MET, f"met in all of the box, by analysis of {runs} run{'s' * (runs != 1)}"
        self.row_names: set[str] = set()  # of the quantities that have rows

    def answer(self, topic: str) -> list[dict[str, str]]:
        """Return the rows that answer a clause of a topic, as dicts of texts."""
        if topic in ANALYSES:
            return list(filter(None, [ANALYSES[topic](self)]))
        names = [row["name"] for row in self.facts["quantities"] if self._is_about(row, topic)]
        if topic == "margin":  # those by own factors behind those of the standard
            names.sort(key=lambda name: bool(self.margins[name]["own"]))
        rows = [x for name in names for x in self.quantity_rows(self._quantities[name], topic)]
        if topic == "latches" and rows:  # latches that no quantity is about, beside others
            places = [self._numbers[name].places for name in names]
            rest = [latch for latch in self._mechanism["latches"] if (latch,) not in places]
            rows += [_row(", ".join(rest))] if rest else []
        return rows

    def _is_about(self, row: Mapping[str, Any], topic: str) -> bool:
        """Return whether a quantity is of a clause's topic."""
        number, margin = self._numbers[row["name"]], self.margins.get(row["name"])
        response = number.response
        if margin and margin["without"]:
            return topic == "failure" and not margin["own"]
        if margin:
            return topic == "margin" and margin["standard"] == self.standard
        if response is None:
            return topic in TOPICS.get(number.event, ())
        kind = response.kind
        kind = f"{kind} {response.subjects[1]}" if kind == "joint_moment" else kind
        return topic in TOPICS.get(kind, ())

    def quantity_rows(self, row: Mapping[str, Any], topic: str = "") -> list[dict[str, str]]:
        """Return the row of a quantity for a topic, unless this is empty, and one for each of the
        campaign's own requirements of it."""
        name, rows = row["name"], []
        self.row_names.add(name)
        limits = self._limits.get(name, [])
        if topic and topic not in JUDGES and limits:
            return [self._row(row, self._approve(row, limit, topic), limit) for _, limit in limits]
        if topic in JUDGES:
            verdict, clause_limit = JUDGES[topic](self, row), None
            if topic == "latches":
                clause_limit = next((entry for _, entry in limits if _is_there(entry)), None)
            elif topic in ("margin", "failure"):
                clause_limit = self._limit_at_zero(name)
            rows = [self._row(row, verdict, clause_limit)]
            if topic == "margin" and self.margins[name]["own"]:
                rows[0] |= {"clause": "own", "asks": "a margin with the campaign's own factors"}
            limits = [pair for pair in limits if pair[1] is not clause_limit]
        elif topic in ALLOWABLES:
            rows = [self._row(row, _because(NOT_ANALYSED, "no allowable was stated (at_most)"))]
        elif topic:
            rows = [self._row(row, (REPORT, "reported; no limit was stated"))]
        for requirement, limit in limits:
            state, text = verdict = self._judge(row, limit)
            weaker = limit["kind"] != "at_least" or limit["level"] < 0
            if name in self.margins and weaker and state != UNMET:
                outcome = "kept in all of the box" if state == MET else text
                text = f"{outcome}, which does not show that the margin is at least 0"
                verdict = _because(REPORT, text)
            names = {"clause": "own", "asks": f"own requirement {requirement}"}
            rows.append(names | self._row(row, verdict, limit))
        return rows

    def _row(
        self, row: Mapping[str, Any], verdict: Verdict, limit: Mapping[str, Any] | None = None
    ) -> dict[str, str]:
        """A quantity with its interval and a verdict; limit: by which it is judged."""
        name, units, parameters = row["name"], row["units"], self.facts["parameters"]
        value = f"{numbers.interval(row)} ± {numbers.quantity(whole_error(row), units, 2)}"
        if row["lower"] is None:
            value = "happens in no run"
        analysed, nearest = f"{name}: {row['long_name']}", ""
        if margin := self.margins.get(name):
            analysed += f"; {_describe_margin(margin)}"
            if limit is None:
                least = numbers.quantity(row["simulated_lower"], units, 4)
                nearest = f"{numbers.place(row['argmin'], parameters)}: {least}, computed there"
        if limit is not None:
            analysed += f"; {_describe_limit(limit, units)}"
            if limit["kind"] != "happens" or limit["met"] not in ("all", "undecided"):
                least = numbers.quantity(limit["simulated"], units, 4, missing="")
                nearest = numbers.place(limit["at"], parameters)
                nearest += f": {least}, computed there" if least else ", by the fit"
        if margin:
            opening = numbers.quantity(margin["budget"]["opening"], margin["unit"], 4)
            nearest += f", at an opening of {opening}"
        return _row(analysed, verdict, value, nearest, name)

    # -- verdicts ----------------------------------------------------------------------------------

    def _judge(self, row: Mapping[str, Any], limit: Mapping[str, Any]) -> Verdict:
        """Return whether a requirement's limit is kept, as assessed and by the printed interval."""
        if limit["met"] == "none":
            return ALL_FAIL
        if limit["met"] == "some":
            share = numbers.share(limit["share"], limit["share_uncertainty"])
            return UNMET, f"not met in a part of the box; {share} of the box meets it"
        if limit["met"] == "undecided":
            runs = f"no failure found in {limit['runs']} runs"
            return _because(OPEN, f"{runs}, which does not prove the rest of the box")
        if limit["kind"] != "happens" and (
            row["runs_without"] or not keeps(row, limit["kind"], limit["level"])
        ):
            return _because(OPEN, "the limit is within the error")
        if row.get("doubt"):
            return _because(OPEN, row["doubt"])
        return self._met

    def _approve(self, row: Mapping[str, Any], limit: Mapping[str, Any], topic: str) -> Verdict:
        """Return whether a limit is kept that is an allowable; nothing where it is none."""
        if topic not in ALLOWABLES:
            return self._judge(row, limit)
        sides = {self._side(q, bound) for q in self._numbers for _, bound in self._limits.get(q, ())
                 if self._numbers[q].response == self._numbers[row["name"]].response}  # fmt: skip
        if not self._side(row["name"], limit):
            text = f"{_describe_limit(limit, row['units'])} does not bound the largest load here"
            return _because(NOT_ANALYSED, text)
        state, text = verdict = self._judge(row, limit)
        if state != MET:
            return verdict
        if self._numbers[row["name"]].response.least is None and not {1, -1} <= sides:
            text = "met for loads of one sign; state a limit for the other sign, too"
            return _because(PARTIAL, text)
        return MET, f"{text}, by the allowable that the campaign states"

    def _side(self, name: str, limit: Mapping[str, Any]) -> int:
        """Return the side from which a limit bounds a response: 1 (above), -1 (below), 0 (none)."""
        number = self._numbers[name]
        if number.response is None:
            return 0
        final = number.kind == "final" and number.response.kind.startswith("latch_imp")
        if limit["kind"] == "at_most" and (number.kind == "largest" or final):
            return 1
        is_signed = number.response.least is None
        lower = limit["kind"] == "at_least" and (number.kind == "smallest" or final)
        return -1 if lower and is_signed else 0

    def _limit_at_zero(self, name: str) -> Mapping[str, Any] | None:
        limits = (limit for _, limit in self._limits.get(name, ()))
        return next((x for x in limits if x["kind"] == "at_least" and x["level"] == 0), None)

    def _above_zero(self, row: Mapping[str, Any]) -> Verdict:
        """Return whether a margin is at least 0, by the requirement of that or by its interval."""
        if limit := self._limit_at_zero(row["name"]):
            return self._judge(row, limit)
        if row["upper"] is not None and row["upper"] < 0:
            return ALL_FAIL
        if row["lower"] is None or row["lower"] < 0:
            return SOME_FAIL
        if not row["runs_without"] and keeps(row, "at_least", 0.0):
            return self._met
        return _because(OPEN, "the least margin is within its error")

    def _margin(self, row: Mapping[str, Any]) -> Verdict:
        """Return whether a margin meets its standard; of one by factors of its own, what both say.
        One without parts that drive nowhere is not a failure case."""
        margin, (state, text) = self.margins[row["name"]], self._above_zero(row)
        if idle := [part for part in margin["without"] if part not in margin["drives"]]:
            text = f"{', '.join(idle)} drives nowhere, so its absence is not a failure case"
            return _because(NOT_ANALYSED, text)
        if margin["own"]:
            name, standard_text = f"{margin['name']}{BY_STANDARD}_least", NOT_ANALYSED
            peer = self.margins.get(name, {})
            if not peer.get("own", True) and peer["standard"] == margin["standard"]:
                _, standard_text = self._margin(self._quantities[name])
            text = f"by own factors ({', '.join(margin['own'])}): {text}"
            return REPORT, f"{text}; by those of the standard: {standard_text}"
        if state != MET:
            return state, text
        for requirement, limit in self._limits.get(row["name"], ()):
            own_state, _ = self._judge(row, limit)
            if limit["kind"] == "at_least" and limit["level"] > 0 and own_state != MET:
                text = f"own requirement {requirement}, {_describe_limit(limit, row['units'])}"
                return _because(own_state, f"{text}; the margin is at least 0")
        if reasons := [*self._open_travel(margin)]:
            analysed = _stretch((margin["first"], margin["last"]), margin["unit"])
            return _because(PARTIAL, f"met from {analysed}; {'; '.join(reasons)}")
        if "measurement" in margin["evidence"] or "test" in margin["evidence"]:
            text += ", if tests have confirmed the values behind the factors"
        return MET, text

    def _open_travel(self, margin: Mapping[str, Any]) -> Iterator[str]:
        """Yield the reasons why a margin does not cover the whole travel."""
        if margin["travel"] is None:
            names = " or ".join(margin["openings"])
            yield f"no latch or stop of {names} states where its travel ends"
        else:
            (a, b), (c, d) = sorted((margin["first"], margin["last"])), sorted(margin["travel"])
            room = 1e-6 * (d - c)
            if a > c + room or b < d - room:
                yield f"the travel is {_stretch(margin['travel'], margin['unit'])}"
        peers = [x for x in self.margins.values() if x["standard"] == margin["standard"]]
        openings = {name for peer in peers for name in peer["openings"]}
        if locks := [name for name in margin["locked"] if name not in openings]:
            yield f"{', '.join(locks)} {'is' if len(locks) == 1 else 'are'} held and not moved"
        group = {margin["openings"][0], *margin["apart"]} if margin["apart"] else set()
        if group - {name for p in peers if not p["apart"] for name in p["openings"]}:
            names = " and ".join(name for name in margin["openings"] if name in group)
            yield f"nothing couples {names}, so that each needs a margin of its own"
        if margin["weaker"]:
            yield f"the structure's file counts {', '.join(margin['weaker'])}"

    def _catches(self, row: Mapping[str, Any]) -> Verdict:
        """Return whether a latch catches."""
        places = self._numbers[row["name"]].places
        limits = [limit for _, limit in self._limits.get(row["name"], ())]
        event_limits = [limit for limit in limits if _is_there(limit)]
        if not event_limits:
            text = "requires that it does not happen" if limits else "does not require it"
            return _because(NOT_ANALYSED, f"the campaign {text}")
        verdict = self._judge(row, event_limits[0])
        if verdict[0] == MET and len(places) > 1:
            return _because(PARTIAL, f"met for the first of {', '.join(places)} that latches")
        return verdict

    def _catches_later(self, row: Mapping[str, Any]) -> Verdict:
        """Return whether a latch that misses catches later."""
        if not row["runs_with"]:
            return _because(NOT_ANALYSED, "no run misses")
        places = self._numbers[row["name"]].places
        for name, number in self._numbers.items():
            if number.event == "latches" and number.places == places:
                state, text = self._catches(self._quantities[name])
                return state, f"{text} (by {name})"
        return _because(NOT_ANALYSED, "no quantity says whether it latches later")

    def _clearance(self, row: Mapping[str, Any]) -> Verdict:
        """Return whether the least clearance is three times its tolerance, its interval's width."""
        if self._numbers[row["name"]].kind != "smallest":
            return _because(NOT_ANALYSED, "the clearance needs its `smallest` value")
        error = whole_error(row)
        if row["lower"] is None or error is None or not row["upper"] > row["lower"]:
            return _because(NOT_ANALYSED, "it does not vary with any tolerance")
        tolerance = row["upper"] - row["lower"] + 2 * error
        text = f"three times its tolerance is {numbers.quantity(3 * tolerance, row['units'])}"
        if row["lower"] - error >= 3 * tolerance:
            return MET, f"{self._met[1]}: {text}"
        return UNMET, f"{SOME_FAIL[1]}: {text}"

    # -- clauses that are about no single quantity -------------------------------------------------

    def redundant(self) -> dict[str, str] | None:
        """Row on whether the margin holds without any one driving spring; None if none drives."""
        margins = {name: m for name, m in self.margins.items()
                   if m["standard"] == self.standard and not m["own"]}  # fmt: skip
        springs = list(dict.fromkeys(name for m in margins.values() for name in m["springs"]))
        if len(springs) < 2:
            text = f"{''.join(springs)} is the only driving spring, which has to be justified"
            return _row("", _because(NOT_ANALYSED, text)) if springs else None
        verdicts = {
            margin["without"][0]: (name, *self._margin(self._quantities[name]))
            for name, margin in margins.items()
            if len(margin["without"]) == 1 and margin["without"][0] in springs
        }
        if not verdicts:
            return _row("", _because(NOT_ANALYSED, ", ".join(springs)))
        names, states, texts = zip(*verdicts.values(), strict=True)
        rest = [name for name in springs if name not in verdicts]
        state = next(member for member in STATES if member in states)
        text = f"met in all of the box without any one of {', '.join(springs)}"
        if state != MET or rest:
            parts = [f"without {x}: {text}" for x, text in zip(verdicts, texts, strict=True)]
            parts += [f"not analysed: {', '.join(rest)}"] if rest else []
            state = PARTIAL if state == MET else state
            text = "; ".join(parts)
        text = text if text.startswith(state) else f"{state}: {text}"
        return _row(f"one at a time: {', '.join(names)}", (state, text))

    def all_requirements(self) -> dict[str, str] | None:
        """Row on the part of the box of parameters in which all requirements, and all margins'
        limits, are met; None where the campaign has no requirements."""
        if (whole := self.facts.get("together")) is None:
            return None
        rows = self.facts["requirements"]
        analysed = f"all requirements together over the box of {', '.join(self._free)}, by "
        analysed += f"{self.facts['runs']['all']} runs including the worst places"
        states = {name: self._margin(self._quantities[name])[0] for name in self.margins}
        failures: dict[str, None] = {}
        for row in (row for row in rows if row["met"] in ("some", "none")):
            names = [limit["quantity"] for limit in row["limits"] if limit["met"] != "all"]
            failures |= dict.fromkeys(names or [row["name"]])
        failures |= dict.fromkeys(name for name, state in states.items() if state == UNMET)
        outcomes = [self._judge(self._quantities[limit["quantity"]], limit)[0]
                    for row in rows for limit in row["limits"]]  # fmt: skip
        verdict = self._met
        if failures and whole["met"] == "some":
            share = numbers.share(whole["share"], whole["share_uncertainty"])
            verdict = UNMET, f"not met in a part of the box; {share} of the box meets all"
        elif not self._free:
            verdict = _because(NOT_ANALYSED, "no parameter is an interval")
        elif failures:
            verdict = SOME_FAIL
        elif whole["met"] != "all" or OPEN in outcomes:
            verdict = self._judge({}, {**whole, "met": "undecided"})
        elif unclear := [name for name, state in states.items() if state not in (MET, UNMET)]:
            text = f"the requirements are met, but see the rows of {', '.join(unclear)}"
            verdict = _because(PARTIAL, text)
        return _row(analysed, verdict, f"not met: {', '.join(failures)}" if failures else "")

    def balance(self) -> dict[str, str]:
        """Row on the runs' energy balance: met if energies change by much more than its error."""
        motion, allowed = self._mechanism["motion"], numbers.percent(self._tolerance)
        runs, duration = self.facts["runs"]["all"], numbers.quantity(self.facts["duration"], "s")
        analysed = f"{runs} runs, each of {duration}; a run fails if the error of its energy "
        analysed += f"balance exceeds {allowed} of the largest energy"
        if motion is None:
            text = "the results do not keep the change of energies (`jobs.keep`)"
            return _row(analysed, _because(PARTIAL, text))
        change, largest = motion["exchanged"], motion["largest"]
        value = f"in the nominal run energies change by up to {numbers.quantity(change, 'J')}; the "
        value += f"largest energy is {numbers.quantity(largest, 'J')}, and the error of the "
        value += f"balance is {numbers.quantity(motion['imbalance'], 'J', 2)}"
        if change < MIN_EXCHANGE * self._tolerance * largest or change == 0:
            text = "energies hardly change, so the balance shows nothing"
            return _row(analysed, _because(NOT_ANALYSED, text), value)
        return _row(analysed, (MET, "met in all runs"), value)

    def parametric(self) -> dict[str, str]:
        """Row on which parameters of the structure vary in the campaign, and which are fixed."""
        if not self._free:
            return _row("")
        rows = [row for row in self.facts["fixed"] if isinstance(row["value"], float)]
        values = (numbers.quantity(row["value"], row["units"], 4) for row in rows)
        texts = [f"{row['description'] or row['name']} ({row['name']} = {value})"
                 for row, value in zip(rows, values, strict=True)]  # fmt: skip
        verdict = _because(PARTIAL, f"these do not vary: {'; '.join(texts)}")
        verdict = verdict if texts else (REPORT, REPORT)
        return _row("parameters that are intervals", verdict, ", ".join(self._free))

    def tests(self) -> dict[str, str]:
        """Row on what measured curves leave of the parameters' box, or that they refute it."""
        if (measured := self.facts.get("measured")) is None:
            return _row("")
        analysed = "measured curves: " + ", ".join(test["name"] for test in measured["tests"])
        worst = measured["worst"]
        nearest = f"the nearest run is within {numbers.number(measured['attained'])} bands, "
        nearest += f"farthest at {numbers.quantity(worst['time'], 's', 7)} of {worst['test']} "
        nearest += f"({worst['response']})"
        failed_checks = [check["name"] for check in measured["checks"] if check["inside"] is False]
        if measured["refuted"] or failed_checks:
            text = f"no remaining values explain {', '.join(failed_checks)}"
            if measured["refuted"]:
                least = numbers.number(measured["least"])
                text = f"the model comes no nearer than {least} bands to the tests. "
                text = (text + sentence("differing", self.facts, escapes=False)).strip()
            return _row(analysed, _because(UNMET, text.removesuffix(".")), "", nearest)
        rows = measured["parameters"]
        value = "; ".join(f"{row['name']} {_stretch(row['after'], row['units'])}" for row in rows)
        verdict = _because(REPORT, "the intervals that remain after the tests")
        if measured["attained"] > 1:
            text = "no run explains the tests, but nothing excludes the remaining values"
            verdict = _because(OPEN, text)
        return _row(analysed, verdict, value, nearest)

    def influence(self) -> dict[str, str] | None:
        """Row that names for each quantity the parameter that widens its interval most."""
        texts = [f"{row['name']}: {name} ({numbers.percent(row['influence'][name]['share'])})"
                 for row in self.facts["quantities"] if (name := decisive(row))]  # fmt: skip
        analysed = "share of each quantity's width that its main parameter causes, by the fit"
        return _row(analysed, (REPORT, REPORT), "; ".join(texts)) if texts else None

    def budget(self) -> dict[str, str] | None:
        """Row on the width of each quantity's interval, now and with the main tolerance halved."""
        texts = []
        for row in self.facts["quantities"]:
            if (name := decisive(row)) and has_effect(row["influence"][name], row, "halved"):
                widths = fitted_width(row), row["influence"][name]["halved"]
                whole, half = (numbers.quantity(width, row["units"], 2) for width in widths)
                texts.append(f"{row['name']}: {whole}, {half} with half the tolerance of {name}")
        analysed = "width of each interval, now and with its main tolerance halved"
        return _row(analysed, (REPORT, REPORT), "; ".join(texts)) if texts else None


ANALYSES: dict[str, Callable[[_Sheet], dict | None]] = {
    "together": _Sheet.all_requirements, "balance": _Sheet.balance, "influence": _Sheet.influence,
    "budget": _Sheet.budget, "redundant": _Sheet.redundant, "parametric": _Sheet.parametric,
    "tests": _Sheet.tests,
}  # fmt: skip
"""What analyses clauses that are about no quantity."""

JUDGES = {
    "margin": _Sheet._margin, "failure": _Sheet._margin, "latches": _Sheet._catches,
    "misses": _Sheet._catches_later, "clearance": _Sheet._clearance,
}  # fmt: skip
"""What judges a quantity by the limit that its clause has."""


def _because(state: str, reason: str) -> Verdict:
    return state, f"{state}: {reason}"


def _row(
    analysed: str, verdict: Verdict = (NOT_ANALYSED, NOT_ANALYSED), value: str = "",
    nearest: str = "", quantity: str = "",
) -> dict[str, str]:  # fmt: skip
    state, text = verdict
    return {"analysed": analysed, "value": value, "verdict": text, "state": state,
            "nearest": nearest, "of": quantity}  # fmt: skip


def _stretch(ends: Sequence[float], unit: str) -> str:
    """Openings from one to another."""
    first, last = ends
    return f"{numbers.number(first, 4)} to {numbers.quantity(last, unit, 4)}"


def _describe_limit(limit: Mapping[str, Any], units: str) -> str:
    """A limit in words."""
    if limit["kind"] == "happens":
        return "happens" if limit["level"] else "does not happen"
    level = numbers.quantity(limit["level"], units)
    return f"{limit['kind'].replace('_', ' ')} {level}"


def _describe_margin(margin: Mapping[str, Any]) -> str:
    """Describe how a margin was computed, and over which positions."""
    text = f"analysed from {_stretch((margin['first'], margin['last']), margin['unit'])}"
    text += "; no latch or stop states where the travel ends" if margin["travel"] is None else (
        f" of a travel from {_stretch(margin['travel'], margin['unit'])}")  # fmt: skip
    text += " in the nominal run; every other run begins at its own start" * margin["starts_vary"]
    lists = {"without": "without {}", "own": "own factors: {}", "added": "with {}",
             "locked": "{} held"}  # fmt: skip
    words = [form.format(", ".join(margin[key])) for key, form in lists.items() if margin[key]]
    words += [f"without the latch {name}, which catches on the way" for name in margin["latches"]]
    words += [f"without the elastic motor of {name}" for name in margin["motors"]]
    if margin["evidence"] == "spring out":
        words.append("by the factors for a failed spring, not comparable with the intact mechanism")
    return "; ".join([text, *words])


def _is_there(limit: Mapping[str, Any]) -> bool:
    """Return whether a limit requires its quantity to happen."""
    return limit["kind"] != "happens" or bool(limit["level"])
