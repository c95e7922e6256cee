"""Runs for other programs: ParaView, viewers of glTF, moving pictures, figures, tables."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from deployable.campaign.convert import write_mjcf
from deployable.campaign.errors import CampaignError
from deployable.campaign.export.selection import SelectedRun, choose
from deployable.campaign.export.tables import write_figures, write_tables
from deployable.campaign.export.vtk import write_vtk
from deployable.campaign.files import check_results
from deployable.campaign.pictures.animation import write_moving
from deployable.campaign.pictures.glb import write_glb
from fpm.errors import did_you_mean


class ExportFormat(NamedTuple):
    """A format in which a run is exported. frames: how many by default; suffix: of the file into
    which `writer(motion, path)` writes the motion, of moving pictures also with `by_stress`, and
    whose path it returns; without one `writer(run, folder, frames)` simulates the `SelectedRun`,
    and returns the paths to open; takes: names of results that it reads besides `samples.nc`."""

    writer: Callable
    summary: str
    frames: int
    suffix: str = ""
    takes: tuple[str, ...] = ()


FORMATS = {
    "vtk": ExportFormat(
        write_vtk,
        "a collection for ParaView: a .pvd, and up to three .vtu for every frame",
        101,
        ".pvd",
    ),
    "glb": ExportFormat(
        write_glb, "one glTF file that moves, for viewers and Blender", 101, ".glb"
    ),
    "gif": ExportFormat(write_moving, "a moving picture", 60, ".gif"),
    "webp": ExportFormat(
        write_moving, "a moving picture, smaller and with more colours", 60, ".webp"
    ),
    "mp4": ExportFormat(write_moving, "a video, where ffmpeg is installed", 60, ".mp4"),
    "figures": ExportFormat(
        write_figures,
        "figures for a journal: PDF, SVG, PNG",
        401,
        "",
        ("bounds.nc", "sensitivities.nc"),
    ),
    "csv": ExportFormat(
        write_tables,
        "curves of the run; of a campaign also its bounds and runs",
        0,
        "",
        ("bounds.nc",),
    ),
    "mjcf": ExportFormat(write_mjcf, "rigid bodies at their start, for MuJoCo", 0),
}
MOVIES = ("gif", "webp", "mp4")
COLOURS = ("bars", "stress")  # by what moving pictures are coloured


def export(
    run: SelectedRun, kind: str, folder: str | Path, frames: int | None = None, colour: str = "bars"
) -> list[Path]:
    """Simulate a run, write it in one format, and return the paths of the files to open: of a
    ParaView collection the .pvd alone, of figures the PDF files. Raises `CampaignError` if there is
    no such format, it has no such colour, `frames` is below 1, or the run fails, and `DamagedError`
    if results of the run's campaign are damaged.

    Parameters
    ----------
    run: the run, as `choose` returns it.
    kind: name of a format, a key of `FORMATS`: vtk, glb, gif, webp, mp4, figures, csv or mjcf.
    folder: folder of the files; made where it is missing.
    frames: number of frames, evenly spread over the run; None: the format's own number. csv and
        mjcf need none.
    colour: by what moving pictures (gif, webp, mp4) are coloured: ``bars``, each in its colour, or
        ``stress``, equivalent stress."""
    if kind not in FORMATS:
        hint = did_you_mean(kind, FORMATS)
        raise CampaignError(f"{kind!r} is not a format{hint}; allowed: {', '.join(FORMATS)}")
    form = FORMATS[kind]
    if colour != "bars" and kind not in MOVIES:
        raise CampaignError(f"--colour {colour} is not for {kind}; allowed: {', '.join(MOVIES)}")
    if frames is not None and frames < 1:
        raise CampaignError(f"--frames {frames}; allowed: 1 or more")
    if run.folder:
        extras = ("quantities.nc",) * (kind == "csv" and run.folder.quantities.exists())
        check_results(run.folder, ("samples.nc", *form.takes, *extras))
    frames = frames or form.frames
    if not form.suffix:
        return form.writer(run, Path(folder), frames)
    colours = {} if colour == "bars" else {"by_stress": True}
    return [form.writer(run.motion(frames), Path(folder, run.name + form.suffix), **colours)]


__all__ = ["COLOURS", "FORMATS", "SelectedRun", "choose", "export"]
