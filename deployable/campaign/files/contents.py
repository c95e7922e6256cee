"""Checks of what results hold: variables, their dimensions, values and names. Results may come from
anybody. Their readers rely on these checks, which are made once, where a file is opened."""

import json
import math
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.config.sections import Experiment, steps_problems
from deployable.campaign.errors import CampaignError, HeldConfigError
from deployable.campaign.files.variables import VariableSpec, variables_of
from fpm.files.seals import DamagedError

ROLES = ("nominal", "node", "held_out", "further")
EVENT_VARIABLES = ("event_time", "event_contact", "event_closing")
"""Variables of events of runs, in the order of the columns of their tables."""

FAILURE_VARIABLES = ("failed_id", "failed_normalized", "failed_value", "failed_time",
                     "failed_reason")  # fmt: skip
"""Variables of runs that failed, which no other variable has."""

RUN_ID = re.compile("[0-9a-f]{16}")
"""Pattern of the names of runs, after which files are called."""

_SCALING = {"scale_factor", "add_offset", "missing_value", "valid_min", "valid_max", "valid_range",
            "_Unsigned"}  # fmt: skip
"""Attributes by which libraries make other numbers, or none, of those that are in a file."""

_ROOM, _MAX_EXPANSION = 1 << 28, 200
"""Bytes that a file's numbers may take in memory, or as many times those that it takes itself."""

_LONGEST, _LARGEST = 2000, 1e300
"""Characters of a text, and a number beyond which differences of numbers are infinite."""

_ALL = 1 << 26
"""Bytes of a variable up to which all its numbers are looked at."""


@contextmanager
def report_damage(path: str | os.PathLike) -> Iterator[None]:
    """Context manager for code that reads the file `path`: errors from malformed content become
    DamagedErrors; others, such as a missing file or a message for users, stay as they are."""
    try:
        yield
    except Exception as error:
        is_other = isinstance(error, OSError) and (error.errno or 0) > 0  # it is not there, say
        is_ours = isinstance(error, CampaignError) and not isinstance(error, HeldConfigError)
        if is_other or is_ours or isinstance(error, DamagedError):
            raise
        words = " ".join(str(error).split()) or type(error).__name__
        is_missing = isinstance(error, LookupError)
        raise DamagedError(path, f"{words} is missing" if is_missing else words) from error


def experiment_of(path: str | os.PathLike) -> Experiment | None:
    """Check the content of a result in netCDF and return the `Experiment` that it carries as its
    config; None for a file of which only sizes are checked, such as a motion. Raises DamagedError
    where variables, shapes or values are not those of such a file."""
    state = os.stat(path)
    return _inspect(Path(path), state.st_ino, state.st_size, state.st_mtime_ns, state.st_ctime_ns)


@lru_cache(64)
def _inspect(path: Path, *state: int) -> Experiment | None:
    import netCDF4

    with report_damage(path), netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        _check_sizes(file, os.path.getsize(path))
        name = path.name
        if name == "samples.nc" and "lower_run" in file.variables:
            name = "extremes"
        if not (variables := variables_of(name)):
            return None
        if name == "sensitivities.nc" and not file.variables:  # nothing was fitted
            return Experiment.read(file.config)
        for field, spec in variables.items():
            if spec.dims == ("@",):
                _check_attribute(file, field, spec.content)
            else:
                _check_variable(file, field, spec)
        return _belongs(file, Experiment.read(file.config))


def _check_sizes(file: Any, size: int) -> None:
    total = 0
    for name, variable in file.variables.items():
        if names := _SCALING & set(variable.ncattrs()):
            raise ValueError(f"its variable {name} has {', '.join(sorted(names))}, as none has")
        item_bytes = 64 if variable.dtype is str else variable.dtype.itemsize
        total += item_bytes * math.prod(map(int, variable.shape))
    if total > max(_ROOM, _MAX_EXPANSION * size):
        raise ValueError(f"its {size} bytes would be {total:.3g} in memory")


def _check_attribute(file: Any, name: str, kind: str) -> None:
    value = file.getncattr(name) if name in file.ncattrs() else None
    if isinstance(value, str) != (kind == "text") or value is None:
        raise ValueError(f"it has no attribute {name} that is a {kind}")
    is_list = np.ndim(value) > (name == "design_order")
    if kind == "number" and (is_list or not np.isfinite(value).all()):
        raise ValueError(f"its attribute {name} is no number")
    if name == "provenance":
        matches(_PROVENANCE, json.loads(value), name)


def _check_variable(file: Any, name: str, spec: VariableSpec) -> None:
    kind, variable = spec.content, file.variables.get(name)
    if variable is None:
        if spec.is_optional:
            return
        raise ValueError(f"it has no variable {name}")
    if variable.dimensions != spec.dims:
        axes = " and ".join(variable.dimensions) or "nothing"
        raise ValueError(f"its variable {name} lies over {axes}, not {' and '.join(spec.dims)}")
    if not variable.size:  # text is kept as numbers then
        return
    is_text = variable.dtype is str
    if is_text != (kind == "text") or not (is_text or variable.dtype.kind in "fiu"):
        raise ValueError(f"its variable {name} holds {variable.dtype}, not {kind}s")
    if not is_text and variable.size * variable.dtype.itemsize > _ALL:
        return
    values, fill_value = variable[:], getattr(variable, "_FillValue", np.nan)  # if it can be read
    if is_text and max(map(len, values.ravel())) > _LONGEST:
        raise ValueError(f"its variable {name} has a text of more than {_LONGEST} characters")
    if kind == "known" and not ((np.abs(values) < _LARGEST) & (values != fill_value)).all():
        raise ValueError(f"its variable {name} has values that are no numbers, or too large")


def _belongs(file: Any, experiment: Experiment) -> Experiment:
    """The experiment of a file, if what it holds is of that."""
    variables = file.variables
    sections = {"response": experiment.responses, "quantity": experiment.quantities,
                "parameter": experiment.intervals}  # fmt: skip
    for dim in sections.keys() & variables.keys():
        if (names := file[dim][:].tolist()) != list(sections[dim]):
            stray = next((name for name in names if name not in sections[dim]), names)
            raise ValueError(f"{str(stray)[:80]!r} is no name of a {dim} of its config")
    for name in file["run_id"][:].tolist() if "run_id" in variables else ():
        if not RUN_ID.fullmatch(name):  # after which files are called
            raise ValueError(f"{name[:80]!r} is no name of a run_id")
    for text in file["response_along"][:] if "response_along" in variables else ():
        if (axis := json.loads(text)) is not None:
            matches(_schema()["$defs"]["along"], axis, "response_along")
    if mismatches := [name for name, is_own in _compare(file, experiment) if not is_own]:
        raise ValueError(f"its {mismatches[0]} is not what its config has")
    return experiment


def _compare(file: Any, experiment: Experiment) -> Iterator[tuple[str, bool]]:
    """What of a file is as the config of its experiment has it, by name."""
    variables, intervals = file.variables, experiment.intervals.values()
    yield "campaign", file.campaign == experiment.name
    for key in ("lower", "upper", "nominal"):
        ends = [getattr(interval, key) for interval in intervals]
        yield f"box_{key}", file[f"box_{key}"][:].tolist() == ends
    if "normalized" in variables and len(points := file["normalized"][:]):
        yield "normalized", np.abs(points).max(initial=0.0) < 1.0 + 1e-6
    if "role" in variables:
        yield "role", set(file["role"][:].tolist()) <= set(ROLES)
    if "time" in variables:
        time, step = file["time"][:], file.time_step
        yield "time_step", step > 0 and not steps_problems(experiment.solver, step)
        yield "time", len(time) == experiment.solver.instants and (np.diff(time) > 0).all()
    if "event_time" in variables:
        contact = file["event_contact"][:][np.isfinite(file["event_time"][:])]
        is_known = (contact >= 0) & (contact < len(file.dimensions["contact"]))
        yield "event_contact", is_known.all()
    for name in {"lower_run", "upper_run"} & variables.keys():
        yield name, file[name][:].max(initial=-1) < len(file.dimensions["run"])


# -- JSON ------------------------------------------------------------------------------------------

_TYPES = {"object": (dict,), "array": (list,), "string": (str,), "boolean": (bool,),
          "null": (type(None),), "number": (int, float), "integer": (int,)}  # fmt: skip
_NUMBERS = {"type": "array", "minItems": 2, "items": {"type": "number"}}
_BATCH = {"seconds": _NUMBERS, "seconds_integrating": _NUMBERS, "simulated": {"type": "number"}}
_MANIFEST = {"required": list(_BATCH), "properties": _BATCH}
_TEXTS = {"type": "object", "additionalProperties": {"type": "string"}}
_PROVENANCE = {**_TEXTS, "required": ["program", "commit", "processor"]}


@cache
def _schema() -> dict:
    text = Path(__file__).parents[1] / "results" / "summary.schema.json"
    return json.loads(text.read_text(encoding="utf-8"))


def data_of(path: str | os.PathLike, content: bytes) -> dict:
    """Parse and check a result in JSON, and return its data without the seal. path: of the file,
    whose name tells what it should hold, else DamagedError; content: its bytes."""
    properties = _schema()["properties"]
    answers = {name: properties[name] for name in ("requirements", "together")}
    schemas = {
        "plan.json": {"type": "object"},
        "summary.json": _schema(),
        "requirements.json": {"required": [*answers, "further_runs"], "properties": answers},
        "choice.json": {
            **properties["choice"],
            "required": [*properties["choice"]["required"], "fitted"],
        },
        "cases.json": _schema()["$defs"]["cases"],
        "measured.json": properties["measured"],
    }
    with report_damage(path):
        data = json.loads(content, parse_constant=_no_number)
        matches(schemas.get(Path(path).name, _MANIFEST), data)
        return {key: value for key, value in data.items() if key != "seal"}


def _no_number(text: str) -> None:
    raise ValueError(f"{text} is no number")


def matches(schema: Mapping, data: Any, path: str = "") -> None:
    """Raise ValueError unless plain data of a result match a JSON schema. Keywords that
    `summary.schema.json` does not use are ignored. path: for messages, as `rows[2]`."""
    if "$ref" in schema:
        matches(_schema()["$defs"][schema["$ref"].rpartition("/")[2]], data, path)
    _check_value(schema, data, path)
    if isinstance(data, list):
        if len(data) < (least := schema.get("minItems", 0)):
            raise ValueError(f"{path} has {len(data)} entries; allowed: {least} or more")
        for number, item in enumerate(data):
            matches(schema.get("items", {}), item, f"{path}[{number}]")
    elif isinstance(data, dict):
        if lacks := [name for name in schema.get("required", ()) if name not in data]:
            raise ValueError(f"{'.'.join(filter(None, [path, lacks[0]]))} is missing")
        properties, extra = schema.get("properties", {}), schema.get("additionalProperties", {})
        for name, item in data.items():
            if (rule := properties.get(name, extra)) is False:
                raise ValueError(f"{path}.{name} is not known")
            matches(rule, item, f"{path}.{name}" if path else name)


def _check_value(schema: Mapping, data: Any, path: str) -> None:
    kinds = schema.get("type", "object" if "required" in schema else [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    types = tuple(kind for name in kinds for kind in _TYPES[name])
    if kinds and (not isinstance(data, types) or (isinstance(data, bool) and bool not in types)):
        raise ValueError(f"{path or 'all of it'} is no {' or '.join(kinds)}")
    if data not in schema.get("enum", [data]) or data != schema.get("const", data):
        allowed = schema.get("enum", [schema.get("const")])
        raise ValueError(f"{path} is {data!r:.60}; allowed: {', '.join(map(repr, allowed))}")
