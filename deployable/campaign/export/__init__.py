"""Runs for other programs: ParaView, viewers of glTF, moving pictures, figures, tables."""

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from deployable.campaign.errors import CampaignError
from deployable.campaign.export.selection import SelectedRun, choose
from deployable.campaign.files import check_results


@dataclass(frozen=True)
class ExportFormat:
    """A format in which a run is exported. writer: module of the campaign, and function in it,
    imported when it is used; frames: how many by default; suffix: of the file into which
    `writer(motion, path)` writes the motion, of moving pictures also with `by_stress`, and whose
    path it returns; without one `writer(run, folder, frames)` simulates the `SelectedRun`, and
    returns the paths to open; takes: names of results that it reads besides `samples.nc`."""

    writer: str
    summary: str
    frames: int
    suffix: str = ""
    takes: tuple[str, ...] = ()

    def write(self, run: SelectedRun, folder: Path, frames: int, **colours: bool) -> list[Path]:
        """Simulate a run, write it into a folder, and return the paths of the files to open."""
        module, function = self.writer.split(":")
        writer = getattr(import_module(f"deployable.campaign.{module}"), function)
        if not self.suffix:
            return writer(run, folder, frames)
        return [writer(run.motion(frames), folder / f"{run.name}{self.suffix}", **colours)]


_CURVES = "bounds.nc", "sensitivities.nc"
_MOVING = "pictures.animation:write_moving"
FORMATS = {
    "vtk": ExportFormat(
        "export.vtk:write_vtk",
        "a collection for ParaView: a .pvd, and up to three .vtu for every frame", 101, ".pvd",
    ),
    "glb": ExportFormat(
        "pictures.glb:write_glb", "one glTF file that moves, for viewers and Blender", 101, ".glb"
    ),
    "gif": ExportFormat(_MOVING, "a moving picture", 60, ".gif"),
    "webp": ExportFormat(_MOVING, "a moving picture, smaller and with more colours", 60, ".webp"),
    "figures": ExportFormat(
        "export.figures:write_figures", "figures for a journal: PDF, SVG, PNG", 401, takes=_CURVES
    ),
    "csv": ExportFormat(
        "export.tables:write_tables",
        "curves of the run; of a campaign also its bounds and runs", 0, takes=_CURVES[:1],
    ),
}  # fmt: skip


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
