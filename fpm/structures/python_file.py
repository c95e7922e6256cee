"""Structures in Python, for whoever needs loops and conditions. Loading such a file runs it."""

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

from fpm.errors import SceneError
from fpm.kernels.sources import own_sources
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import Parameter, SceneType
from fpm.structures.opened import STATED, Build, Loader, Opened, watching
from fpm.structures.reading import Problem, StructureError, read_text


def load_python(path: Path) -> SceneType:
    """The structure of a Python file with `PARAMETERS` and `build`, and, if it has them, `MESH` and
    `DATA`.

    PARAMETERS: dict of fpm.scene_type.Parameter; build(**parameters) -> fpm.Scene; MESH: the name
    of the parameter that sets the mesh; DATA: patterns of files, from its folder, that it reads at
    other values only or unseen (`fpm.structures.opened`). The docstring is its description.
    StructureError otherwise. Its digest is of all files that are opened while it is loaded and
    built at its defaults, of those below its folder that its code imports, and of DATA. It is
    loaded once, and again when one of these has changed.
    """
    read_text(path)  # which tells what is no file, before Python waits for it
    place = path.absolute()
    if place not in _KNOWN or not _KNOWN[place][1].is_same():
        opened = Opened(path.resolve())
        found = _loaded(path, opened)
        if place in _KNOWN:
            opened.follow(_KNOWN[place][1])
        _KNOWN[place] = found, opened
    found, opened = _KNOWN[place]
    if outer := watching():
        outer.adopt(opened)
    return found


_KNOWN: dict[Path, tuple[SceneType, Opened]] = {}
"""Structures that were loaded, and what they are made of."""


def _loaded(path: Path, opened: Opened) -> SceneType:
    with opened.watched():
        module = _run(path, opened)
        found = _built(path, module)
    data = getattr(module, "DATA", None)
    patterns = [] if data is None else data
    if not isinstance(patterns, list | tuple) or not all(isinstance(p, str) for p in patterns):
        _refuse(path, f"DATA: {data!r} is not allowed; allowed: a list of patterns of files")
    content = opened.seal(data)
    _check_imports(path, opened)
    for pattern in patterns:
        if not opened.files_of(pattern):
            _refuse(path, f"DATA: {pattern!r} stands for no file; allowed: patterns of files")
    if hidden := opened.hidden():
        _refuse(path, f"{', '.join(hidden)}: {HIDDEN}; allowed: {STATED}")
    return replace(found, function=Build(found.function, opened), content=content)


HIDDEN = "what this reads is not seen, and results are named after all that a structure reads"


def _built(path: Path, module: ModuleType) -> SceneType:
    """The structure, built at its defaults, with the digest of no code yet."""
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


def _run(path: Path, opened: Opened) -> ModuleType:
    """The module of a file, which may import others from beside it, now or when it builds."""
    if (beside := str(path.resolve().parent)) not in sys.path:
        sys.path.append(beside)  # last: none of them stands for a module that is installed
    name = f"structure_{path.stem}"
    loader = Loader(name, str(path.resolve()), opened)
    spec = importlib.util.spec_from_file_location(name, path, loader=loader)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look up annotations
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        _refuse(path, f"it cannot be run: {type(error).__name__}: {error}")
    return module


def _check_imports(path: Path, opened: Opened) -> None:
    """Refuse a file that has another module for one beside it, of which its digest is made."""
    folder = path.resolve().parent
    for beside in own_sources(path) - {path.resolve()}:
        if folder not in beside.parents:
            continue
        parts = beside.relative_to(folder).with_suffix("").parts
        name = ".".join(parts).removesuffix(".__init__")
        file = getattr(opened.modules.get(name, sys.modules.get(name)), "__file__", None)
        if file and Path(file).resolve() != beside:
            _refuse(
                path, f"import {name}: is {file} already, not {beside.name} from beside it; "
                "allowed: a name that no other module has"
            )  # fmt: skip


def _refuse(path: Path, text: str) -> None:
    raise StructureError(str(path), [Problem(0, text)]) from None
