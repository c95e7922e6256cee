"""The campaign that is attacked: a small one, run once, and what it must always give."""

import copy
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from deployable import campaign
from fpm.files.seals import DamagedError, check

RAW = {
    "campaign": "victim",
    "scene": {"name": "bennett", "parameters": {"elements": 2}},
    "solver": {"duration": 0.004, "instants": 9},
    "intervals": {"a": {"nominal": 0.035, "relative": 0.01}},
    "design": {"method": "tensor_roots", "order": 2},
    "held_out": 2,
    "responses": {"BD": {"distance": ["B", "D"]}, "vBz": {"velocity": "B", "component": "z"}},
    "jobs": {"group": 2},
}
VARIABLES = ("lower", "upper", "nominal", "error")


def silent(text: str) -> None:
    """Tell nobody."""


class Victim:
    """The campaign in `folder`, with runs kept as `keep` says, drawn or not; its true bounds."""

    def __init__(self, folder: Path, keep: str = "trajectories", has_figures: bool = False):
        self.raw = copy.deepcopy(RAW)
        self.raw["jobs"]["keep"] = keep
        self.keep, self.has_figures = keep, has_figures
        self.whole = folder / f"whole-{keep}{'-drawn' * has_figures}"
        self.truth = self.run(self.whole)

    @property
    def name(self) -> str:
        """Its name, and that of its folder."""
        return self.raw["campaign"]

    def run(self, results: Path, notify: Callable[[str], None] = silent) -> dict[str, np.ndarray]:
        """Run it (what is there already is used); its bounds."""
        bounds = campaign.run(self.raw, results, figures=self.has_figures, notify=notify)
        return {name: bounds[name].values for name in VARIABLES}

    def copy(self, results: Path) -> Path:
        """The finished campaign once more; its folder."""
        shutil.rmtree(results, ignore_errors=True)
        shutil.copytree(self.whole, results)
        return results / self.name

    def is_true(self, bounds: dict[str, np.ndarray]) -> bool:
        """Whether bounds are the true ones, bit for bit."""
        return all(np.array_equal(bounds[name], self.truth[name]) for name in VARIABLES)


def results_in(folder: Path) -> list[Path]:
    """All sealed files of a campaign, those of its runs too."""
    suffixes = {".nc", ".json", ".md", ".html", ".png", ".pdf", ".svg"}
    paths = sorted(path for path in folder.rglob("*") if path.suffix in suffixes)
    return [path for path in paths if not path.name.startswith(".")]


def list_broken_files(folder: Path) -> list[Path]:
    """Results that have their final names and are not whole."""
    return [path for path in results_in(folder) if not _is_whole(path)]


def list_leftovers(folder: Path) -> list[Path]:
    """Temporary files that nobody writes any more."""
    return [path for path in folder.rglob(".*.part*") if path.is_file()]


def _is_whole(path: Path) -> bool:
    try:
        check(path)
    except DamagedError:
        return False
    return True


def read_bounds(folder: Path) -> dict[str, Any]:
    """The bounds that a campaign's folder publishes, by any means."""
    import xarray

    with xarray.open_dataset(folder / "bounds.nc") as data:
        return {name: data[name].values for name in VARIABLES}
