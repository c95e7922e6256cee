"""Runs for other programs: ParaView, viewers of glTF, moving pictures, figures, tables."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from deployable.campaign.errors import CampaignError
from deployable.campaign.export.selection import SelectedRun, choose
from deployable.campaign.files import check_results


@dataclass(frozen=True)
class ExportFormat:
    """A format in which a run is exported, such as vtk. write: function ``write(run, folder,
    frames)`` that simulates a `SelectedRun`, writes the files and returns the paths to open; of
    moving pictures also with `by_stress` (colours); summary: what the format is, in words; frames:
    how many by default; takes: names of results that `write` reads besides `samples.nc`."""

    write: Callable[..., list[Path]]
    summary: str
    frames: int
    takes: tuple[str, ...] = ()


def _motion_file(suffix: str) -> Callable[..., list[Path]]:
    def write(run: SelectedRun, folder: Path, frames: int, **colours: bool) -> list[Path]:
        from deployable.campaign.export.vtk import write_vtk
        from deployable.campaign.pictures.animation import write_moving
        from deployable.campaign.pictures.glb import write_glb

        write_motion = {"pvd": write_vtk, "glb": write_glb}.get(suffix, write_moving)
        return [write_motion(run.motion(frames), folder / f"{run.name}.{suffix}", **colours)]

    return write


def _csv(run: SelectedRun, folder: Path, frames: int) -> list[Path]:
    from deployable.campaign.export.tables import write_tables

    return write_tables(run, folder)


def _figures(run: SelectedRun, folder: Path, frames: int) -> list[Path]:
    from deployable.campaign.export.figures import write_figures

    return write_figures(run, folder, frames)


_CURVES = "bounds.nc", "sensitivities.nc"
FORMATS = {
    "vtk": ExportFormat(
        _motion_file("pvd"), "a collection for ParaView: a .pvd, and two .vtu for every frame", 101
    ),
    "glb": ExportFormat(
        _motion_file("glb"), "one glTF file that moves, for viewers and Blender", 101
    ),
    "gif": ExportFormat(_motion_file("gif"), "a moving picture", 60),
    "webp": ExportFormat(
        _motion_file("webp"), "a moving picture, smaller and with more colours", 60
    ),
    "figures": ExportFormat(_figures, "figures for a journal: PDF, SVG, PNG", 401, _CURVES),
    "csv": ExportFormat(
        _csv, "curves of the run; of a campaign also its bounds and runs", 0, _CURVES[:1]
    ),
}


MOVIES = ("gif", "webp")
COLOURS = ("bars", "stress")
"""By what moving pictures are coloured."""


def export(
    run: SelectedRun, kind: str, folder: str | Path, frames: int | None = None, colour: str = "bars"
) -> list[Path]:
    """Simulate a run, write it in one format, and return the paths of the files to open: of a
    ParaView collection the .pvd alone, of figures the PDF files. Raises `CampaignError` if the
    format has no such colour, `frames` is below 1, or the run fails, and `DamagedError` if results
    of the run's campaign are damaged.

    Parameters
    ----------
    run: the run, as `choose` returns it.
    kind: name of a format, a key of `FORMATS`: vtk, glb, gif, webp, figures or csv.
    folder: folder of the files; made where it is missing.
    frames: number of frames, evenly spread over the run; None: the format's own number. csv needs
        none.
    colour: by what moving pictures (gif, webp) are coloured: ``bars``, each in its colour, or
        ``stress``, equivalent stress."""
    form = FORMATS[kind]
    if colour != "bars" and kind not in MOVIES:
        raise CampaignError(f"--colour {colour} is not for {kind}; allowed: {', '.join(MOVIES)}")
    if frames is not None and frames < 1:
        raise CampaignError(f"--frames {frames}; allowed: 1 or more")
    if run.folder:
        extras = ("quantities.nc",) * (kind == "csv" and run.folder.quantities.exists())
        check_results(run.folder, ("samples.nc", *form.takes, *extras))
    colours = {} if colour == "bars" else {"by_stress": True}
    return form.write(run, Path(folder), frames or form.frames, **colours)


__all__ = ["COLOURS", "FORMATS", "SelectedRun", "choose", "export"]
