"""Run the benchmark: `python -m benchmark [--output FOLDER] [--quick] [--only PART ...]`."""

import argparse
import sys
import time

import fpm
from benchmark import campaigns, kernel, kinds, machine, overheads, peers, plot
from benchmark.rows import Row, table, write_results

PARTS = {
    "cost": lambda n: kernel.cost(20_000 // n, 5),
    "cores": lambda n: kernel.cores(20_000 // n, 8),
    "recording": lambda n: kernel.recording(60_000 // n, 8),
    "memory": lambda n: kernel.memory(10_000 // n),
    "kinds": lambda n: kinds.kinds(20_000 // n, 8),
    "machine": lambda n: machine.peak(20_000 // n, 8),
    "starting": lambda n: overheads.starting(3),
    "surrogate": lambda n: overheads.surrogate(3),
    "writing": lambda n: overheads.writing(3),
    "campaign": lambda n: campaigns.paper(),
    "exudyn": lambda n: peers.exudyn(0.1, 3),
    "elastica": lambda n: peers.elastica(0.02, 3),
}


def measure(parts: list[str], quick: bool = False) -> list[Row]:
    """The rows of some parts; `quick`: runs of a tenth of the length."""
    fpm.warm_up()
    rows = []
    for part in parts:
        start = time.perf_counter()
        rows += PARTS[part](10 if quick else 1)
        print(f"{part}: {time.perf_counter() - start:.0f} s", file=sys.stderr, flush=True)
    order = list(dict.fromkeys(row.group for row in rows))
    return sorted(rows, key=lambda row: order.index(row.group))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", help="folder for summary.json, table.md and the plot")
    parser.add_argument("--quick", action="store_true", help="shorter runs, noisier figures")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), metavar="PART")
    options = parser.parse_args()
    about = machine.describe()
    rows = measure(options.only, options.quick)
    if options.output:
        write_results(options.output, rows, about)
        plot.costs(rows, options.output)
    print(table(rows))


if __name__ == "__main__":
    main()
