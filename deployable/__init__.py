"""Bounds of a deployable structure's motion over interval parameters.

The one name under which everything is imported: `deployable.fpm` is mechanics,
`deployable.intervals` interval mathematics, `deployable.campaign` what joins the two. Nothing is
imported here, so that `python -m deployable` can set up numerics that are not loaded yet.
"""
