"""Pictures show the structure: where it is, how large, and nothing that is behind."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib import colormaps, rcParams
from PIL import Image

from deployable.campaign.config.sections import scene_type
from deployable.campaign.errors import CampaignError
from deployable.campaign.export import export
from deployable.campaign.pictures.animation import frames, write_moving
from deployable.campaign.pictures.colours import stress_colours
from deployable.campaign.pictures.drawing import draw_structure
from deployable.campaign.pictures.paint import (
    View,
    nice_length,
    paint_cables,
    visible_faces,
)
from deployable.campaign.pictures.solid import Solid, solid_of_motion, solid_of_scene

STRUCTURES = Path(__file__).parents[2] / "config/structures"
SQUARE = 0.5 * np.array([[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]])


def cube():
    """A cube of 1 m between two particles on the x axis."""
    return Solid(
        nodes=np.array([[0, 1]]),
        sections=np.stack([SQUARE, SQUARE])[None],
        position=np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]]),
        frame=np.tile(np.eye(3), (1, 2, 1, 1)),
        elements=("bar[0]",),
    )


@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_a_moving_picture_has_all_frames_and_plays_for_ever(motion, tmp_path, kind):
    path = write_moving(motion, tmp_path / f"run.{kind}")
    with Image.open(path) as image:
        assert image.n_frames == motion.sizes["time"]
        assert image.info["loop"] == 0
        shown = []
        for frame in range(image.n_frames):
            image.seek(frame)
            shown.append(np.asarray(image.convert("RGB")).astype(int))
    assert (shown[0][-1] == 255).all()
    for one, other in pairwise(shown):
        assert np.abs(one - other).max() > 50
    assert max(shown[0].shape) <= 700


def test_a_video_has_all_frames_and_holds_the_last(motion, tmp_path, monkeypatch):
    """Of a stand-in for ffmpeg, which keeps the pixels that it is given."""
    path, program = tmp_path / "run.mp4", tmp_path / "ffmpeg"
    program.write_text('#!/bin/sh\nfor last; do :; done\ncat > "$last"\n')
    monkeypatch.setitem(rcParams, "animation.ffmpeg_path", str(program))
    with pytest.raises(
        CampaignError, match="mp4 needs ffmpeg, which is not installed; allowed: gi"
    ):
        write_moving(motion, path)
    program.chmod(0o755)
    expected = np.array(list(frames(motion)))
    assert write_moving(motion, path) == path
    height, width = (2 * (size // 2) for size in expected.shape[1:3])
    pixels = np.fromfile(path, np.uint8).reshape(-1, height, width, 4)[..., :3]
    np.testing.assert_array_equal(pixels[: len(expected)], expected[:, :height, :width])
    rest = pixels[len(expected) :]
    assert len(rest) == round(0.8 * len(expected) / 5) and (rest == rest[:1]).all()


def test_colours_of_stress_go_from_none_to_most_and_bodies_are_grey(motion):
    short = motion.isel(time=[0, -1]).copy(deep=True)
    stress = np.linspace(0, 5e6, short["stress"].size).reshape(short["stress"].shape)
    short["stress"].values[:] = stress
    colours, top = stress_colours(short)
    assert top == pytest.approx(np.quantile(stress, 0.995))
    np.testing.assert_allclose(colours[0, 0], colormaps["viridis"](0.0)[:3])
    np.testing.assert_allclose(colours[-1, -1], colormaps["viridis"](1.0)[:3])
    assert (np.diff(colours.reshape(-1, 3) @ [0.2126, 0.7152, 0.0722]) > -1e-3).all()  # brighter
    short["element_particle"].values[0] = 0  # a rigid body: one particle at both ends
    np.testing.assert_allclose(stress_colours(short)[0][:, 0], 0x99 / 255)


def test_a_moving_picture_by_stress_shows_the_same_frames_in_other_colours(motion, tmp_path):
    short = motion.isel(time=[0, -1])
    paths = [write_moving(short, tmp_path / f"{by}.webp", by_stress=by) for by in (False, True)]
    with Image.open(paths[0]) as one, Image.open(paths[1]) as other:
        assert one.size == other.size and one.n_frames == other.n_frames == 2
        pixels = [np.asarray(image.convert("RGB")).astype(int) for image in (one, other)]
    drawn = [(p < 200).any(axis=2) for p in pixels]
    assert (drawn[1] & drawn[0]).sum() > 0.8 * drawn[0].sum()  # the structure is where it was
    assert np.abs(pixels[0] - pixels[1]).max() > 50


def test_only_moving_pictures_are_coloured_by_stress(tmp_path):
    with pytest.raises(CampaignError, match="not for vtk; allowed: gif, webp"):
        export(None, "vtk", tmp_path, colour="stress")


def test_only_faces_towards_the_eye_are_painted_and_the_nearest_last():
    view = View(azimuth=-60, elevation=22)
    faces, colours = visible_faces(cube(), 0, view)
    assert faces.shape == (3, 4, 2) and colours.shape == (3, 3)
    area = 0.0
    for face in faces:
        d = face[2] - face[0], face[3] - face[1]
        area += 0.5 * abs(d[0][0] * d[1][1] - d[0][1] * d[1][0])
    assert area == pytest.approx(np.abs(view.direction).sum(), rel=1e-12)  # shadow of a unit cube


def test_the_view_is_orthonormal_and_x_y_z_are_right_handed_on_the_page():
    view = View()
    axes = np.vstack([view.page, view.direction])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert view.page[1] @ [0, 0, 1] > 0


def test_a_solid_of_a_scene_is_that_of_its_motions_first_frame(motion):

    still = solid_of_scene(scene_type("bennett").build(elements=3))
    moving = solid_of_motion(motion)
    np.testing.assert_allclose(still.corners[0], moving.corners[0], atol=1e-12)
    for solid in (still, moving):
        names = (name.partition("[")[0] for name in solid.elements)
        numbers = dict(zip(names, solid.bar.tolist(), strict=True))
        assert numbers == {"AB": 0, "BC": 1, "CD": 2, "DA": 3}
    assert still.visible.sum() == 12 * 4 + 4 * 2  # sides of all elements, two ends of each bar


@pytest.mark.parametrize(
    ("wanted", "found"), [(1.0, 1.0), (0.99, 0.5), (0.3, 0.2), (7.0, 5.0), (0.021, 0.02)]
)
def test_scales_are_round_lengths(wanted, found):
    assert nice_length(wanted) == pytest.approx(found)


@pytest.mark.parametrize("name", ["bennett", "pendulum", "tensegrity.yaml", "scissor.yaml"])
def test_a_still_shows_bars_cables_points_and_scale(name):
    from deployable.campaign.config.sections import scene_type

    file = str(STRUCTURES / name) if "." in name else ""
    scene = scene_type(name, file).build()
    (ax,) = draw_structure(scene).axes
    words = {text.get_text() for text in ax.texts}
    assert {"x", "y", "z", *scene.points} <= words
    assert any(word.endswith((" m", " mm")) for word in words)
    bars, cables = ax.collections
    assert len(bars.get_paths()) >= 3 * len(scene.beams)
    assert len(cables.get_paths()) == len(scene.cables)  # all of one stretch here
    ends = solid_of_scene(scene).cable_points[0]
    for place in [*scene.position[scene.beams[0].nodes[:, 0]], *ends]:
        x, y = View().page @ place
        assert ax.get_xlim()[0] < x < ax.get_xlim()[1]
        assert ax.get_ylim()[0] < y < ax.get_ylim()[1]


def test_the_scale_is_as_long_as_it_says():

    (ax,) = draw_structure(scene_type("pendulum").build()).axes
    said = next(t.get_text() for t in ax.texts if t.get_text().endswith(" m"))
    spans = [np.ptp(line.get_xdata()) for line in ax.lines if len(line.get_xdata()) == 2]
    assert any(span == pytest.approx(float(said.split()[0])) for span in spans)


def test_slack_cables_are_dashed(strung):
    from matplotlib.figure import Figure

    ax, solid = Figure().subplots(), solid_of_motion(strung)
    taut, slack = (paint_cables(ax, solid, moment, View()) for moment in (0, 5))
    assert [dash is not None for _, dash in taut.get_linestyle()] == [False, False, False]
    assert [dash is not None for _, dash in slack.get_linestyle()] == [False, True, True]


def test_stretches_of_a_bar_have_one_colour_and_the_faces_where_they_meet():
    one = cube()
    two = replace(
        one,
        nodes=np.array([[0, 1], [1, 2]]),
        sections=np.tile(one.sections, (2, 1, 1, 1)),
        position=np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]]),
        frame=np.tile(np.eye(3), (1, 3, 1, 1)),
        elements=("bar from foot[0]", "bar from knee[0]"),
    )
    assert two.bar.tolist() == [0, 0]
    assert two.visible.all()
    assert not replace(two, elements=("bar[0]", "bar[1]")).visible.all()
