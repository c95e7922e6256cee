"""Structures in Python, for whoever needs loops and conditions. Loading such a file runs it."""

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

from fpm.errors import SceneError
from fpm.kernels.sources import find_user_sources
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import Parameter, SceneType
from fpm.structures.opened_files import DATA_HINT, Build, FileRecord, Loader, current_record
from fpm.structures.reading import Problem, StructureError, read_text
from fpm.structures.structure import Structure


def load_python(path: Path) -> SceneType:
    """Return the structure (SceneType) in the Python file at `path`, which is run.

    The file has PARAMETERS (dict of fpm.scenes.scene_type.Parameter by name) and
    build(**parameters), which returns an fpm.Scene, perhaps MESH (name of the parameter that sets
    the mesh), and the description as its docstring; or it has STRUCTURE, a fpm.Structure. Either
    may have DATA (glob patterns in its folder of files read at other values only or unseen). Raises
    StructureError for anything else. The structure's digest covers all files opened while it is
    loaded and built at its defaults, code imported from below its folder, and DATA. A process loads
    it once, and again when one of these changed."""
    read_text(path)  # which tells what is no file, before Python waits for it
    place = path.absolute()
    if place not in _CACHE or not _CACHE[place][1].is_same():
        record = FileRecord(path.resolve())
        structure = _load(path, record)
        if place in _CACHE:
            record.follow(_CACHE[place][1])
        _CACHE[place] = structure, record
    structure, record = _CACHE[place]
    if outer := current_record():
        outer.adopt(record)
    return structure


_CACHE: dict[Path, tuple[SceneType, FileRecord]] = {}
"""Structures that were loaded, and what they are made of."""


def _load(path: Path, record: FileRecord) -> SceneType:
    with record.recording():
        module = _run(path, record)
        structure = _build_type(path, module)
    data = getattr(module, "DATA", None)
    patterns = [] if data is None else data
    if not isinstance(patterns, list | tuple) or not all(isinstance(p, str) for p in patterns):
        _refuse(path, f"DATA: {data!r} is not allowed; allowed: a list of patterns of files")
    content = record.seal(data)
    _check_imports(path, record)
    for pattern in patterns:
        if not record.files_of(pattern):
            _refuse(path, f"DATA: {pattern!r} stands for no file; allowed: patterns of files")
    if reads := record.list_hidden_reads():
        _refuse(path, f"{', '.join(reads)}: {HIDDEN_READS}; allowed: {DATA_HINT}")
    function = Build(structure.function, record)
    return replace(structure, function=function, prepare=None, content=content)


HIDDEN_READS = "what this reads is not seen, and results are named after all that a structure reads"


def _build_type(path: Path, module: ModuleType) -> SceneType:
    """The structure, built at its defaults, with the digest of no code yet."""
    parameters, build = getattr(module, "PARAMETERS", None), getattr(module, "build", None)
    if (structure := getattr(module, "STRUCTURE", None)) is not None:
        if not isinstance(structure, Structure) or parameters is not None:
            _refuse(path, "STRUCTURE: not allowed; allowed: an fpm.Structure, without PARAMETERS")
        structure.source = str(path)
        return structure.scene_type
    mesh = getattr(module, "MESH", None)
    values = parameters.values() if isinstance(parameters, dict) else [None]
    if not all(isinstance(value, Parameter) for value in values):
        _refuse(
            path,
            "PARAMETERS: missing; allowed: a dict of fpm.scenes.scene_type.Parameter by name, or "
            "STRUCTURE in its place",
        )
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


def _run(path: Path, record: FileRecord) -> ModuleType:
    """The module of a file, which may import others from beside it, now or when it builds."""
    if (folder := str(path.resolve().parent)) not in sys.path:
        sys.path.append(folder)  # last: none of them stands for a module that is installed
    name = f"structure_{path.stem}"
    loader = Loader(name, str(path.resolve()), record)
    spec = importlib.util.spec_from_file_location(name, path, loader=loader)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look up annotations
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        _refuse(path, f"it cannot be run: {type(error).__name__}: {error}")
    return module


def _check_imports(path: Path, record: FileRecord) -> None:
    """Refuse a file that has another module for one beside it, of which its digest is made."""
    folder = path.resolve().parent
    for source in find_user_sources(path) - {path.resolve()}:
        if folder not in source.parents:
            continue
        parts = source.relative_to(folder).with_suffix("").parts
        name = ".".join(parts).removesuffix(".__init__")
        file = getattr(record.modules.get(name, sys.modules.get(name)), "__file__", None)
        if file and Path(file).resolve() != source:
            modules = f"is {file} already, not {source.name} from beside it"
            _refuse(path, f"import {name}: {modules}; allowed: a name that no other module has")


def _refuse(path: Path, text: str) -> None:
    raise StructureError(str(path), [Problem(0, text)]) from None
