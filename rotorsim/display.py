"""How results show themselves in notebooks: handed to the report package when one asks."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def as_html(result: Any) -> str:
    """HTML of a result, for its ``_repr_html_``.

    The report stands above everything that it shows; it is therefore loaded by name, here alone.
    """
    return import_module("rotorsim.show.report.notebook").as_html(result)
