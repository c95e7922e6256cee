"""The study of extremes: every row is accurate as stated, a clear refusal, or a failing row."""

from collections.abc import Callable, Mapping
from functools import partial

from evidence import plots
from evidence.extremes import (
    cables,
    joints,
    latches,
    motors,
    parameters,
    rigid_holds,
    runs,
    stable_step,
)
from evidence.results import Report
from evidence.rows import Row, set_group

GROUPS: dict[str, Callable[[], list[Row]]] = {
    "stable-step": stable_step.study,
    "materials": parameters.materials,
    "sections": parameters.sections,
    "lengths": parameters.lengths,
    "stiffnesses": parameters.stiffnesses,
    "starts": runs.starts,
    "meshes": runs.meshes,
    "durations": runs.durations,
    "damping": runs.damping,
    "precision": runs.precision,
    "intervals": runs.intervals,
    "cables": cables.study,
    "latches": latches.study,
    "slides": partial(latches.study, latches.SLIDE),
    "motors": motors.study,
    "joints": joints.study,
    "rigid-holds": rigid_holds.study,
    "refusals": parameters.refusals,
}


def _measure(group: str, quick: bool) -> list[dict]:
    return [row.plain() for row in set_group(group.replace("-", " "), GROUPS[group]())]


PARTS = {group: partial(_measure, group) for group in GROUPS}


def report(parts: Mapping[str, list[dict]]) -> Report:
    """The rows of all groups, and how much of its allowance each takes."""
    rows = [Row(**row) for group in parts.values() for row in group]
    steps = [row for row in rows if row.group == "stable step"]
    rest = [row for row in rows if row.group != "stable step"]
    figures = {"stable-step": draw_steps(steps), "errors": draw_errors(rest)}
    return Report(rows, figures=figures)


def draw_steps(rows: list[Row]):
    """Ratio of the estimated to the true stable step, case by case."""
    figure, (axes,) = plots.panels(size=(7, 0.16 * len(rows) + 1))
    axes.barh(range(len(rows)), [row.value for row in rows], color=plots.BLUE, height=0.7)
    axes.axvline(1.0, color="black", linewidth=0.8)
    axes.set_yticks(range(len(rows)), [r.name.removeprefix("stable step: ") for r in rows])
    axes.tick_params(axis="y", labelsize=6)
    axes.set(xlim=(stable_step.LOWEST, 1.02), xlabel="estimated / true stable step")
    axes.margins(y=0.005)
    axes.invert_yaxis()
    return figure


def draw_errors(rows: list[Row]):
    """Error over what is allowed of every row; refusals as marks at the left."""
    figure, (axes,) = plots.panels(size=(7, 0.16 * len(rows) + 1))
    plots.draw_utilization(axes, rows, [row.name for row in rows])
    axes.tick_params(axis="y", labelsize=5)
    return figure
