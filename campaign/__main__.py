"""`python -m campaign`."""

import os
import sys


def program() -> int:
    """The console script `deployable-intervals`."""
    # As jobs of Snakemake have it: more threads of linear algebra would round otherwise. Their
    # library is loaded with this package, and reads the number of threads then.
    if "OMP_NUM_THREADS" not in os.environ:
        os.environ["OMP_NUM_THREADS"] = "1"
        os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])

    from campaign.stopping import end_on_ctrl_c

    end_on_ctrl_c()

    from campaign.cli import main

    return main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(program())
