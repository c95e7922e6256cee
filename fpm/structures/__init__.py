"""Structures from text files: `load(path)` gives the `SceneType` of a file.

A YAML file is data, in the language of docs/structures.md: it is checked before anything runs, and
runs no code."""

from fpm.structures.reading import StructureError
from fpm.structures.text_file import load, loads

__all__ = ["StructureError", "load", "loads"]
