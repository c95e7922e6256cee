"""The notebook of the docs runs, and each of its cells shows something."""

import ast
import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_the_notebook_runs_and_every_cell_shows_what_it_ends_with(tmp_path, monkeypatch):
    notebook = json.loads((ROOT / "docs/notebook.ipynb").read_text(encoding="utf-8"))
    (tmp_path / "config").symlink_to(ROOT / "config")
    (tmp_path / "docs").mkdir()  # Jupyter runs a notebook in its own folder
    monkeypatch.chdir(tmp_path / "docs")
    names, shown = {}, []
    for cell in notebook["cells"]:
        if cell["cell_type"] != "code":
            continue
        *body, last = ast.parse("".join(cell["source"])).body
        exec(compile(ast.Module(body, []), "cell", "exec"), names)
        value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
        if hasattr(value, "_repr_png_"):
            assert value._repr_png_().startswith(b"\x89PNG")
        else:
            html = value._repr_html_()
            assert "<" in html and len(html) > 50
            shown.append(html)
    assert len(shown) == 4 and "hinge" in "".join(shown)
    assert "0.5 s in" in shown[2] and "&lt;" not in shown[0]
    bounds, figure = names["bounds"], value
    (ax, _) = figure.axes
    drawn = [line.get_ydata() for line in ax.get_lines()]
    for end in ("lower", "upper"):
        curve = bounds[end].sel(response="psi").values
        assert any(len(y) == len(curve) and abs(y - curve).max() == 0 for y in drawn)
