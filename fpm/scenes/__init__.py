"""Scenes: particles and elements at their start, and what a campaign needs of a structure."""
