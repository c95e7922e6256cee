"""What is written for ParaView, read by readers that are not ours."""

import sys
import xml.etree.ElementTree as Xml

import meshio
import numpy as np
import pytest

from deployable.campaign.errors import CampaignError
from deployable.campaign.export.vtk import write_vtk
from deployable.campaign.pictures.solid import solid_of_motion


@pytest.fixture(scope="module")
def collection(motion, tmp_path_factory):
    """The collection's file."""
    return write_vtk(motion, tmp_path_factory.mktemp("vtk") / "run.pvd")


def datasets(collection):
    """Time, name and file of each grid of the collection."""
    rows = Xml.parse(collection).getroot().find("Collection")
    return [
        (float(row.get("timestep")), row.get("name"), collection.parent / row.get("file"))
        for row in rows
    ]


def test_the_collection_has_two_grids_for_each_frame(collection, motion):
    rows = datasets(collection)
    assert all(path.exists() for *_, path in rows)
    for name in ("axes", "solid"):
        assert [time for time, other, _ in rows if other == name] == motion["time"].values.tolist()


def test_meshio_reads_what_the_motion_is(collection, motion):
    paths = [path for _, name, path in datasets(collection) if name == "axes"]
    for frame, path in enumerate(paths):
        grid, now = meshio.read(path), motion.isel(time=frame)
        np.testing.assert_array_equal(grid.points, now["position"].values)
        lines = grid.cells_dict["line"]
        np.testing.assert_array_equal(lines, motion["element_particle"].values)
        np.testing.assert_array_equal(grid.point_data["velocity"], now["velocity"].values)
        for k, axis in enumerate("xyz"):
            expected = now["frame"].values[:, :, k]
            np.testing.assert_array_equal(grid.point_data[f"axis_{axis}"], expected)
        for name in ("axial_strain", "bending_strain", "stress"):
            found = grid.cell_data_dict[name]["line"]
            np.testing.assert_array_equal(found, now[name].values)
            assert np.abs(found).max() > 0
        np.testing.assert_array_equal(
            grid.cell_data_dict["section_size"]["line"], motion["section_size"].values
        )
        alone = set(range(motion.sizes["particle"])) - set(lines.ravel())
        assert set(grid.cells_dict.get("vertex", np.zeros((0, 1), int)).ravel()) == alone


def test_axes_of_sections_are_normal_to_each_other_and_to_the_bar(collection, motion):
    grid = meshio.read(next(path for _, name, path in datasets(collection) if name == "axes"))
    y, z = (grid.cell_data_dict[f"section_{name}"]["line"] for name in "yz")
    ends = grid.points[grid.cells_dict["line"]]
    chord = ends[:, 1] - ends[:, 0]
    chord /= np.linalg.norm(chord, axis=1, keepdims=True)
    np.testing.assert_allclose(np.cross(chord, y), z, atol=1e-12)
    np.testing.assert_allclose(np.sum(y * z, axis=1), 0.0, atol=1e-12)


def hexahedron_volume(corners):
    """Volume (m3) of a hexahedron in VTK's order, exact by 2 x 2 x 2 Gauss points."""
    signs = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1),
                      (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])  # fmt: skip
    volume = 0.0
    for point in signs / np.sqrt(3.0):
        factors = 1.0 + signs * point
        slopes = [signs[:, k] * np.delete(factors, k, axis=1).prod(axis=1) / 8.0 for k in range(3)]
        jacobian = np.linalg.det(np.array(slopes) @ corners)
        assert jacobian > 0  # not inside out
        volume += jacobian
    return volume


def test_meshio_reads_the_solid_bars(collection, motion):
    expected = solid_of_motion(motion)
    paths = [path for _, name, path in datasets(collection) if name == "solid"]
    for frame, path in enumerate(paths):
        grid = meshio.read(path)
        corners = grid.points[grid.cells_dict["hexahedron"]]
        np.testing.assert_array_equal(corners, expected.corners[frame])
    assert set(grid.cell_data_dict["bar"]["hexahedron"]) == {0, 1, 2, 3}
    # Ends at hinges are oblique to the chords, which lengthens some elements and shortens others.
    areas = motion["section_size"].values.prod(axis=1)
    volume = sum(map(hexahedron_volume, expected.corners[0]))
    assert volume == pytest.approx(motion["element_length"].values @ areas, rel=0.01)


def test_without_meshio_the_message_names_the_extra(motion, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(
        CampaignError, match=r"meshio: pip install 'deployable-intervals\[export\]'"
    ):
        write_vtk(motion, tmp_path / "run.pvd")
    assert not [*tmp_path.iterdir()]


def test_a_structure_of_particles_alone_is_points(motion, tmp_path):
    bare = motion.isel(element=slice(0, 0), time=[0])
    write_vtk(bare, tmp_path / "bare.pvd")
    assert [name for _, name, _ in datasets(tmp_path / "bare.pvd")] == ["axes"]
    grid = meshio.read(tmp_path / "bare/axes-0000.vtu")
    assert len(grid.cells_dict["vertex"]) == len(grid.points) == motion.sizes["particle"]


def test_cables_are_lines_with_their_tension(strung, cable_places, tmp_path):
    write_vtk(strung, tmp_path / "strung.pvd")
    names = [name for _, name, _ in datasets(tmp_path / "strung.pvd")]
    assert names == ["axes", "solid", "cables"] * strung.sizes["time"]
    for frame in (0, 4):
        grid = meshio.read(tmp_path / f"strung/cables-{frame:04d}.vtu")
        np.testing.assert_allclose(grid.points, cable_places[frame], atol=1e-15)
        assert grid.cells_dict["line"].tolist() == [[0, 1], [2, 3], [3, 4]]
        one, two = strung["cable_tension"].values[frame]
        assert grid.cell_data_dict["tension"]["line"].tolist() == [one, two, two]


def test_a_rigid_body_is_a_box_and_no_line(hub, tmp_path):
    write_vtk(hub, tmp_path / "hub.pvd")
    grid = meshio.read(tmp_path / "hub/axes-0001.vtu")
    assert "line" not in grid.cells_dict and grid.cells_dict["vertex"].tolist() == [[0]]
    box = meshio.read(tmp_path / "hub/solid-0001.vtu").points
    along = np.array([np.cos(0.5), np.sin(0.5), 0.0])
    np.testing.assert_allclose(
        sorted((box - [0.5, 0, 0]) @ along), [-0.5] * 4 + [0.5] * 4, rtol=1e-9
    )
