"""From the quantities of all runs to their intervals, `quantities.nc`, with the further runs that
their ends take, `further.nc`.

    dims   quantity, parameter
    lower, upper (quantity)         the interval: of the simulated ends and of the surrogate's
    simulated_lower, simulated_upper, argmin, argmax    the extreme runs, and where they are
    surrogate_lower, surrogate_upper                    what the surrogate says
    moving_lower, moving_upper      1 where the surrogate promises more than was simulated
    error                           estimated error of the surrogate
    error_step, error_mesh, error_whole     with `verify.finer`: those of step and mesh, and the sum
    runs_with, runs_without         in how many runs there is such a number, and in how many not
    happens, open                   share of the box in which there is, and in which it is not known
    is_time, fit                    1 for times of the run; what was fitted
    share, alone, fixed, halved (quantity, parameter)   what each parameter contributes
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from campaign.answers.bench import Bench
from campaign.answers.ends import Ends, settle
from campaign.answers.finer import finer_errors
from campaign.config.sections import Jobs, Verify, plain_data
from campaign.folder import Folder
from campaign.results.bounds import write_dataset
from campaign.runs.progress import Tell


def answer(folder: Folder, verify: Verify, jobs: Jobs, tell: Tell, threads: int) -> None:
    """Write quantities.nc and further.nc of a sampled campaign that has quantities."""
    bench = Bench.of(folder, jobs, tell, threads)
    ends = settle(bench, verify.rounds)
    if bench.further:
        tell(f"{bench.experiment.name}: further runs at ends: {len(bench.further)}")
    finer = finer_errors(bench, ends) if verify.finer else {}
    found = quantities_dataset(bench, ends, finer)
    write_dataset(found, folder.quantities, "Intervals of quantities")
    write_dataset(further_dataset(bench), folder.further, "Further runs for the ends of intervals")


def quantities_dataset(bench: Bench, ends: list[Ends], finer: Mapping[str, np.ndarray]) -> Any:
    """The intervals of all quantities as an xarray Dataset; finer: errors (q,) of step and mesh."""
    import xarray as xr

    from intervals.scalars import influence

    to_value = bench.experiment.box.from_unit
    of, by = ("quantity",), ("quantity", "parameter")
    variables: dict[str, tuple] = {}

    def put(name: str, dims: tuple[str, ...], values: Any, text: str, units: str = "") -> None:
        attributes = {"long_name": text} | ({"units": units} if units else {})
        variables[name] = (dims, np.array(values), attributes)

    for i, side in enumerate(("lower", "upper")):
        put(side, of, [e.outer[i] for e in ends], f"{side} end, of runs and surrogate")
        simulated = [getattr(e, side) for e in ends]
        put(f"simulated_{side}", of, simulated, f"{side} end of the simulated runs")
        found = [(e.found.low, e.found.high)[i] for e in ends]
        put(f"surrogate_{side}", of, found, f"{side} end by the surrogate")
        moving = [int(e.moving[i]) for e in ends]
        put(f"moving_{side}", of, moving, f"1 where the surrogate goes beyond the {side} end", "1")
        which = ("argmin", "argmax")[i]
        places = to_value(np.array([getattr(e, which) for e in ends]))
        put(which, by, places, f"parameters of the run at the {side} end")
    nominal = bench.surrogates()
    at = bench.nominal[None]
    put("nominal", of, [s.evaluate(at)[0] for s in nominal], "at the nominal values, by surrogate")
    errors = [e.surrogate.error for e in ends]
    errors = [error if np.isfinite(error) else np.nan for error in errors]
    put("error", of, errors, "estimated error of the surrogate: its largest left-out one")
    for name, values in finer.items():
        put(f"error_{name}", of, values, f"change of the ends with a finer {name}")
    if finer:
        whole = np.sum([errors, *finer.values()], axis=0)
        put("error_whole", of, whole, "errors of surrogate, step and mesh together")
    runs = len(bench.unit) + bench.left_out
    there = np.isfinite(bench.numbers).sum(axis=0) + bench.others
    put("runs_with", of, there, "runs that have the number", "1")
    put("runs_without", of, runs - there, "runs in which it does not happen", "1")
    shares = np.array([e.surrogate.occurrence.share() for e in ends])
    put("happens", of, shares[:, 0], "share of the box in which it happens", "1")
    put("open", of, shares[:, 1], "share of the box in which that is not known", "1")
    found = [influence(e.surrogate, bench.nominal) for e in ends]
    share = "share of the widths, 0 where not above the error of the surrogate"
    put("share", by, [f.share for f in found], share, "1")
    put("alone", by, [f.alone for f in found], "width when only this parameter varies")
    put("fixed", by, [f.fixed for f in found], "width when this parameter is fixed")
    put("halved", by, [f.halved for f in found], "width when its interval is half as wide")
    times = [int(quantity.is_time) for quantity in bench.experiment.numbers]
    put("is_time", of, times, "1 for times of the run", "1")
    kinds = [e.surrogate.fit.kind if e.surrogate.fit else "none" for e in ends]
    variables["fit"] = (of, kinds, {"long_name": "what was fitted to the runs"})
    return xr.Dataset(variables, coordinates(bench), attributes_of(bench))


def further_dataset(bench: Bench) -> Any:
    """The further runs with their quantities as an xarray Dataset."""
    import xarray as xr

    runs, k = bench.further, bench.unit.shape[1]
    numbers = bench.numbers[len(bench.numbers) - len(runs) :]
    along = ("run", "parameter")
    values = np.array([run.values for run in runs]).reshape(-1, k)
    unit = np.array([run.unit for run in runs]).reshape(-1, k)
    ids = np.array([run.id for run in runs], dtype=object)
    variables = {
        "run_id": ("run", ids, {"long_name": "name of the trajectory"}),
        "unit": (along, unit, {"units": "1", "long_name": "coordinates in the box, -1 to 1"}),
        "value": (along, values, {"long_name": "parameter values in their units"}),
        "quantities": (("run", "quantity"), numbers, {"long_name": "value of the quantity"}),
    }
    return xr.Dataset(variables, coordinates(bench), attributes_of(bench))


def coordinates(bench: Bench) -> dict:
    """Coordinates over quantity and parameter."""
    experiment = bench.experiment
    quantities, known = experiment.numbers, experiment.scene_type.parameters
    names, rows = list(experiment.intervals), experiment.intervals.values()
    columns = {
        "quantity": ("quantity", [q.name for q in quantities], "name of the quantity"),
        "quantity_units": ("quantity", [q.unit for q in quantities], "units of the quantity"),
        "quantity_long_name": ("quantity", [q.long_name for q in quantities], "the same in words"),
        "parameter": ("parameter", names, "interval parameter"),
        "box_units": ("parameter", [known[n].unit for n in names], "units of the parameter"),
    }
    for key in ("lower", "upper", "nominal"):
        ends = [getattr(interval, key) for interval in rows]
        columns[f"box_{key}"] = ("parameter", ends, f"{key} value of the parameter")
    return {name: (dim, values, {"long_name": t}) for name, (dim, values, t) in columns.items()}


def attributes_of(bench: Bench) -> dict:
    """What files of answers tell of the campaign."""
    return {
        "Conventions": "CF-1.11",
        "campaign": bench.experiment.name,
        "scene": bench.experiment.scene.name,
        "config_hash": bench.plan.config_hash,
        "config": json.dumps(plain_data(bench.experiment)),
        "mechanics": bench.plan.mechanics,
        "runs": len(bench.unit) + bench.left_out,
        "further_runs": len(bench.further),
    }
