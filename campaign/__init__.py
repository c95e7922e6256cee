"""Campaigns: from a config to runs, samples, bounds and figures.

    import campaign
    bounds = campaign.run("config/paper.yaml")  # an xarray.Dataset; files in results/paper/

The only package that knows both `fpm` (mechanics) and `intervals` (interval mathematics). The two
meet in netCDF files. Rooms in the order of a campaign: `config`, `plan`, `runs`, `results`;
`stages` joins them to files, `whole` and the rules of the workflow the stages. Heavy imports stay
inside the functions that need them.
"""

from campaign.config.check import check_config, load_config
from campaign.errors import CampaignError, ConfigError
from campaign.whole import run

__all__ = ["CampaignError", "ConfigError", "check_config", "load_config", "run"]
