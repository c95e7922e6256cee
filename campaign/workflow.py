"""What the Snakefile asks of a campaign: its files, its batches, its sections of the config."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path

from campaign.config import RUN_SECTIONS, load_config
from campaign.loader import retyped


class Campaign:
    """A checked config with the names of its files.

    Importing and making one is cheap, since every call of Snakemake does it.
    """

    RUN_SECTIONS = RUN_SECTIONS

    def __init__(self, config: Mapping):
        self.config = config
        self.name = config["campaign"]

    @classmethod
    def from_files(cls, paths: Sequence[str | Path], overrides: Mapping | None = None) -> Campaign:
        """The campaign of YAML files, later ones and `overrides` (of `--config`) winning.

        Raises `ConfigError`.
        """
        return cls(load_config([_relative(path) for path in paths], retyped(overrides or {})))

    @property
    def data_version(self) -> str:
        """Version of the mechanics; another one makes other runs."""
        import fpm

        return str(fpm.DATA_VERSION)

    def sections_json(self, *names: str) -> str:
        """Some sections of the config as one JSON text, in the order of the file."""
        return json.dumps({name: self.config[name] for name in names}, separators=(",", ":"))

    @cache  # noqa: B019 - there is one campaign in a process
    def batch_count(self) -> int:
        """Number of jobs that the runs are shared among."""
        from campaign.nodes import count_runs

        return -(-count_runs(self.config) // self.config["jobs"]["nodes_per_job"])

    def store_folder(self) -> str:
        """Where runs are kept; all designs of a campaign share it."""
        return f"results/{self.name}/{self.config['jobs']['keep']}"

    def envelope_figures(self, stage: str) -> list[str]:
        """The figures of the responses."""
        return _figures(stage, self.config["responses"])

    def draws_structure(self) -> bool:
        """Whether the scene can be drawn and a trajectory to draw from is kept."""
        from campaign.linkage import BARS

        kept = self.config["jobs"]["keep"] == "trajectories"
        return kept and self.config["scene"]["name"] in BARS

    def results(self) -> list[str]:
        """The files that a campaign leaves for its reader."""
        stage = f"results/{self.name}"
        figures = self.envelope_figures(stage)
        if self.draws_structure():
            figures += _figures(stage, ["linkage"])
        return [*figures, f"{stage}/summary.json", f"{stage}/summary.md"]


def _figures(stage: str, names: Iterable[str]) -> list[str]:
    return [f"{stage}/figures/{name}.{kind}" for name in names for kind in ("png", "pdf")]


def _relative(path: str | Path) -> Path:
    """The path as the user would write it, for messages."""
    path = Path(path)
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
