"""The review sheet: each clause of a standard with what a campaign showed of it, as rows of text.

Nothing in it claims compliance: it says what an analysis of a model showed, of what was stated.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from deployable.campaign.files import csv_text
from deployable.campaign.results.facts import decisive
from deployable.campaign.text import numbers
from fpm.reading.standards import STANDARDS

COLUMNS = ("clause", "asks", "analysed", "value", "verdict", "nearest")
HEADS = {
    "clause": "clause", "asks": "what it asks", "analysed": "how it was analysed",
    "value": "value, with its interval", "verdict": "verdict", "nearest": "nearest to failing",
}  # fmt: skip

NOT_ANALYSED = "not analysed"


class Clause(NamedTuple):
    """number; asks: in one's own words; by: what analyses it, a topic of quantities or a name of
    OTHERS."""

    number: str
    asks: str
    by: str


CLAUSES = {
    "ecss-e-st-33-01c": (
        Clause("4.7.5.2", "stresses and tensions within allowables, with factors of safety: metals "
               "1.25 (yield), 1.5 (ultimate), 4 (fatigue); cables 3; stops 2 on yield", "stress"),
        Clause("4.7.5.3", "at every position of the travel at least the actuation Tmin, without "
               "kinetic energy", "margin"),
        Clause("4.7.5.3", "springs are redundant, or single ones justified", "redundant"),
        Clause("4.7.5.4.3", "latches catch over all temperatures, gradients and tolerances",
               "latches"),
        Clause("4.7.5.4.3", "a first miss does not prevent a latch from catching later", "misses"),
        Clause("4.7.5.4.4", "stops bear the largest shock, with margins", "stop"),
        Clause("4.7.5.4.8", "clearance of at least three times its tolerance, with thermoelastic "
               "effects", "clearance"),
        Clause("4.8.2.1", "effects on ground told apart from those in orbit", ""),
        Clause("4.8.2.5", "budgets of preload and tolerance", "budget"),
        Clause("4.8.2.6", "conformance at the worst combinations of parameters", "together"),
        Clause("4.8.2.6", "failure cases", "failure"),
        Clause("4.8.2.6", "integrity of the model, by a balance of energy or momentum", "balance"),
        Clause("4.8.2.6", "sensitivity to the uncertainty of parameters", "influence"),
        Clause("4.8.2.11", "shock that the mechanism makes", "shock"),
    ),
}  # fmt: skip
"""By standard, as in `fpm.reading.standards` (edition of 6 March 2009)."""

ENDS = {
    "not met": ("some", "none"),
    "no failure found, which proves nothing of the rest of the box": ("open",),
    "met in all of the box": ("all",),
}
"""How requirements end, in words, by what is said of them (`answers.requirements`)."""

TOPICS = {
    "stress": "stress", "section_force": "stress", "section_moment": "stress", "tension": "stress",
    "clearance": "clearance", "acceleration": "shock", "latch_impulse": "shock",
    "latch_impact": "shock", "latch_moment": "shock", "constraint_force": "shock",
    "reaction_force": "shock", "latches": "latches", "misses": "misses",
}  # fmt: skip
"""Topics by kinds of response and by events of which quantities are."""


def rows_of(facts: Mapping[str, Any], experiment: Any, standard: str) -> list[dict[str, str]]:
    """The rows of a standard's sheet from the facts of a campaign (`facts.facts_of`)."""
    sheet = _Sheet(facts, experiment, STANDARDS[standard].title)
    return [row for clause in CLAUSES[standard] for row in sheet.rows(clause)] + sheet.others()


def head_of(facts: Mapping[str, Any], rows: Sequence[Mapping[str, str]]) -> list[str]:
    """What stands above the rows: how it ends, over which box, and how to read the numbers."""
    ends = []
    for words, met in ENDS.items():
        if names := [row["name"] for row in facts.get("requirements", ()) if row["met"] in met]:
            ends.append(f"{words}: {', '.join(names)}")
    left = list(dict.fromkeys(row["clause"] for row in rows if row["verdict"] == NOT_ANALYSED))
    ends += [f"{NOT_ANALYSED}, in whole or in part: {', '.join(left)}"] if left else []
    box = (
        f"{p['description'] or p['name']} ({p['name']}) from {numbers.number(p['lower'], 4)} to "
        f"{numbers.quantity(p['upper'], p['units'], 4)}"
        for p in facts["parameters"]
    )
    return [
        f"{numbers.capitalised('; '.join(ends))}.",
        f"The box: {'; '.join(box)}. All else is as the structure's file states it.",
        "By analysis of a model, for what the campaign states; no claim of compliance. A margin is "
        "what drives over what is required, less 1; ± is the error at either end of an interval; "
        "a share of the box is no probability.",
    ]


def as_csv(rows: Iterable[Mapping[str, str]]) -> str:
    """The sheet as CSV, with heads."""
    return csv_text([row[name] for name in COLUMNS] for row in (HEADS, *rows))


class _Sheet:
    def __init__(self, facts: Mapping[str, Any], experiment: Any, title: str):
        self.facts, self.title = facts, title
        self._numbers = {number.name: number for number in experiment.numbers}
        self._tolerance = experiment.solver.energy_tolerance
        self._limits: dict[str, tuple] = {}  # the requirement and the limit of each quantity
        for row in facts.get("requirements", ()):
            for limit in row["limits"]:
                self._limits.setdefault(limit["quantity"], (row, limit))
        self._used: set[str] = set()

    def rows(self, clause: Clause) -> list[dict[str, str]]:
        """A row for each quantity that says something of a clause; one that says that none does."""
        if clause.by in OTHERS:
            found = [found] if (found := OTHERS[clause.by](self)) else []
        else:
            found = [self._row(row) for row in self._about(clause.by)] if clause.by else []
        none = {"analysed": "", "value": "", "verdict": NOT_ANALYSED, "nearest": ""}
        return [{"clause": clause.number, "asks": clause.asks, **row} for row in found or [none]]

    def others(self) -> list[dict[str, str]]:
        """Margins by other standards, and requirements of quantities that no clause is about."""
        found = []
        for row in self.facts["quantities"]:
            name, number = row["name"], self._numbers[row["name"]]
            if name in self._used or name not in self._limits:
                continue
            of = number.response
            margin = of is not None and of.kind == "margin"
            clause = STANDARDS[_standard(of)].title if margin else "own"
            asks = (
                "margin of at least 0 at every position"
                if margin
                else self._limits[name][0]["name"]
            )
            found.append({"clause": clause, "asks": asks, **self._row(row)})
        return found

    def _about(self, topic: str) -> list[Mapping[str, Any]]:
        """Quantities of a topic; margins, and those with parts out, are those by this standard,
        failure cases those by any."""
        return [row for row in self.facts["quantities"] if topic in self._topics(row["name"])]

    def _topics(self, name: str) -> set[str]:
        number = self._numbers[name]
        of = number.response
        if of is None:
            return {TOPICS.get(number.event, "")}
        if of.kind == "margin":
            left, own = _left_out(of), STANDARDS[_standard(of)].title == self.title
            topics = {"failure": left, "redundant": left and own, "margin": own and not left}
            return {topic for topic, of_it in topics.items() if of_it}
        if of.kind == "joint_moment" and of.about[1] == "stop":
            return {"stop"}
        return {TOPICS.get(of.kind, "")}

    def _row(self, row: Mapping[str, Any]) -> dict[str, str]:
        """What a quantity says: its interval, and whether its limit is kept."""
        self._used.add(row["name"])
        parameters, name = self.facts["parameters"], row["name"]
        value = f"{numbers.interval(row)} ± {numbers.quantity(row['error'], row['units'], 2)}"
        if row["lower"] is None:
            value = "happens in no run"
        requirement, limit = self._limits.get(name, (None, None))
        if requirement is None:
            return {"analysed": f"{name}: {row['long_name']}", "value": value,
                    "verdict": "told; no limit was stated", "nearest": ""}  # fmt: skip
        level = {"at_least": "at least", "at_most": "at most"}.get(limit["kind"], "")
        asked = f"{level} {numbers.quantity(limit['level'], row['units'])}" if level else "happens"
        of, near = self._numbers[name].response, numbers.place(limit["at"], parameters)
        if not level and requirement["met"] in ("all", "open"):
            near = ""  # what always happens is as far from failing everywhere
        elif limit["simulated"] is not None:
            near += f": {numbers.quantity(limit['simulated'], row['units'], 4)}, simulated"
        return {
            "analysed": f"{name}: {row['long_name']}; {asked}{_own_factors(of)}", "value": value,
            "verdict": _verdict(requirement), "nearest": near,
        }  # fmt: skip

    def together(self) -> dict[str, str] | None:
        """What of the box meets all requirements."""
        if "together" not in self.facts:
            return None
        names = ", ".join(p["name"] for p in self.facts["parameters"])
        rows = self.facts["requirements"]
        failing = ", ".join(row["name"] for row in rows if row["met"] in ENDS["not met"])
        return {
            "analysed": f"all requirements together, over the box of {names}; "
            f"{self.facts['runs']['all']} runs, worst places simulated",
            "value": f"not met: {failing}" if failing else "",
            "verdict": _verdict(self.facts["together"]), "nearest": "",
        }  # fmt: skip

    def balance(self) -> dict[str, str]:
        """The balance of energy, which every run keeps that there is."""
        return {
            "analysed": f"every run, at every instant: {self.facts['runs']['all']} runs",
            "value": f"off by less than {numbers.percent(self._tolerance)} of the largest energy",
            "verdict": "met: runs that do not keep it fail", "nearest": "",
        }  # fmt: skip

    def influence(self) -> dict[str, str] | None:
        """The parameter that widens each quantity most."""
        found = [f"{row['name']} by {name} ({numbers.percent(row['influence'][name]['share'])})"
                 for row in self.facts["quantities"] if (name := decisive(row))]  # fmt: skip
        return found and {
            "analysed": "shares of the widths of quantities, by their surrogates",
            "value": "most: " + ", ".join(found), "verdict": "told", "nearest": "",
        }  # fmt: skip

    def budget(self) -> dict[str, str] | None:
        """How wide intervals of quantities are, and with half of the tolerance that counts most."""
        found = []
        for row in self.facts["quantities"]:
            if name := decisive(row):
                now, half = row["surrogate_upper"] - row["surrogate_lower"], row["influence"][name]
                widths = (numbers.quantity(x, row["units"], 2) for x in (now, half["halved"]))
                found.append("{}: {}, {} with half the tolerance of {}".format(
                    row["name"], *widths, name))  # fmt: skip
        return found and {
            "analysed": "widths of intervals, and with half of the tolerance that widens each most",
            "value": "; ".join(found), "verdict": "told", "nearest": "",
        }  # fmt: skip


OTHERS = {"together": _Sheet.together, "balance": _Sheet.balance, "influence": _Sheet.influence,
          "budget": _Sheet.budget}  # fmt: skip
"""What analyses clauses that are about no quantity."""


def _standard(margin: Any) -> str:
    """The name of the standard of a margin (`fpm.reading.margins`)."""
    return next(word for word in margin.about if word in STANDARDS)


def _left_out(margin: Any) -> bool:
    """Whether a margin is one with parts that are out."""
    return margin.about.index(_standard(margin)) + 2 < len(margin.about)


def _own_factors(response: Any) -> str:
    """That a margin is by factors of its own, where it could be taken for one of the others."""
    if response is None or response.kind != "margin" or "spring out" not in response.about:
        return ""
    return "; by the factors for that case, so not to be compared with the intact mechanism's"


def _verdict(row: Mapping[str, Any]) -> str:
    """What is said of a requirement (`answers.requirements`)."""
    if row["met"] == "open":
        return f"no failure found in {row['runs']} runs, which proves nothing of the rest"
    if row["met"] == "all":
        return "met in all of the box, by analysis"
    if row["met"] == "none":
        return "not met anywhere in the box"
    return f"not met: only in {numbers.share(row['share'], row['open'])} of the box"
