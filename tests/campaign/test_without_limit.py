"""A structure on which nothing elastic acts has no stable step: its runs take the instants'."""

import pytest

from deployable.campaign import run

STRUCTURE = """
name: free
parameters:
  T: {value: 1, unit: N m, range: [0, 500], description: torque}
points: {root: [0, 0, 0]}
bodies:
  panel: {mass: 1, centre: root, inertia: [1, 1, 1]}
joints:
  hinge: {type: revolute, parts: [ground, panel], at: root, axis: z}
"""
ACTORS = (
    "actions: {m: {type: torque motor, joint: hinge, torque: T}}",
    "loads: {m: {part: panel, at: root, moment: [0, 0, T]}}",
)


@pytest.mark.slow
@pytest.mark.parametrize("actor", ACTORS)
def test_a_structure_on_which_nothing_elastic_acts_is_run(tmp_path, actor):
    """It turns by T t² / 2 J, by up to 9 rad in a step."""
    (tmp_path / "free.yaml").write_text(STRUCTURE + actor, encoding="utf-8")
    raw = {
        "campaign": "free",
        "scene": {"file": str(tmp_path / "free.yaml")},
        "solver": {"duration": 1, "instants": 11},
        "intervals": {"T": {"lower": 50, "upper": 100}},
        "responses": {"x": {"opening": "hinge"}},
    }
    bounds = run(raw, tmp_path, figures=False)
    last = bounds.isel(response=0, time=-1)
    assert [last["lower"].item(), last["upper"].item()] == pytest.approx([25, 50], rel=1e-9)
