"""Files follow CF-1.8 but for what docs/data.md says; judged by a checker that is not ours."""

import json
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs/data.md"

# Of the sections in which the checker may complain: that simulated time begins at no date.
KNOWN = {"3.1": "units", "4.4": "time"}


@pytest.mark.slow  # to import the checker takes seconds
@pytest.mark.parametrize(
    "file", ["samples.nc", "bounds.nc", "surrogate.nc", "sensitivities.nc", ""]
)
def test_the_checker_finds_no_error_but_that_time_has_no_date(finished, tmp_path, file):
    runner = pytest.importorskip(
        "compliance_checker.runner", reason="compliance-checker is not installed"
    )
    path = finished / file if file else next((finished / "trajectories").glob("*.nc"))
    runner.CheckSuite.load_all_available_checkers()
    report = tmp_path / "report.json"
    runner.ComplianceChecker.run_checker(
        str(path), ["cf:1.8"], 0, "lenient", output_filename=str(report), output_format="json"
    )
    (found,) = json.loads(report.read_text()).values()
    errors = [(row["name"], message) for row in found["high_priorities"] for message in row["msgs"]]
    unknown = [e for e in errors if not any(s in e[0] and w in e[1] for s, w in KNOWN.items())]
    assert not unknown
    assert all("time" in message for _, message in errors)


def test_the_page_names_all_files(finished):
    told = set(re.findall(r"`([\w<>/-]+\.(?:nc|json))`", DOCS.read_text(encoding="utf-8")))
    left = {path.name for path in finished.path.iterdir() if path.suffix in (".nc", ".json")}
    assert left <= told
