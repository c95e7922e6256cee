"""The responses of all runs of a plan, gathered into `samples.nc`."""
