"""Flow laws: what a column of oil conducts and how that changes with the film thickness.

Through a face of unit width flow -h^3 F_2 dp/ds and U h (1 - G). A law gives the integrals F_0, F_2
and 1 - G of each column, and how F_2 and 1 - G change with h where they do: in laminar flow they
do not. The faces' part of the change, h^3 and h, is here as well, so that whoever linearises the
film asks this module alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from ..arrays import Array
from ..model import Case, FlowRegime
from .layers import LayerIntegrals, TurbulentIntegrals
from .roughness import RoughFlow
from .turbulence import TURBULENT_PRANDTL, integrate, layer_tables, wall_table

POISEUILLE_POWER = 3
"""d ln(flow)/d ln(h) of the Poiseuille part of Dowson's equation at given F_2."""
COUETTE_POWER = 1
"""d ln(flow)/d ln(h) of the Couette part at given G."""
CRITICAL_TAYLOR = 41.2
"""Re sqrt(c/R) at which Taylor vortices set in between concentric cylinders (Taylor 1923)."""


_NEVER = (1e300, 2e300)
"""Transition of a film that stays laminar."""


class FlowLaw(Protocol):
    """A law of flow across the film."""

    def integrals(
        self, layers: LayerIntegrals, thickness: Array, surface_speed: float
    ) -> LayerIntegrals:
        """Return the integrals of every column under this law.

        layers : Of laminar flow with the same viscosity.
        thickness : (n, m) array. At cell centres [m].
        surface_speed : [m/s]
        Returns: With `LayerIntegrals.rates` where they change with the film thickness.
        """
        ...


class LaminarFlow:
    """Integrals that do not depend on the film thickness."""

    def integrals(
        self, layers: LayerIntegrals, thickness: Array, surface_speed: float
    ) -> LayerIntegrals:
        """Return `layers`, as they are."""
        del thickness, surface_speed
        return layers


@dataclass(frozen=True)
class TurbulentFlow:
    """Eddy viscosity after Reichardt, or a bulk law with his profile (see `film.turbulence`).

    density : [kg/m3]
    transition : rho U h/mu up to which the film is laminar, and from which it is turbulent, mu =
        1/F_0 of the laminar film; (0, 0): turbulent throughout.
    diffusion : c_p/(k Pr_t) [1/(Pa s)]: eddies conduct mu eps times this as much as the oil.
    bulk : tuple of (base, factor, exponent, added). Of shear, k_x and k_y: base + factor
        Re^exponent, or where not added the larger of the two. Empty: Reichardt's own.
    """

    density: float
    transition: tuple[float, float]
    diffusion: float
    bulk: tuple[tuple[float, float, float, float], ...] = ()
    always: bool = False
    """True to fill all shares even where the film is laminar throughout."""
    _stresses: dict[tuple[int, int, int], Array] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )
    """Shear stress of the last call, by the film's shape: a first guess that saves time."""

    def integrals(
        self, layers: LayerIntegrals, thickness: Array, surface_speed: float
    ) -> LayerIntegrals:
        """See `FlowLaw.integrals`."""
        lower, upper = self.transition
        reynolds = self.density * surface_speed * thickness * layers.f0
        if surface_speed <= 0.0 or (upper > 0.0 and not reynolds.max() > lower):
            if not self.always:
                return layers
            lower, upper = _NEVER
        n, m, across = layers.viscosity.shape
        shares = layers.pressure_share.shape[2]
        stresses = self._stresses.setdefault((n, m, across), np.zeros((n, m)))
        weight, f0, f2, f2_axial, g, g_tangent = (np.empty((n, m)) for _ in range(6))
        rates = np.empty((3, n, m))
        pressure, axial, shear = (np.empty((n, m, shares)) for _ in range(3))
        heat, conduction = np.empty((4, n, m, shares)), np.empty((n, m, shares + 1))
        integrate(
            layer_tables(across), wall_table(), layers.viscosity, thickness, layers.f0,
            self.density, surface_speed, lower, upper, np.array(self.bulk or ((0.0,) * 4,) * 3),
            self.diffusion if shares else 0.0, stresses, weight, f0, f2, f2_axial, g, g_tangent,
            rates, pressure, axial, shear, heat, conduction,
        )  # fmt: skip
        turbulent = TurbulentIntegrals(layers, weight, g_tangent, axial, heat, conduction)
        return replace(
            layers, f0=f0, f2=f2, f2_axial=f2_axial, g=g, pressure_share=pressure,
            shear_share=shear, rates=rates, turbulent=turbulent,
        )  # fmt: skip


_BULK: dict[FlowRegime, tuple[tuple[float, float, float, float], ...]] = {
    FlowRegime.TURBULENT: (),
    # Ng & Pan, J. Basic Eng. 87, 1965, linearised about Couette flow.
    FlowRegime.NG_PAN: (
        (1.0, 0.0012, 0.94, 1.0), (12.0, 0.0136, 0.90, 1.0), (12.0, 0.0043, 0.96, 1.0),
    ),
    # Constantinescu, Proc. IMechE 182(3A), 1967; the shear as Ng & Pan's.
    FlowRegime.CONSTANTINESCU: (
        (1.0, 0.0012, 0.94, 1.0), (12.0, 0.026, 0.8265, 1.0), (12.0, 0.0198, 0.741, 1.0),
    ),
    # Hirs, J. Lubr. Technol. 95, 1973: f = 0.066 Re^-0.25 at each wall, about Couette flow.
    FlowRegime.HIRS: (
        (1.0, 0.00981, 0.75, 0.0), (12.0, 0.0687, 0.75, 0.0), (12.0, 0.0392, 0.75, 0.0),
    ),
}  # fmt: skip


def flow_law(case: Case) -> FlowLaw:
    """Return the law that the case's film settings name."""
    film, oil = case.film, case.lubricant
    rough = film.roughness is not None and film.roughness.combined > 0.0
    laminar = film.flow is FlowRegime.LAMINAR
    if laminar and not rough:
        return LaminarFlow()
    law = TurbulentFlow(
        oil.density,
        _NEVER if laminar else _transition_limits(case),
        oil.specific_heat / (oil.thermal_conductivity * TURBULENT_PRANDTL),
        () if laminar else _BULK[film.flow],
        always=rough,
    )
    return RoughFlow(law, film.roughness) if rough and film.roughness else law


def _transition_limits(case: Case) -> tuple[float, float]:
    """Return the local Reynolds numbers at which the transition begins and ends.

    With Taylor's criterion from 41.2 sqrt(R/c), where vortices begin, to twice that.
    """
    if case.film.transition != "taylor":
        lower, upper = case.film.transition
        return float(lower), float(upper)
    bearing = case.bearing
    onset = CRITICAL_TAYLOR * math.sqrt(bearing.journal_radius / bearing.radial_clearance)
    return onset, 2.0 * onset


__all__ = [
    "COUETTE_POWER",
    "POISEUILLE_POWER",
    "FlowLaw",
    "LaminarFlow",
    "TurbulentFlow",
    "flow_law",
]
