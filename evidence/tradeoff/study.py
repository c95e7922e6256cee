"""The study "error against cost": its parts, rows and tables."""

from collections.abc import Mapping
from dataclasses import replace

from evidence.results import Report
from evidence.tradeoff.measure.cases import CASES
from evidence.tradeoff.measure.records import measure_case
from evidence.tradeoff.measure.tolerance_cases import ACCURACY_CASES
from evidence.tradeoff.measure.tolerances import measure_targets
from evidence.tradeoff.rows import all_rows, case_text
from evidence.tradeoff.tolerance_rows import accuracy_rows, accuracy_text

# Each is measured by a process of its own, so that cpu times are those of one core.
PARTS = {case.name: lambda quick, case=case: measure_case(case) for case in CASES}
PARTS |= {
    f"asked-{case.name}": lambda quick, case=case: measure_targets(case) for case in ACCURACY_CASES
}


def report(parts: Mapping[str, dict]) -> Report:
    """The claims, and every number of every case."""
    accuracy = [data for name, data in parts.items() if name.startswith("asked-")]
    cases = {name: data for name, data in parts.items() if not name.startswith("asked-")}
    rows = [
        replace(row, group=f"{c['case']}, accuracy") for c in accuracy for row in accuracy_rows(c)
    ]
    texts = [*map(case_text, cases.values()), *map(accuracy_text, accuracy)]
    return Report(all_rows(cases) + rows, text="".join(texts))
