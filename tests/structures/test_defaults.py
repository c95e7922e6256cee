"""What a structure file leaves out, and what the command tells of a structure's parameters."""

import numpy as np
import pytest
from structures_for_tests import structure

from fpm.structures.describe import describe
from fpm.structures.statement import REQUIRED
from fpm.structures.statements import STATEMENTS

NOTHING, AHEAD, UPWARDS = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]
DEFAULTS = {
    "materials": {"nu": 0.3},
    "bars": {"inertia_scale": 1.0},
    "bodies": {"points": (), "x": AHEAD, "up": UPWARDS},
    "masses": {"inertia": 0.0},
    "supports": {"translations": "xyz", "rotations": "xyz"},
    "joints revolute": {"opening": 0.0, "held": ""},
    "joints prismatic": {"opening": 0.0},
    "actions torsion spring": {"rest": 0.0},
    "actions spring": {"rest": 0.0},
    "actions stop": {"damping": 0.0},
    "actions latch": {"tolerance": 0.0, "side": "either", "damping": 0.0},
    "actions motor": {"damping": 0.0},
    "actions release": {"damping": 0.0},
    "loads": {"force": NOTHING, "moment": NOTHING},
    "cables": {"reel": 0.0},
    "drives": {"velocity": NOTHING, "spin": NOTHING},
    "motions": {"velocity": NOTHING, "spin": NOTHING},
}
"""What files that exist rely on: another default would change what they mean without a word."""


@pytest.mark.parametrize("name", DEFAULTS)
def test_what_is_left_out_means_what_it_did(name):
    (found,) = (s for s in STATEMENTS if f"{s.group} {s.type}".strip() == name)
    for key, value in DEFAULTS[name].items():
        default = found.keys[key].default
        assert (default.tolist() if isinstance(default, np.ndarray) else default) == value


def test_no_number_is_left_out_of_these():
    for one in STATEMENTS:
        known = DEFAULTS.get(f"{one.group} {one.type}".strip(), {})
        for key, kind in one.keys.items():
            if kind.default is not REQUIRED and isinstance(kind.default, float | np.ndarray):
                assert key in known, (one.group, key)


def test_the_command_tells_each_parameter_with_its_default_unit_and_limits():
    found = structure("scissor")
    rows = {line.split()[0]: line for line in describe(found).splitlines()[::-1] if line.strip()}
    for name, parameter in found.parameters.items():
        row, default = rows[name], parameter.default
        assert ("(from others)" in row) == (default is None)
        if default is not None:
            assert float(row.split()[1]) == pytest.approx(float(default), rel=1e-8)
        assert parameter.unit == "1" or parameter.unit in row
