"""A whole motion for ParaView: a collection (.pvd) of unstructured grids (.vtu).

In every frame `axes` has all particles, and the elements as lines; `solid` the elements as
hexahedra between their sections; `cables` the cables, where there are any. Numbers are in SI units,
of 64 bits, as they are in the motion. Format: VTK's XML formats,
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np

from deployable.campaign.files import write_text
from deployable.campaign.pictures.solid import Solid, solid_of_motion

if TYPE_CHECKING:
    import xarray

_VERTEX, _LINE, _HEXAHEDRON = 1, 3, 12  # VTK's numbers of the types of cells
_TYPES = {"f": "Float64", "i": "Int64", "u": "UInt8"}
_ELEMENT_VARIABLES = ("axial_strain", "bending_strain", "stress")


def write_vtk(motion: xarray.Dataset, path: Path) -> Path:
    """Write a whole motion (dataset of `fpm.motions`) for ParaView: a collection `path` (.pvd),
    which is returned, and grids (.vtu) of each frame in a folder beside it with its name."""
    solid = solid_of_motion(motion)
    places, entries = path.with_suffix(""), []
    for frame, time in enumerate(motion["time"].values.tolist()):
        grids = {"axes": _axes(motion, solid, frame), "solid": _solid(motion, solid, frame)}
        if len(solid.cables.cable):
            grids["cables"] = _cables(solid, frame)
        for part, (name, (points, cells, *data)) in enumerate(grids.items()):
            file = places / f"{name}-{frame:04d}.vtu"
            write_text(file, grid_text(points, cells, data[0], data[1], time))
            file_name = quoteattr(f"{places.name}/{file.name}")
            text = f'timestep="{time!r}" part="{part}" name="{name}" file={file_name}'
            entries.append(f"<DataSet {text}/>")
    collection = "\n".join(["<Collection>", *entries, "</Collection>"])
    write_text(path, _file("Collection", collection))
    return path


def _axes(motion: xarray.Dataset, solid: Solid, frame: int) -> tuple:
    """Points, cells, data of points and of cells: particles, and elements as lines."""
    position, axes = motion["position"].values[frame], motion["frame"].values[frame]
    nodes, width = solid.nodes, motion["section_size"].values
    radius = np.sqrt(width.prod(axis=1) / np.pi)  # of a circle of the same area
    bars = nodes[:, 0] != nodes[:, 1]  # and no rigid bodies, whose lines have no length
    nodes, width, radius = nodes[bars], width[bars], radius[bars]
    vertices = np.setdiff1d(np.arange(len(position)), nodes)
    at_points = np.zeros(len(position))
    np.maximum.at(at_points, nodes.ravel(), np.repeat(radius, 2))
    points = {"velocity": motion["velocity"].values[frame], "radius": at_points}
    points |= {f"axis_{name}": axes[:, :, k] for k, name in enumerate("xyz")}
    y, z = _section_axes(solid.corners[frame][bars])
    cells = {name: motion[name].values[frame][bars] for name in _ELEMENT_VARIABLES}
    cells |= {"bar": solid.bar[bars], "radius": radius, "section_size": width}
    cells |= {"section_y": y, "section_z": z}
    cell_data = {  # cells that are no elements have no strain
        name: np.concatenate([values, np.zeros((len(vertices), *values.shape[1:]), values.dtype)])
        for name, values in cells.items()
    }
    return position, [(_LINE, nodes), (_VERTEX, vertices[:, None])], points, cell_data


def _solid(motion: xarray.Dataset, solid: Solid, frame: int) -> tuple:
    """Points, cells, data of points and of cells: elements as hexahedra."""
    corners = solid.corners[frame]
    cells = np.arange(8 * len(corners)).reshape(-1, 8)
    data = {name: motion[name].values[frame] for name in _ELEMENT_VARIABLES}
    return corners.reshape(-1, 3), [(_HEXAHEDRON, cells)], {}, {**data, "bar": solid.bar}


def _cables(solid: Solid, frame: int) -> tuple:
    """Points, cells, data of points and of cells: the cables' straight stretches as lines."""
    cables = solid.cables
    cable = cables.cable[cables.stretches[:, 0]]
    data = {"tension": cables.tension[frame][cable], "cable": cable}
    return solid.cable_points[frame], [(_LINE, cables.stretches)], {}, data


def _section_axes(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (m, 3) along width and height, normal to chords, from corners (m, 8, 3)."""
    ends = corners.reshape(-1, 2, 4, 3)
    chord = ends[:, 1].mean(axis=1) - ends[:, 0].mean(axis=1)
    chord /= np.linalg.norm(chord, axis=1, keepdims=True)
    width_axis = ends[:, :, 1] + ends[:, :, 2] - ends[:, :, 0] - ends[:, :, 3]
    y = width_axis.sum(axis=1)
    y -= np.sum(y * chord, axis=1, keepdims=True) * chord
    y /= np.linalg.norm(y, axis=1, keepdims=True)
    return y, np.cross(chord, y)


def grid_text(points: np.ndarray, cells: list, point_data: Mapping, data: Mapping, time) -> str:
    """Write the text of a .vtu file with one unstructured grid. points (n, 3): positions (m);
    cells: pairs of VTK's number of a type, as 3 for lines, and cells (m, k) as indices of points;
    point_data, data: arrays by name, a row for each point, or cell; time: in s."""
    connectivity = np.concatenate([nodes.ravel() for _, nodes in cells]).astype(np.int64)
    sizes = np.concatenate([np.full(len(nodes), nodes.shape[1]) for _, nodes in cells])
    kinds = np.concatenate([np.full(len(nodes), kind, np.uint8) for kind, nodes in cells])
    shape = {"connectivity": connectivity, "offsets": sizes.cumsum(), "types": kinds}
    instant = _array("TimeValue", np.array([time]), ' NumberOfTuples="1"')
    piece = f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(kinds)}">'
    body = ["<FieldData>", instant, "</FieldData>", piece]
    sections: dict[str, Mapping] = {"Points": {"position": points}, "Cells": shape}
    sections |= {"PointData": point_data, "CellData": data}
    body += [line for name, arrays in sections.items() for line in _section(name, arrays)]
    grid = "\n".join(["<UnstructuredGrid>", *body, "</Piece>", "</UnstructuredGrid>"])
    return _file("UnstructuredGrid", grid)


def _section(name: str, arrays: Mapping[str, np.ndarray]) -> list[str]:
    return [f"<{name}>", *(_array(key, values) for key, values in arrays.items()), f"</{name}>"]


def _array(name: str, values: np.ndarray, attrs: str = "") -> str:
    """An array in base64, behind the number of its bytes."""
    kind = _TYPES[values.dtype.kind]
    raw = np.ascontiguousarray(values, dtype=np.dtype(kind.lower()).newbyteorder("<")).tobytes()
    text = base64.b64encode(len(raw).to_bytes(8, "little") + raw).decode()
    if values.ndim > 1:
        attrs += f' NumberOfComponents="{values.shape[1]}"'
    head = f'type="{kind}" Name={quoteattr(name)}{attrs} format="binary"'
    return f"<DataArray {head}>{text}</DataArray>"


def _file(kind: str, content: str) -> str:
    return (
        f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64">\n{content}\n</VTKFile>\n'
    )
