"""Where the files of a campaign are: one folder, and one like it for each round."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

CAMPAIGN = "campaign.yaml"  # name of the campaign in a folder of one's own

PICTURES = ("png", "pdf")

MOST_PANELS = 8  # panels of one figure, as many as fit on a page


def _file(name: str, text: str) -> Any:
    """Return the path of a file or folder by its name, which a docstring describes."""
    return property(lambda folder: folder / name, doc=text)


@dataclass(frozen=True)
class Folder:
    """A folder of results, with the paths of its files as attributes: `results/<campaign>`, or of
    one round of an `accuracy` (rounds of more runs until bounds are good)
    `results/<campaign>/rounds/<n>`; `folder / name` is any other file. path: of the folder."""

    path: Path

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", Path(self.path))

    def __truediv__(self, name: str) -> Path:
        return self.path / name

    def __fspath__(self) -> str:
        return str(self.path)

    plan = _file("plan.json", "Which runs there are.")
    samples = _file("samples.nc", "Responses of all runs.")
    surrogate = _file("surrogate.nc", "Coefficients of the polynomials.")
    sensitivities = _file("sensitivities.nc", "Influence of each parameter.")
    design_bounds = _file("design_bounds.nc", "Bounds of the responses by the planned runs.")
    bounds = _file("bounds.nc", "Bounds of the responses by all runs, further ones included.")
    quantities = _file("quantities.nc", "Intervals of the quantities.")
    refinement = _file("refinement.nc", "The further runs that answers took.")
    requirements = _file("requirements.json", "What of the box meets the requirements.")
    choice = _file("choice.json", "The best choice.")
    measured = _file("measured.json", "What of the box explains measured curves.")
    report = _file("report.html", "The page to open.")
    motions = _file("motions", "The folder of the whole motions of the runs that the page shows.")
    figures = _file("figures", "The folder of the figures of single responses.")
    overviews = _file("figures/campaign", "The folder of the figures of the whole campaign.")

    @property
    def stage_folders(self) -> tuple[Path, ...]:
        """All folders that stages (steps from config to page) write to, except those of runs."""
        return self.path, self.figures, self.overviews, self / "batches", self.motions

    def batch(self, number: int) -> Path:
        """Path of the JSON file written when batch `number` (from 0; runs of one job) is stored."""
        return self / f"batches/{number}.json"

    def runs(self, keep: str) -> Path:
        """Folder in which runs are stored, the same for all rounds. keep: its name, that is
        `jobs.keep` of the config, what is kept of a run: trajectories or responses."""
        return self.whole / keep

    @property
    def whole(self) -> Path:
        """Path of the campaign's own folder: this one, or, of a round, that above `rounds`."""
        return self.path.parents[1] if self.path.parent.name == "rounds" else self.path

    def round(self, number: int) -> "Folder":
        """Return the folder of a round of this campaign's `accuracy`; number: of it, from 0."""
        return Folder(self / f"rounds/{number}")
