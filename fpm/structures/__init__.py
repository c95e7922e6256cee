"""Structures from text files: `load(path)` gives the `SceneType` of a file.

A YAML file is data, in the language of docs/structures.md: it is checked before anything runs, and
runs no code. A Python file has a function `build` and its `PARAMETERS`; loading it runs it.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path

from fpm.errors import SceneError
from fpm.scenes.scene_type import SceneType
from fpm.structures.python_file import load_python
from fpm.structures.reading import Problem, StructureError
from fpm.structures.text_file import load_text, loads

__all__ = ["StructureError", "check", "load", "loads"]


def load(path: str | Path) -> SceneType:
    """The structure of a file, `.yaml` or `.py`; StructureError says all that is wrong with it."""
    path = Path(path)
    return load_python(path) if path.suffix == ".py" else load_text(path)


def check(scene_type: SceneType, samples: Iterable[Mapping[str, float]]) -> None:
    """Build a structure at samples of its parameters; StructureError tells the worst of each kind.

    samples: values that differ from the defaults, by name, in the parameters' units: the corners of
    a campaign's box, say. Nothing is run.
    """
    worst: dict[tuple[int, str], tuple[Problem, Mapping]] = {}
    count: dict[tuple[int, str], int] = {}
    source, total = scene_type.name, 0
    for sample in samples:
        total += 1
        try:
            scene_type.build(**sample)
            continue
        except StructureError as error:
            source = error.source
            problems = [(problem.where, problem) for problem in error.problems]
        except SceneError as error:
            problems = [((0, error.key), Problem(0, str(error)))]
        for where, problem in problems:
            count[where] = count.get(where, 0) + 1
            if where not in worst or problem.size > worst[where][0].size:
                worst[where] = problem, sample
    if worst:
        raise StructureError(source, [
            problem._replace(text=f"{problem.text} (in {count[where]} of {total} samples, worst at "
                             f"{', '.join(f'{n} = {v:.9g}' for n, v in sample.items())})")
            for where, (problem, sample) in worst.items()
        ])  # fmt: skip
