"""The calibration of K_F: its campaign, its measures, its files, and the scene's defaults."""

from evidence.calibration import scans
from evidence.calibration.scans import PAPER, Reading

MESH_8 = Reading("mesh 8", (("elements", 8), ("start", 3.0)))


def test_the_chosen_readings_give_the_papers_numbers():
    (result,) = scans.campaign(MESH_8, [5.5], 5.5)
    assert result.fits
    assert result.misfit < 0.2
    assert result.at_second_closure
    assert {len(c) for c in result.closures} == {2}
    # "the upper and lower boundary curves essentially coincide" before the first closure
    for name in PAPER:
        assert result.first_width[name] < 0.05 * result.span[name]
