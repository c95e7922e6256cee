"""`python -m deployable`: the commands of `deployable.campaign.cli`."""

import gc
import os
import sys

LIBRARIES = ("OMP", "OPENBLAS", "MKL", "BLIS")
# Linear algebra on one thread, before numpy is loaded: on two, sums and so results round otherwise.
os.environ |= dict.fromkeys((f"{name}_NUM_THREADS" for name in LIBRARIES), "1")
os.environ["VECLIB_MAXIMUM_THREADS"] = "1"
# After each 700 new objects Python looks for circles that nobody uses: a tenth of a short stage.
gc.set_threshold(10_000)
# With its first dataset xarray would load dask for half a second, which nothing uses.
sys.modules.setdefault("dask", None)  # type: ignore[arg-type]


def program() -> int:
    """Run the command line (console script `deployable`) with `sys.argv`, and return the
    exit status; 1 if output cannot be written."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by who started this
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    from deployable.campaign.cli import main
    from deployable.campaign.runs.progress import end_on_ctrl_c

    end_on_ctrl_c()
    try:
        try:
            return main(sys.argv[1:])
        finally:  # of help and versions, too, which end by an exception
            sys.stdout.flush()
    except OSError as error:
        if error.filename is not None:  # not of standard output
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):  # whose reader has seen enough, as `head` has
            print(f"error: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(program())
