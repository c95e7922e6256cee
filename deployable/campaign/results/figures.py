"""Envelope figures in the manner of the paper's Figure 4, sensitivities, and nominal moments.

Bounds differ by dash as well as by colour, so that a grey print can be read."""

import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from deployable.campaign.files import result_file
from deployable.campaign.folder import PICTURES
from deployable.campaign.pictures import make_figure
from deployable.campaign.pictures.colours import BARS, BLUE, RED
from deployable.campaign.results.response_bounds import (
    LARGE,
    UNSURE,
    CampaignBounds,
    ResponseBounds,
)
from deployable.campaign.text.numbers import pretty

LOWER = {"color": BLUE, "linestyle": (0, (4, 1.5)), "linewidth": 1.1, "label": "lower bound"}
UPPER = {"color": RED, "linestyle": (0, (5, 1, 1, 1)), "linewidth": 1.1, "label": "upper bound"}
ERROR = {"color": BARS[3], "alpha": 0.35, "linewidth": 0, "label": "error estimate"}
NOMINAL = {"color": "0.35", "linestyle": "-", "linewidth": 0.8, "label": "nominal run"}
RANGE = {"color": "0.85", "linewidth": 0, "zorder": 1, "label": "between the bounds"}
DOUBT = f"do not rely on these bounds: error\nfrom {100 * UNSURE:.0f} % of the largest difference"
FAINT = {"linestyle": (0, (1, 1)), "linewidth": 1.0, "alpha": 0.6, "label": DOUBT}
ARROW = {"arrowstyle": "<->", "color": "black", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
SIGN: Any = {"marker": r"$\updownarrow$", "markersize": 9, "linestyle": "none", "color": "black"}
SHADE: Any = {"facecolor": "#F0E442", "edgecolor": "0.6", "hatch": "///", "alpha": 0.25}
DATELESS = {"png": {"Software": None}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}
"""Metadata of figures that the same data make the same."""
STYLE: Any = {"svg.hashsalt": "deployable-intervals", "pdf.fonttype": 42}
"""Matplotlib's settings for files: the same names in all, and TrueType fonts, as journals ask."""
_COLOURS = (BLUE, RED, *(BARS[i] for i in (2, 3, 0, 1)), "#000000", "#7F7F7F")
_DASHES = ("-", (0, (4, 1.5)), (0, (1, 1)), (0, (5, 1, 1, 1)), (0, (8, 2)))


def envelope(bounds: Sequence[ResponseBounds], width: float = 6.4) -> Any:
    """Make a matplotlib figure of responses over time: bounds, their error, nominal run, instants
    hatched where the error is large; bounds are faint where it exceeds a quarter (`UNSURE`) of
    their largest difference. All words stand below the axes.

    Parameters
    ----------
    bounds: of the responses. One stands above the difference of its bounds; several have a panel
        each, (a), (b), ...
    width: of the figure (inches)."""
    is_single, columns, narrow = len(bounds) == 1, 1 if len(bounds) <= 3 else 2, width < 5.0
    heights = [1.0] * -(-len(bounds) // columns)
    if is_single and (bounds[0].width > 0).any():
        heights = [1.0, 0.5]
    size = (width, (0.95 if narrow else 0.5625) * width / columns * sum(heights))
    figure = make_figure(figsize=size, layout="constrained")
    grid = {"sharex": is_single, "squeeze": False, "height_ratios": heights}
    axes = figure.subplots(len(heights), columns, **grid).ravel()
    for place, response in enumerate(bounds):
        letter = "" if is_single else f"({chr(97 + place)})"
        panel = axes if is_single else axes[place : place + 1]
        _draw_envelope(panel, response, letter)
        ylabel = f"{response.long_name}{_unit(response)}"
        panel[0].set_ylabel(textwrap.fill(ylabel, 30 if narrow or columns > 1 else 36))
    for ax in axes[max(len(bounds), len(heights)) :]:
        ax.set_axis_off()
    keys = [pair for ax in axes for pair in zip(*ax.get_legend_handles_labels(), strict=True)]
    keys.sort(key=lambda pair: pair[1].startswith("("))  # the numbers of panels last
    handles = {label: handle for handle, label in keys}
    style: Any = {"ncols": 2, "fontsize": 6} if narrow else {"ncols": 3, "fontsize": 7}
    style |= {"columnspacing": 1.2, "handlelength": 1.8, "frameon": False}
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", **style)
    return figure


def _draw_envelope(axes: Any, bounds: ResponseBounds, letter: str) -> None:
    """Draw a response into the first of some axes, the difference of its bounds into another."""
    ax, *difference_axes = axes
    lower, upper, difference, error = bounds.lower, bounds.upper, bounds.width, bounds.known_error
    time, axis_label = _abscissa(bounds)
    sure = np.full(len(time), True) if error is None else error < UNSURE * difference.max()
    faint = np.convolve(~sure, [1, 1, 1], "same") > 0  # joins what is sure
    ax.fill_between(time, lower, upper, where=sure, **RANGE)
    if bounds.nominal is not None:
        ax.plot(time, bounds.nominal, zorder=2, **NOMINAL)
    curves = [(ax, lower, LOWER), (ax, upper, UPPER)]
    curves += [(axis, difference, {"color": "black", "linewidth": 0.9}) for axis in difference_axes]
    for axis, values, style in curves:
        axis.plot(time, np.where(sure, values, np.nan), zorder=3, **style)
        if faint.any():
            values = np.where(faint, values, np.nan)
            axis.plot(time, values, zorder=1.5, **style | FAINT | {"label": None})
    if faint.any():
        ax.plot([], [], color="0.3", **FAINT)
    if error is not None:
        bands = [(ax, np.fmax(lower - error, bounds.least), lower),
                 (ax, upper, np.fmin(upper + error, bounds.most))]  # fmt: skip
        band = np.maximum(difference - error, 0), difference + error
        bands += [(axis, *band) for axis in difference_axes]
        label = f"error above {100 * LARGE:.3g} % of\nthe largest difference"
        for axis, low, high in bands:
            axis.fill_between(time, low, high, where=sure, zorder=0.5, **ERROR)
        for axis in axes:
            _shade(axis, time, error > LARGE * difference.max(), label)
    if sure[i := int(difference.argmax())] and difference[i] > 0:  # marked, and told in the legend
        ends = (time[i], lower[i]), (time[i], upper[i])
        ax.annotate("", *ends, arrowprops=ARROW, zorder=5)
        label = f"{letter} largest difference {difference[i]:.3g} {pretty(bounds.units)}"
        ax.plot([], [], label=label.strip().removesuffix(" 1"), **SIGN)
    ax.set_title(letter, loc="left", fontsize="medium")
    for axis in difference_axes:
        axis.set_ylabel(f"difference{_unit(bounds)}")
        axis.set_ylim(bottom=0)
    for axis in axes:
        axis.set_xlim(time[0], time[-1])
        axis.grid(color="0.9", linewidth=0.5)
        axis.set_axisbelow(True)
    ax.margins(y=0.08)
    axis.set_xlabel(axis_label)


def overlay(bounds: Mapping[str, ResponseBounds], width: float = 6.4) -> Any:
    """Make a matplotlib figure of the bounds of one response in several results, by their labels;
    width: of the figure (inches)."""
    figure = make_figure(figsize=(width, 0.5 * width), layout="constrained")
    ax = figure.subplots()
    for i, (label, response) in enumerate(bounds.items()):
        time, style = _abscissa(response)[0], {"color": _COLOURS[i % len(_COLOURS)]}
        ax.fill_between(time, response.lower, response.upper, alpha=0.2, lw=0, **style)
        dashes = _DASHES[i % len(_DASHES)]
        for end, name in ((response.lower, label), (response.upper, None)):
            ax.plot(time, end, linestyle=dashes, lw=1.0, label=name, **style)
    first = next(iter(bounds.values()))
    ax.set(ylabel=f"{first.long_name}{_unit(first)}", xlabel=_abscissa(first)[1])
    ax.legend(fontsize=7, frameon=False)
    return figure


def _unit(bounds: ResponseBounds) -> str:
    units = pretty(bounds.units)
    return f" ({units})" if units != "1" else ""


def shares(bounds: CampaignBounds, width: float = 7.0) -> Any:
    """Matplotlib figure of what each parameter contributes to each response: left its width over
    time when one parameter varies alone, right these integrated, in per cent of their sum. Widths
    not above the error of the fit are grey, and count as 0. width: of the figure (inches)."""
    responses = bounds.responses
    parameters = [parameter["name"] for parameter in bounds.parameters]
    labels = [_abscissa(response)[1] for response in responses]
    figure = make_figure(figsize=(width, 2.2 * len(responses) + 0.4), layout="constrained")
    axes = figure.subplots(len(responses), 2, width_ratios=(3, 1), squeeze=False)
    for place, (row, response) in enumerate(zip(axes, responses, strict=True)):
        time, error = _abscissa(response)[0], response.width_error
        share: Any = response.shares
        row[0].fill_between(time, error, color="0.92", lw=0, label="error of the fit")
        for i, (parameter, curve) in enumerate(zip(parameters, response.widths, strict=True)):
            line, colour = _DASHES[i % len(_DASHES)], _COLOURS[i % len(_COLOURS)]
            significant = np.where(curve > error, curve, np.nan)
            row[0].plot(time, curve, color="0.75", linestyle=line, lw=0.6, zorder=1)
            row[0].plot(time, significant, color=colour, linestyle=line, label=parameter, lw=1.0)
            row[1].barh(parameter, 100 * share[i], color=colour, height=0.6)
            row[1].text(100 * share[i], i, f" {100 * share[i]:.0f} %", va="center", fontsize=7)
        row[0].set_ylabel(f"width of {response.name} ({pretty(response.units)})", fontsize=8)
        row[0].set_xlim(time[0], time[-1])
        row[0].set_ylim(0, 1.05 * max(float(response.widths.max()), 1e-300))
        row[0].grid(color="0.9", linewidth=0.5)
        if labels[place : place + 1] != labels[place + 1 : place + 2]:
            row[0].set_xlabel(labels[place], fontsize=8)
        row[1].set_xlim(0, 130)
        row[1].invert_yaxis()
        for ax in row:
            ax.tick_params(labelsize=8)
    axes[-1, 1].set_xlabel("share (%)", fontsize=8)
    handles, texts = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside upper center", ncols=8, fontsize=8, frameon=False)
    return figure


def _abscissa(bounds: ResponseBounds) -> tuple[np.ndarray, str]:
    """Return the abscissa (T) of a response, and its label."""
    time, abscissa = bounds.time, bounds.abscissa
    if not abscissa:
        return time, "time (s)"
    share = (time - time[0]) / (time[-1] - time[0])
    positions = abscissa["first"] + (abscissa["last"] - abscissa["first"]) * share
    return positions, f"{abscissa['words']} ({abscissa['unit']})"


def _shade(ax: Any, time: np.ndarray, mask: np.ndarray, label: str) -> None:
    """Hatch the spans of time in which `mask` holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    for count, (start, stop) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        ends = time[start], time[min(stop, len(time) - 1)]
        ax.axvspan(*ends, label=label if count == 0 else None, linewidth=0, zorder=0, **SHADE)


@contextmanager
def small_fonts() -> Iterator[None]:
    """Context manager in which fonts that matplotlib embeds come without the tables by which other
    programs set text, which no PDF needs, and which take most of the time."""
    from fontTools import subset

    usual = subset.load_font

    def load_small(*arguments: Any, **options: Any) -> Any:
        font = usual(*arguments, **options)
        for table in {"GDEF", "GPOS", "GSUB", "kern"} & {*font.keys()}:
            del font[table]
        return font

    subset.load_font = load_small
    try:
        yield
    finally:
        subset.load_font = usual


def save(
    figure: Any,
    path: Path,
    kinds: Iterable[str] = PICTURES,
    dpi: int = 200,
    file: Any = result_file,
) -> None:
    """Save a matplotlib figure in some `kinds` of `DATELESS`, without dates: equal data give equal
    files. path: without suffix; file: context manager of a temporary path, by default sealed."""
    from matplotlib import rc_context
    from matplotlib.text import Text

    for text in figure.findobj(Text):  # in which dollar signs start no formula
        text.set_parse_math(False)
    for kind in kinds:
        with (
            file(path.with_name(f"{path.name}.{kind}")) as temporary,
            rc_context(STYLE),
            small_fonts(),
        ):
            fast = {"pil_kwargs": {"compress_level": 3}} if kind == "png" else {}
            figure.savefig(temporary, dpi=dpi, metadata=DATELESS[kind], **fast)
        figure.set_layout_engine(None)  # found by now, and the same for the next kind
