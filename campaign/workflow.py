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

    @property
    def is_adaptive(self) -> bool:
        """Whether the order is found in rounds."""
        return self.config["design"]["order"] == "auto"

    @property
    def plan_rules(self) -> str:
        """The rules that plan the runs: all at once, or in rounds."""
        return f"workflow/rules/{'adaptive' if self.is_adaptive else 'nodes'}.smk"

    @property
    def any_stage(self) -> str:
        """Pattern of the folders of the campaign and of its rounds."""
        return rf"results/{self.name}(/rounds/\d+)?"

    @property
    def run_stage(self) -> str:
        """Pattern of the folders in which runs are made: the campaign's, or those of its rounds."""
        return rf"results/{self.name}/rounds/\d+" if self.is_adaptive else f"results/{self.name}"

    @cache  # noqa: B019 - there is one campaign in a process
    def batch_count(self, plan_path: str | None = None) -> int:
        """Number of jobs that the runs are shared among, those of a plan or of the config."""
        from campaign.nodes import count_runs, read_plan

        runs = len(read_plan(plan_path)["runs"]) if plan_path else count_runs(self.config)
        return -(-runs // self.config["jobs"]["nodes_per_job"])

    def is_last(self, plan_path: str) -> bool:
        """Whether a round's plan says that the rounds are over."""
        from campaign.adaptive import is_finished
        from campaign.nodes import read_plan

        return is_finished(read_plan(plan_path))

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
        if len(self.config["intervals"]) > 1 and self.config["design"]["order"] is not None:
            figures += _figures(stage, ["sensitivities"])
        return [*figures, f"{stage}/summary.json", f"{stage}/summary.md"]


def _figures(stage: str, names: Iterable[str]) -> list[str]:
    return [f"{stage}/figures/{name}.{kind}" for name in names for kind in ("png", "pdf")]


def _relative(path: str | Path) -> Path:
    """The path as the user would write it, for messages."""
    path = Path(path)
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
