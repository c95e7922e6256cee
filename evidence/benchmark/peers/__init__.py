"""The same work by Exudyn, where it is installed."""
