"""The workflow's side: from a config to nodes, runs, samples, bounds and figures.

The only package that knows both `fpm` (mechanics) and `intervals` (interval mathematics). The two
meet in netCDF files. Modules in the order of a campaign: `config`, `nodes`, `run`, `gather`,
`analyse`, `figures`, `linkage`, `summary`. Heavy imports stay inside the functions that need them.
"""
