"""Runs as files: outcomes of samples, and trajectories as netCDF."""
