"""Bounds in Python that draw themselves: `bounds.plot()`."""

from typing import Any

import xarray as xr

from deployable.campaign.results.figures import envelope
from deployable.campaign.results.response_bounds import ResponseBounds


class Envelopes(xr.Dataset):
    """The bounds that `campaign.run` returns: a dataset whose `plot` draws them."""

    __slots__ = ()

    def plot(self, *names: str) -> Any:  # type: ignore[override]
        """Draw bounds over time as a matplotlib figure, which notebooks show; names: of the
        responses, none: all."""
        return envelope([self._read(str(x)) for x in names or self["response"].values], 0.1)

    def _read(self, name: str) -> ResponseBounds:
        data = self.sel(response=name)
        keys = [key for key in ("lower", "upper", "nominal", "error") if key in data]
        curves: Any = {key: data[key].values for key in keys}
        return ResponseBounds(
            name=name, long_name=str(data["response_long_name"].values),
            units=str(data["response_units"].values), kind=data.attrs["bounds_kind"],
            time=data["time"].values, **curves,
        )  # fmt: skip
