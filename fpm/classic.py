"""netCDF's classic format (64-bit offset), written and read in one go.

A file is a header and then the numbers, big-endian (NetCDF Users' Guide, "File Format
Specifications"). A trajectory has some thirty small variables: to create them through HDF5 takes
half as long as to simulate the run, here little longer than to copy the numbers. Any netCDF library
reads these files; `read` here also notices one that was cut off, which the C library does not.
"""

import os
import struct
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

_DIMENSION, _VARIABLE, _ATTRIBUTE = 10, 11, 12
_MAGIC = b"CDF\x02"
# Number of a type in the file -> type of numpy.
_TYPES = {n: np.dtype(t) for n, t in enumerate((">i1", "S1", ">i2", ">i4", ">f4", ">f8"), 1)}
_NUMBERS = {dtype: number for number, dtype in _TYPES.items()}


class Variable(NamedTuple):
    """An array of numbers or text, the names of its dimensions, and its attributes."""

    dims: tuple[str, ...]
    values: np.ndarray
    attributes: Mapping[str, Any]


def write(
    path: str | os.PathLike,
    attributes: Mapping[str, Any],
    variables: Mapping[str, Variable],
    unlimited: str,
) -> None:
    """Write a file; attributes are text or numbers, `unlimited` is the dimension of its records.

    Text takes one more dimension, `<name>_width`, as characters. The format has no empty dimension
    but the unlimited one: variables of another that is empty are left out. There must be none or
    several variables with the unlimited dimension, which is their only one.
    """
    sizes, fixed, grow = {unlimited: 0}, {}, {}
    for name, variable in variables.items():
        column = _column(name, *variable)
        if column.dims == (unlimited,):
            grow[name] = column
        elif not column.values.size:
            continue
        else:
            fixed[name] = column
        sizes.update(zip(column.dims, column.values.shape, strict=True))
    # One record holds a value of each variable, at multiples of four bytes.
    places = np.cumsum([0, *(_whole(c.values.itemsize) for c in grow.values())]).tolist()
    types = [column.values.dtype for column in grow.values()]
    record = {"names": list(grow), "formats": types, "offsets": places[:-1], "itemsize": places[-1]}
    records = np.zeros(sizes[unlimited], record)
    for name, column in grow.items():
        records[name] = column.values

    head = [_MAGIC, _integer(len(records)), _list_of(_DIMENSION, sizes)]
    head += [_name(dim) + _integer(0 if dim == unlimited else n) for dim, n in sizes.items()]
    head += [_attributes(attributes), _list_of(_VARIABLE, fixed | grow)]
    columns = {name: _described(name, c, list(sizes)) for name, c in (fixed | grow).items()}
    place = sum(map(len, head)) + sum(len(text) + 12 for text in columns.values())
    for name, text in columns.items():
        values = fixed[name].values if name in fixed else grow[name].values[:0]
        size = _whole(values.nbytes if name in fixed else values.itemsize)
        head.append(text + struct.pack(">Iq", size, place))
        place += size
    data = [part for c in fixed.values() for part in (c.values.data, bytes(-c.values.nbytes % 4))]
    with open(path, "wb") as file:
        file.write(b"".join([*head, *data, records.tobytes()]))


def read(path: str | os.PathLike) -> tuple[dict[str, Any], dict[str, Variable]]:
    """Attributes and variables of a file that `write` has written; text stays characters.

    Raises OSError if it is not such a file, or not whole.
    """
    with open(path, "rb") as file:
        content = file.read()
    try:
        return _Reader(content).file()
    except (struct.error, ValueError, TypeError, KeyError, IndexError):
        raise OSError(f"{os.fspath(path)} is not a whole file in netCDF's classic format") from None


def _column(name: str, dims: tuple[str, ...], values: np.ndarray, attributes: Mapping) -> Variable:
    """The variable as the file keeps it."""
    values = np.asarray(values)
    if values.dtype.kind != "U":
        return Variable(tuple(dims), values.astype(values.dtype.newbyteorder(">"), "C"), attributes)
    encoded = np.char.encode(values, "utf-8")
    width = max(1, encoded.dtype.itemsize)
    characters = encoded.astype(f"S{width}").view("S1").reshape(*values.shape, width)
    return Variable((*dims, f"{name}_width"), characters, {**attributes, "_Encoding": "utf-8"})


def _described(name: str, variable: Variable, dims: list[str]) -> bytes:
    """What the header says of a variable, but for its size and place."""
    ids = [_integer(dims.index(dim)) for dim in variable.dims]
    return b"".join(
        [
            _name(name),
            _integer(len(ids)),
            *ids,
            _attributes(variable.attributes),
            _integer(_NUMBERS[variable.values.dtype]),
        ]
    )


def _attributes(attributes: Mapping[str, Any]) -> bytes:
    parts = [_list_of(_ATTRIBUTE, attributes)]
    for name, value in attributes.items():
        if isinstance(value, str):
            number, content = 2, value.encode()
            count = len(content)
        elif isinstance(value, (int, np.integer)) and -(2**31) <= value < 2**31:
            number, count, content = 4, 1, _integer(value)
        else:
            number, count, content = 6, 1, struct.pack(">d", value)
        parts.append(_name(name) + struct.pack(">ii", number, count) + _filled(content))
    return b"".join(parts)


def _list_of(tag: int, items: Any) -> bytes:
    return struct.pack(">ii", tag if len(items) else 0, len(items))


def _name(name: str) -> bytes:
    encoded = name.encode()
    return _integer(len(encoded)) + _filled(encoded)


def _integer(value: int) -> bytes:
    return struct.pack(">i", value)


def _filled(content: bytes) -> bytes:
    """Up to a multiple of four bytes."""
    return content + bytes(-len(content) % 4)


def _whole(size: int) -> int:
    return size + -size % 4


class _Reader:
    """Reads a header piece by piece."""

    def __init__(self, content: bytes):
        if content[:4] != _MAGIC:
            raise ValueError
        self.content, self.at = content, 4

    def file(self) -> tuple[dict[str, Any], dict[str, Variable]]:
        rows = self.integer()
        dims = [(self.name(), self.integer()) for _ in range(self.count())]
        attributes = self.attributes()
        entries = [self.entry() for _ in range(self.count())]
        sizes = [size for _, size in dims]
        stride = sum(size for _, ids, *_, size, _ in entries if ids and not sizes[ids[0]])
        variables = {}
        for name, ids, attrs, dtype, _, place in entries:
            grows = bool(ids) and not sizes[ids[0]]
            shape = [rows if not sizes[i] else sizes[i] for i in ids]
            strides = (stride,) if grows else None
            if grows and not rows:  # its place may be just behind the end
                values = np.zeros(shape, dtype)
            else:
                values = np.ndarray(shape, dtype, self.content, place, strides)
            variables[name] = Variable(tuple(dims[i][0] for i in ids), values, attrs)
        return attributes, variables

    def entry(self) -> tuple:
        name = self.name()
        ids = [self.integer() for _ in range(self.integer())]
        attributes, dtype, size = self.attributes(), _TYPES[self.integer()], self.integer()
        (place,) = struct.unpack_from(">q", self.content, self.at)
        self.at += 8
        return name, ids, attributes, dtype, size, place

    def attributes(self) -> dict[str, Any]:
        found = {}
        for _ in range(self.count()):
            name, number, count = self.name(), self.integer(), self.integer()
            dtype = _TYPES[number]
            content = self.take(count * dtype.itemsize)
            found[name] = content.decode() if number == 2 else np.frombuffer(content, dtype)[0]
        return found

    def count(self) -> int:
        self.at += 4  # the tag, which only says what follows
        return self.integer()

    def name(self) -> str:
        return self.take(self.integer()).decode()

    def take(self, size: int) -> bytes:
        content = self.content[self.at : self.at + size]
        if len(content) < size:
            raise ValueError
        self.at += _whole(size)
        return content

    def integer(self) -> int:
        (value,) = struct.unpack_from(">i", self.content, self.at)
        self.at += 4
        return value
