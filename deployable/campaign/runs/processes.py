"""Several processes that share work, and what was made before them: the compiled time loop."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from deployable.campaign.errors import CampaignError

_WORK: dict[str, Any] = {}
"""What the processes inherit, since it need not be sent to them then."""


def spread(function: Callable, work: Sequence[tuple], processes: int) -> Iterator[Any]:
    """`function(*arguments)` for all arguments in `work`, as they end, by so many processes.

    They are copies of this one, so that what it has loaded is there once. Raises what a function
    raises, and `CampaignError` if a process was ended from outside.
    """
    processes = min(processes, len(work))
    if processes < 2:
        yield from (function(*arguments) for arguments in work)
        return
    _WORK.update(function=function, work=work)
    context = multiprocessing.get_context("fork")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        try:
            for done in as_completed([pool.submit(_one, number) for number in range(len(work))]):
                yield done.result()
        except BrokenProcessPool:
            raise CampaignError(
                "a process of this job was ended from outside, for lack of memory perhaps; "
                "finished runs are kept"
            ) from None
        finally:
            pool.shutdown(cancel_futures=True)
            _WORK.clear()


def _one(number: int) -> Any:
    return _WORK["function"](*_WORK["work"][number])
