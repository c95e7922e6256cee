"""Structures in Python, for whoever needs loops and conditions. Loading such a file runs it."""

import importlib.util
import os
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

from fpm.errors import SceneError
from fpm.kernels.sources import own_sources, syntax_digest
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import Parameter, SceneType
from fpm.structures.reading import Problem, StructureError, read_text


def load_python(path: Path) -> SceneType:
    """The structure of a Python file with `PARAMETERS` and `build`, and, if it has one, `MESH`.

    PARAMETERS: dict of fpm.scene_type.Parameter; build(**parameters) -> fpm.Scene; MESH: the name
    of the parameter that sets the mesh. The docstring is its description. StructureError otherwise.
    Its digest is of the file, of those below its folder that it imports, and of data files there
    that Python opens while it is loaded and built at its defaults.
    """
    read_text(path)  # which tells what is no file, before Python waits for it
    _hook()
    _READING.append((read := set(), path.resolve().parent))
    try:
        found = _loaded(path)
    finally:
        _READING.pop()
    content = syntax_digest([*own_sources(path), *sorted(read)])
    return replace(found, content=content)


_READING: list[tuple[set[Path], Path]] = []
"""Where files that are read are noted, and below which folder."""


@cache
def _hook() -> None:
    """Note data files that are opened to be read, for good: hooks stay."""

    def note(event: str, arguments: tuple) -> None:
        if _READING and event == "open" and isinstance(arguments[0], str | bytes):
            read, folder = _READING[-1]
            path = Path(os.fsdecode(arguments[0])).resolve()
            if path.suffix not in (".py", ".pyc") and folder in path.parents and path.is_file():
                read.add(path)

    sys.addaudithook(note)


def _loaded(path: Path) -> SceneType:
    """The structure, with the digest of no code yet."""
    module = _run(path)
    parameters, build = getattr(module, "PARAMETERS", None), getattr(module, "build", None)
    mesh = getattr(module, "MESH", None)
    known = parameters.values() if isinstance(parameters, dict) else [None]
    if not all(isinstance(one, Parameter) for one in known):
        _refuse(path, "PARAMETERS: missing; allowed: a dict of fpm.scene_type.Parameter by name")
    if not callable(build):
        _refuse(path, "build: missing; allowed: a function of the parameters that gives a Scene")
    if mesh is not None and (mesh not in parameters or parameters[mesh].kind != "integer"):
        _refuse(path, f"MESH: {mesh!r} is not allowed; allowed: an integer parameter's name, None")
    defaults = {name: parameter.default for name, parameter in parameters.items()}
    try:
        scene = build(**defaults)
    except SceneError as error:
        _refuse(path, f"build at the default values: {error}")
    except Exception as error:
        _refuse(path, f"build at the default values: {type(error).__name__}: {error}")
    if not isinstance(scene, Scene):
        _refuse(path, f"build: gives {type(scene).__name__}; allowed: an fpm.Scene")
    _check_imports(path)
    return SceneType(
        name=path.stem,
        description=(module.__doc__ or "").strip().split("\n")[0],
        parameters=parameters,
        points=tuple(scene.points),
        hinges=tuple(hinge.name for hinge in scene.hinges),
        function=build,
        mesh=mesh,
        content="",
    )


def _run(path: Path):
    """The module of a file, which may import others from beside it, now or when it builds."""
    if (beside := str(path.resolve().parent)) not in sys.path:
        sys.path.append(beside)  # last: none of them stands for a module that is installed
    spec = importlib.util.spec_from_file_location(f"structure_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look up annotations
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        _refuse(path, f"it cannot be run: {type(error).__name__}: {error}")
    return module


def _check_imports(path: Path) -> None:
    """Refuse a file that has another module for one beside it, of which its digest is made."""
    folder = path.resolve().parent
    for beside in own_sources(path) - {path.resolve()}:
        if folder not in beside.parents:
            continue
        parts = beside.relative_to(folder).with_suffix("").parts
        name = ".".join(parts).removesuffix(".__init__")
        file = getattr(sys.modules.get(name), "__file__", None)
        if file and Path(file).resolve() != beside:
            _refuse(
                path, f"import {name}: is {file} already, not {beside.name} from beside it; "
                "allowed: a name that no other module has"
            )  # fmt: skip


def _refuse(path: Path, text: str) -> None:
    raise StructureError(str(path), [Problem(0, text)]) from None
