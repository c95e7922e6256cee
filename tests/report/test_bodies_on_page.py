"""Rigid bodies on the page: the picture holds them whole."""

from dataclasses import replace

import numpy as np
import pytest
from browser import MISSING, Browser

from deployable.campaign.report import write_page

pytestmark = pytest.mark.skipif(
    bool(MISSING), reason=f"not installed: {', '.join(MISSING)} (apt-get install chromium-driver)"
)


def with_a_body(motion, reach):
    """The motion whose last element is a rigid body that reaches so far (m) from its particle."""
    ends, corners = motion["element_particle"].copy(), motion["section_corner"].copy()
    ends[-1] = ends[-1, 1]
    corners[-1] = np.sign(corners[-1]) * 0.01
    corners[-1, :, :, 0] = np.array([[-reach], [reach]])
    return motion.assign(element_particle=ends, section_corner=corners)


def extent_of(data, path, browser):
    """Radius (m) of what the page's picture holds, and the share of it that this takes."""
    write_page(data, path)
    browser.open(path)
    browser.settle()
    assert browser.errors() == []
    view = "document.getElementById('view').dataset"
    return browser.ask(f"[Number({view}.radius), Number({view}.page)]")


@pytest.mark.slow
def test_the_picture_holds_bodies(data, tmp_path):
    moving = tuple(replace(m, motion=with_a_body(m.motion, 3.0)) for m in data.moving)
    with Browser() as browser:
        radius, share = extent_of(data, tmp_path / "bars.html", browser)
        wide, same = extent_of(replace(data, moving=moving), tmp_path / "body.html", browser)
    assert share == pytest.approx(0.8, abs=0.02) and same == pytest.approx(0.8, abs=0.02)
    assert 3.0 < wide < 3.0 + 2 * radius
