"""Bounds of a deployable structure's motion over interval parameters.

`deployable.intervals` is interval mathematics, `deployable.campaign` what joins it to `fpm`, the
mechanics."""

__version__ = "0.1.0"
