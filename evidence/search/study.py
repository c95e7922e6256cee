"""The study of bounds and fractions: mechanisms whose bounds are known, by whole campaigns, and
boxes whose numbers are closed forms."""

from collections.abc import Mapping
from functools import partial

from evidence.results import Report
from evidence.search import fractions, mechanisms

PARTS = {
    **{
        part: partial(mechanisms.measure, f"mechanisms_{part}")
        for part in ("carts", "slides", "chains")
    },
    "fractions": fractions.measure,
}


def report(parts: Mapping[str, list]) -> Report:
    """What the study claims of all boxes that were measured, and all as tables."""
    checks = [check for name, part in parts.items() if name != "fractions" for check in part]
    reports = [mechanisms.report(checks)] if checks else []
    reports += [fractions.report(parts["fractions"])] if "fractions" in parts else []
    extra = {key: value for report in reports for key, value in report.extra.items()}
    rows = [row for report in reports for row in report.rows]
    return Report(rows, extra, "".join(report.text for report in reports))
