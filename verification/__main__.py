"""Run the verification suite: ``python -m verification --output results/verification``.

The exit status tells whether the suite ran, not whether all rows passed: a row that fails stays in
summary.json and table.md as a failing row. ``--strict`` makes failing rows an exit status of 1.
"""

import argparse
import sys
from pathlib import Path

from verification import report, suite


def main(arguments: list[str] | None = None) -> int:
    """Parse the command line, run, write; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m verification", description=__doc__)
    parser.add_argument("--output", type=Path, default=Path("results/verification"))
    parser.add_argument("--quick", action="store_true", help="coarser meshes and shorter runs")
    parser.add_argument("--strict", action="store_true", help="fail if a row fails")
    parser.add_argument("problems", nargs="*", help="names of problems; all by default")
    options = parser.parse_args(arguments)
    known = suite.problems()
    unknown = [name for name in options.problems if name not in known]
    if unknown:
        parser.error(f"unknown problem {unknown[0]!r}; known are: {', '.join(known)}")
    benches = suite.run(options.problems or None, options.quick)
    report.write(benches, options.output)
    rows = [row for bench in benches for row in bench.rows]
    failed = [row for row in rows if not row.passed]
    for row in failed:
        print(f"failed: {row.name}: {row.value:.6g}, expected {row.reference:.6g}")
    print(f"{len(rows)} rows, {len(failed)} failed: {options.output / 'table.md'}")
    return 1 if options.strict and failed else 0


if __name__ == "__main__":
    sys.exit(main())
