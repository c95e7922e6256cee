"""A panel that a spring opens: a campaign with quantities, requirements and a choice."""

import math
from pathlib import Path

CONFIG = {
    "campaign": "opening",
    "scene": {
        "file": str(Path(__file__).parents[2] / "config/structures/panel.yaml"),
        "parameters": {"elements": 2},
    },
    "solver": {"duration": 2.2, "instants": 441},
    "intervals": {"k": {"nominal": 0.1, "relative": 0.05}},
    "design": {"method": "tensor_roots", "order": 2},
    "held_out": 2,
    "responses": {"psi": {"opening": "hinge"}},
    "quantities": {
        "t_open": {"crossing": "psi", "level": math.pi / 2},
        "t_never": {"crossing": "psi", "level": 3},
    },
    "requirements": {"in_time": {"t_open": {"at_most": 1.9334}}},
    "choose": {
        "parameters": {"k": [0.09, 0.12]},
        "maximise": "lower(t_open)",
    },
}
