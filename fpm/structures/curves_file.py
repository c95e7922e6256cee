"""Curves of time from CSV files, as instruments and other programs write them."""

from __future__ import annotations

import codecs
import csv
import hashlib
import re
from collections.abc import Container
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from itertools import dropwhile
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from fpm.arithmetic.units import Unit, UnitError, translate, unit
from fpm.errors import fold_name
from fpm.files.seals import read_bytes

EXAMPLE = "`t [s],angle [rad]`"

_POWER = r"(?:[dDeE][-+]?\d+)?"
_NUMBER = re.compile(rf"[-+]?(?:\d+\.?\d*|\.\d+){_POWER}")
_DIGITS = re.compile(rf"[-+−]?[\d.,]*\d[\d.,]*{_POWER}")  # a number, with signs of any language
_DECIMAL_COMMA = re.compile(
    rf"[-+]?(?:0*,\d+|\d{{4,}},\d+|\d+,(?:\d{{0,2}}|\d{{4,}})|\d{{1,3}}(?:\.\d{{3}})+,\d+){_POWER}"
    r"|[-+]?\d,\d+[eE][-+]?\d+"
)
_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:,\d{3})+\.\d*|[-+]?\d{1,3}(?:,\d{3}){2,}")
_THOUSANDS_BY_POINTS = re.compile(r"[-+]?\d{1,3}(?:\.\d{3}){2,}")
_THOUSANDS_OR_DECIMALS = re.compile(r"[-+]?[1-9]\d{0,2}\.\d{3}")
_WITH_DECIMAL_COMMA = re.compile(r"[-+]?\d{1,3}(?:\.\d{3})+,\d*|[-+]?\d{1,3}(?:\.\d{3}){2,}|[^.]*")
_WITH_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:,\d{3})+(?:\.\d*)?|[^,]*")
_COMMENT = re.compile(r"[\s;,]*$|\s*([#%!]|//)")  # an empty line, or a comment
_COMMA_PAIR = re.compile(rf"(?:[-+−]?\d+(?:,\d+{_POWER})?)?")
_SPACED_THOUSANDS = re.compile(r"[-+−]?\d{1,3}(?:['’_\s]\d{3})+(?:[.,]\d*)?")
_SHEET_ERROR = re.compile(r"#+|#[^\sa-z]*[!?]|#N/?[A-Z]")  # in any language
_IN_BRACKETS = re.compile(r"(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))")
_BEHIND_SLASH = re.compile(r"([^/]*[^/\s])\s*/\s*(?:\(([^()]+)\)|([^()]+))")
NO_UNIT = f"it has no unit; allowed: such as {EXAMPLE}"
_TIMES = ("t", "time", "zeit", "temps", "tiempo", "tempo", "timestamp")
_USUAL_TIME = re.compile(rf"\W*(?:(?:elapsed|running|test) ?)?(?:{'|'.join(_TIMES)})[\W\d_]*")
_OTHER_FORMATS = {b"PK\3": "a workbook (.xlsx) or an archive", b"\x1f\x8b\x08": "compressed (.gz)"}


class CurvesFileError(ValueError):
    """Raised for a CSV file of curves that cannot be used; its text says where and why."""


@dataclass(frozen=True)
class CurvesFile:
    """Content of a CSV file of curves of time. times (r,): s, increasing; columns: others (r,) by
    name, SI units; units: of these in the file by name; digest: of the file; time_unit: s, of the
    times in the file; faults: why other columns cannot be used, by name; doubts: warnings."""

    times: np.ndarray
    columns: dict[str, np.ndarray]
    units: dict[str, Unit]
    digest: str
    time_unit: float
    faults: dict[str, str] = field(default_factory=dict)
    doubts: tuple[str, ...] = ()

    @classmethod
    def read(cls, path: str | Path) -> CurvesFile:
        """Read the CSV file `path` of curves, into SI units: names with units, or a line of each,
        above rows of numbers. One column is the time, which increases. Raises `CurvesFileError`."""
        table = CsvTable(path, EXAMPLE)
        table.refuse_decimal_commas()
        time, *copies = _time_columns(table)
        times = table.numbers(time, may_repeat=True)
        if len(reversals := np.flatnonzero(np.diff(times) <= 0)):
            row = reversals[0] + 1
            text = f"the time {times[row]:.9g} s does not follow {times[row - 1]:.9g} s"
            table.refuse(table.rows[row][0], f"{text}; allowed: increasing times")
        columns, units, faults = {}, {}, {}
        for number, name in enumerate(table.names):
            if number in (time, *copies) or not name:
                continue
            try:
                columns[name] = table.numbers(number)
                units[name] = table.units[number]
            except CurvesFileError as error:
                faults[name] = str(error)
        name, factor = table.names[time], table.units[time].si(1.0)
        text = f"the time in {path} is the column `{name}`: if this is right, call it `t`"
        doubts = () if _USUAL_TIME.fullmatch(name.lower()) else (text,)
        return cls(times, columns, units, table.digest, factor, faults, doubts)


def _time_columns(table: CsvTable) -> list[int]:
    """Numbers of the columns that are the time: one, or several with the same times."""
    second = unit("s").dimension
    columns = [k for k, u in enumerate(table.units) if getattr(u, "dimension", None) == second]
    times = [k for k, name in enumerate(table.names) if name.lower() in _TIMES]
    matches = [k for k in columns if k in times]
    if columns and not matches:  # `time` without a unit beside `delay [s]`
        columns += [k for k in times if table.units[k] == NO_UNIT]
    columns = matches or columns
    if not columns:
        text = f"{table.head_line.strip()!r} has no column with a unit of time"
        remedy = f"a line such as {EXAMPLE} above the rows, and # before other lines above it"
    elif len(table.names) < 2:
        text, remedy = "there is no column beside the time", f"such as {EXAMPLE}"
    elif len(columns) == 1:
        return columns
    else:
        readings, series = [], []
        for k in columns:
            readings.append(f"{table.names[k]} (column {k + 1})")
            with suppress(CurvesFileError):
                series.append(table.numbers(k, may_repeat=True))
                ends = "{:.6g} to {:.6g} s".format(*series[-1][[0, -1]])
                readings[-1] = f"{table.names[k]} (column {k + 1}, {ends})"
        if len(series) == len(columns) and np.ptp(series, axis=0).max() < 1e-6 * np.ptp(series[0]):
            return columns
        text = f"the time could be {' or '.join(readings)}"
        remedy = "one column with a unit of time, one of them called t, or the same times in all"
    return table.refuse(table.head, f"{text}; allowed: {remedy}")


def _decode(content: bytes) -> str:
    """The text of a file in UTF-8 or UTF-16, or in the code page of western Windows."""
    if words := _OTHER_FORMATS.get(content[:3]):
        raise ValueError(f"it is {words}")
    is_wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = content.decode("utf-16" if is_wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", "replace").replace("\ufffd", "\0")
    if "\0" in text:
        raise ValueError("it is not UTF-8 text (perhaps UTF-16 without a byte order mark)")
    return text


class CsvTable:
    """Content of the CSV file at `path`; raises `CurvesFileError`. names, units: of its columns (a
    text: why there is no unit); head, head_line: where the names stand; rows: number and text of
    the lines below them; digest: of the file; example: names with units, for messages."""

    def __init__(self, path: str | Path, example: str = "`k [N m/rad],m [kg]`"):
        self.path = str(path)
        try:
            content = read_bytes(path)
            text = _decode(content)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or getattr(error, "reason", error)
            raise CurvesFileError(f"{path}: {reason}; allowed: a CSV file in UTF-8") from None
        self.digest = hashlib.sha256(content).hexdigest()[:16]
        text = re.sub(r"[\r\n][\s;,]*\Z", "", text)  # rows of separators end a sheet
        lines = list(enumerate(re.split(r"\r\n|\r|\n", text), 1))
        self.head, self.head_line, self.separator = self._find_names(lines, example)
        rows = [row for row in lines[self.head :] if self._is_row(*row)]
        self.rows = list(dropwhile(lambda row: not row[1].strip("; ,\t"), rows))
        for number, line in [(self.head, self.head_line), *self.rows]:
            if line.count('"') % 2:
                self.refuse(number, "quotes do not close where they open; allowed: both in a line")
        self.names, self.units = self._header()

    def _find_names(self, lines: list[tuple[int, str]], example: str) -> tuple[int, str, str]:
        """Number and text of the line of names, and what separates columns."""
        rows = [(number, line) for number, line in lines if not _COMMENT.match(line)]
        separator = rows.pop(0)[1][4:5] if rows and re.fullmatch("sep=.", rows[0][1]) else ""
        if not rows:
            self.refuse(1, f"'' is not a line of names with units; allowed: such as {example}")
        number, head = rows[0]
        while head.count('"') % 2 and any('"' in line for _, line in lines[number:]):
            head, number = f"{head} {lines[number][1]}", number + 1  # a line break in quotes
        cells = _cells(head, separator or _separator(head))
        if all(map(_DIGITS.fullmatch, cells)):  # names may stand in a comment
            lines_above = [line for line in lines[: number - 1] if line[1].strip(" \t;,")]
            if not lines_above:
                text = "no line of names with units stands above the numbers; allowed: such as "
                self.refuse(number, text + example)
            number, head = lines_above[-1][0], lines_above[-1][1].strip().lstrip("#%!/ ")
        return number, head, separator or _separator(head)

    @cached_property
    def cells(self) -> list[tuple[str, ...]]:
        """Cells (r) of each column; refuses rows with another number of them than names."""
        if not self.rows:
            raise CurvesFileError(f"{self.path}: no rows; allowed: rows of numbers")
        table = [_cells(line, self.separator) for _, line in self.rows]
        count, has_more = len(self.names), {*map(len, table)} == {len(self.names) + 1}
        last = max((k for k, name in enumerate(self.names, 1) if name), default=0)
        is_long = self.separator != " " and max(map(len, table)) >= last  # some rows are
        least = 0 if is_long else count
        for (number, _), row in zip(self.rows, table, strict=True):
            while row and not row[-1]:  # lines may end in separators
                row.pop()
            if not least <= (size := len(row)) <= count:
                is_comma = self.separator == "," and size > count and "." not in "".join(row)
                hint = " (does the first column have no heading? Write its name)" * has_more
                hint = " (decimal commas need semicolons between columns)" if is_comma else hint
                text = f"{size} values{hint}; allowed: {count}, as in line {self.head}"
                self.refuse(number, text)
            row += [""] * (count - size)
        return [*zip(*table, strict=True)]

    def refuse_decimal_commas(self, names: Container[str] = ()) -> None:
        """Refuse whole numbers between commas that could be numbers with decimal commas, as the
        last columns are not used: they state no unit and are not called as one of `names`."""
        table = enumerate(zip(self.names, self.units, strict=True))  # a bracket in a name has words
        columns = [k for k, (n, u) in table if n in names or (u != NO_UNIT and n[-1:] != ")")]
        if self.separator != "," or len(columns) <= (not names):  # no curve beside the time
            return
        last = [cell for cells in self.cells[columns[-1] + 1 :][:1] for cell in cells if cell]
        columns = columns if all(map(_COMMA_PAIR.fullmatch, last)) else columns[-1:]
        for k in reversed(columns if last else []):
            pairs = [f"{a},{b}".rstrip(",") for a, b in zip(*self.cells[k : k + 2], strict=True)]
            row = next((row for row, pair in enumerate(pairs) if "," in pair), 0)
            pair, (line, content) = pairs[row], self.rows[row]
            if all(map(_COMMA_PAIR.fullmatch, pairs)) and "," in pair and pair in content:
                text = f"{pair!r} could be {pair.replace(',', '.')} or two numbers"
                remedy = "decimal commas in quotes or beside semicolons, or a unit such as [1]"
                self.refuse(line, f"{text}; allowed: {remedy} for the last column")

    def refuse(self, line: int, text: str) -> NoReturn:
        """Raise the error that something is wrong in a line (from 1)."""
        raise CurvesFileError(f"{self.path}, line {line}: {text}")

    def _is_row(self, number: int, line: str) -> bool:
        """Whether a line below the names is a row; refuses what could be one or a comment."""
        if not (match := _COMMENT.match(line)) or not match[1]:
            return bool(line.strip(" " if self.separator == "\t" else None))
        first, *cells = _cells(line, self.separator)
        is_error = bool(_SHEET_ERROR.fullmatch(first))
        if not is_error and any(map(_DIGITS.fullmatch, (first.lstrip("#%!/ "), *cells))):
            text = f"{first!r} could begin a comment or a row of numbers"
            self.refuse(number, f"{text}; allowed: that cell in quotes, or no such line")
        return is_error

    def _header(self) -> tuple[list[str], list[Any]]:
        """Names and units of the columns, from one line or, with the first row, from two."""
        cells, rows = _cells(self.head_line, self.separator), self.rows
        names, units = map(list, zip(*map(_name_with_unit, cells), strict=True))
        if rows and not any(isinstance(u, Unit) for u in units):
            words = [cell.strip("[]() ") for cell in _cells(rows[0][1], self.separator)]
            row = [_unit(w) if re.search(r"[^\d.,eE+]", w) else NO_UNIT for w in words]
            # Units of columns that are not used may be any words.
            is_units = any(isinstance(u, Unit) for u in row) and not any(map(_DIGITS.match, words))
            if is_units and len(row) == len(cells):
                rows.pop(0)
                return [*map(fold_name, cells)], row
        for number, cell in enumerate(cells):
            rest = "\n".join(names[:number] + names[number + 1 :])
            word = re.fullmatch(r"(.*\S)\s*\((min|in)\)", cell)
            if word and re.search(rf"(?m)^{re.escape(word[1])}\s*\(.*\)$", rest):
                text = f"{cell!r} has a unit or another word in brackets"
                units[number] = f"{text}; allowed: {word[1]} [{word[2]}] for the unit"
                names[number] = fold_name(cell)
        return names, units

    @cached_property
    def _signs(self) -> tuple[str, int, str]:
        """What commas in numbers are: "decimal" (so that points stand between thousands),
        "thousands", or "" where none has one; line and cell that show it."""
        first: dict[str, tuple[int, str]] = {}
        forms = {
            "thousands": _THOUSANDS, "decimal": _DECIMAL_COMMA, "points": _THOUSANDS_BY_POINTS,
            "lone point": _THOUSANDS_OR_DECIMALS, "decimal point": re.compile(r"[^,.]*\.[^,.]*"),
            "date": re.compile("[^,]*"),
        }  # fmt: skip
        for cells in self.cells:
            for (line, _), cell in zip(self.rows, cells, strict=True):
                is_new = "," in cell or ("." in cell and "decimal point" not in first)
                if is_new and _DIGITS.fullmatch(cell):
                    kind = next((kind for kind, form in forms.items() if form.fullmatch(cell)), "")
                    first.setdefault(kind, (line, cell))
        if "points" in first and not first.keys() & {"thousands", "decimal point"}:
            first.setdefault("decimal", first["points"])
        kinds = [kind for kind in ("decimal", "thousands") if kind in first]
        if len(kinds) == 2:
            (line, cell), (second_line, number) = first["decimal"], first["thousands"]
            text = f"{cell!r} has a decimal comma, and {number!r} in line {second_line} one between"
            self.refuse(line, f"{text} thousands; allowed: one of both in a file")
        # Where semicolons stand between columns, commas are usually decimal.
        is_unclear = self.separator == ";" and "decimal point" not in first
        unclear = first.get("", first.get("lone point") if is_unclear else None)
        if unclear and not kinds:
            line, cell = unclear
            text = f"{cell!r} could be {cell.replace(',', '.')} or {re.sub('[.,]', '', cell)}"
            remedy = "decimal points (one number with other than three decimals)"
            self.refuse(line, f"{text}; allowed: {remedy}, and no sign between thousands")
        return (kinds[0], *first[kinds[0]]) if kinds else ("", 0, "")

    def numbers(
        self, column: int, default: Unit | None = None, may_repeat: bool = False
    ) -> np.ndarray:
        """Return the numbers (r,) of a column in SI units; raises `CurvesFileError` if it has none.
        default: unit of a column without one; may_repeat: whether its name may stand twice."""
        name, column_unit = self.names[column], self.units[column]
        if self.names.count(name) > 1 and not may_repeat:
            self.refuse(self.head, f"the column {name} stands twice; allowed: each name once")
        if column_unit == NO_UNIT and default:
            column_unit = default
        if isinstance(column_unit, str):
            self.refuse(self.head, f"{name}: {column_unit}")
        cells, (comma, *proof) = self.cells[column], self._signs
        form = {"decimal": _WITH_DECIMAL_COMMA, "thousands": _WITH_THOUSANDS}.get(comma)
        decimal, mark = (",", ".") if comma == "decimal" else (".", ",")
        texts = []
        for (line, _), cell in zip(self.rows, cells, strict=True):
            if form and _DIGITS.fullmatch(cell) and not form.fullmatch(cell):
                text = f"{cell!r} could be {cell.replace(',', '.')} or {re.sub('[.,]', '', cell)}"
                text = "{0} beside {2!r} in line {1}".format(text, *proof)
                self.refuse(line, f"{text}; allowed: one sign for decimals")
            text = cell.replace(mark, "") if form else cell
            text = text.replace(decimal, ".").replace("−", "-")
            texts.append(re.sub("[dD](?=[-+]?[0-9]+$)", "e", text))
            if not _NUMBER.fullmatch(texts[-1]) or not np.isfinite(float(texts[-1])):
                allowed = "seconds since the start" if ":" in cell else "a finite number"
                if _SPACED_THOUSANDS.fullmatch(cell):
                    allowed = "the number without the sign between thousands"
                text = f"{cell!r} is not allowed" if cell else f"the cell of {name} is empty"
                self.refuse(line, f"{text}; allowed: {allowed}, or no such row")
        return column_unit.si(np.array(texts, dtype=object).astype(float))


def _separator(line: str) -> str:
    bare = re.sub(r'"[^"]*"', "", line)
    return next((sign for sign in "\t;," if sign in bare), " ")


def _cells(line: str, separator: str) -> list[str]:
    """The cells of one line; a unit in brackets belongs to the word before it."""
    if separator == " ":
        cells = re.findall(r'"[^"]*"|[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?|\S+', line)
        return [cell.strip('"') for cell in cells]
    reader = csv.reader([line], delimiter=separator, skipinitialspace=True)
    return [cell.strip() for cell in next(reader)]


def _name_with_unit(cell: str) -> tuple[str, Any]:
    """Name and unit of a column, from `angle [rad]`, `angle (rad)` or `angle/rad`."""
    for form in (_BEHIND_SLASH, _IN_BRACKETS):
        if match := form.fullmatch(cell):
            words = match[1].split()
            if form is _BEHIND_SLASH and words[1:] and isinstance(_unit(words[-1]), Unit):
                continue  # `v m/s`
            column_unit = _unit(next(filter(None, match.groups()[1:]), ""))
            if isinstance(column_unit, Unit) and isinstance(_name_with_unit(match[1])[1], Unit):
                return fold_name(cell), f"{cell!r} has two units; allowed: one"
            if isinstance(column_unit, Unit) or (form is _IN_BRACKETS and cell.endswith("]")):
                return fold_name(match[1]), column_unit
            if form is _IN_BRACKETS:
                return fold_name(cell), column_unit
    return fold_name(cell), NO_UNIT


def _unit(text: str) -> Unit | str:
    """The unit that a text names, also as other programs write it, or why there is none."""
    for form, words in _UNCLEAR.items():
        if re.search(form, text.strip()):
            return f"{text!r} could be {words}; allowed: one of these units"
    factor, name = translate("1" if text.strip() == "-" else text)
    try:
        si_unit = unit(name)
    except UnitError as error:
        return str(error).replace(repr(name), repr(text), 1)
    return si_unit._replace(numerator=si_unit.numerator * factor)


_UNCLEAR = {
    r"\bg\b(?!/c?m)": "a mass (kg) or an acceleration (m/s2)",
    r"\bt\b(?!/m)": "a mass (kg) or a time (s)",
    r"\blbs?\b": "a mass (kg) or a force (lbf)",
    r"^1?\s*/\s*min$|^min\^?[-−⁻]": "a speed (rpm) or a frequency (Hz)",
    r"\bms\^?[-−⁻][1¹]": "m/s or 1/ms",
    r"\bms\^?[-−⁻]?[2²]": "m/s2 or a square of ms",
}
