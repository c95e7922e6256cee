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
