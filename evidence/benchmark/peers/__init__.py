"""The same work by peers, where they are installed: Exudyn and PyElastica."""
