"""Structures from YAML, in the language of docs/structures.md: data, which runs no code.

Parameters have value, unit, range and description side by side."""

import hashlib
import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from fpm.arithmetic.expressions import ExpressionError, parse
from fpm.arithmetic.units import Unit, UnitError, number_hint, unit
from fpm.declare import NO_VALUE
from fpm.errors import SceneError, did_you_mean
from fpm.scenes.scene import Scene
from fpm.scenes.scene_type import Parameter, SceneType
from fpm.structures.builder import Builder
from fpm.structures.curves_file import CurvesFile
from fpm.structures.keys import STRING
from fpm.structures.model import KEYS, TEXTS, UNIT_KEYS, FileStatements, overall
from fpm.structures.names import Names
from fpm.structures.reading import (
    OF_CAMPAIGNS,
    OTHER_KEYS,
    Node,
    Problems,
    check_keys,
    commas,
    correct_keys,
    read,
    read_text,
)
from fpm.structures.sample import build_sample, find_numbers, share_parts
from fpm.structures.statement import Statement
from fpm.structures.statements import GROUPS

MOST_VALUES, FINEST, COARSEST = 200_000, 1025, 65
"""Largest number of values of all expressions, and of values of the parameter, most and least."""

SHARP = 10.0
"""By how much the change of slope at a bend exceeds that of both sides."""

ROUNDING = 1e-9
"""Share of an expression's size below which a change is none."""


LEAST_GAPS = 1e-6, 1e-12
"""Shares of the interval: two extremes, or two knots, that are no farther apart are the same."""


def find_turns(
    evaluate: Callable[[float], np.ndarray], borders: Sequence[bool], lower: float, upper: float
) -> list[float]:
    """Return the values of a parameter between `lower` and `upper` at which any of m functions has
    an extreme, then the exact ones (knots) at which a border among them vanishes, then those at
    which a slope jumps elsewhere. evaluate(value): functions (m,), NaN: none; borders (m).
    An extreme or jump of slope below a thousandth of the interval is not seen, of more than 200
    functions a 65th."""
    from scipy.optimize import brentq, minimize_scalar

    if not borders:
        return []
    count, width = int(np.clip(MOST_VALUES // len(borders), COARSEST, FINEST)), upper - lower
    grid = np.linspace(lower, upper, count)
    values = np.array([evaluate(x) for x in grid])
    extremes, knots, bends = set(), set(), set()
    for k, (series, size) in enumerate(zip(values.T, np.abs(values).max(axis=0), strict=True)):
        function = lambda x, k=k: evaluate(x)[k]  # noqa: E731
        # Extremes: between steps of unlike signs, with none between them but where it is flat.
        steps = np.diff(series)
        rows = np.flatnonzero(np.abs(steps) > ROUNDING * size)
        turns = np.flatnonzero(np.diff(np.sign(steps[rows])))
        places = dict(zip(grid, series, strict=True))
        for first, last in zip(rows[turns], rows[turns + 1] + 1, strict=True):
            loss = lambda x, f=function, step=steps[first]: -np.sign(step) * f(x)  # noqa: E731
            bounds, options = grid[[first, last]], {"xatol": 1e-9 * width}
            x = minimize_scalar(loss, bounds=bounds, method="bounded", options=options).x
            extremes.add(x)
            places[x] = function(x)
        # Knots: roots between neighbouring places, extremes among them.
        signs = [(x, np.sign(y)) for x, y in sorted(places.items())] if borders[k] else []
        for (start, sign), (end, next_sign) in pairwise(signs):
            if sign != next_sign and sign * next_sign <= 0:
                with suppress(ValueError):  # no number between
                    knots.add(brentq(function, start, end, xtol=1e-15 * width))
        # Bends: the slope changes much more than on both sides; the first of neighbouring places.
        change = np.abs(np.diff(steps))
        sides = np.abs(change[:-4]) + np.abs(change[4:])
        sharp = change[2:-2] > SHARP * sides + ROUNDING * size
        bends |= set(grid[np.flatnonzero(sharp & ~np.append(False, sharp[:-1])) + 3])
    peaks = [x for y in extremes for x in knots if abs(x - y) <= LEAST_GAPS[0] * width]
    results, shares = [lower, upper], (LEAST_GAPS[1], *LEAST_GAPS, 2 / (count - 1))
    for group, share in zip((peaks, extremes, knots, bends), shares, strict=True):
        for x in map(float, sorted(group)):
            if lower < x < upper and min(abs(x - y) for y in results) > share * width:
                results.append(x)
    return results[2:]


NAME = re.compile(r"\w[\w .+()-]{0,63}")
NAME_RULE = "up to 64 letters, digits, spaces and . + - _ ( ), beginning with a letter or digit"
"""Names of structures: files are called after them."""


PARAMETER_KEYS = ("value", "unit", "range", "description", "whole")


@dataclass(frozen=True)
class GivenParameter:
    """A parameter of a YAML file. parameter: its definition; unit: in which the file gives its
    values; line: where it stands, from 1."""

    parameter: Parameter
    unit: Unit
    line: int

    def si(self, value: float) -> float:
        """Return a value, given in the parameter's unit, in SI units."""
        return self.unit.si(float(value))


class _File:
    """A structure's file, from which scenes are built."""

    def __init__(self, table: Node, parameters: dict[str, GivenParameter], source: str):
        self.table, self.parameters, self.source = table, parameters, source
        self.files: dict[Path, CurvesFile] = {}
        self._models: dict[tuple, FileStatements] = {}

    def build(self, **parameters) -> Scene:
        """Return the scene at the values given, each in its parameter's unit."""
        problems = Problems(self.source)
        builder = self.builder(parameters, problems)
        if not problems and not len(builder.scene.mass):
            problems.say(0, "the structure has no part; allowed: at least a bar, a body or a mass")
        problems.stop()
        return builder.scene

    def prepare(self, samples: Sequence[Mapping]) -> Callable[[Mapping], Scene | None]:
        """Return a function that builds samples at values of all parameters, with their common
        parts built once. It returns None for a sample that must be built on its own."""
        first, *rest = map(self._values, samples)
        names = {name for values in rest for name in first if values[name] != first[name]}
        model = self._model(first, problems := Problems(self.source))
        if problems or any(self.parameters[name].parameter.is_whole for name in names):
            return lambda sample: None
        build = share_parts(model, first, names)
        return lambda sample: build(self._values(sample))

    def find_turns(self, parameters: Mapping, name: str, lower: float, upper: float) -> list[float]:
        """Values between two of one parameter at which an expression that depends on it, or a part
        of one, turns back or bends, at values given of the others, each in its parameter's unit."""
        model = self._model(self._values(parameters), Problems(self.source))
        names, numbers = model.names, model.names.dependents([name])
        order = [number for number in names.order if number in numbers]
        bounds = {}  # each expression once that depends on the parameter
        for bound in names.bounds:
            if not numbers.isdisjoint(bound.full.values()):
                bounds[bound.expression.text, *bound.full.values()] = bound
        functions = []
        for bound in bounds.values():
            for part in (bound.expression.value, *bound.expression.parts):
                functions.append((part, bound.full, part in bound.expression.borders))
        build = Builder(Problems(self.source))
        find_numbers(build, model, self._values(parameters), names.order)

        def evaluate(value: float) -> np.ndarray:
            find_numbers(build, model, self._values({**parameters, name: value}), order)
            values = np.full(len(functions), np.nan)  # of vectors, coordinates are numbers as well
            for k, (function, full, _) in enumerate(functions):
                with suppress(KeyError, ArithmeticError, ValueError, TypeError):
                    values[k] = float(function({x: build.numbers[y] for x, y in full.items()}))
            return values

        with np.errstate(all="ignore"):
            return find_turns(evaluate, [is_border for *_, is_border in functions], lower, upper)

    def _values(self, parameters: Mapping) -> dict[str, float]:
        return {name: p.si(parameters[name]) for name, p in self.parameters.items()}

    def builder(self, parameters: Mapping, problems: Problems) -> Builder:
        """Return the sample at the values given; `problems` has what is wrong."""
        values = self._values(parameters)
        return build_sample(self._model(values, problems), values, problems)

    def _model(self, values: Mapping[str, float], problems: Problems) -> FileStatements:
        """Return the statements at values of the whole-number parameters."""
        counts = {name: values[name] for name, p in self.parameters.items() if p.parameter.is_whole}
        key = tuple(counts.values())
        model = self._models.get(key) or FileStatements(
            self.table, self.parameters, counts, Names(problems, self.files)
        )
        if not problems:
            self._models[key] = model
        return model

    def __getstate__(self) -> dict:
        """Return the file, from which another process makes the models again."""
        return {**self.__dict__, "_models": {}}


def load(path: str | Path) -> SceneType:
    """Return the structure in the YAML file at `path` as a SceneType object, whose `build` makes
    its scenes. Raises StructureError, which lists all that is wrong with the file."""
    return loads(read_text(path), str(path))


def loads(text: str, source: str = "structure") -> SceneType:
    """Return the structure (SceneType) in the text of a YAML file. source: name of the text in
    messages. Raises StructureError, which lists all that is wrong with it."""
    problems = Problems(source)
    if Path(text).suffix in (".yaml", ".yml") and "\n" not in text:
        problems.say(0, f"{text!r} is a path, not the text of a file: use `structures.load`")
        problems.stop()
    return build_type(read(text, problems), problems)


def build_type(node: Node, problems: Problems) -> SceneType:
    """Return the structure (SceneType) that the top table `node` of a file states. problems: of the
    file; if there are any, they are raised as StructureError."""
    source = problems.source
    if len(OF_CAMPAIGNS & node.entries.keys()) > 1:
        remedy = f"use `check {source}`, in Python `campaign.run`, or the file of its `scene`"
        problems.say(0, f"this is a campaign's file, not a structure's: {remedy}")
        problems.stop()
    table = correct_keys(node, KEYS, problems)
    parameters = table.entries.get("parameters", Node({}))
    if not parameters.is_table:
        problems.refuse(parameters.line, "parameters", parameters.plain, "a mapping from names")
        problems.stop()
    values = _parameters(parameters, problems)
    name, description, mesh = (_text(table, key, problems) for key in TEXTS)
    if name and not NAME.fullmatch(name):
        problems.refuse(table.lines["name"], "name", name, NAME_RULE)
    whole = [n for n, p in values.items() if p.parameter.is_whole]
    # Nothing is said of a mesh that is refused as a parameter.
    if mesh and mesh not in whole and (mesh in values or mesh not in parameters.entries):
        allowed = f"{did_you_mean(mesh, whole)}; allowed: a parameter with `whole: true`"
        line = table.lines["mesh"]
        problems.say(line, f"mesh: {mesh!r} is not allowed{allowed}: {commas(whole)}")
    if len(values) < len(parameters.entries):
        problems.stop()  # Each use of a skipped parameter would be reported as a further problem.
    file = _File(table, values, source)
    scene = file.builder({n: p.parameter.default for n, p in values.items()}, problems).scene
    problems.stop()
    digests = [curves.digest for curves in file.files.values()]
    content = "".join([json.dumps(table.plain), *digests]).encode()
    return SceneType(
        name=name or Path(source).stem,
        description=description,
        parameters={name: parameter.parameter for name, parameter in values.items()},
        points=tuple(scene.points),
        hinges=tuple(hinge.name for hinge in scene.hinges),
        function=file.build,
        prepare=file.prepare,
        find_turns=file.find_turns,
        cables=tuple(cable.name for cable in scene.cables),
        mesh=mesh or None,
        digest=hashlib.sha256(content).hexdigest()[:16],
        files=tuple(file.files),
    )


def _text(table: Node, key: str, problems: Problems) -> str:
    node = table.entries.get(key, Node(""))
    if not isinstance(node.value, str):
        problems.refuse(node.line, key, node.plain, "text")
    return node.text


# -- parameters ------------------------------------------------------------------------------------


def _parameters(table: Node, problems: Problems) -> dict[str, GivenParameter]:
    """Return the parameters of a table by name, except wrong ones, which are noted as problems."""
    result = {}
    for name, node in table.entries.items():
        key, line = f"parameters.{name}", table.lines[name]
        if not node.is_table:
            problems.refuse(line, key, node.plain, "a mapping with value, unit, description")
        elif parameter := _parameter(key, line, node, problems):
            result[name] = parameter
    return result


def _parameter(key: str, line: int, node: Node, problems: Problems) -> GivenParameter | None:
    check_keys(node, key, PARAMETER_KEYS, problems)
    if "value" not in node.entries:
        problems.say(line, f"{key}.value: missing; allowed: a number")
        return None
    texts = {name: str(entry.plain) for name, entry in node.entries.items()}
    if (whole := texts.get("whole", "false")) not in ("true", "false"):
        problems.refuse(node.lines["whole"], f"{key}.whole", whole, "true or false")
    try:
        parameter_unit = unit(texts.get("unit", ""))
    except UnitError as error:
        problems.say(node.lines["unit"], f"{key}.unit: {error}")
        return None
    value = _number(f"{key}.value", node.entries["value"], parameter_unit, problems)
    least, most = -math.inf, math.inf
    if (ends := node.entries.get("range")) is not None:
        allowed = "[lowest, highest]"
        if len(ends.items) == 2:
            low, high = (_number(f"{key}.range", x, parameter_unit, problems) for x in ends.items)
            if low is None or high is None:
                return None
            least, most, allowed = low, high, "the lowest value first"
        if len(ends.items) != 2 or least > most:
            problems.refuse(ends.line, f"{key}.range", ends.plain, allowed)
            return None
    if value is None:
        return None
    is_whole = whole == "true"
    if is_whole and value == round(value):
        value = round(value)
    limits: Any = {"unit": parameter_unit.udunits, "least": least, "most": most}
    parameter = Parameter(value, texts.get("description", ""), is_whole=is_whole, **limits)
    try:
        parameter.check(key, value)
    except SceneError as error:
        problems.refuse(line, f"{key}.value", value, error.allowed)
        return None
    return GivenParameter(parameter, parameter_unit, line)


def _number(key: str, node: Node, symbol: Unit, problems: Problems) -> float | None:
    """Arithmetic of numbers, in the unit of the parameter: plain ones, or with units that fit."""
    allowed, hint = "a number in the parameter's `unit`, or with a unit that fits", ""
    try:
        expression = parse(node.text)
        if not expression.names and (dimension := expression.dimension({})).fits(symbol.dimension):
            value = expression.value({})
            return value if dimension.bare else float(f"{value / symbol.si(1.0):.15g}")
    except ExpressionError as error:
        hint = number_hint(node.text)
        allowed = f"{allowed}: {error}" if node.text and not hint else allowed
    problems.refuse(node.line, key, node.plain, allowed, hint)
    return None


def schema() -> dict[str, Any]:
    """Return the JSON Schema of structure files, by which editors complete and check them. What
    depends on names and units is left to the program."""
    tables: dict[str, Any] = {
        group: {"additionalProperties": {"anyOf": [_entry(kind) for kind in kinds.values()]}}
        for group, kinds in GROUPS.items()
    }
    parameter = {"properties": {k: {} for k in PARAMETER_KEYS}, "additionalProperties": False}
    tables |= {"let": {}, "points": {}, "parameters": {"additionalProperties": parameter}}
    unit_keys = {key: tables.get(key, {}) for key in UNIT_KEYS}
    unit = {"properties": unit_keys, "additionalProperties": False, "required": ["count"]}
    tables["repeat"] = {"additionalProperties": unit}
    tops = dict.fromkeys(TEXTS, STRING) | _entry(overall)["properties"]
    tops |= {key: {"type": ["object", "null"], **table} for key, table in tables.items()}
    properties = {key: tops[key] for key in KEYS}
    return {"type": "object", "properties": properties, **OTHER_KEYS}


def _entry(statement: Statement) -> dict[str, Any]:
    """What JSON Schema says of an entry, on a hinge or a slide."""
    keys = {name: key for slides in ((), ("joint",)) for name, (_, key) in
            statement.for_slides(slides).items()}  # fmt: skip
    properties = {name: key.schema | {"description": key.text} for name, key in keys.items()}
    common = keys.keys() & statement.keys & statement.for_slides(["joint"]).keys()
    mandatory = [name for name in common if keys[name].default is NO_VALUE]
    if statement.type:
        properties["type"], mandatory = {"const": statement.type}, [*mandatory, "type"]
    return {
        "type": "object",
        "description": statement.text,
        "properties": properties,
        "additionalProperties": False,
        "required": sorted(mandatory),
    }
