"""Results as text: one table of quantities with their units, short numbers, rows, HTML tables.

Terminal, report, figures, recordings and notebooks take labels, units and digits from here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import Any, NamedTuple

from .errors import InputError

RPM = 30.0 / math.pi
"""Revolutions per minute in one rad/s."""
ZERO_CELSIUS = 273.15
"""[K]"""


def number(value: float | None, digits: int = 4) -> str:
    """Return short text of a number, below a million without an exponent.

    A dash where there is none.

    Examples
    --------
    >>> number(1234.5678), number(18000.0), number(2010.0, 3), number(7.0e6), number(None)
    ('1235', '18000', '2010', '7.000e+06', '-')
    """
    if value is None or not math.isfinite(value):
        return "-"
    if abs(value) >= 1e6:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{digits}g}" if abs(value) < 10.0**digits - 0.5 else f"{value:.0f}"


_US = {
    "µm": ("mil", 1.0 / 25.4, 0.0),
    "kN": ("lbf", 1e3 / 4.4482216152605, 0.0),
    "N": ("lbf", 1.0 / 4.4482216152605, 0.0),
    "kg": ("lb", 1.0 / 0.45359237, 0.0),
    "kPa": ("psi", 1e3 / 6894.757293168, 0.0),
    "MPa": ("psi", 1e6 / 6894.757293168, 0.0),
    "°C": ("°F", 1.8, 32.0),
    "kW": ("hp", 1e3 / 745.69987158227, 0.0),
    "L/min": ("gal/min", 1.0 / 3.785411784, 0.0),
    "mm": ("in", 1.0 / 25.4, 0.0),
    "N/m": ("lbf/in", 0.0254 / 4.4482216152605, 0.0),
    "N s/m": ("lbf s/in", 0.0254 / 4.4482216152605, 0.0),
    "g mm": ("oz in", 1.0 / 28.349523125 / 25.4, 0.0),
    "MN/m": ("klbf/in", 1e3 * 0.0254 / 4.4482216152605, 0.0),
    "kN s/m": ("lbf s/in", 1e3 * 0.0254 / 4.4482216152605, 0.0),
    "kN/mm": ("klbf/in", 1e3 * 0.0254 / 4.4482216152605, 0.0),
    "N m": ("lbf in", 1.0 / 4.4482216152605 / 0.0254, 0.0),
    "kg m²": ("lb in²", 1.0 / 0.45359237 / 0.0254**2, 0.0),
    "GPa": ("Mpsi", 1e3 / 6894.757293168, 0.0),
    "K": ("°F", 1.8, 0.0),
    "m/s": ("ft/s", 1.0 / 0.3048, 0.0),
    "mPa s": ("cP", 1.0, 0.0),
    "kg/m³": ("lb/ft³", 0.3048**3 / 0.45359237, 0.0),
    "J/(kg K)": ("BTU/(lb °F)", 1.0 / 4186.8, 0.0),
    "W/(m K)": ("BTU/(h ft °F)", 0.3048 * 3600.0 / 1055.05585262 / 1.8, 0.0),
    "W/(m² K)": ("BTU/(h ft² °F)", 0.3048**2 * 3600.0 / 1055.05585262 / 1.8, 0.0),
}
"""US customary unit in place of one that is shown otherwise: its name, factor and offset."""
_shown_in = ["si"]


def show_units(system: str) -> None:
    """Show results in the units of a system from now on: ``si`` or ``us``.

    Raises InputError: No such system.
    """
    if system not in ("si", "us"):
        raise InputError("must be si or us", key="units", value=system)
    _shown_in[0] = system


def units_shown() -> str:
    """Return the system of `show_units`."""
    return _shown_in[0]


def shown_unit(unit: str) -> tuple[str, float, float]:
    """Return unit that a value in `unit` is shown in, the factor and the offset that lead to it."""
    return _US.get(unit, (unit, 1.0, 0.0)) if _shown_in[0] == "us" else (unit, 1.0, 0.0)


def axis_title(label: str, unit: str) -> str:
    """Return the title of a figure's axis in the unit that is shown: ``pressure [psi]``."""
    return f"{label} [{shown_unit(unit)[0]}]"


def in_shown_unit(value: Any, unit: str) -> Any:
    """Return values (a number or an array) in `unit`, in the unit that is shown in its place."""
    _, factor, zero = shown_unit(unit)
    return value * factor + zero


def shown(value: float | None, unit: str, digits: int = 4) -> str:
    """Return short text of a value in `unit`, in the unit shown in its place; see `heads`."""
    return number(None if value is None else in_shown_unit(value, unit), digits)


def heads(*texts: str) -> tuple[str, ...]:
    """Return heads of columns that end in a unit, with the unit that is shown in its place.

    Examples
    --------
    >>> heads("rpm", "load kN", "amplitude µm")
    ('rpm', 'load kN', 'amplitude µm')
    """
    found = []
    for text in texts:
        ends = (unit for unit in _US if text.endswith(f" {unit}"))
        unit = max(ends, key=len, default="")
        found.append(text.removesuffix(unit) + shown_unit(unit)[0] if unit else text)
    return tuple(found)


def with_unit(value: float | None, unit: str, digits: int = 4) -> str:
    """Return short text of a value in `unit`, with the unit that is shown in its place."""
    return f"{shown(value, unit, digits)} {shown_unit(unit)[0]}"


@dataclass(frozen=True)
class Quantity:
    """Name, unit and scale with which a quantity is shown.

    label, symbol : In words, and short for the head of a column.
    base : Unit where nothing else is asked for; `unit` is the one shown.
    to_base, base_zero : Factor and offset from SI to `base`.
    digits : In tables.
    owner : Whose it is, of a machine's parameter.
    """

    label: str
    symbol: str
    base: str = ""
    to_base: float = 1.0
    base_zero: float = 0.0
    digits: int = 4
    owner: str = ""

    @property
    def unit(self) -> str:
        """Unit shown, see `show_units`."""
        return shown_unit(self.base)[0]

    @property
    def factor(self) -> float:
        """Factor from SI to `unit`."""
        return self.to_base * shown_unit(self.base)[1]

    @property
    def offset(self) -> float:
        """Offset of `unit`, after the factor."""
        _, factor, zero = shown_unit(self.base)
        return self.base_zero * factor + zero

    @property
    def head(self) -> str:
        """Head of a column: symbol and unit."""
        return f"{self.owner} {self.symbol} {self.unit}".strip()

    @property
    def axis(self) -> str:
        """Title of a figure's axis."""
        return f"{self.label} [{self.unit or '-'}]"

    def shown(self, value: Any) -> Any:
        """Convert SI values (a number or an array) to the unit shown."""
        return value * self.factor + self.offset

    def text(self, value: float | None, digits: int | None = None) -> str:
        """Write an SI value in the unit shown, without the unit."""
        if value is None:
            return "-"
        shown = self.shown(value)
        if self.unit == "rpm" and math.isfinite(shown):
            return f"{shown:.0f}"
        return number(shown, digits or self.digits)

    def with_unit(self, value: float | None, digits: int | None = 4) -> str:
        """Write an SI value with the unit shown: ``100 µm``."""
        return f"{self.text(value, digits)} {self.unit}".strip()

    def said(self, value: float | None) -> str:
        """Write an SI value with its name and unit: ``c = 100 µm``."""
        name = f"{self.symbol} = " if len(self.symbol) == 1 or self.owner else ""
        return f"{self.owner} {name}{self.with_unit(value)}".strip()


QUANTITIES = {
    "speed": Quantity("shaft speed", "", "rpm", RPM),
    "radial_clearance": Quantity("radial clearance", "c", "µm", 1e6),
    "applied_load": Quantity("load per bearing", "", "kN", 1e-3),
    "supply_temperature": Quantity("supply temperature", "T_in", "°C", 1.0, -ZERO_CELSIUS),
    "mass": Quantity("rotor mass per bearing", "", "kg"),
    "eccentricity_ratio": Quantity("eccentricity ratio", "ε", digits=3),
    "attitude_angle": Quantity("attitude angle", "φ", "°", 180.0 / math.pi, digits=3),
    "load": Quantity("load", "load", "kN", 1e-3),
    "sommerfeld_number": Quantity("Sommerfeld number", "S"),
    "min_film_thickness": Quantity("minimum film thickness", "h_min", "µm", 1e6, digits=3),
    "max_pressure": Quantity("maximum pressure", "p_max", "MPa", 1e-6, digits=3),
    "max_temperature": Quantity("maximum temperature", "T_max", "°C", 1.0, -ZERO_CELSIUS, digits=3),
    "mean_temperature": Quantity("mean temperature", "T_mean", "°C", 1.0, -ZERO_CELSIUS, digits=3),
    "shaft_temperature": Quantity(
        "shaft temperature", "T_shaft", "°C", 1.0, -ZERO_CELSIUS, digits=3
    ),
    "hot_radial_clearance": Quantity("hot radial clearance", "c_hot", "µm", 1e6, digits=4),
    "hot_preload": Quantity("hot preload", "m_hot", digits=3),
    "deflection": Quantity("elastic deflection", "w_max", "µm", 1e6, digits=3),
    "outlet_temperature": Quantity(
        "oil outlet temperature", "T_out", "°C", 1.0, -ZERO_CELSIUS, digits=3
    ),
    "friction_force": Quantity("friction force", "friction", "N"),
    "power_loss": Quantity("power loss", "loss", "kW", 1e-3),
    "side_flow": Quantity("side flow", "side flow", "L/min", 6e4),
    "wall_heat_share": Quantity("heat through the walls", "to walls", "%", 100.0),
    "reynolds_number": Quantity("largest local Reynolds number", "Re", digits=3),
    "laminar_share": Quantity("laminar part of the film", "laminar", "%", 100.0, digits=3),
    "transitional_share": Quantity("part in transition", "transition", "%", 100.0, digits=3),
    "turbulent_share": Quantity("turbulent part of the film", "turbulent", "%", 100.0, digits=3),
    "heat_imbalance": Quantity("heat imbalance", "imbalance", "%", 100.0, digits=2),
    "critical_mass": Quantity("critical mass per bearing", "M_crit", "kg"),
    "critical_mass_dimensionless": Quantity("dimensionless critical mass", "M c ω²/W"),
    "whirl_frequency_ratio": Quantity("whirl frequency ratio", "whirl ratio", digits=3),
    "growth_rate": Quantity("growth rate", "growth", "1/s"),
    "threshold_speed": Quantity("threshold speed", "threshold", "rpm", RPM),
    "viscosity": Quantity("viscosity", "viscosity", "times"),
    "elevation": Quantity("elevation", "elevation", "µm", 1e6),
    "stiffness": Quantity("stiffness", "k", "MN/m", 1e-6),
    "damping": Quantity("damping", "damping", "kN s/m", 1e-3),
    "pedestal_stiffness": Quantity("pedestal's stiffness", "pedestal", "MN/m", 1e-6),
    "pedestal_damping": Quantity("pedestal's damping", "pedestal", "kN s/m", 1e-3),
    "pedestal_mass": Quantity("pedestal's mass", "pedestal", "kg"),
    "destabilising_stiffness": Quantity("destabilising stiffness", "Q", "MN/m", 1e-6),
    "internal_damping": Quantity("internal damping", "internal damping", "µs", 1e6),
    "axial_force": Quantity("axial force", "axial force", "kN", 1e-3),
    "youngs_modulus": Quantity("Young's modulus", "E", "GPa", 1e-9),
}
"""By the name of the attribute, JSON key or table variable (SI)."""


_BASES = {
    "m": ("mm", 1e3, 0.0), "rad": ("°", 180.0 / math.pi, 0.0), "Pa": ("MPa", 1e-6, 0.0),
    "Pa*s": ("mPa s", 1e3, 0.0), "K": ("°C", 1.0, -ZERO_CELSIUS), "N": ("kN", 1e-3, 0.0),
    "N/m": ("MN/m", 1e-6, 0.0), "N*s/m": ("kN s/m", 1e-3, 0.0), "m^3/s": ("L/min", 6e4, 0.0),
}  # fmt: skip
"""Quantities of entries of files without a name in `QUANTITIES`, by their SI unit."""


def quantity(name: str, unit: str = "") -> Quantity:
    """Return how a quantity is shown, by its name.

    Of a machine's parameter ``left.load``, or an entry ``bearing.pocket[0].depth``, with its owner.

    unit : SI unit, of an entry that no result is called like.

    Examples
    --------
    >>> quantity("left.radial_clearance").said(1e-4), quantity("speed").said(100.0)
    ('left c = 100 µm', '955 rpm')
    >>> quantity("bearing.pocket[0].depth", "m").said(1e-4)
    'pocket[0] depth = 100 µm'
    """
    owner, _, word = name.rpartition(".")
    if word not in QUANTITIES:
        owner, label = owner.rpartition(".")[2], word.replace("_", " ")
        base, factor, zero = _BASES.get(
            unit, (unit.replace("*", " ") if unit != "1" else "", 1.0, 0.0)
        )
        if base == "mm" and "depth" in word:
            base, factor = "µm", 1e6
        whole = f"{label}, {owner}" if owner else label
        return Quantity(whole, label, base, factor, zero, owner=owner)
    found = QUANTITIES[word]
    return replace(found, label=f"{found.label}, {owner}", owner=owner) if owner else found


class Row(NamedTuple):
    """One result for people: what, its value, its unit."""

    label: str
    value: str
    unit: str = ""

    @property
    def with_unit(self) -> str:
        """Value and unit; degrees without a space."""
        return f"{self.value}{'' if self.unit in ('', '°') else ' '}{self.unit}"


def facts_html(rows: Iterable[Row]) -> str:
    """Return the HTML table of two columns: what, and its value with the unit."""
    body = "\n".join(
        f'<tr><th scope="row">{escape(row.label)}</th><td>{escape(row.with_unit)}</td></tr>'
        for row in rows
    )
    return f'<table class="facts"><tbody>\n{body}\n</tbody></table>'


_VERDICT_CLASSES = {"stable": "good", "unstable": "bad", "converged": "good"}
"""Classes of the cells that carry a verdict; the words in them say the same without colour."""


def table_html(
    head: Sequence[str], rows: Iterable[Sequence[str]], caption: str = "", *, texts: int = 1
) -> str:
    """Return the HTML table; the first `texts` columns are texts, the others numbers."""
    columns = "".join(
        f'<th scope="col"{"" if place < texts else " class=number"}>{escape(name)}</th>'
        for place, name in enumerate(head)
    )
    body = "\n".join(f"<tr>{_cells(row, texts)}</tr>" for row in rows)
    titled = f"<caption>{escape(caption)}</caption>" if caption else ""
    top = f"<thead><tr>{columns}</tr></thead>" if any(head) else ""
    return f"<table>{titled}{top}<tbody>\n{body}\n</tbody></table>"


def _cells(row: Sequence[str], texts: int) -> str:
    cells = []
    for place, text in enumerate(row):
        kind = _VERDICT_CLASSES.get(text, "" if place < texts else "number")
        cells.append(f"<td{f' class={kind}' if kind else ''}>{escape(text)}</td>")
    return "".join(cells)


def result_html(title: str, *parts: str, notes: Iterable[str] = ()) -> str:
    """Return the fragment of HTML for notebooks: a title, tables, and notes."""
    said = "".join(f"<p>{escape(note)}</p>" for note in notes if note)
    inside = "\n".join(part for part in parts if part)
    return f"<div><strong>{escape(title)}</strong>\n{inside}\n{said}</div>"
