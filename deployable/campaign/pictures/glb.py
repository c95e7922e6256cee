"""A whole motion as one glTF 2.0 file (.glb) that plays in viewers and in Blender.

Particles are nodes that move and turn; bars, cables and pins of hinges are one skinned mesh, whose
corners follow particles. glTF's axes are right-handed with y up: x, z and -y of ours. Metres,
seconds. Format: Khronos, glTF 2.0 specification, https://registry.khronos.org/glTF/specs/2.0."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from deployable.campaign.files import whole_file
from deployable.campaign.pictures.colours import BARS, CABLE, PIN, rgb
from deployable.campaign.pictures.solid import FACES, Solid, solid_of_motion

if TYPE_CHECKING:
    import xarray

TO_GLTF = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # from our axes to glTF's

_COMPONENTS = {"f4": 5126, "u4": 5125, "u2": 5123, "i2": 5122}  # glTF's numbers of the types
_VERTEX, _INDEX = 34962, 34963  # and of what a view is for
_STRAND = 12  # vertices of a strand: three ribbons
_SURFACE = {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0.0, "roughnessFactor": 0.7}
_LINE = {"doubleSided": True, "extensions": {"KHR_materials_unlit": {}}}
_SHAPES = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}


class _Buffer:
    """The file's binary part, and the accessors into it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict] = []
        self.accessors: list[dict] = []

    def add(self, values: np.ndarray, kind: str = "f4", target: int | None = None, **fields) -> int:
        """Store an array in the binary part of the file and return the index of its accessor
        (glTF's description of an array). kind: type to store it in; target: glTF's number of its
        use (vertices or indices); fields: further keys of the accessor, such as normalized=True."""
        raw = np.ascontiguousarray(values, dtype=f"<{kind}")
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": raw.nbytes}
        self.views.append(view | ({"target": target} if target else {}))
        self.data += raw.tobytes() + b"\0" * (-raw.nbytes % 4)
        accessor: dict[str, Any] = {"bufferView": len(self.views) - 1, "count": len(raw)}
        accessor |= {"componentType": _COMPONENTS[kind], "type": _SHAPES[raw.shape[1:]]}
        if kind == "f4" and raw.ndim < 3:  # the format asks for them at some, and allows all
            low, high = raw.min(axis=0), raw.max(axis=0)
            accessor |= {"min": np.atleast_1d(low).tolist(), "max": np.atleast_1d(high).tolist()}
        self.accessors.append(accessor | fields)
        return len(self.accessors) - 1


def write_glb(motion: xarray.Dataset, path: Path) -> Path:
    """Write a whole motion (dataset of `fpm.solver.motion`) to `path` (.glb), one glTF file that
    plays in viewers and Blender; returns `path`."""
    with whole_file(path) as temporary:
        temporary.write_bytes(glb_of(motion))
    return path


def glb_of(motion: xarray.Dataset, small: bool = False) -> bytes:
    """Encode a whole motion (dataset of `fpm.solver.motion`) as the bytes of a glTF file (.glb)
    that plays it. small: round positions to 1/65534 of the extent, rotations to 16 bits."""
    buffer = _Buffer()
    content = _content(motion, buffer, small)
    text = json.dumps(content, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(buffer.data), b"BIN\0") + bytes(buffer.data)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _content(motion: xarray.Dataset, buffer: _Buffer, small: bool) -> dict[str, Any]:
    """Return the JSON part: the particles' node, the mesh, a node for each particle and point."""
    place = motion["position"].values @ TO_GLTF.T
    if small:
        quantum = np.ptp(place, axis=(0, 1)).max() / 65534 or 1.0
        place = quantum * np.rint(place / quantum)
    turn = TO_GLTF @ motion["frame"].values @ TO_GLTF.T
    quaternion = _quaternions(turn)
    nodes: list[dict] = [{"name": f"particles of {motion.attrs['scene']}"}]
    if meshes := _mesh(motion, buffer):
        nodes.append({"name": "structure", "mesh": 0, "skin": 0})
    first = len(nodes)
    poses = zip(place[0].tolist(), quaternion[0].tolist(), strict=True)
    nodes += [
        {"name": f"particle {p}", "translation": x, "rotation": turns}
        for p, (x, turns) in enumerate(poses)
    ]
    nodes[0]["children"] = joints = [*range(first, len(nodes))]
    columns = (motion[f"point{key}"].values for key in ("", "_particle", "_arm"))
    for name, particle, arm in zip(*columns, strict=True):
        nodes[first + particle].setdefault("children", []).append(len(nodes))
        nodes.append({"name": f"point {name}", "translation": (TO_GLTF @ arm).tolist()})
    animation = _animation(motion["time"].values, place, quaternion, joints, buffer, small)
    loads = {}  # stress (Pa) of elements, tension (N) of cables by frame: colours, shares of `most`
    for name, key in (("stress", "stress"), ("tension", "cable_tension")):
        values = motion[key].values if key in motion else np.zeros(0)
        if values.size:
            most = float(values.max())
            shares = np.ceil(65535 * np.clip(values / (most or 1.0), 0.0, 1.0)).ravel()
            loads[name] = {"most": most, "accessor": buffer.add(shares, "u2", normalized=True)}
    content = {
        "asset": {"version": "2.0", "generator": "deployable-intervals"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1] if meshes else [0]}],
        "nodes": nodes,
        "animations": [animation],
        "extras": loads,
        **meshes,
    }
    if meshes:  # with the inverse of each particle's transform in the first frame, by columns
        matrices = np.zeros((len(place[0]), 4, 4))
        matrices[:, :3, :3] = turn[0].transpose(0, 2, 1)
        matrices[:, :3, 3] = -np.einsum("nji,nj->ni", turn[0], place[0])
        matrices[:, 3, 3] = 1.0
        bind = buffer.add(matrices.transpose(0, 2, 1))
        content["skins"] = [{"joints": joints, "skeleton": 0, "inverseBindMatrices": bind}]
    content |= {"accessors": buffer.accessors, "bufferViews": buffer.views}
    return content | {"buffers": [{"byteLength": len(buffer.data)}]}


def _mesh(motion: xarray.Dataset, buffer: _Buffer) -> dict[str, Any]:
    """Bars, cables and pins in the first frame, particles they follow, elements (`_OF`)."""
    solid = solid_of_motion(motion.isel(time=slice(0, 1)))
    primitives = []
    if len(solid.nodes):
        primitives.append(_bars(solid, buffer))
    span = float(np.ptp(motion["position"].values, axis=(0, 1)).max()) or 1.0
    cables, ends = solid.cables, solid.cables.stretches
    if len(ends):
        points, nodes = solid.cable_points[0][ends], cables.particle[ends]
        primitives.append(_strands(points, nodes, 0.002 * span, CABLE, buffer) | {"material": 1})
        cable = np.repeat(cables.cable[ends[:, 0]], _STRAND)
        primitives[-1]["attributes"]["_OF"] = buffer.add(cable, target=_VERTEX)
    if motion.sizes["hinge"]:
        bars = solid.nodes[:, 0] != solid.nodes[:, 1]  # of whose widths pins take the largest
        half = float(np.abs(solid.sections[bars]).max(initial=0.0)) or 0.02 * span
        pins, nodes = _pins(motion, 0.9 * half)
        primitives.append(_strands(pins, nodes, 0.11 * half, PIN, buffer) | {"material": 2})
    if not primitives:
        return {}
    return {
        "meshes": [{"name": "structure", "primitives": primitives}],
        "materials": [
            {"name": "bars", "pbrMetallicRoughness": _SURFACE},
            {"name": "cables", **_LINE},
            {"name": "pins", **_LINE},
        ],
        "extensionsUsed": ["KHR_materials_unlit"],
    }


def _bars(solid: Solid, buffer: _Buffer) -> dict[str, Any]:
    """Return the visible faces of the bars, two triangles each."""
    element, face = np.nonzero(solid.visible)
    corner = FACES[face]  # (f, 4)
    points = (solid.corners[0] @ TO_GLTF.T)[element[:, None], corner]
    normal = np.cross(points[:, 2] - points[:, 0], points[:, 3] - points[:, 1])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.where(length > 0, normal / np.maximum(length, 1e-300), [0.0, 1.0, 0.0])  # of a line
    colours = np.array([rgb(BARS[bar % len(BARS)]) for bar in solid.bar])[element]
    follows = solid.nodes[element[:, None], corner // 4].ravel()
    element_ids = np.where(solid.nodes[:, 0] == solid.nodes[:, 1], -1, np.arange(len(solid.nodes)))
    primitive = _quads(points, np.repeat(colours, 4, axis=0), follows, buffer) | {"material": 0}
    primitive["attributes"] |= {
        "NORMAL": buffer.add(np.repeat(normal, 4, axis=0), target=_VERTEX),
        "_OF": buffer.add(np.repeat(element_ids[element], 4), target=_VERTEX),
    }
    return primitive


def _pins(motion: xarray.Dataset, half: float) -> tuple[np.ndarray, np.ndarray]:
    """Hinges' axes, `half` (m) to either side: ends (h, 2, 3) m at first, and particles (h, 2)."""
    particles = motion["hinge_particle"].values[:, :1]
    ends = np.multiply.outer([-half, half], motion["hinge_axis"].values)
    ends += motion["hinge_arm"].values
    first = motion.isel(time=0)
    offsets = np.einsum("hij,ehj->hei", first["frame"].values[particles[:, 0]], ends)
    return first["position"].values[particles] + offsets, np.repeat(particles, 2, axis=1)


def _strands(
    ends: np.ndarray, nodes: np.ndarray, half: float, colour: str, buffer: _Buffer
) -> dict[str, Any]:
    """Strands between ends (s, 2, 3) m that follow particles `nodes` (s, 2): three ribbons each."""
    shift = half * np.stack([np.eye(3), np.eye(3), -np.eye(3), -np.eye(3)], axis=1)  # (3, 4, 3)
    points = (ends[:, None, [0, 1, 1, 0]] + shift).reshape(-1, 4, 3) @ TO_GLTF.T
    colours = np.tile(rgb(colour), (4 * len(points), 1))
    return _quads(points, colours, np.tile(nodes[:, None, [0, 1, 1, 0]], (1, 3, 1)).ravel(), buffer)


def _quads(
    points: np.ndarray, colours: np.ndarray, follows: np.ndarray, buffer: _Buffer
) -> dict[str, Any]:
    """Quadrilaterals (f, 4, 3): colours of screens, the one particle that each vertex follows."""
    points = points.reshape(-1, 3)
    joints = np.zeros((len(points), 4), int)
    joints[:, 0] = follows
    weights = np.tile([1.0, 0.0, 0.0, 0.0], (len(points), 1))
    light = np.where(  # of colours of screens (sRGB): as shares of it are those of the format
        colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4
    )
    triangles = 4 * np.arange(len(points) // 4)[:, None, None] + [[0, 1, 2], [0, 2, 3]]
    return {
        "attributes": {
            "POSITION": buffer.add(points, target=_VERTEX),
            "COLOR_0": buffer.add(light, target=_VERTEX),
            "JOINTS_0": buffer.add(joints, "u2", _VERTEX),
            "WEIGHTS_0": buffer.add(weights, target=_VERTEX),
        },
        "indices": buffer.add(triangles.ravel(), "u4", _INDEX),
    }


def _animation(
    time: np.ndarray, place: np.ndarray, quaternion: np.ndarray, joints: Sequence[int],
    buffer: _Buffer, small: bool,
) -> dict[str, Any]:  # fmt: skip
    """Places and turns of all particles in time; turns in 16 bits if `small`."""
    clock = buffer.add(time - time[0])
    samplers: list[dict] = []
    channels: list[dict] = []
    kind: dict[str, Any] = {"kind": "i2", "normalized": True} if small else {}
    turns = np.rint(32767 * quaternion) if small else quaternion
    for p, node in enumerate(joints):
        places, rotations = buffer.add(place[:, p]), buffer.add(turns[:, p], **kind)
        for path, output in (("translation", places), ("rotation", rotations)):
            channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
            samplers.append({"input": clock, "output": output})
    return {"name": "motion", "samplers": samplers, "channels": channels}


def _quaternions(turn: np.ndarray) -> np.ndarray:
    """Unit quaternions (t, n, 4), x y z w, of rotations (t, n, 3, 3), each near the one before."""
    trace, transpose = np.trace(turn, axis1=2, axis2=3)[..., None, None], turn.swapaxes(2, 3)
    products = np.empty((*turn.shape[:2], 4, 4))  # four times those of their numbers
    products[..., :3, :3] = turn + transpose + (1.0 - trace) * np.eye(3)
    products[..., 3, :3] = (turn - transpose)[..., [2, 0, 1], [1, 2, 0]]
    products[..., :3, 3], products[..., 3:, 3:] = products[..., 3, :3], 1.0 + trace
    largest = np.einsum("tnii->tni", products).argmax(axis=2)
    quats = np.take_along_axis(products, largest[..., None, None], axis=2)[:, :, 0]
    quats /= np.linalg.norm(quats, axis=2, keepdims=True)
    flips = np.sum(quats[1:] * quats[:-1], axis=2) < 0
    signs = np.where(np.cumsum(flips, axis=0) % 2 == 1, -1.0, 1.0)
    quats[1:] *= signs[:, :, None]
    return quats
