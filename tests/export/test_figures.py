"""Figures for a journal: sizes, fonts, words that hide no curve; moments that tell the motion."""

import re
import zlib

import numpy as np
import pytest
import xarray

from deployable.campaign.errors import CampaignError
from deployable.campaign.export import choose, export
from deployable.campaign.folder import Folder
from deployable.campaign.pictures.drawing import draw_moments, telling_moments
from deployable.campaign.results.envelopes import Envelopes
from deployable.campaign.results.figures import envelope
from deployable.campaign.results.response_bounds import ResponseBounds, read_bounds


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


def test_no_words_stand_among_the_curves(results):
    (bounds,) = (row for row in read_bounds(Folder(results)).responses if row.name == "x")
    figure = envelope([bounds])
    ax, _ = figure.axes
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


def bounds_of(width, error):
    """Bounds about a curve from 2 to 10 m, with their differences and errors (t,) or (n, t)."""
    width, error = np.atleast_2d(width), np.atleast_2d(error)
    time, middle = np.linspace(0, 1, width.shape[1]), np.linspace(2, 10, width.shape[1])
    lower, upper = np.maximum(middle - width / 2, 0), np.minimum(middle + width / 2, 14)
    return [
        ResponseBounds(
            name, "place of the tip", "m", time, *ends, "enclosed range of the polynomial",
            error=of_it, least=0.0, most=14.0,
        )
        for name, of_it, *ends in zip("xyzu", error, lower, upper, strict=False)
    ]  # fmt: skip


EVEN = np.arange(21)
ERRORS = {  # by what part of the bounds is not to be relied on, where their difference is 4
    "none": np.full(21, 0.1),
    "end": np.where(EVEN > 15, 1.5, 0.1),
    "middle": np.where((EVEN > 8) & (EVEN < 12), 1.5, 0.5),
    "all": np.full(21, 1.5),
}


def drawn_lines(ax):
    """The two or more curves of bounds of some axes that are not faint, and those that are."""
    lines = [line for line in ax.lines if len(line.get_xdata()) == len(EVEN)]
    faint = [line.get_ydata() for line in lines if line.get_alpha()]
    return [line.get_ydata() for line in lines if not line.get_alpha()], faint


def test_bounds_are_drawn_at_all_instants_and_faint_where_they_are_not_to_be_relied_on():
    bounds = bounds_of(np.full((4, 21), 4.0), np.array(list(ERRORS.values())))
    singles = [envelope([one]) for one in bounds]
    panels = envelope(bounds)
    for ax, figure, error in zip(panels.axes, singles, ERRORS.values(), strict=True):
        for axis in (ax, *figure.axes):
            strong, faint = drawn_lines(axis)
            assert all((np.isnan(values) == (error >= 1)).all() for values in strong)
            assert len(faint) == len(strong) * (error >= 1).any()
            assert not any(np.isnan(values)[error >= 1].any() for values in faint)
        told = [text.get_text() for text in figure.legends[0].get_texts()]
        assert any("do not rely" in text for text in told) == (error >= 1).any()


@pytest.mark.parametrize(("count", "width"), [(1, 3.54), (2, 6.4), (2, 3.54), (4, 6.4)])
def test_several_responses_have_panels_with_letters_and_no_word_is_cut(count, width):
    bounds = bounds_of(np.full((count, 21), 4.0), np.tile(ERRORS["middle"], (count, 1)))
    figure = envelope(bounds, width)
    panels = [ax for ax in figure.axes if ax.axison]
    letters = [f"({letter})" for letter in "abcd"[:count]] if count > 1 else ["", ""]
    assert [ax.get_title("left") for ax in panels] == letters
    figure.draw_without_rendering()
    box = figure.legends[0].get_window_extent()
    assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1
    assert all(box.y1 < ax.get_window_extent().y0 for ax in panels)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(labels) == len(set(labels))


@pytest.mark.parametrize("share", [0.02, 0.1, 0.2, 0.24])
def test_no_band_is_cut_or_beyond_what_is_possible(share):
    width = np.linspace(0.1, 6.0, 21)
    figure = envelope(bounds_of(width, np.full(21, share * 6.0)))
    ax, below = figure.axes
    np.testing.assert_allclose(below.lines[0].get_ydata(), width)
    for axis in figure.axes:
        low, high = axis.get_ylim()
        points = [path.vertices[:, 1] for band in axis.collections for path in band.get_paths()]
        points = np.concatenate(points)
        assert max(0.0, low) <= points.min() and points.max() <= min(14.0, high)
    assert below.get_xlabel() == "time (s)" and not ax.get_xlabel()


def test_a_hatch_means_one_thing_in_all_axes():
    bounds = bounds_of(np.full((4, 21), 4.0), np.array(list(ERRORS.values())))
    choices = *([one] for one in bounds), bounds
    axes = [ax for rows in choices for ax in envelope(rows).axes]
    hatched = [patch for ax in axes for patch in ax.patches if patch.get_hatch()]
    meanings = {(patch.get_hatch(), patch.get_label()) for patch in hatched}
    assert meanings == {("///", "error above 10 % of\nthe largest difference")}
    assert len({patch.axes for patch in hatched}) == len(hatched) == 9  # of 12 axes, once in each


def test_bounds_in_python_draw_themselves_whole_or_selected(results):
    data = xarray.load_dataset(results / "bounds.nc")
    bounds = Envelopes(data.data_vars, data.coords, data.attrs)
    upper = bounds["upper"].sel(response="x").values
    early = bounds.sel(response="x").isel(time=slice(0, 5))
    for figure, count in (
        (bounds.plot(), None), (bounds.plot("x"), None), (bounds.sel(response="x").plot(), None),
        (bounds.sel(response=["x"]).plot(), None), (early.plot("x"), 5),
    ):  # fmt: skip
        drawn = [line.get_ydata() for line in figure.axes[0].get_lines()]
        assert any(np.array_equal(y, upper[:count]) for y in drawn)
    figure = bounds.assign_attrs(display='{"length": "mm"}').plot("x")
    assert any(np.allclose(x.get_ydata(), 1000 * upper) for x in figure.axes[0].get_lines())
    for one in (bounds, early):
        with pytest.raises(
            CampaignError, match=r"'X' is not a response \(did you mean x\?\); all.*: x"
        ):
            one.plot("X")
    with pytest.raises(CampaignError, match="no curve at one instant"):
        bounds.isel(time=3).plot()
