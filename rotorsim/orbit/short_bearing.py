"""Ocvirk's short bearing with a ruptured film, in closed form.

In the frame that turns at half the shaft's speed an isoviscous film is squeezed and nothing else:
with e the journal's eccentricity, v its velocity and

    v_s = v - (w/2) k x e

Reynolds' equation reads div(h^3 grad p)/(12 mu) = -v_s . n(theta). The short film's pressure is
positive just where v_s . n > 0, so half-Sommerfeld and Reynolds conditions are the same film.
Ocvirk (1952); Childs, Moes & van Leeuwen (1977) for the pure-squeeze form.
"""

from __future__ import annotations

import math

from ..compiled import compiled


@compiled()
def squeeze_integrals(eccentricity_ratio: float, angle: float) -> tuple[float, float]:
    """Integrals of cos(t - a) (cos t, sin t)/(1 - eps cos t)^3 over a - pi/2 to a + pi/2.

    Sommerfeld's substitution 1 - eps cos t = (1 - eps^2)/(1 + eps cos g) makes them elementary.

    Parameters
    ----------
    eccentricity_ratio : float
        Below 1.
    angle : float
        From the eccentricity to the squeeze velocity, in the direction of rotation [rad].
    """
    eps = eccentricity_ratio
    root = math.sqrt(1.0 - eps * eps)
    ca, sa = math.cos(angle), math.sin(angle)
    # limits t = a -+ pi/2: cos t = +-sin a, sin t = -+cos a
    s1, c1 = -root * ca / (1.0 - eps * sa), (sa - eps) / (1.0 - eps * sa)
    s2, c2 = root * ca / (1.0 + eps * sa), (-sa - eps) / (1.0 + eps * sa)
    g1, g2 = math.atan2(s1, c1), math.atan2(s2, c2)
    span = g2 - g1
    if span <= 0.0:
        span += 2.0 * math.pi
    ds = s2 - s1
    dsc = s2 * c2 - s1 * c1
    cc = ((eps * eps + 0.5) * span + 2.0 * eps * ds + 0.5 * dsc) / root**5
    cs = (eps * (c1 - c2) + 0.5 * (s2 * s2 - s1 * s1)) / root**4
    ss = 0.5 * (span - dsc) / root**3
    return ca * cc + sa * cs, ca * cs + sa * ss


@compiled()
def short_bearing_impedance(
    eccentricity_ratio: float, angle: float, slenderness: float
) -> tuple[float, float]:
    """Dimensionless film force on the journal, radial and tangential.

    Parameters
    ----------
    eccentricity_ratio : float
    angle : float
        From the eccentricity to the squeeze velocity [rad].
    slenderness : float
        L/D [-].

    Returns
    -------
    radial, tangential : float
        In units of 2 mu |v_s| L (R/c)^3, along the eccentricity and 90 degrees ahead of it.
    """
    radial, tangential = squeeze_integrals(eccentricity_ratio, angle)
    factor = -2.0 * slenderness * slenderness
    return factor * radial, factor * tangential
