"""A moving picture (GIF, WebP, MP4) of a motion."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from deployable.campaign.errors import CampaignError
from deployable.campaign.files import whole_file
from deployable.campaign.pictures import make_figure
from deployable.campaign.pictures.colours import draw_scale, stress_colours
from deployable.campaign.pictures.paint import (
    View,
    frame_picture,
    limits_of,
    paint_cables,
    paint_solid,
)
from deployable.campaign.pictures.solid import solid_of_motion

if TYPE_CHECKING:
    import xarray

SECONDS = 5.0  # how long the picture plays, whatever the time that it shows
HOLD = 0.8  # seconds for which its last frame stays
WIDTH, _DPI = 4.8, 100  # width of the picture, in inches, and pixels of an inch


def write_moving(motion: xarray.Dataset, path: Path, by_stress: bool = False) -> Path:
    """Write a whole motion as a moving picture of five seconds to `path` (.gif, .webp or .mp4);
    by_stress: coloured by it. Raises `CampaignError` for .mp4 without ffmpeg."""
    from PIL import Image

    if path.suffix == ".mp4":
        return _write_video(list(frames(motion, by_stress)), path)
    images = [Image.fromarray(frame) for frame in frames(motion, by_stress)]
    frame_ms = round(1000 * SECONDS / len(images))
    durations = [frame_ms] * (len(images) - 1) + [frame_ms + round(1000 * HOLD)]
    if path.suffix == ".gif":  # one palette for all, so that nothing flickers
        palette = _palette(images)
        images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
        options: dict[str, Any] = {"optimize": False, "disposal": 1}
    else:
        options = {"quality": 80, "method": 4}
    options |= {"append_images": images[1:], "duration": durations, "loop": 0}
    with whole_file(path) as temporary:
        images[0].save(temporary, save_all=True, **options)
    return path


def _write_video(images: list[np.ndarray], path: Path) -> Path:
    from matplotlib.animation import FFMpegWriter

    if not FFMpegWriter.isAvailable():
        raise CampaignError("mp4 needs ffmpeg, which is not installed; allowed: gif, webp")
    rate: Any = len(images) / SECONDS  # ffmpeg takes fractions
    height, width = (2 * (size // 2) for size in images[0].shape[:2])  # as the codec asks
    figure = make_figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)
    picture = figure.figimage(images[0][:height, :width])
    writer = FFMpegWriter(fps=rate)
    with whole_file(path) as temporary, writer.saving(figure, str(temporary), _DPI):
        for image in images + [images[-1]] * round(HOLD * rate):
            picture.set_data(image[:height, :width])
            writer.grab_frame()
    return path


def frames(motion: xarray.Dataset, by_stress: bool = False) -> Iterator[np.ndarray]:
    """Draw the frames of a whole motion in turn, as images (height, width, 3) of bytes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    solid, view = solid_of_motion(motion), View()
    limits = limits_of(solid.places, view)
    x_span, y_span = limits[1] - limits[0]
    height = WIDTH * (y_span + 0.2 * max(x_span, y_span)) / x_span
    shrink = min(1.0, 1.25 * WIDTH / height)  # a mast stands in a picture that is not too tall
    figure = make_figure(figsize=(WIDTH, shrink * height), dpi=_DPI)
    canvas = FigureCanvasAgg(figure)
    ax = figure.add_axes((0, 0, 1, 1))
    frame_picture(ax, limits, view)
    clock = ax.text(0.02, 0.98, "", transform=ax.transAxes, fontsize=9, va="top")
    colours = None
    if by_stress:
        colours, top = stress_colours(motion)
        draw_scale(figure, top)
    for moment, time in enumerate(motion["time"].values):
        if len(solid.nodes):
            moment_colours = None if colours is None else colours[moment]
            artists = [paint_solid(ax, solid, moment, view, moment_colours)]
            artists.append(paint_cables(ax, solid, moment, view))
        else:
            artists = ax.plot(*(view.page @ solid.position[moment].T), "o", color="black")
        clock.set_text(f"{time:.2f} s")
        canvas.draw()
        yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
        for artist in artists:
            artist.remove()


def _palette(images: list) -> Any:
    """Return a picture whose palette serves all frames: some of them side by side."""
    from PIL import Image

    sample = images[:: max(1, len(images) // 8)]
    width, height = images[0].size
    sheet = Image.new("RGB", (width, height * len(sample)), "white")
    for i, image in enumerate(sample):
        sheet.paste(image, (0, i * height))
    palette_image = sheet.quantize(128, dither=Image.Dither.NONE)
    colours = np.array(palette_image.getpalette()).reshape(-1, 3)
    colours[(colours > 244).all(axis=1)] = 255  # paper stays white
    palette = Image.new("P", (1, 1))
    palette.putpalette(colours.ravel().tolist())
    return palette
