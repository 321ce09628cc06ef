"""Pieces of HTML: figures, sections, lists. Every text that comes in is escaped here."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SVG_LIMIT = 400_000
"""Bytes from which on a figure is embedded as pixels: long orbits make long paths."""


def figure(drawn: Figure, caption: str) -> str:
    """Return the figure within the page: as SVG, or as pixels where that would grow long.

    With what `figures.js` shows of it under the pointer.
    """
    from ..figures.style import figure_bytes
    from .hover import hover_data

    data, kind = figure_bytes(drawn, "svg"), "svg+xml"
    if len(data) > _SVG_LIMIT:
        data, kind = figure_bytes(drawn, "png"), "png"
    coded = base64.b64encode(data).decode("ascii")
    said, width, planes = escape(caption), drawn.get_figwidth(), hover_data(drawn)
    known = f' data-planes="{escape(planes)}"' if planes else ""
    return (
        f'<figure><div class="frame"{known}><img style="width:{width:.2f}in" alt="{said}" '
        f'src="data:image/{kind};base64,{coded}"></div>'
        f"<figcaption>{said}</figcaption></figure>"
    )


def section(title: str, *parts: str) -> str:
    """Return the heading and what belongs to it; nothing where nothing does."""
    inside = "\n".join(part for part in parts if part)
    return f"<section>\n<h2>{escape(title)}</h2>\n{inside}\n</section>" if inside else ""


def listing(lines: Iterable[str], kind: str = "") -> str:
    """Return the bullet points."""
    items = "\n".join(f"<li>{escape(line)}</li>" for line in lines)
    return f"<ul{f' class={kind}' if kind else ''}>\n{items}\n</ul>" if items else ""


def paragraph(text: str, kind: str = "") -> str:
    """Return one paragraph of plain text."""
    return f"<p{f' class={kind}' if kind else ''}>{escape(text)}</p>"
