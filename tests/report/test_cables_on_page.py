"""Cables in the whole motion and on the page: where their points are, by tension or slack."""

from dataclasses import replace

import numpy as np
import pytest
from browser import MISSING, Browser

from deployable import campaign
from deployable.campaign.report import from_results, make_motions, write_page

pytestmark = pytest.mark.slow  # a time loop of its own

STRUCTURE = """
name: swing
description: A bar that falls into a slack cable and hangs on another
parameters: {g: {value: 9.81, unit: m/s2, range: [1, 20], description: weight}}
points: {A: [0, 0, 0], B: [1, 0, 0], C: [0, 0, 1], D: [1, 0, 1]}
materials: {steel: {E: 210 GPa, rho: 7850}}
sections: {rod: {type: rectangle, width: 30 mm, height: 20 mm}}
bars: {bar: {through: [A, B], section: rod, material: steel, elements: 1, up: z}}
cables:
  tight: {through: [A, {part: ground, at: C}], EA: 100 kN, preload: 23 N}
  slack: {through: [B, {part: ground, at: D}], EA: 100 kN, rest: 1.05}
gravity: [0, 0, -g]
record: {A: {part: bar, at: A}, B: {part: bar, at: B}}
"""
CONFIG = {
    "campaign": "cables",
    "solver": {"duration": 0.2, "instants": 201},
    "intervals": {"g": {"nominal": 9.81, "relative": 0.05}},
    "design": {"method": "tensor_roots", "order": 1},
    "held_out": 1,
    "responses": {"pull": {"tension": "slack"}},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    home = tmp_path_factory.mktemp("cables")
    (home / "swing.yaml").write_text(STRUCTURE)
    config = {**CONFIG, "scene": {"file": str(home / "swing.yaml")}}
    campaign.run(config, home / "results", figures=False, notify=lambda text: None)
    make_motions(home / "results" / "cables", frames=41)
    return home / "results" / "cables"


@pytest.fixture(scope="module")
def data(folder):
    return from_results(folder)


def test_the_motion_has_the_cables_points_and_tensions(data):
    motion = data.moving[0]
    assert motion["cable"].values.tolist() == ["tight", "slack"]
    assert motion["cable_point_cable"].values.tolist() == [0, 0, 1, 1]
    on, arms = motion["cable_point_particle"].values, motion["cable_point_arm"].values
    places = motion["position"].values[0, on] + np.einsum(
        "pij,pj->pi", motion["frame"].values[0, on], arms
    )
    np.testing.assert_allclose(places, [[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 0, 1]], atol=1e-12)
    tension = motion["cable_tension"].values
    assert tension[0].tolist() == pytest.approx([23.0, 0.0])
    assert tension[:, 1].max() > 100
    nominal = data.runs[0].curves[0]
    kept = np.searchsorted(data.time, motion["time"].values - 1e-9)
    assert np.array_equal(nominal[kept], tension[:, 1])


@pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)}")
def test_the_page_draws_them(folder, data):
    without = {i: m.drop_dims(["cable", "cable_point"]) for i, m in data.moving.items()}
    bare = replace(data, moving=without)
    key = "document.getElementById('cables')?.textContent ?? ''"
    seen = {}
    with Browser() as browser:
        for name, shown in (("with", data), ("without", bare)):
            page = folder / f"{name}.html"
            write_page(shown, page)
            browser.open(page)
            browser.settle()
            assert ("grey: no force" in browser.ask(key)) == (name == "with")
            seen[name] = browser.ask("document.getElementById('view').toDataURL()")
            assert browser.errors() == []
    assert seen["with"] != seen["without"]
