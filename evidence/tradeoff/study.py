"""The study "error against cost": its parts, rows, tables and plots."""

from collections.abc import Mapping
from dataclasses import replace

from evidence.results import Report
from evidence.tradeoff.figures import draw_pareto
from evidence.tradeoff.measure.cases import CASES
from evidence.tradeoff.measure.peers import measure_peers
from evidence.tradeoff.measure.records import measure_case
from evidence.tradeoff.measure.tolerance_cases import ACCURACY_CASES
from evidence.tradeoff.measure.tolerances import measure_targets
from evidence.tradeoff.rows import all_rows
from evidence.tradeoff.tables import case_text
from evidence.tradeoff.tolerance_rows import accuracy_rows, accuracy_text

# Each is measured by a process of its own, so that cpu times are those of one core.
PARTS = {case.name: lambda quick, case=case: measure_case(case) for case in CASES}
PARTS["peers"] = lambda quick: measure_peers()
PARTS |= {
    f"asked-{case.name}": lambda quick, case=case: measure_targets(case) for case in ACCURACY_CASES
}


def report(parts: Mapping[str, dict]) -> Report:
    """The claims, every number of every case, and the fronts of error against cost."""
    accuracy = [data for name, data in parts.items() if name.startswith("asked-")]
    rest = {name: data for name, data in parts.items() if not name.startswith("asked-")}
    cases = {name: data for name, data in rest.items() if name != "peers"}
    rows = [
        replace(row, group=f"{c['case']}, accuracy") for c in accuracy for row in accuracy_rows(c)
    ]
    return Report(
        all_rows(cases, parts.get("peers")) + rows,
        text="".join([*map(case_text, cases.values()), *map(accuracy_text, accuracy)]),
        figures={f"pareto_{name}": draw_pareto(case) for name, case in cases.items()},
    )
