"""Integrals across the film with viscosity varying from layer to layer (Dal Eq. 3, 8, 12).

In each of the k layers the viscosity is constant, so every integral below is exact. With
I_0(z) = int_0^z dz'/mu and I_1(z) = int_0^z z' dz'/mu over the unit film,

- F_0 = I_0(1), G = F_1/F_0 = I_1(1)/I_0(1);
- a pressure gradient p' drives h^3 p' a_k through layer k, a_k = int_k (I_1 - G I_0) dz, and their
  sum is -F_2, F_2 = int z (z - G)/mu dz;
- the moving journal drags U h b_k through layer k, b_k = int_k I_0 dz/F_0, whose sum is 1 - G.

Dowson's equation is thus the sum over the layers of the very fluxes that carry the heat.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .kernels import kernel


@dataclass(frozen=True)
class LayerIntegrals:
    """Cross-film integrals of every column of cells.

    f0, f2, g : (n, m) arrays. F_0 [1/(Pa s)], F_2 [1/(Pa s)] in the direction of motion, G =
        F_1/F_0 [-].
    f2_axial : (n, m) array. F_2 along the axis; the same in laminar flow.
    pressure_share, shear_share : (n, m, k) arrays. a_k [1/(Pa s)] and b_k [-]; empty (k = 0) for an
        isoviscous film.
    viscosity : (n, m, k) array. Laminar [Pa s]; k = 1 for an isoviscous film.
    rates : (3, n, m) array or None. d ln/d ln h of f2, f2_axial and 1 - g, where the flow law makes
        them depend on the film thickness.
    turbulent : What a turbulent film needs besides.
    """

    f0: Array
    f2: Array
    f2_axial: Array
    g: Array
    pressure_share: Array
    shear_share: Array
    viscosity: Array
    rates: Array | None = None
    turbulent: TurbulentIntegrals | None = None


@dataclass(frozen=True)
class TurbulentIntegrals:
    """Besides `LayerIntegrals`, where any column is not laminar.

    laminar : Of the same viscosity.
    weight : (n, m) array. Of turbulent against laminar fluidity, 0 to 1.
    g_tangent : (n, m) array. F_1/F_0 of the viscosity that a pressure gradient along the motion
        meets.
    axial_share : (n, m, k) array. a_k along the axis [1/(Pa s)].
    heat_share : (4, n, m, k) array. Integrals over each layer that share out the dissipation; see
        `film.energy.dissipation`.
    conduction : (n, m, k + 1) array. By how much eddies multiply the conduction between
        neighbouring layers, walls included.
    """

    laminar: LayerIntegrals
    weight: Array
    g_tangent: Array
    axial_share: Array
    heat_share: Array
    conduction: Array


def isoviscous_layers(shape: tuple[int, int], viscosity: float) -> LayerIntegrals:
    """Return the F_0 = 1/mu, G = 1/2, F_2 = 1/(12 mu): Reynolds' equation."""
    empty = np.empty((*shape, 0))
    f2 = np.full(shape, 1.0 / (12.0 * viscosity))
    return LayerIntegrals(
        f0=np.full(shape, 1.0 / viscosity),
        f2=f2,
        f2_axial=f2,
        g=np.full(shape, 0.5),
        pressure_share=empty,
        shear_share=empty,
        viscosity=np.full((*shape, 1), viscosity),
    )


def layer_integrals(viscosity: Array) -> LayerIntegrals:
    """Integrate across the film for a viscosity field (n, m, k) [Pa s] on equal layers."""
    n, m, k = viscosity.shape
    f0, f2, g = np.empty((n, m)), np.empty((n, m)), np.empty((n, m))
    pressure_share, shear_share = np.empty((n, m, k)), np.empty((n, m, k))
    _integrate(viscosity, f0, f2, g, pressure_share, shear_share)
    return LayerIntegrals(f0, f2, f2, g, pressure_share, shear_share, viscosity)


@kernel
def _integrate(viscosity, f0, f2, g, pressure_share, shear_share):
    n, m, layers = viscosity.shape
    dz = 1.0 / layers
    for i in range(n):
        for j in range(m):
            i0 = 0.0
            i1 = 0.0
            for k in range(layers):
                fluidity = 1.0 / viscosity[i, j, k]
                z = k * dz
                # int over the layer of I_0, and of I_1, each exact
                shear_share[i, j, k] = dz * (i0 + 0.5 * dz * fluidity)
                pressure_share[i, j, k] = dz * (i1 + fluidity * dz * (0.5 * z + dz / 6.0))
                i0 += dz * fluidity
                i1 += dz * fluidity * (z + 0.5 * dz)
            ratio = i1 / i0
            total = 0.0
            for k in range(layers):
                pressure_share[i, j, k] -= ratio * shear_share[i, j, k]
                total += pressure_share[i, j, k]
                shear_share[i, j, k] /= i0
            f0[i, j] = i0
            g[i, j] = ratio
            f2[i, j] = -total
