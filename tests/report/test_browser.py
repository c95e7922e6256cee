"""The page in Chromium: it moves, listens to keys and mouse, and nothing goes wrong."""

import numpy as np
import pytest
from browser import MISSING, Browser

pytestmark = pytest.mark.skipif(
    bool(MISSING), reason=f"not installed: {', '.join(MISSING)} (apt-get install chromium-driver)"
)

PIXELS = "document.getElementById('view').toDataURL()"
NOW = "Number(document.getElementById('view').dataset.time)"
SLIDE = """(() => {{ const slider = document.getElementById('time'); slider.value = {};
slider.dispatchEvent(new Event('input')); }})()"""


def look(browser):
    """Azimuth and elevation (rad) of the eye, its distance (m) and what it looks at (3,)."""
    return np.array(browser.ask("document.getElementById('view').dataset.look").split(), float)


PATHS = (
    "[...document.querySelectorAll('#charts path')].map((path) => path.getAttribute('d')).join()"
)


@pytest.fixture(scope="module")
def window(page):
    with Browser() as browser:
        browser.open(page)
        browser.settle()
        yield browser


@pytest.fixture(autouse=True)
def start(window, page):
    window.open(page)
    window.settle()
    yield
    assert window.errors() == []


def test_the_slider_moves_structure_and_cursor(window):
    cursor = "document.querySelector('#charts .cursor').getAttribute('x1')"
    seen = set()
    for time in (0.0, 0.2, 0.4):
        window.ask(SLIDE.format(time))
        window.settle()
        assert window.ask(NOW) == pytest.approx(time, abs=1e-6)
        seen.add((window.ask(PIXELS), window.ask(cursor)))
    assert len({pixels for pixels, _ in seen}) == 3
    assert len({place for _, place in seen}) == 3


def test_points_are_seen_where_the_motion_has_them(window, data):
    """Names stand 16 pixels beside the points that are seen from where the picture says it is."""
    motion = data.moving[0]
    box = window.ask("[view.clientWidth, view.clientHeight]")
    names = window.ask(
        "[...document.querySelectorAll('#picture .name')].map(({ textContent, style }) =>"
        " [textContent, parseFloat(style.left), parseFloat(style.top)])"
    )
    frame = int(np.abs(motion["time"].values - window.ask(NOW)).argmin())
    azimuth, elevation, away, *target = look(window)
    ca, sa, ce, se = np.cos(azimuth), np.sin(azimuth), np.cos(elevation), np.sin(elevation)
    right, up, towards = [-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]
    assert sorted(name for name, *_ in names) == sorted(motion["point"].values.tolist())
    for name, *seen in names:
        place = motion["point_position"].values[frame][motion["point"].values.tolist().index(name)]
        x, y, z = np.array([right, up, towards]) @ (place - target)
        scale = box[1] / 2 / np.tan(np.radians(11)) / (away - z)
        expected = np.array([box[0] / 2 + scale * x, box[1] / 2 - scale * y])
        assert np.linalg.norm(expected - seen) == pytest.approx(16, abs=1.5), name


def test_colour_by_stress_and_runs_that_are_hidden(window):
    seen = [window.ask(PIXELS)]
    window.ask("(() => { const s = document.getElementById('colour'); s.value = 'stress';"
               "s.dispatchEvent(new Event('change')); })()")  # fmt: skip
    window.settle()
    seen.append(window.ask(PIXELS))
    assert "MPa" in window.ask("document.getElementById('scale').textContent")
    window.ask("document.querySelectorAll('#runs-shown input')[1].click()")
    window.settle()
    seen.append(window.ask(PIXELS))
    assert len(set(seen)) == 3


def test_dragging_across_a_curve_zooms_all_and_a_button_goes_back(window):
    window.ask(
        "document.querySelector('#charts').scrollIntoView({behavior: 'instant', block: 'center'})"
    )
    before = window.ask(PATHS)
    window.drag("#charts svg", 90, 0)
    window.settle()
    assert window.ask(PATHS) != before
    assert window.ask("document.getElementById('whole').hidden") is False
    window.ask("document.getElementById('whole').click()")
    window.settle()
    assert window.ask(PATHS) == before


def test_the_cursors_values_are_those_of_the_bounds(window, data):
    window.ask(SLIDE.format(0.2))
    window.settle()
    said = window.ask("document.querySelector('#charts .readout').textContent").replace("−", "-")
    lower = data.responses[0].lower[100]
    assert f"{float(f'{lower:.4g}'):g}" in said


@pytest.fixture(scope="module")
def telephone(page):
    with Browser(390, 844) as browser:
        browser.open(page)
        browser.settle()
        yield browser
        assert browser.errors() == []


def test_a_telephone_needs_no_sideways_scrolling(telephone):
    assert telephone.ask("document.documentElement.scrollWidth") <= 390
    assert telephone.ask(
        "[...document.querySelectorAll('.scroll')].every((b) => b.scrollWidth <= b.clientWidth + 1)"
    )


def test_fingers_turn_zoom_and_move_the_structure(telephone):
    """Unless it was tapped, a finger that goes up or down scrolls the page."""

    def changes(*ways):
        telephone.middle("#view")
        before = look(telephone), telephone.ask("scrollY")
        telephone.touch("#view", *ways)
        (turned, raised, away, *moved) = look(telephone) - before[0]
        return turned, raised, away, np.abs(moved).max(), telephone.ask("scrollY") - before[1]

    turned, *others = changes(((0, 0), (80, 0)))
    assert turned < -0.3 and others == [0, 0, 0, 0]
    telephone.tap("#view")
    _, raised, *others = changes(((0, 0), (0, -40)))
    assert raised < -0.15 and others == [0, 0, 0]
    for pinch, nearer in (
        ((((-30, 0), (-60, 0)), ((30, 0), (60, 0))), True),
        ((((0, 60), (0, 30)), ((0, -60), (0, -30))), False),
    ):
        _, _, away, *_ = changes(*pinch)
        assert (away < 0) == nearer and abs(away) > 0.1
    turned, raised, away, moved, scrolled = changes(((-30, 0), (0, 40)), ((30, 0), (60, 40)))
    assert moved > 0.01 and (turned, raised, scrolled) == (0, 0, 0) and abs(away) < 0.01
    telephone.ask("document.getElementById('view').blur()")
    *others, scrolled = changes(((0, 40), (0, -60)))
    assert scrolled > 40 and others == [0, 0, 0, 0]


@pytest.mark.slow
def test_without_webgl_a_still_picture_stands_in_its_place(page):
    with Browser(webgl=False) as browser:
        browser.open(page)
        browser.settle(0.5)
        shown = "getComputedStyle(document.querySelector('{}')).display != 'none'"
        assert browser.ask(shown.format(".poster")) and not browser.ask(shown.format("#view"))
        assert browser.ask("document.querySelector('.poster img').naturalWidth") > 500
        assert browser.ask("document.querySelectorAll('#charts svg path').length") > 0
        browser.ask(SLIDE.format(0.2))
        assert browser.errors() == []
