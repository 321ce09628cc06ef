"""Curves of a coefficient table over speed, for programs that take one bearing at a time."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..bearing.table import CoefficientTable
from ..errors import TableError
from ..rows import RPM


@dataclass(frozen=True)
class Curve:
    """Converged coefficients of one bearing over speed (SI, load frame).

    name : For a file's name: what tells this curve from the others of its table; empty if it is
        alone.
    facts : The same in words, for the file's head.
    speed : (n,) array [rad/s]
    stiffness, damping : (n, 2, 2) arrays [N/m], [N s/m]
    constant : They hold at any speed.
    """

    name: str
    facts: tuple[str, ...]
    speed: Array
    stiffness: Array
    damping: Array
    constant: bool = False


def curves(table: CoefficientTable) -> Iterator[Curve]:
    """Return every curve of `table` that has a converged point.

    Raises TableError: No point of the table converged.
    """
    values = {name: table.dataset[name].values for name in table.choices}
    title = str(table.dataset.attrs.get("title", ""))
    found = False
    for index in np.ndindex(table.converged.shape[:-1]):
        usable = table.converged[index]
        if not usable.any():
            continue
        found = True
        chosen = {n: column[i] for (n, column), i in zip(values.items(), index, strict=True)}
        left_out = table.speeds[~usable] * RPM
        facts = [title] if title else []
        facts += [_words(name, value) for name, value in chosen.items() if _known(value)]
        if table.constant:
            facts.append("Constant: the same at any speed")
        if left_out.size:
            facts.append(
                "Left out, not converged, rpm: " + ", ".join(f"{rpm:.6g}" for rpm in left_out)
            )
        yield Curve(
            name="_".join(_short(n, v) for n, v in chosen.items() if len(values[n]) > 1),
            facts=tuple(facts),
            speed=table.speeds[usable],
            stiffness=table.stiffness[index][usable],
            damping=table.damping[index][usable],
            constant=table.constant,
        )
    if not found:
        raise TableError("no point of the table converged: nothing to write", key="status")


def _known(value: Any) -> bool:
    return isinstance(value, str) or bool(np.isfinite(value))


def _words(name: str, value: Any) -> str:
    if name == "radial_clearance":
        return f"radial clearance {float(value) * 1e6:.6g} µm"
    shown = value if isinstance(value, str) else f"{float(value):.6g}"
    return f"{name.replace('_', ' ')} {shown}"


def _short(name: str, value: Any) -> str:
    if name == "radial_clearance":
        return f"{float(value) * 1e6:.6g}um"
    shown = str(value) if isinstance(value, str) else f"{name}{float(value):.6g}"
    return re.sub(r"[^A-Za-z0-9.]+", "-", shown)
