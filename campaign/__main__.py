"""`python -m campaign`."""

import os
import sys

# As jobs of Snakemake have it: more threads of linear algebra would round otherwise.
os.environ.setdefault("OMP_NUM_THREADS", "1")


def program() -> int:
    """The console script `deployable-intervals`."""
    try:
        from campaign.cli import main

        return main(sys.argv[1:])
    except KeyboardInterrupt:
        print(
            "stopped; finished runs are kept, the same command goes on from there", file=sys.stderr
        )
        return 130


if __name__ == "__main__":
    sys.exit(program())
