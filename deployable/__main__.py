"""`python -m deployable`: the commands of `deployable.campaign.cli`."""

import gc
import os
import sys
from importlib.util import LazyLoader, find_spec, module_from_spec
from typing import Any

from deployable import check_fpm_module
from deployable.one_thread import set_environment

set_environment()  # before numpy is loaded
import numpy  # noqa: E402

# scipy takes all names of numpy: Fortran's tools and `unittest` too, which take 0.1 s to load.
for _name in ("f2py", "testing"):
    _spec: Any = find_spec(f"numpy.{_name}")
    _spec.loader = LazyLoader(_spec.loader)
    sys.modules[_spec.name] = module_from_spec(_spec)
    _spec.loader.exec_module(sys.modules[_spec.name])
    setattr(numpy, _name, sys.modules[_spec.name])
# After each 700 new objects Python looks for circles that nobody uses: a tenth of a short stage.
gc.set_threshold(10_000)
# Nothing here is an array of dask, which xarray would load to see so, where it is installed.
sys.modules.setdefault("dask", None)  # type: ignore[arg-type]  # so Python marks what it does not load


def program() -> int:
    """Run the command line (console script `deployable-intervals`) with `sys.argv`. Ends the
    process with the command's exit status; returns 1 if it cannot start or write output."""
    if message := check_fpm_module():
        print(message, file=sys.stderr)
        return 1
    from deployable.campaign.interrupts import end_on_ctrl_c, leave

    end_on_ctrl_c()
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by who started this
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115

    from deployable.campaign.cli import main

    try:
        try:
            status = main(sys.argv[1:])
        finally:  # of help and versions, too, which end by an exception
            sys.stdout.flush()
        leave(status)
    except OSError as error:
        if error.filename is not None:  # not of standard output
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):  # whose reader has seen enough, as `head` has
            print(f"error: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(program())
