"""What a page is made of, and its two renderings: HTML in one file, and Markdown."""

from __future__ import annotations

import base64
import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .claim import Verdict


@dataclass(frozen=True)
class Heading:
    """A heading of level 1 to 3."""

    level: int
    text: str


@dataclass(frozen=True)
class Paragraph:
    """Plain text."""

    text: str


@dataclass(frozen=True)
class Items:
    """A list."""

    entries: Sequence[str]


@dataclass(frozen=True)
class Grid:
    """A table of texts; cells that are a verdict are coloured in HTML."""

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Picture:
    """A figure by its name."""

    name: str
    caption: str


Block = Heading | Paragraph | Items | Grid | Picture

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 1180px; margin: 2em auto; padding: 0 1em;
  color: #1b1f24; background: #fff; }
h1 { font-size: 1.7em; } h2 { margin-top: 2em; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; font-size: 13px; margin: 1em 0; }
.scroll { overflow-x: auto; }
th, td { border: 1px solid #d5d9de; padding: 3px 7px; text-align: left; vertical-align: top; }
th { background: #f0f2f4; position: sticky; top: 0; }
figure { margin: 1.5em 0; } img { max-width: 100%; height: auto; }
figcaption { color: #555; font-size: 13px; }
.agrees { background: #d9f0dd; } .trend { background: #fdf0c8; }
.contradicts { background: #f9d6d2; } .undecided { background: #e4e4ea; }
@media print { body { max-width: none; } th { position: static; } }
"""
_CLASSES = {
    Verdict.AGREES: "agrees",
    Verdict.TREND: "trend",
    Verdict.CONTRADICTS: "contradicts",
    Verdict.UNDECIDED: "undecided",
}
MARKS = {Verdict.AGREES: "✓", Verdict.TREND: "~", Verdict.CONTRADICTS: "✗", Verdict.UNDECIDED: "?"}


def to_html(title: str, blocks: Sequence[Block], pictures: Mapping[str, bytes]) -> str:
    """One self-contained file: figures embedded, nothing fetched.

    Parameters
    ----------
    title : str
    blocks : sequence of Block
    pictures : mapping
        PNG data by figure name.
    """
    body = "\n".join(_html(block, pictures) for block in blocks)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"{body}\n</body>\n</html>\n"
    )


def _html(block: Block, pictures: Mapping[str, bytes]) -> str:
    if isinstance(block, Heading):
        return f"<h{block.level}>{html.escape(block.text)}</h{block.level}>"
    if isinstance(block, Paragraph):
        return f"<p>{html.escape(block.text)}</p>"
    if isinstance(block, Items):
        return "<ul>" + "".join(f"<li>{html.escape(e)}</li>" for e in block.entries) + "</ul>"
    if isinstance(block, Picture):
        data = base64.b64encode(pictures[block.name]).decode("ascii")
        caption = html.escape(block.caption)
        return (
            f'<figure><img alt="{caption}" src="data:image/png;base64,{data}">'
            f"<figcaption>{caption}</figcaption></figure>"
        )
    head = "".join(f"<th>{html.escape(column)}</th>" for column in block.columns)
    rows = "\n".join("<tr>" + "".join(map(_cell, row)) + "</tr>" for row in block.rows)
    return (
        f'<div class="scroll"><table><thead><tr>{head}</tr></thead>\n'
        f"<tbody>{rows}</tbody></table></div>"
    )


def _cell(text: str) -> str:
    for verdict, name in _CLASSES.items():
        if text == verdict.value or text.endswith(f" {MARKS[verdict]}"):
            return f'<td class="{name}">{html.escape(text)}</td>'
    return f"<td>{html.escape(text)}</td>"


def to_markdown(blocks: Sequence[Block], folder: str) -> str:
    """Markdown with figures in `folder`, relative to the page."""
    return "\n\n".join(_markdown(block, folder) for block in blocks) + "\n"


def _markdown(block: Block, folder: str) -> str:
    if isinstance(block, Heading):
        return f"{'#' * block.level} {block.text}"
    if isinstance(block, Paragraph):
        return _plain(block.text)
    if isinstance(block, Items):
        return "\n".join(f"- {_plain(entry)}" for entry in block.entries)
    if isinstance(block, Picture):
        return f"![{block.caption}]({folder}/{block.name}.png)\n\n*{_plain(block.caption)}*"
    lines = [block.columns, ["---"] * len(block.columns), *block.rows]
    return "\n".join("| " + " | ".join(_plain(cell) for cell in line) + " |" for line in lines)


def _plain(text: str) -> str:
    # What Markdown would take for markup.
    for character in "\\|*_<":
        text = text.replace(character, f"\\{character}")
    return text
