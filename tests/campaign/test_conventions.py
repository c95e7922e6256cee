"""Files follow CF-1.8; judged by a checker that is not ours."""

import json
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs/data.md"


@pytest.mark.parametrize(
    "file", ["samples.nc", "bounds.nc", "surrogate.nc", "sensitivities.nc", ""]
)
def test_the_checker_finds_no_error(finished, tmp_path, file):
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
    assert [(row["name"], row["msgs"]) for row in found["high_priorities"] if row["msgs"]] == []


def test_the_page_names_all_files(finished):
    told = set(re.findall(r"`([\w<>/-]+\.(?:nc|json))`", DOCS.read_text(encoding="utf-8")))
    left = {path.name for path in finished.path.iterdir() if path.suffix in (".nc", ".json")}
    assert left <= told
