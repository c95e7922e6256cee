"""Bounds of the responses, and what parameters contribute to them, as `bounds.nc` and
`sensitivities.nc` have them. Nothing else that shows or tells results knows these files."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from deployable.campaign.files import open_netcdf
from deployable.campaign.folder import Folder

COMPONENTS = ("surrogate", "step", "mesh")  # components of an error
LARGE = 0.1  # share of the largest difference of bounds above which their error is large
UNSURE = 0.25  # the same from which bounds are not drawn


@dataclass(frozen=True)
class ResponseBounds:
    """Bounds of a response at T instants `time` (s): arrays (T) `lower`, `upper`, `nominal` (run at
    nominal parameters) and `error` (estimated, of the bounds), in `units`; None stands for unknown.

    name, long_name: of the response, the latter in words; kind: of the bounds, in words; errors:
    components of the error (T) by name, "held_out", "decay", and, where these were checked, those
    of `COMPONENTS`; error_shares: those of `COMPONENTS` as fractions of the width, both integrated
    over time; least, most: what bounds are within, for physical reasons, such as 0, NaN where
    there is no limit; growth
    (T): of a scan's bounds with the last quarter of its runs; abscissa: the horizontal axis where
    it is not time, such as a hinge's opening: a dict of `words`, `unit`, `first` and `last` value,
    and the `duration` (s) onto which these are mapped.

    widths (k, T): of the response's range when one of k parameters varies alone; width_error (T):
    error of the fit, below which a width is none; shares (k): widths above it, integrated over
    time, as fractions (0 to 1) of their sum over all parameters; None without a polynomial. scale:
    factor by which all are multiplied (`results.display`)."""

    name: str
    long_name: str
    units: str
    time: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    kind: str = ""
    nominal: np.ndarray | None = None
    error: np.ndarray | None = None
    errors: Mapping[str, np.ndarray] = field(default_factory=dict)
    error_shares: Mapping[str, float] = field(default_factory=dict)
    least: float = np.nan
    most: float = np.nan
    growth: np.ndarray | None = None
    abscissa: Mapping[str, Any] | None = None
    widths: Any = None
    width_error: np.ndarray | None = None
    shares: np.ndarray | None = None
    scale: float = 1.0

    @property
    def width(self) -> np.ndarray:
        """Differences (T) of the upper and the lower bound."""
        return self.upper - self.lower

    @property
    def widest(self) -> int:
        """Index of the instant at which the bounds differ most."""
        return int(self.width.argmax())

    @property
    def known_error(self) -> np.ndarray | None:
        """The `error` (T); None also where it is 0 at all instants only because the bounds are
        those of a scan, which the second half of its runs did not change."""
        return None if self.error is None or self.is_unknown(self.error.max()) else self.error

    def is_unknown(self, error: float) -> bool:
        """Return whether an error of these bounds is not known: 0 by the growth of a scan."""
        return self.kind.startswith("least") and not error


@dataclass(frozen=True)
class CampaignBounds:
    """Bounds of all responses of a campaign. parameters: dicts of the interval parameters (name,
    units, lower, nominal, upper); attributes: of the file `bounds.nc`, by name; quantity_errors: of
    the bounds of quantities (q), in their units, by component, "step" and "mesh", if checked."""

    responses: tuple[ResponseBounds, ...]
    parameters: list[dict[str, Any]]
    attributes: Mapping[str, Any]
    quantity_errors: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def time(self) -> np.ndarray:
        """Instants (T) of all bounds, in s."""
        return self.responses[0].time


def read_bounds(folder: Folder, of_design: bool = False) -> CampaignBounds:
    """Read the bounds of a campaign's responses, with what parameters contribute where that is
    known. of_design: those by the planned runs alone. Raises `DamagedError`."""
    columns: dict[str, Any] = {}
    if folder.sensitivities.exists():
        with open_netcdf(folder.sensitivities) as file:
            names = {"widths": "width", "width_error": "error", "shares": "width_overall"}
            columns = {key: _column(file, name) for key, name in names.items()}
    with open_netcdf(folder.design_bounds if of_design else folder.bounds) as file:
        attributes = {name: file.getncattr(name) for name in file.ncattrs()}
        time, nones = file["time"][:], ["null"] * len(file["response"])
        for key in ("lower", "upper", "nominal", "error", "least", "most"):
            columns[key] = _column(file, key)
        columns |= {
            "name": file["response"][:], "units": file["response_units"][:],
            "long_name": file["response_long_name"][:],
            "growth": _column(file, "growth_quarter"),
            "abscissa": [(axis := json.loads(text)) and axis | {"duration": float(time[-1])}
                         for text in _column(file, "response_along", nones)],
        }  # fmt: skip
        errors = _components(file, "error", ("held_out", "decay", *COMPONENTS))
        shares = {"surrogate": _column(file, "error_share_of_width", [np.nan] * len(nones))}
        shares |= _components(file, "share")
        parameters, quantity_errors = read_parameters(file), _components(file, "quantity_error")
    responses = [
        ResponseBounds(
            time=time, kind=attributes["bounds_kind"],
            errors={name: values[i] for name, values in errors.items()},
            error_shares={name: float(values[i]) for name, values in shares.items()},
            **{key: values[i] for key, values in columns.items() if values is not None},
        )
        for i in range(len(nones))
    ]  # fmt: skip
    return CampaignBounds(tuple(responses), parameters, attributes, quantity_errors)


def read_parameters(file: Any) -> list[dict[str, Any]]:
    """Read the interval parameters of an open result (`netCDF4.Dataset`): a dict each, of name,
    units, and lower, nominal and upper value in these."""
    keys = {"name": "parameter", "units": "box_units"}
    keys |= {key: f"box_{key}" for key in ("lower", "nominal", "upper")}
    columns = [file[name][:].tolist() for name in keys.values()]
    return [dict(zip(keys, row, strict=True)) for row in zip(*columns, strict=True)]


def _column(file: Any, name: str, default: Any = None) -> Any:
    """Return a variable of an open file, or the default if it is absent."""
    return file[name][:] if name in file.variables else default


def _components(file: Any, prefix: str, names: Sequence[str] = COMPONENTS) -> dict[str, np.ndarray]:
    """Variables of an open file by component of an error, those that there are."""
    columns = {name: _column(file, f"{prefix}_{name}") for name in names}
    return {name: values for name, values in columns.items() if values is not None}
