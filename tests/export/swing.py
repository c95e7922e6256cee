"""The config of a small campaign."""

CONFIG = {
    "campaign": "swing",
    "scene": {"name": "pendulum", "parameters": {"elements": 3, "E": 1e8}},
    "solver": {"duration": 0.2, "instants": 101},
    "intervals": {"L": {"nominal": 1.0, "relative": 0.05}},
    "design": {"method": "tensor_roots", "order": 1},
    "held_out": 1,
    "responses": {"x": {"position": "T", "component": "x"}},
    "quantities": {
        "last": {"final": "x"},
        "passes": {"crossing": "x", "level": 0.7, "way": "falling"},  # not in all runs
    },
}
