"""Figures for a journal: sizes, fonts, words that hide no curve; moments that tell the motion."""

import re
import zlib

import numpy as np
import pytest

from deployable.campaign.export import choose, export
from deployable.campaign.files import open_netcdf
from deployable.campaign.pictures.moments import draw_moments, telling_moments
from deployable.campaign.results.figures import envelope


@pytest.fixture(scope="module")
def drawn(results, tmp_path_factory):
    """The folder of a campaign's figures."""
    folder = tmp_path_factory.mktemp("figures")
    export(choose(str(results)), "figures", folder)
    return folder


def unpacked(path):
    """The bytes of a PDF with its streams inflated."""
    raw = path.read_bytes()
    streams = re.findall(rb"stream\r?\n(.*?)endstream", raw, re.S)
    return raw + b"".join(zlib.decompressobj().decompress(s) for s in streams if s[:1] == b"x")


def test_there_are_pdf_svg_and_png_of_responses_and_moments(drawn):
    names = {path.name for path in drawn.iterdir()}
    assert names == {f"{n}.{k}" for n in ("x", "nominal-moments") for k in ("pdf", "svg", "png")}


@pytest.mark.parametrize(("name", "millimetres"), [("x", 90), ("nominal-moments", 190)])
def test_pdfs_are_as_wide_as_columns_with_truetype_fonts_in_them(drawn, name, millimetres):
    content = unpacked(drawn / f"{name}.pdf")
    box = re.search(rb"/MediaBox \[\s*0 0 ([\d.]+)", content)
    assert float(box.group(1)) * 25.4 / 72 == pytest.approx(millimetres, abs=0.1)
    assert b"/FontFile2" in content  # TrueType
    assert b"/Type3" not in content


@pytest.mark.slow
def test_the_same_run_gives_the_same_bytes(results, drawn, tmp_path):
    export(choose(str(results)), "figures", tmp_path)
    for path in drawn.iterdir():
        assert path.read_bytes() == (tmp_path / path.name).read_bytes(), path.name


def test_no_words_stand_among_the_curves(results):
    with open_netcdf(results / "bounds.nc") as bounds:
        figure = envelope(bounds, "x", 0.1)
    (ax,) = figure.axes
    assert not any(text.get_text() for text in ax.texts)
    figure.draw_without_rendering()
    (legend,) = figure.legends
    assert not legend.get_window_extent().overlaps(ax.get_window_extent())
    told = [text.get_text() for text in legend.get_texts()]
    assert any(text.startswith("largest difference") and text.endswith(" m") for text in told)
    page = figure.bbox
    box = legend.get_window_extent()
    assert page.x0 <= box.x0 and box.x1 <= page.x1 and box.y1 <= page.y1


def test_moments_are_evenly_spread_in_the_way_gone(motion):
    import xarray

    uneven = motion["position"].values[[0] * 7].copy()
    uneven[:, :, 0] += np.array([0, 0.1, 0.2, 0.3, 0.4, 0.8, 1.0])[:, None]
    moved = motion.assign(position=(motion["position"].dims, uneven))
    assert telling_moments(moved, 2).tolist() == [0, 6]
    assert telling_moments(moved, 3).tolist() == [0, 4, 6]
    shut = xarray.Dataset({
        "contact_event_time": ("event", [0.3, 0.5]), "contact_event_closing": ("event", [1, 1]),
    })  # fmt: skip
    closed = moved.drop_dims("event", errors="ignore").merge(shut)
    assert telling_moments(closed, 2).tolist() == [0, 3]


def test_a_panel_a_moment_all_in_the_same_measure(motion):
    figure = draw_moments(motion, 4)
    assert len(figure.axes) == 4
    assert len({(*ax.get_xlim(), *ax.get_ylim()) for ax in figure.axes}) == 1
    titles = [ax.get_title() for ax in figure.axes]
    assert titles[0] == "0 s" and titles[-1] == "0.6 s"


class Bounds(dict):
    """As much of an open `bounds.nc` as a figure asks for."""

    bounds_kind = "enclosed range of the polynomial"
    variables = property(lambda self: self)


def bounds_of(width, error):
    """Bounds about a curve from 2 to 10 m, with their differences and errors (t,)."""
    middle = np.linspace(2, 10, len(width))
    return Bounds(
        response=["x"], response_units=["m"], response_long_name=["place of the tip"],
        response_least=[0.0], time=np.linspace(0, 1, len(width)),
        lower=middle[None] - width / 2, upper=middle[None] + width / 2, error=error[None],
    )  # fmt: skip


def test_a_difference_that_is_too_thin_to_see_has_a_panel_of_its_own():
    width = np.linspace(0.1, 0.5, 11)
    figure = envelope(bounds_of(width, 0.01 * width), "x", 0.1)
    ax, below = figure.axes
    np.testing.assert_allclose(below.lines[0].get_ydata(), width)
    assert below.get_xlabel() == "time (s)" and not ax.get_xlabel()
    assert len(envelope(bounds_of(10 * width, 0.1 * width), "x", 0.1).axes) == 1


def test_bounds_are_not_drawn_where_their_error_is_large():
    width, error = np.full(11, 4.0), np.where(np.arange(11) > 5, 1.5, 0.1)
    figure = envelope(bounds_of(width, error), "x", 0.1)
    (ax,), (legend,) = figure.axes, figure.legends
    drawn = {line.get_label(): line.get_ydata() for line in ax.lines}
    for name in ("lower bound", "upper bound"):
        assert (np.isnan(drawn[name]) == (error > 1)).all()
    assert any("no bounds where it is large" in text.get_text() for text in legend.get_texts())
    figure.draw_without_rendering()
    assert legend.get_window_extent().y1 < ax.get_window_extent().y0  # no words above the axes
    bands = [place for band in ax.collections for place in band.get_paths()]
    assert (
        min(path.vertices[:, 1].min() for path in bands if len(path.vertices)) >= -2.0
    )  # least bound
