"""Closed forms that tests compare with."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorsim.bearing.whirl import rigid_thresholds, routh_coefficients


def flexible_critical_mass(
    stiffness: ArrayLike, damping: ArrayLike, shaft_stiffness: ArrayLike
) -> NDArray[np.float64]:
    """Critical disc mass of a symmetric Jeffcott rotor with massless journals, per bearing [kg].

    stiffness, damping : (..., 2, 2) arrays. Of one bearing [N/m], [N s/m].
    shaft_stiffness : Of the shaft at the disc, per bearing (half the shaft's) [N/m]; infinity: a
        rigid shaft.

    At the threshold the film reacts like a spring K_e with the whirl frequency nu of the rigid
    rotor; the shaft lies in series with it, so that m nu^2 = K_e k_s/(K_e + k_s) (Lund's argument,
    J. Eng. Ind. 96, 1974). The whirl frequency ratio does not change. NaN without a threshold.
    """
    routh = routh_coefficients(stiffness, damping)
    rigid = rigid_thresholds(stiffness, damping, 1.0).critical_mass
    return np.asarray(rigid / (1.0 + routh.equivalent_stiffness / np.asarray(shaft_stiffness)))
