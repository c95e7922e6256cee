"""Structures in Python, for whoever needs loops and conditions. Loading such a file runs it."""

import importlib.util
import sys
from pathlib import Path

from deployable.fpm.errors import SceneError
from deployable.fpm.scene import Scene
from deployable.fpm.scenes import Parameter, SceneType
from deployable.fpm.sources import own_sources, syntax_digest
from deployable.fpm.structures.problems import Problem, StructureError
from deployable.fpm.structures.structure_type import StructureType


def load_python(path: Path) -> SceneType:
    """The structure of a Python file with `PARAMETERS` and `build`, and, if it has one, `MESH`.

    PARAMETERS: dict of fpm.scenes.Parameter; build(**parameters) -> fpm.Scene; MESH: the name of
    the parameter that sets the mesh. The docstring is its description. StructureError otherwise.
    """
    module = _run(path)
    parameters, build = getattr(module, "PARAMETERS", None), getattr(module, "build", None)
    mesh = getattr(module, "MESH", None)
    if not isinstance(parameters, dict) or not all(
        isinstance(p, Parameter) for p in parameters.values()
    ):
        _refuse(path, "PARAMETERS: missing; allowed: a dict of fpm.scenes.Parameter by name")
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
    return StructureType(
        name=path.stem,
        description=(module.__doc__ or "").strip().split("\n")[0],
        parameters=parameters,
        points=tuple(scene.points),
        hinges=tuple(hinge.name for hinge in scene.hinges),
        function=build,
        mesh=mesh,
        content=syntax_digest(own_sources(path)),
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
    except OSError as error:
        _refuse(path, f"the file cannot be read: {error.strerror}")
    except Exception as error:
        _refuse(path, f"it cannot be run: {type(error).__name__}: {error}")
    return module


def _check_imports(path: Path) -> None:
    """Refuse a file that has another module for one beside it, of which its digest is made."""
    for beside in own_sources(path) - {path.resolve()}:
        file = getattr(sys.modules.get(beside.stem), "__file__", None)
        if beside.parent == path.resolve().parent and file and Path(file).resolve() != beside:
            _refuse(
                path, f"import {beside.stem}: is {file} already, not {beside.name} from beside it; "
                "allowed: a name that no other module has"
            )  # fmt: skip


def _refuse(path: Path, text: str) -> None:
    raise StructureError(str(path), [Problem(0, text)]) from None
