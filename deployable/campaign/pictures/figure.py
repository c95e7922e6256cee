"""Matplotlib's figures, loaded at less cost where nobody reads what it says of them."""

import sys
from functools import cache
from io import BytesIO
from typing import Any


def make_figure(**options: Any) -> Any:
    """Make an empty `matplotlib.figure.Figure`. In a process of the program's commands, in which
    nobody calls `help`, matplotlib is loaded without texts on its settings, which take 0.2 s."""
    if getattr(sys.modules["__main__"], "__package__", None) == "deployable":
        from matplotlib import artist as settings

        setattr(settings, "kwdoc", lambda _: "")  # noqa: B010  # of other arguments
    return _picture_type()(**options)


@cache
def _picture_type() -> Any:
    from matplotlib.figure import Figure

    class Picture(Figure):
        """A figure that notebooks show."""

        def _repr_png_(self) -> bytes:
            buffer = BytesIO()
            self.savefig(buffer, format="png", dpi=110)
            return buffer.getvalue()

    return Picture
