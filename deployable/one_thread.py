"""Linear algebra on one thread: its sums round otherwise on two, and so would results."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)


def set_environment() -> None:
    """Set the environment variables that keep linear algebra on one thread, in libraries loaded
    later and in processes started by this one; those that Snakemake has set are replaced."""
    os.environ.update(dict.fromkeys(_VARIABLES, "1"))


@contextmanager
def one_thread() -> Iterator[None]:
    """Context manager in which linear algebra, loaded before or not, has one thread, in processes
    started there too; at its end limits and environment variables are as before."""
    import scipy.linalg  # noqa: F401  # its library counts, too, and can only be limited when loaded
    from threadpoolctl import threadpool_limits

    previous = {name: os.environ.get(name) for name in _VARIABLES}
    try:
        set_environment()
        with threadpool_limits(limits=1, user_api="blas"):
            yield
    finally:
        for name, value in previous.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
