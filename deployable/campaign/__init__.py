"""Campaigns: from a config to runs, samples, bounds and figures.

    from deployable import campaign
    bounds = campaign.run("config/paper.yaml")  # an xarray.Dataset; files in results/paper/

The only package that knows both `fpm` (mechanics) and `intervals` (interval mathematics). The two
meet in netCDF files. Rooms in the order of a campaign: `config`, `plan`, `runs`, `results`;
`stages` joins them to files, `workflow` and its rules the stages. What this package itself offers
is imported on first use, so that `__main__` can set up numerics that are not loaded yet."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from deployable.campaign.config.check import check_config, load_config
    from deployable.campaign.errors import CampaignError, ConfigError
    from deployable.campaign.stages.workflow import run

__all__ = ["CampaignError", "ConfigError", "check_config", "load_config", "run"]

_HOMES = {
    "CampaignError": "deployable.campaign.errors",
    "ConfigError": "deployable.campaign.errors",
    "check_config": "deployable.campaign.config.check",
    "load_config": "deployable.campaign.config.check",
    "run": "deployable.campaign.stages.workflow",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
