"""Rows and tables of one key for accuracy: what was asked for, what was true, and what it cost."""

from evidence.results import table
from evidence.rows import Row, at_least, at_most, skip_row

TRUE = "this study: a scan on a finer mesh"
MIN_SHARE, MAX_RATIO, MAX_COST = 0.9, 3.0, 0.4
"""Share of the accuracies that are to be kept, how far estimates may be from the truth in the
median, and the cost beside the best rival that is as accurate. Set before the first
measurement."""


def accuracy_rows(case: dict) -> list[Row]:
    """The rows of a case: whether it is what was asked for, how good estimates are, its cost."""
    met_rows = [row for row in case["asked"] if row["met"]]
    name = f"{case['case']}, accuracy"
    rows = []
    if met_rows:
        successes = [e["most"] <= row["share"] for row in met_rows for e in row["errors"]]
        worst = max(e["most"] / row["share"] for row in met_rows for e in row["errors"])
        text = f"{name}: of those told to be met, true in 90 % of the instants"
        note = f"{len(met_rows)} of {len(case['asked'])} met; at worst {worst:.2g} of the target"
        rows.append(at_least(text, sum(successes) / len(successes), MIN_SHARE, TRUE, note))
    errors = [error for row in case["asked"] for error in row["errors"]]
    ratios = sorted(e["told"] / max(e["share"], 1e-12) for e in errors)
    median = ratios[len(ratios) // 2]
    note = f"{ratios[0]:.2g} to {ratios[-1]:.2g}"
    text = f"{name}: estimate over truth, median, or its inverse"
    rows.append(at_most(text, max(median, 1 / median), MAX_RATIO, TRUE, note))
    covers = min(e["covers"] for e in errors)
    rows.append(
        at_least(f"{name}: instants that the estimate covers, least", covers, MIN_SHARE, TRUE)
    )
    return rows + [_cost_row(name, case, row) for row in case["asked"]]


def _cost_row(name: str, case: dict, row: dict) -> Row:
    """The cost of one accuracy over that of the cheapest rival whose true error is no larger."""
    text = f"{name}: cpu time of {row['share']:g} over that of the best rival"
    error = _worst(row)
    rivals = [rival for rival in case["rivals"] if _worst(rival) <= error]
    if not rivals:
        return skip_row(text, f"none of those tried is as accurate ({error:.2g} of the width)")
    best = min(rivals, key=lambda rival: rival["cpu"])
    note = f"{row['cpu']:.3g} s for {error:.2g}; {best['name']}: {best['cpu']:.3g} s for "
    return at_most(text, row["cpu"] / best["cpu"], MAX_COST, TRUE, f"{note}{_worst(best):.2g}")


def _worst(row: dict) -> float:
    return max(error["share"] for error in row["errors"])


def accuracy_text(case: dict) -> str:
    """Every number of a case as Markdown."""
    head = ["", "met", "mesh", "rounds", "runs", "cpu (s)"]
    for name in case["responses"]:
        head += [f"{name} true", f"{name} estimate", f"{name} in 90 % of the instants"]
    body = []
    for row in (*case["asked"], *case["rivals"]):
        mesh = ", ".join(str(number) for number in (row["mesh"] or {}).values())
        label = f"accuracy {row['share']:g}" if "share" in row else row["name"]
        line = [label, row["met"], mesh, row["rounds"], row["runs"], float(row["cpu"])]
        for error in row["errors"]:
            line += [error["share"], error["told"], error["most"]]
        body.append(line)
    reasons = [f"- {r['share']:g}: {r['reason']}\n" for r in case["asked"] if r["met"] is False]
    text = "\nNot met:\n\n" + "".join(reasons) if reasons else ""
    return f"\n## One key for accuracy: {case['title']}\n\n" + table(head, body) + text
