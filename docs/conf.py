"""Sphinx configuration of the documentation site.

Build it with ``python -m sphinx -W --keep-going docs docs/_build`` (extra ``docs``); nothing is
fetched from the network, and the pages ask no other host for anything.
"""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE / "_extensions")]

import rotorsim  # noqa: E402

project = "rotorsim"
author = "The rotorsim developers"
copyright = "The rotorsim developers, MIT license"
version = release = rotorsim.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml"]
exclude_patterns = ["_build", "_generated", "validation", "data"]

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3
nb_execution_mode = "off"  # notebooks hold their results; a test executes them
html_math_renderer = "mathml"

napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_class_signature = "separated"
python_use_unqualified_type_names = True

html_theme = "furo"
html_title = f"rotorsim {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False


def write_table_variables() -> None:
    """What a coefficient table holds, from the program's own list."""
    from rotorsim.bearing.table_format import ATTRIBUTES

    rows = [f"| `{name}` | {unit} | {text} |" for name, (unit, text) in ATTRIBUTES.items()]
    target = HERE / "_generated" / "table_variables.md"
    target.parent.mkdir(exist_ok=True)
    head = ["| variable | units | meaning |", "| --- | --- | --- |"]
    target.write_text("\n".join([*head, *rows, ""]), encoding="utf-8")


write_table_variables()
