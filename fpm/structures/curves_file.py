"""Curves of time from CSV files, such as measured ones."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fpm.arithmetic.units import UnitError, unit
from fpm.files.seals import DamagedError, read_bytes

_HEADER = re.compile(r"\s*([A-Za-z]\w*)\s*\[([^\]]*)\]\s*")


class CurvesFileError(ValueError):
    """Raised for a CSV file of curves that cannot be used; its text says where and why."""


@dataclass(frozen=True)
class CurvesFile:
    """Content of a CSV file of curves of time. times (r,): s, increasing; columns: others (r,) by
    name, SI units; dimensions: physical dimension of all of them by name; digest: of the file."""

    times: np.ndarray
    columns: dict[str, np.ndarray]
    dimensions: dict[str, Any]
    digest: str

    @classmethod
    def read(cls, path: str | Path) -> CurvesFile:
        """Read the CSV file `path` of curves, into SI units. Line 1 has names with units, such as
        `t [s],angle [rad]`, first that of the time, in any unit of time; then come increasing times
        and finite numbers. Raises `CurvesFileError`."""
        try:
            content = read_bytes(path)
            lines = content.decode("utf-8-sig").splitlines()
        except (OSError, UnicodeDecodeError, ValueError) as error:
            damage = error.reason if isinstance(error, DamagedError) else "it is no text in UTF-8"
            reason = getattr(error, "strerror", None) or damage
            raise CurvesFileError(f"{path}: {reason}; allowed: a CSV file") from None
        names, units = _header(f"{path}, line 1", lines[0] if lines else "")
        if not any(map(str.strip, lines[1:])):
            raise CurvesFileError(f"{path}: no rows; allowed: at least three")
        try:
            table = np.loadtxt(lines[1:], delimiter=",", comments=None, ndmin=2)
        except ValueError:
            table = None
        if table is None or table.shape[1] != len(names) or not np.isfinite(table).all():
            raise CurvesFileError(_row_problem(str(path), lines, len(names)))
        pairs = zip(names, units, table.T, strict=True)
        columns = {name: unit.si(column) for name, unit, column in pairs}
        times = columns.pop(names[0])
        reversals = np.flatnonzero(np.diff(times) <= 0)
        if len(reversals):
            numbers = [i for i, line in enumerate(lines, 1) if i > 1 and line.strip()]
            place = f"{path}, line {numbers[reversals[0] + 1]}"
            text = f"{place}: the time {times[reversals[0] + 1]:.9g} s does not follow "
            raise CurvesFileError(f"{text}{times[reversals[0]]:.9g} s; allowed: increasing times")
        dimensions = {name: u.dimension for name, u in zip(names, units, strict=True)}
        return cls(times, columns, dimensions, hashlib.sha256(content).hexdigest()[:16])


def _header(place: str, line: str) -> tuple[list[str], list[Any]]:
    """Names and units of the columns, the time first."""
    names, units = [], []
    for cell in line.split(","):
        match = _HEADER.fullmatch(cell)
        if not match:
            text = f"{place}: {cell.strip()!r} is no name with a unit"
            raise CurvesFileError(f"{text}; allowed: such as `t [s],angle [rad]`")
        if match[1] in names:
            text = f"{place}: the column {match[1]} stands twice; allowed: each name once"
            raise CurvesFileError(text)
        try:
            units.append(unit(match[2]))
        except UnitError as error:
            raise CurvesFileError(f"{place}: {error}") from None
        names.append(match[1])
    if not units[0].dimension.fits(unit("s").dimension) or len(names) < 2:
        text = f"{place}: {line.strip()!r} does not begin with a time and a column behind it"
        raise CurvesFileError(f"{text}; allowed: such as `t [s],angle [rad]`")
    return names, units


def _row_problem(path: str, lines: list[str], count: int) -> str:
    """What is wrong with the first row that is not `count` finite numbers."""
    for number, line in enumerate(lines[1:], 2):
        cells = line.split(",") if line.strip() else []
        if cells and len(cells) != count:
            return f"{path}, line {number}: {len(cells)} values; allowed: {count}, as in line 1"
        for cell in cells:
            try:
                is_finite = bool(np.isfinite(float(cell)))
            except ValueError:
                is_finite = False
            if not is_finite:
                text = f"{path}, line {number}: {cell.strip()!r} is not allowed"
                return f"{text}; allowed: a finite number"
    return f"{path}: rows that cannot be read; allowed: numbers with commas between them"
