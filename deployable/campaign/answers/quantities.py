"""From the quantities of all runs to their intervals, `quantities.nc`, with the further runs that
their ends take, `further.nc`.

    dims   quantity, parameter
    lower, upper (quantity)         the interval: of the simulated ends and of the surrogate's
    simulated_lower, simulated_upper, argmin, argmax    the extreme runs, and where they are
    surrogate_lower, surrogate_upper                    what the surrogate says
    unconverged_lower, unconverged_upper    1 where the surrogate promises more than was simulated
    error                           estimated error of the surrogate
    error_step, error_mesh, error_whole     those of step and mesh, if verified, and the sum
    runs_with, runs_without         in how many runs there is such a number, and in how many not
    happens, happens_uncertainty    share of the box in which there is, and what of it is open
    error_limit, error_border       errors by step and mesh, if verified, for shares of the box: of
                                    the number, and of the certainty that there is one
    is_time, fit                    1 for times of the run; what was fitted
    least                           what it can not be below, NaN where there is none
    share, alone, fixed, halved (quantity, parameter)   what each parameter contributes
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from deployable.campaign.answers.bench import Bench
from deployable.campaign.answers.ends import Ends, settle
from deployable.campaign.answers.finer import beyond_of, finer_errors
from deployable.campaign.answers.limits import limits_of
from deployable.campaign.config.sections import Jobs, Verify, plain_data
from deployable.campaign.folder import Folder
from deployable.campaign.results.bounds import write_dataset
from deployable.campaign.runs.progress import Tell
from fpm.files.trajectory import CONVENTIONS

_OF, _BY = ("quantity",), ("quantity", "parameter")


def answer(
    folder: Folder,
    requirements: Mapping[str, Mapping],
    verify: Verify,
    jobs: Jobs,
    tell: Tell,
    threads: int,
) -> None:
    """Write quantities.nc and further.nc of a sampled campaign that has quantities, with the runs
    that requirements take."""
    bench = Bench.of(folder, jobs, tell, threads)
    asked = limits_of(requirements, list(bench.experiment.quantities))
    ends = settle(bench, verify.max_iterations, asked)
    if bench.further:
        tell(f"{bench.experiment.name}: further runs where it is decided: {len(bench.further)}")
    finer = finer_errors(bench, ends) if verify.discretization else {}
    found = quantities_dataset(bench, ends, finer)
    write_dataset(found, folder.quantities, "Intervals of quantities")
    write_dataset(further_dataset(bench), folder.further, "Further runs for the ends of intervals")


def quantities_dataset(bench: Bench, ends: list[Ends], finer: Mapping[str, np.ndarray]) -> Any:
    """The intervals of all quantities as an xarray Dataset; finer: errors (q, 2) of step and mesh
    by name, of both ends."""
    import xarray as xr

    from deployable.intervals.estimates import AVERAGED

    variables = _Variables()
    _put_ends(variables, bench, ends)
    sought = bench.experiment.is_sought
    errors = [e.surrogate.usual_error if sought else e.surrogate.error for e in ends]
    errors = np.fmax(errors, [e.error for e in ends])
    errors = [error if np.isfinite(error) else np.nan for error in errors]
    averaged = sought and bench.experiment.box.free.sum() <= AVERAGED
    kind = "mean" if averaged else "largest"
    text = f"estimated error of the surrogate: its {kind} left-out one"
    variables.put("error", _OF, errors, text)
    beyond, border = beyond_of(bench, ends, finer)
    if finer:
        parts = {name: both.max(axis=1) for name, both in finer.items()}
        for name, values in parts.items():
            variables.put(f"error_{name}", _OF, values, f"error of the ends by their {name}")
        whole = np.sum([errors, *parts.values()], axis=0)
        variables.put("error_whole", _OF, whole, "errors of surrogate, step and mesh together")
        text = "errors by step and mesh of {}, for shares of the box".format
        variables.put("error_limit", _OF, beyond, text("the number"))
        variables.put("error_border", _OF, border, text("what tells where it happens"))
    _put_occurrence(variables, bench, ends, border)
    _put_shares(variables, bench, ends)
    times = [int(quantity.is_time) for quantity in bench.experiment.numbers]
    variables.put("is_time", _OF, times, "1 for times of the run", "1")
    least = [np.nan if q.least is None else q.least for q in bench.experiment.numbers]
    variables.put("least", _OF, least, "what it can not be below, where there is such a value")
    kinds = [e.surrogate.fit.kind if e.surrogate.fit else "none" for e in ends]
    variables["fit"] = (_OF, kinds, {"long_name": "what was fitted to the runs"})
    return xr.Dataset(variables, coordinates(bench), attributes_of(bench))


class _Variables(dict):
    """Variables of a dataset: dimensions, values and attributes by name."""

    def put(
        self, name: str, dims: tuple[str, ...], values: Any, text: str, units: str = ""
    ) -> None:
        attributes = {"long_name": text} | ({"units": units} if units else {})
        self[name] = (dims, np.array(values), attributes)


def _put_ends(variables: _Variables, bench: Bench, ends: list[Ends]) -> None:
    """The ends, where they are, and the surrogate at the nominal values."""
    to_value = bench.experiment.box.from_unit
    for i, side in enumerate(("lower", "upper")):
        outer = [e.outer[i] for e in ends]
        variables.put(side, _OF, outer, f"{side} end, of runs and surrogate")
        simulated = [getattr(e, side) for e in ends]
        variables.put(f"simulated_{side}", _OF, simulated, f"{side} end of the simulated runs")
        predicted = [(e.surrogate_range.low, e.surrogate_range.high)[i] for e in ends]
        variables.put(f"surrogate_{side}", _OF, predicted, f"{side} end by the surrogate")
        moving = [int(e.unconverged[i]) for e in ends]
        text = f"1 where the surrogate goes beyond the {side} end"
        variables.put(f"unconverged_{side}", _OF, moving, text, "1")
        which = ("argmin", "argmax")[i]
        places = to_value(np.array([getattr(e, which) for e in ends]))
        variables.put(which, _BY, places, f"parameters of the run at the {side} end")
    nominal = [s.evaluate(bench.nominal[None])[0] for s in bench.surrogates()]
    variables.put("nominal", _OF, nominal, "at the nominal values, by surrogate")


def _put_occurrence(
    variables: _Variables, bench: Bench, ends: list[Ends], border: np.ndarray
) -> None:
    """In how many runs, and in which share of the box, there is such a number."""
    from deployable.intervals.scalars import Limit, share_of_box

    there = np.isfinite(bench.numbers[bench.different]).sum(axis=0) + bench.others
    variables.put("runs_with", _OF, there, "runs that have the number", "1")
    without = len(bench.different) + bench.left_out - there
    variables.put("runs_without", _OF, without, "runs in which it does not happen", "1")
    free = bench.experiment.box.free
    limits = [
        Limit(end.surrogate, "happens", 1.0, border=float(doubt))
        for end, doubt in zip(ends, border, strict=True)
    ]
    shares = np.array([share_of_box([limit], free) for limit in limits])
    variables.put("happens", _OF, shares[:, 0], "share of the box in which it happens", "1")
    text = "by how much that share may be more or less"
    variables.put("happens_uncertainty", _OF, shares[:, 1], text, "1")


def _put_shares(variables: _Variables, bench: Bench, ends: list[Ends]) -> None:
    """What each parameter contributes."""
    from deployable.intervals.scalars import influence

    found = [influence(e.surrogate, bench.nominal) for e in ends]
    texts = {
        "share": "share of the widths, 0 where not above the error of the surrogate",
        "alone": "width when only this parameter varies",
        "fixed": "width when this parameter is fixed",
        "halved": "width when its interval is half as wide",
    }
    # The search over a part may find more than that over the whole has.
    most = {name: np.diff([e.outer for e in ends]) for name in ("alone", "fixed", "halved")}
    for name, text in texts.items():
        units = "1" if name == "share" else ""
        values = np.minimum([getattr(f, name) for f in found], most.get(name, 1.0))
        variables.put(name, _BY, values, text, units)


def further_dataset(bench: Bench) -> Any:
    """The further runs with their quantities as an xarray Dataset."""
    import xarray as xr

    runs, k = bench.further, bench.unit.shape[1]
    numbers, margins = (each[len(each) - len(runs) :] for each in (bench.numbers, bench.margins))
    along = ("run", "parameter")
    values = np.array([run.values for run in runs]).reshape(-1, k)
    unit = np.array([run.normalized for run in runs]).reshape(-1, k)
    ids = np.array([run.id for run in runs], dtype=object)
    variables = {
        "run_id": ("run", ids, {"long_name": "name of the trajectory"}),
        "normalized": (along, unit, {"units": "1", "long_name": "coordinates in the box, -1 to 1"}),
        "value": (along, values, {"long_name": "parameter values in their units"}),
        "quantities": (("run", "quantity"), numbers, {"long_name": "value of the quantity"}),
        "margin": (("run", "quantity"), margins, {"long_name": "by how much the run has it"}),
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
        "Conventions": CONVENTIONS,
        "campaign": bench.experiment.name,
        "scene": bench.experiment.scene.name,
        "config_hash": bench.plan.config_hash,
        "config": json.dumps(plain_data(bench.experiment)),
        "mechanics": bench.plan.mechanics,
        "runs": len(bench.different) + bench.left_out,
        "further_runs": len(bench.further),
    }
