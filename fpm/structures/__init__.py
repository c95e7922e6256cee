"""Structures from text files: `load(path)` gives the `SceneType` of a file.

A YAML file is data, in the language of docs/structures.md: it is checked before anything runs, and
runs no code. A Python file has a function `build` and its `PARAMETERS`; loading it runs it.
"""

import functools
import hashlib
import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from fpm.errors import SceneError, did_you_mean
from fpm.kernels.sources import syntax_digest
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import SceneType
from fpm.structures.builder import Builder
from fpm.structures.model import KEYS, TEXTS, Model
from fpm.structures.parameters import Given, read_parameters
from fpm.structures.place import as_meant
from fpm.structures.problems import Problem, Problems, StructureError, among
from fpm.structures.python_file import load_python
from fpm.structures.reading import Table, Text, plain, read
from fpm.structures.sample import build_sample

NAME = re.compile(r"\w[\w .+()-]{0,63}")
NAMED = "up to 64 letters, digits, spaces and . + - _ ( ), beginning with a letter or digit"
"""Names of structures: files are called after them."""

__all__ = ["StructureError", "check", "load", "loads"]


class _File:
    """A structure's file, from which scenes are built."""

    def __init__(self, table: Table, given: dict[str, Given], source: str):
        self.table, self.given, self.source = table, given, source
        self._models: dict[tuple, Model] = {}

    def build(self, **parameters) -> Scene:
        """The scene at the values given, each in its parameter's unit."""
        problems = Problems(self.source)
        builder = self.builder(parameters, problems)
        problems.stop()
        return builder.scene

    def builder(self, parameters: Mapping, problems: Problems) -> Builder:
        values = {name: one.si(parameters[name]) for name, one in self.given.items()}
        counts = {name: values[name] for name, one in self.given.items() if one.whole}
        key = tuple(counts.values())
        model = self._models.get(key) or Model(self.table, self.given, counts, problems)
        if not problems:
            self._models[key] = model
        return build_sample(model, values, problems)

    def __getstate__(self) -> dict:
        """What crosses processes: the file, from which models are made again."""
        return {**self.__dict__, "_models": {}}


def load(path: str | Path) -> SceneType:
    """The structure of a file, `.yaml` or `.py`; StructureError says all that is wrong with it."""
    path = Path(path)
    if path.suffix == ".py":
        return load_python(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text in UTF-8"
        problem = Problem(0, f"the file cannot be read: {reason}")
        raise StructureError(str(path), [problem]) from None
    return loads(text, str(path))


def loads(text: str, source: str = "structure") -> SceneType:
    """The structure of a YAML file's text; `source` names it in messages."""
    problems = Problems(source)
    stated = read(text, problems)
    if {"campaign", "intervals"} <= stated.entries.keys():
        what = (
            "this is a campaign's file; allowed: a structure's, such as the one its `scene` names"
        )
        problems.say(0, what)
        problems.stop()
    table = as_meant(stated, KEYS, problems)
    parameters = table.entries.get("parameters", Table({}, {}, 0))
    if not isinstance(parameters, Table):
        problems.refuse(parameters.line, "parameters", plain(parameters), "a mapping from names")
        problems.stop()
    given = read_parameters(parameters, problems)
    texts = {key: _text(table, key, problems) for key in TEXTS}
    if texts["name"] and not NAME.fullmatch(texts["name"]):
        line = table.lines.get("name", 0)
        problems.refuse(line, "name", texts["name"], NAMED)
    mesh = _mesh(table, texts["mesh"], given, problems)
    if len(given) < len(parameters.entries):
        problems.stop()  # every use of a parameter left out would be a problem of its own
    file = _File(table, given, source)
    defaults = {name: one.parameter.default for name, one in given.items()}
    scene = file.builder(defaults, problems).scene
    problems.stop()
    return SceneType(
        name=texts["name"] or Path(source).stem,
        description=texts["description"],
        parameters={name: one.parameter for name, one in given.items()},
        points=tuple(scene.points),
        hinges=tuple(hinge.name for hinge in scene.hinges),
        function=file.build,
        cables=tuple(cable.name for cable in scene.cables),
        mesh=mesh,
        content=hashlib.sha256(f"{_language()} {json.dumps(plain(table))}".encode()).hexdigest()[
            :16
        ],
    )


@functools.cache
def _language() -> str:
    """Digest of the code that makes scenes of texts."""
    # What is said of them.
    others = {"describe.py", "problems.py", "python_file.py", "report.py", "table.py"}
    paths = Path(__file__).parent.rglob("*.py")
    return syntax_digest(path for path in paths if path.name not in others)


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
        except StructureError as error:
            source = error.source
            for problem in error.problems:
                where = problem.where
                count[where] = count.get(where, 0) + 1
                if where not in worst or problem.size > worst[where][0].size:
                    worst[where] = problem, sample
        except SceneError as error:
            where = 0, error.key
            count[where] = count.get(where, 0) + 1
            worst.setdefault(where, (Problem(0, str(error)), sample))
    if worst:
        raise StructureError(source, [
            problem._replace(text=f"{problem.text} (in {count[where]} of {total} samples, worst at "
                             f"{', '.join(f'{n} = {v:.9g}' for n, v in sample.items())})")
            for where, (problem, sample) in worst.items()
        ])  # fmt: skip


def _text(table: Table, key: str, problems: Problems) -> str:
    node = table.entries.get(key, Text("", 0))
    if isinstance(node, Text):
        return node.value
    problems.refuse(node.line, key, plain(node), "text")
    return ""


def _mesh(table: Table, name: str, given: Mapping[str, Given], problems: Problems) -> str | None:
    """The parameter that the file calls its mesh."""
    whole = [other for other, one in given.items() if one.whole]
    stated = table.entries.get("parameters", Table({}, {}, 0)).entries
    if name and name not in whole and (name in given or name not in stated):
        hint, line = did_you_mean(name, whole), table.entries["mesh"].line
        problems.say(
            line, f"mesh: {name!r} is not allowed{hint}; allowed: a parameter with `whole: true`: "
            f"{among(whole)}"
        )  # fmt: skip
    return name or None
