"""Selection of the run to export: one of a campaign, a config's nominal one, or a structure's."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import fpm
from deployable.campaign.config.check import load_config
from deployable.campaign.config.loader import read, read_file
from deployable.campaign.config.models import Display
from deployable.campaign.config.sections import Experiment, scene_type
from deployable.campaign.config.units import number_in
from deployable.campaign.errors import CampaignError, ConfigError
from deployable.campaign.folder import Folder
from deployable.campaign.plan.plan import choose_step
from deployable.campaign.results.run_samples import check_mechanics, open_samples
from deployable.campaign.runs.progress import warm_up
from fpm.errors import SceneError
from fpm.solver.motion import whole_motion
from fpm.solver.simulate import HALVINGS

if TYPE_CHECKING:
    import xarray

INSTANTS = 2001  # recorded instants of a structure's run that no config is about


@dataclass(frozen=True)
class SelectedRun:
    """A run that can be simulated for export: its scene, its times, and what files say of it.

    Attributes
    ----------
    name: name of its files, without suffix.
    scene: `fpm.Scene` with the parameter values of the run.
    duration, step: simulated time, and time step (s).
    instants: number of recorded instants, start and end included.
    energy_tolerance: error of the energy balance, relative to the largest energy, above which the
        run fails.
    responses: the campaign's responses (`fpm.reading.responses.Response`), for tables; empty
        without one.
    attributes: texts by name for its files, such as ``campaign`` and ``run_id``.
    folder: the campaign's results; None for a run of a config or a structure.
    display: units of tables and figures."""

    name: str
    scene: Any
    duration: float
    instants: int
    step: float
    energy_tolerance: float = 0.02
    responses: tuple = ()
    attributes: Mapping[str, str] = field(default_factory=dict)
    folder: Folder | None = None
    display: Display = field(default_factory=Display)

    def motion(self, frames: int) -> xarray.Dataset:
        """Simulate the run and return its whole motion, a dataset as `fpm.solver.motion` makes it;
        frames: how many, evenly spread over time. Raises `CampaignError` if the run fails."""
        options: dict[str, Any] = {"frames": frames, "attributes": [dict(self.attributes)]}
        try:
            (motion,) = whole_motion([self.scene], **options, **self._start())
        except fpm.InstabilityError as error:
            raise CampaignError(f"the run fails: {error}") from None
        return motion

    def outcome(self) -> Any:
        """Simulate the run, record all that its responses need, and return its `fpm.Outcome`.
        Raises `CampaignError` if the run fails."""
        record = [need for response in self.responses for need in response.needs]
        (outcome,) = fpm.simulate([self.scene], record=record, **self._start(record))
        if outcome.failure is not None:
            raise CampaignError(f"the run fails: {outcome.failure}")
        return outcome

    def _start(self, record: Sequence = ()) -> dict[str, Any]:
        """Have the kernels compiled, and say so where that takes a while; options of the run."""
        warm_up(self.scene, lambda text: print(text, file=sys.stderr), record)
        keys = ("duration", "instants", "step", "energy_tolerance")
        return {key: getattr(self, key) for key in keys} | {"halvings": HALVINGS}


def choose(
    source: str,
    run: str = "nominal",
    settings: Mapping[str, str] | None = None,
    duration: float | None = None,
) -> SelectedRun:
    """Find a run to export: of a campaign's results, of a campaign's config, or of a structure;
    it is not simulated yet. Raises `CampaignError` if there is no such run, or results were made by
    another version of structure or mechanics, and `SceneError` if the structure cannot be built.

    Parameters
    ----------
    source: folder of a campaign's results; path of a campaign's config, whose nominal run is meant;
        or file or name of a structure, at its default parameters.
    run: ``nominal``; of results also a run's id (hexadecimal) or the beginning of one.
    settings: values of parameters to replace, as texts by name, in the parameters' units; refused
        for results, whose runs are as they are.
    duration: simulated time (s); None: that of the config, or 1 s of a structure; refused for
        results."""
    path = Path(source)
    if duration is not None and not 0 < duration < math.inf:
        raise CampaignError(f"--duration {duration:g}; allowed: a time above 0 (s)")
    if path.is_dir():
        if settings or duration is not None:
            raise CampaignError(
                f"{source} has finished runs, whose parameters and duration cannot be set; give "
                "the config of the campaign in place of its folder"
            )
        try:
            return _select_results_run(Folder(path), run)
        except SceneError as error:
            remedy = "run the campaign again, or export in the folder where it was run"
            text = f"{Folder(path).samples}: {error}; {remedy}"
            raise CampaignError(text) from error
    if run != "nominal":
        raise CampaignError(
            f"--run {run} needs the folder of a campaign's results, not {source!r}, which has one "
            "run"
        )
    if path.suffix in (".yaml", ".yml"):
        with suppress(ConfigError):  # a structure's reader says what is wrong
            if "campaign" in read_file(path).data:
                return _select_config(path, settings or {}, duration)
    if not path.suffix and path.name != source:
        raise CampaignError(
            f"{source}: there is no such folder of results; `snakemake` or `python -m deployable "
            "run` with the campaign makes them"
        )
    structure = scene_type(source, source if path.suffix else "")
    scene = structure.build(**parse_values(settings or {}, structure))
    limit, duration = fpm.SAFETY * fpm.find_stable_step(scene).step, duration or 1.0
    step = fpm.divide_time(duration, INSTANTS, limit).step
    return SelectedRun(structure.name, scene, duration, INSTANTS, step)


def _select_results_run(folder: Folder, run: str) -> SelectedRun:
    if (folder / "cases.json").exists():
        names = ", ".join(sorted(path.parent.name for path in folder.path.glob("*/samples.nc")))
        raise CampaignError(f"{folder.path} is of cases; allowed: the folder of one: {names}")
    if not folder.samples.exists():
        raise CampaignError(
            f"{folder.path} has no samples.nc: it holds no finished campaign; `snakemake` or "
            "`python -m deployable run` with the campaign makes one"
        )
    with open_samples(folder) as samples:
        nominal, values, run_ids = samples.nominal, samples.table.values, samples.ids()
        experiment, mechanics, step = samples.experiment, samples.mechanics, samples.time_step
    check_mechanics(experiment, mechanics, folder)
    matches = {name for name in run_ids if run and name.startswith(run)}
    if run == "nominal" and nominal is not None:
        row = nominal
    elif len(matches) == 1:
        row = run_ids.index(matches.pop())
    else:
        problem = "several runs begin with" if matches else "there is no run"
        raise CampaignError(
            f"{folder.path}: {problem} {run!r}; allowed: nominal, or an id of {len(set(run_ids))} "
            f"runs, e.g. {', '.join(list(dict.fromkeys(run_ids))[:3])}"
        )
    point = dict(zip(experiment.intervals, values[row].tolist(), strict=True))
    return _selected_run(experiment, point, step, run, folder, run_id=run_ids[row])


def _select_config(path: Path, settings: Mapping[str, str], duration: float | None) -> SelectedRun:
    experiment = load_config([path]).experiment
    if duration is not None:
        solver = experiment.solver
        instants = round(duration / solver.duration * (solver.instants - 1)) + 1
        solver = replace(solver, duration=duration, instants=max(2, instants))
        experiment = replace(experiment, solver=solver)
    nominal = dict(zip(experiment.box.names, experiment.nominal, strict=True))
    values = nominal | parse_values(settings, experiment.scene_type)
    # Stable with what is set too, as a finer mesh.
    constants = {name: value for name, value in values.items() if name not in nominal}
    scene = replace(experiment.scene, parameters={**experiment.scene.parameters, **constants})
    step = choose_step(replace(experiment, scene=scene)).step
    return _selected_run(experiment, values, step, experiment.name)


def _selected_run(
    experiment: Experiment, values: Mapping, step: float, name: str, folder: Folder | None = None,
    **attributes: str,
) -> SelectedRun:  # fmt: skip
    solver, responses = experiment.solver, tuple(experiment.response_list)
    times = solver.duration, solver.instants, step, solver.energy_tolerance
    attributes |= {"campaign": experiment.name}
    details = attributes, folder, experiment.display
    return SelectedRun(name, experiment.build(values), *times, responses, *details)


def parse_values(settings: Mapping[str, str], structure: Any) -> dict[str, Any]:
    """Parse values of a structure's parameters, texts by name, as in a YAML file: `"2.5"`,
    `"true"`, `"3 mm"` in the parameter's unit. Raises `ConfigError` for a text that is no YAML."""
    values = {}
    for name, text in settings.items():
        value = read(f"value: {text}", f"--set {name}").data["value"]
        unit = structure.parameters[name].unit if name in structure.parameters else ""
        values[name] = number_in(unit, value) if unit else value
    return values
