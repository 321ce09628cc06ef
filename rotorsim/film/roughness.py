"""Rough walls: the flow factors of Patir & Cheng on any flow law.

Averaged over the roughness, the pressure drives phi_x and phi_y times what it drives between smooth
walls, along the motion and along the axis; the moving wall drags (1 + sigma Phi_s/h) times as much,
and its Couette shear is phi_f times as large (J. Lubr. Technol. 100, 1978, 12-17; 101, 1979,
220-229). All are functions of H = h/sigma, sigma the combined standard deviation of both walls'
heights, and of the pattern gamma: length over width of a typical asperity, along the motion. What
a pressure gradient adds to the friction follows from the flow by conservation of power.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..model import SurfaceRoughness
from .layers import LayerIntegrals

if TYPE_CHECKING:
    from .flow_law import FlowLaw


_PRESSURE = {
    1 / 9: (1.48, 0.42), 1 / 6: (1.38, 0.42), 1 / 3: (1.18, 0.42), 1.0: (0.90, 0.56),
    3.0: (0.225, 1.5), 6.0: (0.520, 1.5), 9.0: (0.870, 1.5),
}  # fmt: skip
"""C and r by gamma (1978, table 1): 1 - C exp(-r H), beyond gamma = 1: 1 + C H^-r."""
_SHEAR = {
    1 / 9: (2.046, 1.12, 0.78, 0.03, 1.856), 1 / 6: (1.962, 1.08, 0.77, 0.03, 1.754),
    1 / 3: (1.858, 1.01, 0.76, 0.03, 1.561), 1.0: (1.899, 0.98, 0.92, 0.05, 1.126),
    3.0: (1.560, 0.85, 1.13, 0.08, 0.556), 6.0: (1.290, 0.62, 1.09, 0.08, 0.388),
    9.0: (1.011, 0.54, 1.07, 0.08, 0.295),
}  # fmt: skip
"""A_1, alpha_1 to alpha_3 and A_2 by gamma (1979, table 1)."""
_CONTACT = 3.0
"""H below which asperities touch; the shear's factor stays what it is there."""


@dataclass(frozen=True)
class RoughFlow:
    """Flow factors on the integrals of a law.

    base : The law between smooth walls; it fills the shares of all layers.
    roughness : Of both walls.
    """

    base: FlowLaw
    roughness: SurfaceRoughness

    def integrals(
        self, layers: LayerIntegrals, thickness: Array, surface_speed: float
    ) -> LayerIntegrals:
        """See `FlowLaw.integrals`."""
        made = self.base.integrals(layers, thickness, surface_speed)
        assert made.turbulent is not None
        assert made.rates is not None
        gamma, sigma = self.roughness.gamma, self.roughness.combined
        ratio = np.maximum(thickness, 1e-12) / sigma
        along, along_rate = pressure_factor(ratio, gamma)
        across, across_rate = pressure_factor(ratio, 1.0 / gamma)
        drawn, drawn_rate = shear_factor(ratio, gamma)
        moving, still = ((s / sigma) ** 2 for s in (self.roughness.journal, self.roughness.bush))
        carried = (moving - still) * drawn / ratio
        dragged, dragged_rate = 1.0 + carried, carried * (drawn_rate - 1.0) / (1.0 + carried)
        stress = stress_factor(ratio)
        g = 1.0 - (1.0 - made.g) * dragged
        heat = made.turbulent.heat_share / stress[:, :, None]
        heat[2] = made.turbulent.heat_share[2] * along[:, :, None]
        heat[3] = made.turbulent.heat_share[3] * across[:, :, None]
        return replace(
            made,
            f0=made.f0 / stress,
            f2=made.f2 * along,
            f2_axial=made.f2_axial * across,
            g=g,
            pressure_share=made.pressure_share * along[:, :, None],
            shear_share=made.shear_share * dragged[:, :, None],
            rates=made.rates + np.stack([along_rate, across_rate, dragged_rate]),
            turbulent=replace(
                made.turbulent,
                g_tangent=made.turbulent.g_tangent + g - made.g,
                axial_share=made.turbulent.axial_share * across[:, :, None],
                heat_share=heat,
            ),
        )


def _row(table: dict[float, tuple[float, ...]], gamma: float) -> tuple[float, ...]:
    return table[min(table, key=lambda known: abs(math.log(known / gamma)))]


def pressure_factor(ratio: Array, gamma: float) -> tuple[Array, Array]:
    """Return phi_x and d ln(phi_x)/d ln(H)."""
    c, r = _row(_PRESSURE, gamma)
    if gamma > 1.0:
        part = c * ratio**-r
        return 1.0 + part, -r * part / (1.0 + part)
    part = c * np.exp(-r * ratio)
    factor = np.maximum(1.0 - part, 0.01)
    return factor, np.where(1.0 - part > 0.01, r * ratio * part / factor, 0.0)


def shear_factor(ratio: Array, gamma: float) -> tuple[Array, Array]:
    """Return phi_s of one wall and d ln(phi_s)/d ln(H)."""
    a, p, q, r, far = _row(_SHEAR, gamma)
    near = a * ratio**p * np.exp(-q * ratio + r * np.minimum(ratio, 5.0) ** 2)
    outside = ratio > 5.0
    factor = np.where(outside, far * np.exp(-0.25 * ratio), near)
    return factor, np.where(outside, -0.25 * ratio, p - q * ratio + 2.0 * r * ratio**2)


def stress_factor(ratio: Array) -> Array:
    """Return phi_f, the mean of 1/h over the roughness' heights times h."""
    far = ratio > 20.0  # the closed form loses its digits there; its series does not
    z = np.clip(ratio, _CONTACT * (1.0 + 1e-9), 20.0) / 3.0
    inner = (1.0 - z**2) ** 3 * np.log((z + 1.0) / (z - 1.0))
    near = 35.0 / 32.0 * z * (inner + z / 15.0 * (66.0 + z**2 * (30.0 * z**2 - 80.0)))
    square = 1.0 / ratio**2
    series = 1.0 + square * (1.0 + square * (27.0 / 11.0 + 8.4965034965 * square))
    return np.where(far, series, near)
