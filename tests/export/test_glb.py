"""The glTF file, read and played by a reader that is not ours."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from deployable.campaign.pictures.glb import glb_of, write_glb
from deployable.campaign.pictures.solid import FACES, solid_of_motion

pygltflib = pytest.importorskip("pygltflib", reason="reads glTF; in the extra `test`")

DTYPES = {5126: "<f4", 5125: "<u4", 5123: "<u2", 5122: "<i2"}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


@pytest.fixture(scope="module")
def document(motion, tmp_path_factory):
    """The file as pygltflib has it."""
    path = write_glb(motion, tmp_path_factory.mktemp("glb") / "run.glb")
    return pygltflib.GLTF2().load(path)


def numbers(document, index):
    """The values of an accessor."""
    accessor = document.accessors[index]
    view, width = document.bufferViews[accessor.bufferView], WIDTHS[accessor.type]
    values = np.frombuffer(
        document.binary_blob(), DTYPES[accessor.componentType], accessor.count * width,
        view.byteOffset,
    )  # fmt: skip
    return values.reshape(-1, width) if width > 1 else values


def transforms(document, frame):
    """The matrices (joint, 4, 4) of the particles at a frame of the animation."""
    found = {}
    animation = document.animations[0]
    for channel in animation.channels:
        values = numbers(document, animation.samplers[channel.sampler].output)[frame]
        found.setdefault(channel.target.node, {})[channel.target.path] = values
    matrices = []
    for node in document.skins[0].joints:
        matrix = np.eye(4)
        matrix[:3, :3] = Rotation.from_quat(found[node]["rotation"]).as_matrix()
        matrix[:3, 3] = found[node]["translation"]
        matrices.append(matrix)
    return np.array(matrices)


def ours(places):
    """glTF's places in our axes, z up."""
    return np.stack([places[..., 0], -places[..., 2], places[..., 1]], axis=-1)


def skinned(document, frame, primitive=0):
    """Vertices of a primitive at a frame, in our axes, by skinning as the specification has it:
    joint transforms times inverse bind matrices."""
    attributes = document.meshes[0].primitives[primitive].attributes
    rest, follows = (numbers(document, getattr(attributes, k)) for k in ("POSITION", "JOINTS_0"))
    assert np.array_equal(numbers(document, attributes.WEIGHTS_0)[:, 0], np.ones(len(rest)))
    bind = numbers(document, document.skins[0].inverseBindMatrices).reshape(-1, 4, 4)
    bind = bind.transpose(0, 2, 1)  # column by column
    homogeneous = np.column_stack([rest, np.ones(len(rest))])
    matrices = (transforms(document, frame) @ bind)[follows[:, 0]]
    return ours(np.einsum("vij,vj->vi", matrices, homogeneous)[:, :3])


def test_every_frame_puts_every_corner_where_the_motion_has_it(document, motion):
    solid = solid_of_motion(motion)
    element, face = np.nonzero(solid.visible)
    for frame in range(motion.sizes["time"]):
        expected = solid.corners[frame][element[:, None], FACES[face]].reshape(-1, 3)
        found = skinned(document, frame)
        np.testing.assert_allclose(found, expected, atol=2e-6)  # single precision, metres


def strands(document, frame, primitive):
    """The ends (s, 2, 3) of strands at a frame, and how far (m) their ribbons' sides are from
    them."""
    corners = skinned(document, frame, primitive).reshape(-1, 3, 4, 3)
    ends = (corners[:, :, [0, 1]] + corners[:, :, [3, 2]]) / 2
    aside = np.linalg.norm(corners[:, :, [0, 1]] - ends, axis=-1)
    assert np.ptp(ends, axis=1).max() < 2e-6 and np.ptp(aside) < 2e-6
    return ends[:, 0], aside.mean()


def test_cables_run_through_their_points(strung, cable_places, tmp_path):
    document = pygltflib.GLTF2().load(write_glb(strung, tmp_path / "strung.glb"))
    for frame in (0, 5):
        ends, aside = strands(document, frame, 1)
        expected = cable_places[frame][[[0, 1], [2, 3], [3, 4]]]
        np.testing.assert_allclose(ends, expected, atol=3e-6)
        assert 0 < aside < 0.01


def test_pins_lie_on_the_hinges_axes(document, motion):
    on = motion["hinge_particle"].values[:, 0]
    for frame in (0, 5):
        ends, _ = strands(document, frame, 1)
        turn, place = (motion[key].values[frame, on] for key in ("frame", "position"))
        middle = place + np.einsum("hij,hj->hi", turn, motion["hinge_arm"].values)
        axis = np.einsum("hij,hj->hi", turn, motion["hinge_axis"].values)
        np.testing.assert_allclose(ends.mean(axis=1), middle, atol=3e-6)
        along = np.diff(ends, axis=1)[:, 0]
        np.testing.assert_allclose(np.cross(along, axis), 0.0, atol=3e-6)


def test_stress_and_tension_come_along(strung, tmp_path):
    """At each frame, by the element or cable that each vertex is of; above 0 wherever they are."""
    document = pygltflib.GLTF2().load(write_glb(strung, tmp_path / "strung.glb"))
    for name, key, primitive in (("stress", "stress", 0), ("tension", "cable_tension", 1)):
        expected, told = strung[key].values, document.extras[name]
        found = numbers(document, told["accessor"]).reshape(expected.shape) / 65535 * told["most"]
        np.testing.assert_allclose(found, expected, atol=2e-5 * expected.max())
        assert np.array_equal(found > 0, expected > 0)
        of = numbers(document, document.meshes[0].primitives[primitive].attributes._OF)
        assert set(of.astype(int)) == set(range(expected.shape[1]))


def test_a_small_file_is_as_exact_as_can_be_seen(motion, tmp_path):
    path = tmp_path / "small.glb"
    path.write_bytes(glb_of(motion, small=True))
    document = pygltflib.GLTF2().load(path)
    solid = solid_of_motion(motion)
    element, face = np.nonzero(solid.visible)
    size = np.ptp(motion["position"].values, axis=(0, 1)).max()
    for frame in (0, 5):
        expected = solid.corners[frame][element[:, None], FACES[face]].reshape(-1, 3)
        assert np.abs(skinned(document, frame) - expected).max() < 5e-5 * size
    assert len(path.read_bytes()) < len(glb_of(motion))


def test_times_are_seconds_and_turns_go_the_short_way(document, motion):
    animation = document.animations[0]
    time = numbers(document, animation.samplers[0].input)
    np.testing.assert_allclose(time, motion["time"].values, rtol=1e-6)
    for channel in animation.channels:
        if channel.target.path == "rotation":
            turn = numbers(document, animation.samplers[channel.sampler].output)
            assert np.sum(turn[1:] * turn[:-1], axis=1).min() >= 0
            np.testing.assert_allclose(np.linalg.norm(turn, axis=1), 1.0, atol=1e-6)


def test_faces_look_outward_with_the_normals_that_are_told(document):
    primitive = document.meshes[0].primitives[0]
    places = numbers(document, primitive.attributes.POSITION)
    told = numbers(document, primitive.attributes.NORMAL)
    triangles = numbers(document, primitive.indices).reshape(-1, 3)
    a, b, c = (places[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    assert np.sum(normal * told[triangles[:, 0]], axis=1).min() > 0.9
    middle = places.mean(axis=0)
    volume = np.einsum("ij,ij->", a - middle, np.cross(b - middle, c - middle)) / 6
    assert volume > 0


def test_named_points_hang_on_their_particles(document, motion):
    names = {node.name: i for i, node in enumerate(document.nodes)}
    matrices = transforms(document, 3)
    for i, name in enumerate(motion["point"].values):
        on = int(motion["point_particle"][i])
        node = document.nodes[names[f"point {name}"]]
        assert names[f"point {name}"] in document.nodes[names[f"particle {on}"]].children
        found = ours((matrices[on] @ [*node.translation, 1.0])[:3])
        np.testing.assert_allclose(found, motion["point_position"].values[3, i], atol=1e-6)


def test_accessors_hold_what_the_format_asks_for(document):
    assert document.asset.version == "2.0"
    assert document.buffers[0].byteLength <= len(document.binary_blob())
    primitive = document.meshes[0].primitives[0]
    for index in (primitive.attributes.POSITION, document.animations[0].samplers[0].input):
        accessor, values = document.accessors[index], numbers(document, index)
        np.testing.assert_allclose(accessor.min, np.atleast_1d(values.min(axis=0)), rtol=1e-6)
        np.testing.assert_allclose(accessor.max, np.atleast_1d(values.max(axis=0)), rtol=1e-6)
    for view in document.bufferViews:
        assert view.byteOffset % 4 == 0


def test_particles_without_bars_move_too(motion, tmp_path):
    path = write_glb(motion.isel(element=slice(0, 0), hinge=slice(0, 0)), tmp_path / "bare.glb")
    document = pygltflib.GLTF2().load(path)
    assert not document.meshes and not document.skins
    assert len(document.animations[0].channels) == 2 * motion.sizes["particle"]


def test_a_rigid_body_is_a_box(hub, tmp_path):
    document = pygltflib.GLTF2().load(write_glb(hub, tmp_path / "hub.glb"))
    found = skinned(document, 1) - [0.5, 0, 0]
    np.testing.assert_allclose(np.abs(found @ [np.cos(0.5), np.sin(0.5), 0.0]), 0.5, atol=1e-6)


def test_everything_is_in_the_scene(document):
    """Each node once, the joints and what is drawn among them."""
    found, left = [], list(document.scenes[document.scene].nodes)
    while left:
        found.append(left.pop())
        left += document.nodes[found[-1]].children or []
    assert sorted(found) == list(range(len(document.nodes)))
    assert any(node.mesh is not None for node in document.nodes)
    assert set(document.skins[0].joints) < set(found)
