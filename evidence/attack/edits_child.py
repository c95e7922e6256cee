"""Runs campaigns of `edits` with the program as it is, in a process of its own each time.

It knows nothing of the program until then; what others wrote is imported once.
"""

import hashlib
import inspect
import json
import os
import signal
import sys
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"

import netCDF4
import numba  # noqa: F401
import numpy as np
import pydantic  # noqa: F401
import scipy.interpolate
import scipy.sparse.csgraph
import scipy.sparse.linalg
import scipy.stats  # noqa: F401
import xarray  # noqa: F401


def numbers_in(path: Path) -> dict[str, str]:
    """A digest of every variable of the samples of a campaign, but for the names of runs."""
    found = {}
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        for variable in file.variables.values():
            values = np.asarray(variable[:])
            text = values.tobytes() if values.dtype.kind in "fiu" else str(values).encode()
            found[variable.name] = hashlib.sha256(text).hexdigest()[:12]
    found.pop("run_id", None)
    return {f"{path.parent.name}/{name}": digest for name, digest in found.items()}


def run(raws: list[dict], results: Path) -> dict:
    """Plan and simulate campaigns, and gather what is kept of their runs, as `campaign.run` does;
    what follows is made anew at every call. The `numbers` of all, or how they failed, and how many
    runs of each were `simulated`."""
    found = {"numbers": {}, "simulated": {}}
    try:
        from deployable.campaign.config.check import check_config
        from deployable.campaign.folder import Folder
        from deployable.campaign.plan.plan import read_plan
        from deployable.campaign.results import kept_extremes, samples
        from deployable.campaign.stages import STAGES

        for raw in raws:
            campaign, folder = check_config(raw), Folder(results / raw["campaign"])
            for stage in (STAGES["plan"], STAGES["simulate"]):
                stage.run(folder, lambda text: None, **stage.sections_of(campaign))
            jobs = campaign.jobs
            collect = kept_extremes.gather if jobs.keep == "extremes" else samples.gather
            collect(read_plan(folder.plan), jobs, folder.runs(jobs.keep), folder.samples)
            found["numbers"] |= numbers_in(folder.samples)
            batches = [json.loads(p.read_text()) for p in folder.path.glob("batches/*.json")]
            found["simulated"][raw["campaign"]] = sum(each["simulated"] for each in batches)
    except Exception as error:
        text = f"{type(error).__name__}: {error}".replace(str(results), "")
        found["numbers"]["failed"] = text
    return found


def answer(asked: dict, place: str) -> dict:
    """What campaigns give in several folders in turn, and the functions of the program that were
    called, if that is asked for."""
    sys.path.insert(0, place)
    called = set()

    def note(frame, event, argument):
        of_function = frame.f_code.co_flags & inspect.CO_OPTIMIZED  # modules and classes are none
        if event == "call" and of_function and frame.f_code.co_filename.startswith(place):
            name = os.path.relpath(frame.f_code.co_filename, place)
            called.add((name, frame.f_code.co_firstlineno))

    if asked["calls"]:
        sys.setprofile(note)
    found = [run(asked["raws"], Path(folder)) for folder in asked["folders"]]
    sys.setprofile(None)
    return {"found": found, "calls": sorted(called)}


def main(place: str) -> None:
    """Answer every line of standard input, a JSON object, by another, from a new process."""
    for line in sys.stdin:
        ends = os.pipe()
        if not (process := os.fork()):
            os.dup2(2, 1)  # where others may print
            signal.alarm(300)  # an edit may make a loop that does not end
            with open(ends[1], "w", encoding="utf-8") as end:
                end.write(json.dumps(answer(json.loads(line), place)))
            os._exit(0)
        os.close(ends[1])
        with open(ends[0], encoding="utf-8") as end:
            text = end.read()
        os.waitpid(process, 0)
        print(text or json.dumps({"found": [], "calls": []}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
