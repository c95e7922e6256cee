"""The cases in which one key for accuracy is put beside designs and scans chosen by hand.

Read by the workflow as well, so that this module imports nothing heavy."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SHARES = (0.2, 0.1, 0.05, 0.02, 0.01)
ROOT = Path(__file__).parents[3]


@dataclass(frozen=True)
class AccuracyCase:
    """A case: a config without design and mesh; rivals, configs by name that say those; and the
    `reference`, one that is much finer."""

    name: str
    title: str
    config: Mapping[str, Any]
    rivals: Mapping[str, Mapping]
    reference: Mapping[str, Any]
    shares: tuple[float, ...] = SHARES


def scan(samples: int, mesh: Mapping[str, int] | None = None, model: str = "spline") -> dict:
    """What a scan adds to a config, on a mesh."""
    change: dict = {"design": {"method": "sobol", "samples": samples}, "bounds": {"model": model}}
    if mesh:
        change["scene"] = {"parameters": mesh}
    return change


def sparse(order: int, held_out: int, mesh: Mapping[str, int] | None = None) -> dict:
    """What a sparse grid with a spline adds to a config, on a mesh."""
    return scan(0, mesh) | {"design": {"method": "smolyak", "order": order}, "held_out": held_out}


def _grids(mesh: str = "") -> dict[str, dict]:
    """Two sparse grids, on 8 and on 16 elements where there is a mesh."""
    return {
        f"smolyak {order}": sparse(order, held_out, {mesh: count} if mesh else None)
        for order, held_out, count in ((2, 4, 8), (4, 3, 16))
    }


def _file(name: str) -> dict:
    return {"file": str(ROOT / "config" / "structures" / f"{name}.yaml")}


_BENNETT = {"BD": {"distance": ["B", "D"]}, "vBz": {"velocity": "B", "component": "z"}}


def _links(count: int) -> dict[str, int]:
    return {"elements": count}


ACCURACY_CASES = (
    AccuracyCase(
        "three", "Bennett linkage, a ± 1 %, K_F ± 5 %, E ± 5 %, 0.4 s",
        {
            "scene": {"name": "bennett"},
            "solver": {"duration": 0.4, "instants": 801},
            "intervals": {
                "a": {"nominal": 0.035, "relative": 0.01},
                "K_F": {"relative": 0.05},
                "E": {"relative": 0.05},
            },
            "responses": _BENNETT,
        },
        {
            **_grids("elements"),
            "scan 32, 6 elements": scan(32, _links(6)),
            "scan 64, 12 elements": scan(64, _links(12)),
            "scan 256, 12 elements": scan(256, _links(12)),
        },
        scan(256, _links(24)),
    ),
    AccuracyCase(
        "six", "Bennett linkage, all six parameters of config/six.yaml, 0.27 s",
        {
            "scene": {"name": "bennett"},
            "solver": {"duration": 0.27, "instants": 541},
            "intervals": {
                "L": {"nominal": 0.45, "relative": 0.005},
                "a": {"nominal": 0.035, "relative": 0.01},
                "E": {"relative": 0.05},
                "rho": {"relative": 0.02},
                "K_C": {"relative": 0.1},
                "K_F": {"relative": 0.02},
            },
            "responses": _BENNETT,
        },
        {
            "smolyak 2": _grids("elements")["smolyak 2"],
            "scan 64, 6 elements": scan(64, _links(6)),
            "scan 256, 6 elements": scan(256, _links(6)),
            "scan 256, 12 elements": scan(256, _links(12)),
        },
        scan(1000, _links(16)),
        (0.2, 0.1, 0.05),
    ),
    AccuracyCase(
        "latch", "Rigid panel that a latch holds, k ± 10 %, angle ± 1°, 3 s",
        {
            "scene": _file("latch"),
            "solver": {"duration": 3.0, "instants": 1501},
            "intervals": {"k": {"relative": 0.1}, "angle": {"nominal": 90, "absolute": 1}},
            "responses": {
                "opening": {"opening": "hinge"},
                "speed": {"velocity": "tip", "component": "norm"},
            },
        },
        {**_grids(), "scan 64": scan(64), "scan 256": scan(256)},
        scan(2000, model="polynomial") | {"solver": {"step": 2e-4}},
    ),
    AccuracyCase(
        "pendulum", "Flexible pendulum, L ± 1 %, angle ± 1°, 1 s",
        {
            "scene": _file("pendulum"),
            "solver": {"duration": 1.0, "instants": 501},
            "intervals": {"L": {"relative": 0.01}, "angle": {"absolute": 1}},
            "responses": {
                "x": {"position": "T", "component": "x"},
                "vz": {"velocity": "T", "component": "z"},
            },
        },
        {**_grids("elements"), "scan 16, 4 elements": scan(16, {"elements": 4})},
        scan(64, {"elements": 32}),
    ),
)  # fmt: skip
