"""A panel that a spring opens, whose times are known in closed form.

A panel of inertia J about its hinge, turned by a spring k that rests at pi, opens to an angle in
sqrt(J / k) arccos(1 - angle / pi): an interval of k, or of the mass, gives that of the time.
"""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np

from deployable import campaign
from deployable.campaign.folder import Folder

ROOT = Path(__file__).parents[2]

PANEL = {
    "campaign": "panel",
    "scene": {
        "file": str(ROOT / "config/structures/panel.yaml"),
        "parameters": {"elements": 2},
    },
    "solver": {"duration": 2.0, "instants": 401},
    "intervals": {"k": {"nominal": 0.1, "relative": 0.05}},
    "design": {"method": "tensor_roots", "order": 3},
    "held_out": 2,
    "responses": {"psi": {"opening": "hinge"}},
    "quantities": {
        "t_open": {"crossing": "psi", "level": float(np.pi / 2), "way": "rising"},
        "t_late": {"crossing": "psi", "level": float(0.52 * np.pi)},
        "wide": {"final": "psi"},
    },
}


def exact_time(k, mass=1.0, opening=np.pi / 2):
    """Time (s) to an opening, of a panel of 1 m and 0.1 m thickness."""
    return np.sqrt(mass * (1 / 3 + 0.01 / 12) / k) * np.arccos(1 - opening / np.pi)


def panel(**changes) -> dict:
    return copy.deepcopy({**PANEL, **changes})


def run(raw, results) -> Folder:
    campaign.run(raw, results, figures=False, notify=lambda text: None)
    return Folder(results / raw["campaign"])
