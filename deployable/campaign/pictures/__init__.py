"""Pictures of structures: any structure, still or moving, from its motion; and empty figures."""

import sys
from functools import partial
from io import BytesIO
from typing import Any


def make_figure(**options: Any) -> Any:
    """Make an empty `matplotlib.figure.Figure`. In a process of the program's commands, in which
    nobody calls `help`, matplotlib is loaded without texts on its settings, which take 0.2 s."""
    if getattr(sys.modules["__main__"], "__package__", None) == "deployable":
        from matplotlib import artist as settings

        setattr(settings, "kwdoc", lambda _: "")  # noqa: B010  # of other arguments
    from matplotlib.figure import Figure

    figure = Figure(**options)
    setattr(figure, "_repr_png_", partial(to_png, figure))  # noqa: B010  # for notebooks
    return figure


def to_png(figure: Any) -> bytes:
    """Return a figure as the content of a PNG file, the same bytes for the same data."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=110, metadata={"Software": None})
    return buffer.getvalue()
