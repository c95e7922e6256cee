"""A whole motion for ParaView: a collection (.pvd) of unstructured grids (.vtu) by meshio.

In every frame `axes` has all particles, and the elements as lines; `solid` the elements as
hexahedra between their sections; `cables` the cables; those that there are. Numbers are in SI
units, of 64 bits, as they are in the motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import whole_file, write_text
from deployable.campaign.pictures.solid import Solid, solid_of_motion

if TYPE_CHECKING:
    import xarray

_ELEMENT_VARIABLES = ("axial_strain", "bending_strain", "stress")


def write_vtk(motion: xarray.Dataset, path: Path) -> Path:
    """Write a whole motion (dataset of `fpm.solver.motion`) for ParaView: `path` (.pvd), which is
    returned, and grids (.vtu) of each frame in a folder beside it with its name. Raises
    `CampaignError` without meshio."""
    try:
        from meshio import Mesh
    except ImportError:
        text = "files for ParaView need meshio: pip install 'deployable-intervals[export]'"
        raise CampaignError(text) from None
    solid, places, entries = solid_of_motion(motion), path.with_suffix(""), []
    for frame, time in enumerate(motion["time"].values.tolist()):
        grids = {"axes": _axes(motion, solid, frame)}
        if len(solid.nodes):
            data = {name: motion[name].values[frame] for name in _ELEMENT_VARIABLES}
            cells = np.arange(8 * len(solid.nodes)).reshape(-1, 8)
            blocks = [("hexahedron", cells, data | {"bar": solid.bar})]
            grids["solid"] = solid.corners[frame].reshape(-1, 3), blocks, {}
        if len(ends := solid.cables.stretches):
            cable = solid.cables.cable[ends[:, 0]]
            blocks = [
                ("line", ends, {"tension": solid.cables.tension[frame][cable], "cable": cable})
            ]
            grids["cables"] = solid.cable_points[frame], blocks, {}
        for part, (name, (points, blocks, point_data)) in enumerate(grids.items()):
            file = places / f"{name}-{frame:04d}.vtu"
            data = {key: [block[2][key] for block in blocks] for key in blocks[0][2]}
            with whole_file(file) as temporary:
                mesh = Mesh(points, [block[:2] for block in blocks], point_data, data)
                mesh.write(temporary, "vtu")
            file_name = quoteattr(f"{places.name}/{file.name}")
            entries.append(
                f'<DataSet timestep="{time!r}" part="{part}" name="{name}" file={file_name}/>'
            )
    body = "\n".join(["<Collection>", *entries, "</Collection>"])
    head = '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">'
    write_text(path, f'<?xml version="1.0"?>\n{head}\n{body}\n</VTKFile>\n')
    return path


def _axes(motion: xarray.Dataset, solid: Solid, frame: int) -> tuple[Any, list[tuple], dict]:
    """Return particles, blocks of cells (kind, nodes, data; elements are lines), data of points."""
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
    ends = solid.corners[frame][bars].reshape(-1, 2, 4, 3)
    chord = ends[:, 1].mean(axis=1) - ends[:, 0].mean(axis=1)
    chord /= np.linalg.norm(chord, axis=1, keepdims=True)
    y = (ends[:, :, 1] + ends[:, :, 2] - ends[:, :, 0] - ends[:, :, 3]).sum(axis=1)  # of the width
    y -= np.sum(y * chord, axis=1, keepdims=True) * chord
    y /= np.linalg.norm(y, axis=1, keepdims=True)
    cells = {name: motion[name].values[frame][bars] for name in _ELEMENT_VARIABLES}
    cells |= {"bar": solid.bar[bars], "radius": radius, "section_size": width}
    cells |= {"section_y": y, "section_z": np.cross(chord, y)}
    # Cells that are no elements have no strain.
    bare = {key: np.zeros((len(vertices), *x.shape[1:]), x.dtype) for key, x in cells.items()}
    blocks = [("line", nodes, cells), ("vertex", vertices[:, None], bare)]
    return position, [block for block in blocks if len(block[1])], points
