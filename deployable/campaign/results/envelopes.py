"""Bounds in Python that draw themselves: `bounds.plot()`."""

import json
from typing import Any

import numpy as np
import xarray as xr

from deployable.campaign.config.models import Display
from deployable.campaign.errors import CampaignError
from deployable.campaign.results.display import shown_bounds
from deployable.campaign.results.figures import envelope
from deployable.campaign.results.response_bounds import CampaignBounds, ResponseBounds
from fpm.errors import did_you_mean


class Envelopes(xr.Dataset):
    """The bounds that `campaign.run` returns: a dataset whose `plot` draws them."""

    __slots__ = ()

    def plot(self, *names: str) -> Any:  # type: ignore[override]
        """Draw bounds over time as a matplotlib figure, which notebooks show, in the units of the
        config's `display`; names: of the responses, none: all. Raises CampaignError for another
        name, and for bounds at one instant."""
        if "time" not in self.dims:
            raise CampaignError("there is no curve at one instant; allowed: bounds at several")
        responses = [str(name) for name in np.atleast_1d(self["response"].values)]
        for name in {*names} - {*responses}:
            text = f"{name!r} is not a response{did_you_mean(name, responses)}"
            raise CampaignError(f"{text}; allowed: {', '.join(responses)}")
        rows = tuple(self._read(name) for name in names or responses)
        display = Display(**json.loads(self.attrs.get("display", "{}")))
        return envelope(shown_bounds(CampaignBounds(rows, [], {}), display).responses)

    def _read(self, name: str) -> ResponseBounds:
        data = self.sel(response=name) if "response" in self.dims else self
        keys = [key for key in ("lower", "upper", "nominal", "error") if key in data]
        curves: Any = {key: data[key].values for key in keys}
        return ResponseBounds(
            name=name, long_name=str(data["response_long_name"].values),
            units=str(data["response_units"].values), kind=data.attrs["bounds_kind"],
            time=data["time"].values, **curves,
        )  # fmt: skip
