"""Structures from text files: `load(path)` gives the `SceneType` of a file.

A YAML file is data, in the language of docs/structures.md: it is checked before anything runs, and
runs no code. A Python file has a function `build` and its `PARAMETERS`; loading it runs it."""

from pathlib import Path

from fpm.scenes.scene_type import SceneType
from fpm.structures.python_file import load_python
from fpm.structures.reading import StructureError
from fpm.structures.text_file import load_text, loads

__all__ = ["StructureError", "load", "loads"]


def load(path: str | Path) -> SceneType:
    """Return the structure in the file at `path`, `.yaml` or `.py`, as a SceneType object, whose
    `build` makes its scenes. A `.py` file is run. Raises StructureError: of a `.yaml` file with all
    that is wrong, of a `.py` the first."""
    path = Path(path)
    return load_python(path) if path.suffix == ".py" else load_text(path)
