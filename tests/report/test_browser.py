"""The page in Chromium: it moves, listens to keys and mouse, and nothing goes wrong."""

from dataclasses import replace

import numpy as np
import pytest
from browser import MISSING, Browser

from deployable.campaign.report import write_page

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
    motion = data.moving[0].motion
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


def test_keys_play_step_and_jump(window):
    window.press("\ue011")  # Home
    window.settle()
    assert window.ask(NOW) == 0.0
    window.press("\ue014", "\ue014")  # right
    window.settle()
    assert window.ask(NOW) == pytest.approx(0.02)  # two frames of 41 in 0.4 s
    window.press(" ")
    window.settle(1.0)
    window.press(" ")
    window.settle()
    stopped = window.ask(NOW)
    assert stopped > 0.02
    window.settle()
    assert window.ask(NOW) == stopped
    window.press("\ue010")  # End
    window.settle()
    assert window.ask(NOW) == pytest.approx(0.4)


def test_mouse_and_keys_turn_and_zoom_the_structure(window):
    window.ask(
        "document.getElementById('view').scrollIntoView({behavior: 'instant', block: 'center'})"
    )
    seen = [window.ask(PIXELS)]
    window.drag("#view", 80, 20)
    window.settle()
    seen.append(window.ask(PIXELS))
    window.ask("document.getElementById('view').focus()")
    for key in ("\ue012", "+"):  # left
        window.press(key)
        window.settle()
        seen.append(window.ask(PIXELS))
    window.press("0")
    window.settle()
    assert len(set(seen)) == len(seen)
    assert window.ask(PIXELS) == seen[0]


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


def test_of_many_runs_as_many_are_shown_as_colours_can_be_told_apart(window, data, tmp_path):
    first, *others = data.moving
    many = [replace(others[i % len(others)], label=f"run {i}") for i in range(9)]
    write_page(replace(data, moving=(first, *many)), tmp_path / "many.html")
    window.open(tmp_path / "many.html")
    window.settle()
    boxes = "[...document.querySelectorAll('#runs-shown input')]"
    checked = f"{boxes}.map((box, i) => box.checked ? i : -1).filter((i) => i >= 0)"
    coloured = f"new Set({boxes}.filter((box) => box.checked).map((box) => box.style.color)).size"
    lines = "document.querySelector('#charts svg').querySelectorAll('path.moving').length"
    assert window.ask(checked) == [0, 1, 2, 3, 4, 5, 6]
    assert window.ask("document.getElementById('few').hidden") is False
    pixels = window.ask(PIXELS)
    window.ask(f"{boxes}[8].click()")
    window.settle()
    assert window.ask(checked) == [0, 2, 3, 4, 5, 6, 8]
    assert window.ask(coloured) == 7 and window.ask(lines) == 6
    window.ask(f"{boxes}[3].click()")
    window.settle()
    assert window.ask(checked) == [0, 2, 4, 5, 6, 8]
    assert window.ask(lines) == 5 and window.ask(PIXELS) != pixels


def test_a_curve_has_a_gap_where_it_has_no_numbers(window, data, tmp_path):
    first, *others = data.responses
    widths = np.ones_like(first.widths)
    widths[0, 50:100] = np.nan
    rows = [{**row, "grade": "small"} for row in data.facts["responses"]]
    facts = {**data.facts, "responses": rows}
    write_page(
        replace(data, facts=facts, responses=(replace(first, widths=widths), *others)),
        tmp_path / "gap.html",
    )
    window.open(tmp_path / "gap.html")
    window.settle()
    curves = (
        "[...document.querySelector('#widths .chart svg').querySelectorAll('path.moving')]"
        ".map((path) => path.getAttribute('d').split('M').length - 1)"
    )
    assert window.ask(curves) == [2, 1]
    assert "NaN" not in window.ask("document.querySelector('#widths').innerHTML")


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


def test_the_table_of_bounds_is_exact(window, data):
    window.ask(
        "URL.createObjectURL = (blob) => {"
        " blob.text().then((text) => { window.table = text; }); return 'data:,'; }"
    )
    window.ask("document.querySelector('[data-table=bounds]').click()")
    window.settle()
    head, *rows = window.ask("window.table").strip().split("\n")
    assert head.split(",")[:3] == ["time (s)", "x_lower (m)", "x_upper (m)"]
    assert len(rows) == len(data.time)
    first = data.responses[0]
    for i in (0, 77, 200):
        cells = [float(cell) for cell in rows[i].split(",")]
        assert cells[:3] == [data.time[i], first.lower[i], first.upper[i]]


def test_a_still_goes_to_its_moment(window):
    window.ask("document.querySelector('#stills button').click()")
    window.settle()
    assert window.ask(NOW) == 0.0
    assert window.ask("document.querySelectorAll('#stills [aria-current=true]').length") == 1


def test_light_and_dark(window):
    theme = "document.documentElement.dataset.theme"
    before, pixels = window.ask(theme), window.ask(PIXELS)
    window.ask("document.getElementById('theme').click()")
    window.settle()
    assert {before, window.ask(theme)} == {"light", "dark"}
    assert window.ask(PIXELS) != pixels


def test_everything_that_can_be_used_has_a_name(window):
    nameless = window.ask(
        "[...document.querySelectorAll('button, select, input, canvas#view, svg[role=img]')]"
        ".filter((node) => !(node.textContent.trim() || node.ariaLabel || node.labels?.length))"
        ".map((node) => node.outerHTML)"
    )
    assert nameless == []


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


@pytest.mark.parametrize("screen", ["window", "telephone"])
def test_the_structure_is_on_the_first_screen_and_the_links_stay(screen, request):
    browser = request.getfixturevalue(screen)
    browser.ask("scrollTo(0, 0)")
    top = "document.querySelector('{}').getBoundingClientRect().{}"
    middle = browser.ask(f"({top.format('#view', 'top')} + {top.format('#view', 'bottom')}) / 2")
    assert browser.ask(top.format("h1", "top")) > 0 and middle < 0.9 * browser.ask("innerHeight")
    browser.ask("scrollTo({top: 2000, behavior: 'instant'})")
    browser.settle()
    assert browser.ask("scrollY") > 500 and browser.ask(top.format("nav a", "top")) >= 0
    browser.ask("scrollTo({top: 0, behavior: 'instant'})")


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


def test_fingers_zoom_curves_and_move_in_time(telephone):
    before = telephone.ask(PATHS)
    telephone.touch("#charts svg", ((-50, 0), (50, 0)))
    assert telephone.ask(PATHS) != before
    telephone.ask("document.getElementById('whole').click()")
    telephone.touch("#time", ((-40, 0), (40, 0)))
    later = telephone.ask(NOW)
    telephone.touch("#charts svg", ((-50, 0), (-50, 0)))
    assert 0 < telephone.ask(NOW) < 0.2 < later


def test_curves_are_as_wide_as_paper_only_while_it_is_printed(window):
    boxes = (
        "[...document.querySelectorAll('.chart svg')].map((each) => each.getAttribute('viewBox'))"
    )
    on_screen = window.ask(boxes)
    window.ask("dispatchEvent(new Event('beforeprint'))")
    window.settle()
    assert {box.split()[2] for box in window.ask(boxes)} == {"690"}
    window.ask("dispatchEvent(new Event('afterprint'))")
    window.settle()
    assert window.ask(boxes) == on_screen


def test_it_prints(window, tmp_path):
    window.print(tmp_path / "page.pdf")
    assert (tmp_path / "page.pdf").read_bytes().startswith(b"%PDF")
    paper = "document.getElementById('paper')"
    inked = f"{paper}.getContext('2d').getImageData(0, 0, {paper}.width, {paper}.height).data"
    assert window.ask(f"{inked}.filter((value, i) => i % 4 == 3 && value == 255).length") > 1000
    assert window.ask("document.documentElement.dataset.theme") == "light"
