"""Facts of a campaign's cases together, from the summary of each: the content of `cases.json`.
`summary.schema.json` describes its keys (`$defs.cases`)."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from operator import itemgetter
from typing import Any

from deployable.campaign.config.cases import folder_name
from deployable.campaign.files import read_json
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import read_plan
from deployable.campaign.results.display import shown_facts
from deployable.campaign.results.quantity_results import whole_error
from deployable.campaign.results.templates import doubts, sentence
from deployable.campaign.text.numbers import place, quantity, spread

Severity = Callable[[Mapping], tuple]

_QUESTIONS = {
    "Which tolerance is worth tightening?": "tolerance",
    "Which nominal value is best?": "choice",
}
"""Questions that each case answers by itself, and the macro of the answer."""

_RELIANCE = "sound_numbers", "unsound_curves", "independence", "covered"

GROUPS = {"none": 0, "some": 0, "undecided": 1, "all": 2}  # which verdicts decide before others


def cases_facts(
    folder: Folder, cases: Mapping[str, Mapping], is_shown: bool = False
) -> dict[str, Any]:
    """Collect what all cases answer as plain data for `cases.json`; folder: of the campaign's
    results, with each case's below it; cases: what each case changes, by its name; is_shown:
    whether numbers are in the units of `display`."""
    folders = {name: Folder(folder / folder_name(name)) for name in cases}
    summaries = {name: read_json(child / "summary.json") for name, child in folders.items()}
    changes = {name: _changes_text(cases[name], facts) for name, facts in summaries.items()}
    for name, child in folders.items() if is_shown else ():
        summaries[name] = shown_facts(summaries[name], read_plan(child.plan).experiment)
    return facts_of_cases(folder.path.name, folders, summaries, changes)


def facts_of_cases(
    campaign: str,
    folders: Mapping[str, Folder],
    summaries: Mapping[str, Mapping],
    changes: Mapping[str, str],
) -> dict[str, Any]:
    """Collect what several results answer together as plain data. campaign: what they are of;
    folders, summaries, changes: where each is, its facts, what differs in it in words, by name."""
    sizes: dict[str, float] = {}  # largest levels of quantities
    rows = (row for facts in summaries.values() for row in facts.get("requirements", ()))
    for limit in (limit for row in rows for limit in row["limits"]):
        sizes[limit["quantity"]] = max(sizes.get(limit["quantity"], 0.0), abs(limit["level"]))

    def severity(limit: Mapping) -> tuple:
        """A sort key, smallest for what decides: by verdict, margin over level, share, name."""
        margin = _margin(limit) / (sizes[limit["quantity"]] or 1.0)
        return GROUPS[limit["met"]], margin, limit["share"], limit["case"]

    requirements = [*_requirements(summaries, severity)]
    verdicts = {name: facts.get("together") for name, facts in summaries.items()}
    # Cases that fail come first: what they ask for is to be read before the rest.
    order = sorted(summaries, key=lambda name: GROUPS[(verdicts[name] or {"met": "all"})["met"]])
    notes = _group_texts((name, text) for name in order for text in _notes(summaries[name]))

    def say(macro: str) -> list[dict[str, Any]]:
        return _group_texts(
            (name, sentence(macro, summaries[name], escapes=False)) for name in order
        )

    return {
        "campaign": campaign,
        "cases": [
            {
                "name": name,
                "folder": child.path.name,
                "page": child.report.exists(),
                "changes": changes[name],
                "headline": " ".join(
                    sentence(macro, summaries[name], escapes=False).strip()
                    for macro in ("headline", "tested")
                ).strip(),
                "together": verdicts[name],
            }
            for name, child in folders.items()
        ],
        "requirements": requirements,
        "quantities": [*_quantities(summaries)],
        "together": {
            "met": combine_met(row["met"] for row in filter(None, verdicts.values())),
            "failing": _select_cases(verdicts, "none", "some"),
            "undecided": _select_cases(verdicts, "undecided"),
            "free": [name for name, verdict in verdicts.items() if not verdict],
        } if requirements else None,
        "worst": min((row["worst"] for row in requirements), key=severity, default=None),
        "next": max(  # that separates runs most: in bands, or unmeasured, as a share of the width
            ({**row, "case": name} for name, facts in summaries.items()
             for row in facts.get("measured", {}).get("next", ())[:1]),
            key=lambda row: (row["bands"] or 0.0, row["fraction"]), default=None,
        ),
        "runs": sum(facts["runs"]["all"] for facts in summaries.values()),
        "answers": {question: say(macro) for question, macro in _QUESTIONS.items()},
        "reliance": [row for macro in _RELIANCE for row in say(macro)],
        "notes": notes,
    }  # fmt: skip


def combine_met(verdicts: Iterable[str]) -> str:
    """Combine the verdicts on a requirement in several cases: `all` if each case meets it, `none`
    if each fails everywhere, `some` if any fails, otherwise `undecided`. verdicts: by case."""
    verdicts = set(verdicts)
    if len(verdicts) == 1:
        return verdicts.pop()
    return "some" if verdicts & {"none", "some"} else "undecided"


def _verdict(by_case: Mapping[str, Mapping]) -> dict[str, Any]:
    """Return the verdict on what stands in some cases, and which of these decide it."""
    return {
        "met": combine_met(row["met"] for row in by_case.values()),
        "cases": list(by_case),
        "failing": _select_cases(by_case, "none", "some"),
        "undecided": _select_cases(by_case, "undecided"),
    }


def _select_cases(rows: Mapping[str, Mapping | None], *verdicts: str) -> list[str]:
    """Names of the cases of which a verdict is one of these."""
    return [name for name, row in rows.items() if row and row["met"] in verdicts]


def _group(summaries: Mapping[str, Mapping], section: str) -> dict[str, dict[str, dict]]:
    """Rows of a section of the summaries, by their name, then by case."""
    by_name: dict[str, dict[str, dict]] = {}
    for case, facts in summaries.items():
        for row in facts.get(section, ()):
            by_name.setdefault(row["name"], {})[case] = row
    return by_name


def _requirements(summaries: Mapping[str, Mapping], severity: Severity) -> Iterator[dict[str, Any]]:
    """Combine each requirement of any case over all of its cases."""
    for name, by_case in _group(summaries, "requirements").items():
        limits: dict[tuple, dict[str, Mapping]] = {}
        for case, limit in ((case, x) for case, row in by_case.items() for x in row["limits"]):
            location = place(limit["at"], summaries[case]["parameters"])
            key = limit["quantity"], limit["kind"], limit["level"]  # each has its margins
            details = {**limit, "requirement": name, "case": case, "where": location}
            limits.setdefault(key, {})[case] = details
        comparisons = [_compare(group, [*summaries], severity) for group in limits.values()]
        worst = min((limit["worst"] for limit in comparisons), key=severity)
        yield {"name": name, **_verdict(by_case), "worst": worst, "limits": comparisons}


def _compare(limits: Mapping[str, Mapping], cases: list[str], severity: Severity) -> dict[str, Any]:
    """Compare one limit over its cases, and find the worst of these."""
    worst = min(limits.values(), key=severity)
    peers = {
        case: row for case, row in limits.items() if GROUPS[row["met"]] == GROUPS[worst["met"]]
    }
    close = [c for c, row in peers.items() if row is not worst and _is_same(row, worst, _margin)]
    keys = ("quantity", "units", "words", "event", "kind", "level")
    return {
        **{key: worst[key] for key in keys if key in worst},
        **_verdict(limits),
        "worst": {**worst, "close": close},
        "by_case": [limits.get(case) for case in cases],
    }


def _margin(limit: Mapping) -> float:
    """Return the margin of a limit; infinite where there is none, as it is kept or not."""
    if limit["margin"] is not None:
        return limit["margin"]
    return math.inf if limit["kept"] else -math.inf


def _is_same(row: Mapping, reference: Mapping, read: Callable[[Mapping], float]) -> bool:
    """Return whether numbers of two rows differ by at most both errors, or are infinite alike."""
    first, last = read(row), read(reference)
    if math.inf in (abs(first), abs(last)):
        return first == last
    return None in (row["error"], reference["error"]) or (
        abs(first - last) <= row["error"] + reference["error"]
    )


def _quantities(summaries: Mapping[str, Mapping]) -> Iterator[dict[str, Any]]:
    """Return the interval of each quantity in each case, and over all."""
    keys = "lower upper error units happens happens_uncertainty runs_without predicted_ends"
    for by_case in _group(summaries, "quantities").values():
        first = next(iter(by_case.values()))
        ends: dict[str, Any] = {}
        for row in by_case.values():
            row["error"] = whole_error(row)
        for end, choose in (("lower", min), ("upper", max)):
            values = {c: row for c, row in by_case.items() if row[end] is not None}
            last = choose(values.values(), key=itemgetter(end), default={end: None})
            ends[end], ends[f"{end}_error"] = last[end], last.get("error")
            ends[f"{end}_cases"] = [
                c for c, row in values.items() if _is_same(row, last, itemgetter(end))
            ]
        yield {
            **{key: first[key] for key in ("name", "units", "long_name", "words") if key in first},
            **ends,
            "censored_cases": [case for case, row in by_case.items() if row["censored_at"]],
            "never": [case for case, row in by_case.items() if row["lower"] is None],
            "by_case": [
                {key: by_case[case].get(key) for key in (*keys.split(), "may_be_endless")}
                if case in by_case
                else None
                for case in summaries
            ],
        }


def _changes_text(changes: Mapping[str, Any], facts: Mapping) -> str:
    """Describe the changes of a case, with units."""
    units = {row["name"]: row["units"] for row in facts["fixed"]}
    spreads = {row["name"]: f"{quantity(row['nominal'], row['units'], 6)}, {spread(row)}"
               for row in facts["parameters"]}  # fmt: skip
    texts = [f"structure {facts['scene']}"] * ("file" in changes)
    for name, value in changes.get("scene", {}).items():
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        texts.append(f"{name} = {quantity(value, units[name], 6) if is_number else value}")
    texts += [f"{name} = {spreads[name]}" for name in changes.get("intervals", {})]
    if changes.get("solver"):
        texts.append(f"duration = {quantity(facts['duration'], 's', 6)}")
    return "; ".join(texts) or "the campaign as it stands"


def _notes(facts: Mapping) -> list[str]:
    """List what makes the numbers of a case doubtful, beside what it says of its reliance."""
    notes = [f"{text}." for text in doubts(facts)]
    if "accuracy" in facts and not facts["accuracy"]["met"]:
        notes.append(sentence("accuracy", facts, escapes=False))
    notes.append(sentence("missed", facts, False, escapes=False))
    return [*notes, sentence("mixed", facts, escapes=False)]


def _group_texts(texts: Iterable[tuple[str, str]]) -> list[dict[str, Any]]:
    """Group cases (first of each pair) by what is said of them (last), in the order of texts."""
    cases: dict[str, list[str]] = {}
    for case, text in texts:
        cases.setdefault(text.strip(), []).append(case)
    return [{"text": text, "cases": names} for text, names in cases.items() if text]
