r"""Equations as MathML, made while the site is built.

Browsers draw MathML by themselves: no script, no font and no other host is needed to read a page.
docutils, on which Sphinx stands, brings the converter from LaTeX.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx


def inline(translator: Any, node: nodes.math) -> None:
    """Write an equation within a line."""
    translator.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def display(translator: Any, node: nodes.math_block) -> None:
    """Write an equation of its own."""
    translator.body.append(f'<div class="math">{_block(node.astext())}</div>\n')
    raise nodes.SkipNode


def _block(latex: str) -> str:
    if r"\\" in latex and r"\begin" not in latex:
        latex = rf"\begin{{aligned}}{latex}\end{{aligned}}"
    return tex2mathml(latex, as_block=True)


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the renderer; ``html_math_renderer = "mathml"`` chooses it."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(inline, None), block_renderers=(display, None)
    )
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
