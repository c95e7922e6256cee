"""Runs campaigns of `edits` with the program as it is, in a process of its own each time.

It knows nothing of the program until then; what others wrote is imported once."""

import gc
import hashlib
import importlib
import inspect
import json
import os
import re
import signal
import sys
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"

import netCDF4
import numba
import numpy as np
import pydantic  # noqa: F401
import scipy.interpolate
import scipy.sparse.csgraph
import scipy.sparse.linalg
import scipy.stats  # noqa: F401
import xarray  # noqa: F401
from numba.core.dispatcher import Dispatcher


def numbers_in(path: Path) -> dict[str, str]:
    """A digest of every variable of the samples of a campaign, but for the names of runs."""
    digests = {}
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        for variable in file.variables.values():
            values = np.asarray(variable[:])
            text = values.tobytes() if values.dtype.kind in "fiu" else str(values).encode()
            digests[variable.name] = hashlib.sha256(text).hexdigest()[:12]
    digests.pop("run_id", None)
    return {f"{path.parent.name}/{name}": digest for name, digest in digests.items()}


def words(error: Exception, results: Path) -> str:
    """Those of an error, wherever the results and things in memory are, in whichever process."""
    text = f"{type(error).__name__}: {error}".replace(str(results), "")
    return re.sub(r"0x[0-9a-f]+|-\d+\.part", "", text)


def run_whole(campaigns: list, results: Path) -> dict:
    """The same of `campaign.run`: of samples and bounds."""
    result = {"numbers": {}, "simulated": {}}
    try:
        from deployable import campaign
        from deployable.campaign.folder import Folder

        for raw in campaigns:
            campaign.run(raw, results, figures=False, notify=lambda text: None)
            folder = Folder(results / "kept-whole")
            result["numbers"] |= numbers_in(folder.samples)
            for name, digest in numbers_in(folder.bounds).items():
                result["numbers"][f"{name} of bounds"] = digest
    except Exception as error:
        result["numbers"]["failed"] = words(error, results)
    return result


def run(raws: list[dict], results: Path) -> dict:
    """Plan and simulate campaigns, and gather what is kept of their runs, as `campaign.run` does;
    what follows is made anew at every call. The `numbers` of all, or how they failed, and how many
    runs of each were `simulated`."""
    result = {"numbers": {}, "simulated": {}}
    try:
        from deployable.campaign.config.check import check_config
        from deployable.campaign.folder import Folder
        from deployable.campaign.plan.plan import read_plan
        from deployable.campaign.samples import kept_extremes, samples
        from deployable.campaign.stages import STAGES

        for raw in raws:
            campaign, folder = check_config(raw), Folder(results / raw["campaign"])
            for stage in (STAGES["plan"], STAGES["simulate"]):
                stage.run(folder, lambda text: None, **stage.sections_of(campaign))
            jobs = campaign.jobs
            collect = kept_extremes.gather if jobs.keep == "extremes" else samples.gather
            collect(read_plan(folder.plan), jobs, folder.runs(jobs.keep), folder.samples)
            result["numbers"] |= numbers_in(folder.samples)
            batches = [json.loads(p.read_text()) for p in folder.path.glob("batches/*.json")]
            result["simulated"][raw["campaign"]] = sum(batch["simulated"] for batch in batches)
    except Exception as error:
        result["numbers"]["failed"] = words(error, results)
    return result


def answer(request: dict, place: str) -> dict:
    """What campaigns give in several folders in turn, and the functions of the program that were
    called or compiled, if that is asked for. After so many of them files get other `texts`."""
    sys.path.insert(0, place)
    os.environ["NUMBA_CACHE_DIR"] = request["cache"]
    numba.config.reload_config()
    functions, answers, raws = set(), [], request["raws"]

    def add(code):
        if code.co_flags & inspect.CO_OPTIMIZED and code.co_filename.startswith(place):
            functions.add((os.path.relpath(code.co_filename, place), code.co_firstlineno))

    if request.get("calls"):  # which makes compiling three times as long
        sys.setprofile(lambda frame, event, argument: event == "call" and add(frame.f_code))
    for name in request.get("imports", ()):
        importlib.import_module(name)
    if request.get("holds"):
        raws = [importlib.import_module("deployable.campaign").check_config(raw) for raw in raws]
    for number, folder in enumerate(request["folders"]):
        if number == request.get("after"):
            for path, text in request["texts"].items():
                Path(path).write_text(text, encoding="utf-8")
        answers.append((run_whole if request.get("whole") else run)(raws, Path(folder)))
    sys.setprofile(None)
    if request.get("compiled"):
        for item in gc.get_objects():
            if isinstance(item, Dispatcher) and item.overloads:
                add(item.py_func.__code__)
    return {"found": answers, "calls": sorted(functions)}


def main(place: str) -> None:
    """Answer every line of standard input, a JSON object, by another, from a new process."""
    for line in sys.stdin:
        ends = os.pipe()
        if not (process := os.fork()):
            os.dup2(2, 1)  # where others may print
            signal.alarm(120)  # an edit may make a loop that does not end
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
