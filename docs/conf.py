"""The documentation as a site: `sphinx-build -W docs site`, then open site/index.html.

Pages are the Markdown files of this folder. Nothing in the site is loaded from a network."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "extensions"), str(HERE.parent)]

project = "deployable-intervals"
copyright = author = "the authors of deployable-intervals"
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "docstrings",
    "gallery",
    "mathml",
    "term_links",
]
exclude_patterns = ["made/*.md", "extensions", "static"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4  # links to headings, as `page.md#heading`
html_theme = "furo"
html_title = "deployable-intervals"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_show_copyright = False
html_copy_source = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_inherit_docstrings = False
suppress_warnings = ["misc.highlighting_failure"]  # listings that are no whole programs
