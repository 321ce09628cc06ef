"""Critical mass and whirl frequency of a rigid rotor in closed form, and with stored oil."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, Booleans, ComplexArray
from ..errors import InputError
from ..status import Stability

_ROUNDING = 1e-10
"""Of the norms of K and C: a smaller coefficient of s is what films' rounding errors leave."""


@dataclass(frozen=True)
class WhirlThreshold:
    """Verdict on a rigid rotor at one operating point.

    critical_mass : Mass per bearing at the threshold [kg]; None without a threshold.
    whirl_frequency : Frequency of the undamped whirl at the threshold [rad/s].
    whirl_frequency_ratio : Whirl frequency over shaft frequency [-].
    critical_mass_dimensionless : M c omega^2/W; needs the load and the clearance.
    """

    stability: Stability
    critical_mass: float | None = None
    whirl_frequency: float | None = None
    whirl_frequency_ratio: float | None = None
    critical_mass_dimensionless: float | None = None


@dataclass(frozen=True)
class _WhirlThresholds:
    """`WhirlThreshold` for a whole array of operating points; NaN where there is no threshold.

    `stability` holds the values of `Stability`, and an empty string where a coefficient is NaN.
    """

    stability: NDArray[np.str_]
    critical_mass: Array
    whirl_frequency: Array
    whirl_frequency_ratio: Array
    critical_mass_dimensionless: Array


@dataclass(frozen=True)
class _RouthCoefficients:
    """Conditions of Routh and Hurwitz on m s^2 + C s + K, for any mass.

    Stable if and only if `trace_damping`, `cross` and `det_stiffness` are all above zero and
    ``det_damping * equivalent_stiffness > mass * det_shifted``.

    cross : K_xx C_yy + K_yy C_xx - K_xy C_yx - K_yx C_xy, the coefficient of s; 0 where it is of
        the size of rounding errors (a film without direct stiffness: full Sommerfeld's).
    equivalent_stiffness : K_e = cross/trace_damping [N/m] (Dal Eq. 23).
    det_shifted : det(K - K_e I) [N^2/m^2], gamma^2 times det C (Dal Eq. 24).
    """

    trace_damping: Array
    det_damping: Array
    det_stiffness: Array
    cross: Array
    equivalent_stiffness: Array
    det_shifted: Array

    @property
    def may_be_stable(self) -> Booleans:
        """Return whether the conditions without the mass hold."""
        return (self.trace_damping > 0.0) & (self.cross > 0.0) & (self.det_stiffness > 0.0)

    def stable(self, mass: ArrayLike) -> Booleans:
        """Return whether every eigenvalue has a negative real part at `mass` [kg] (broadcast)."""
        slack = self.det_damping * self.equivalent_stiffness - np.asarray(mass) * self.det_shifted
        return self.may_be_stable & (slack > 0.0)


def routh_coefficients(stiffness: ArrayLike, damping: ArrayLike) -> _RouthCoefficients:
    """Return the Routh-Hurwitz quantities of (..., 2, 2) stiffness [N/m] and damping [N s/m]."""
    k = np.asarray(stiffness, dtype=float)
    c = np.asarray(damping, dtype=float)
    for name, value in (("stiffness", k), ("damping", c)):
        if value.shape[-2:] != (2, 2):
            raise InputError("must have shape (..., 2, 2)", key=name, value=value.shape)
    kxx, kxy, kyx, kyy = k[..., 0, 0], k[..., 0, 1], k[..., 1, 0], k[..., 1, 1]
    cxx, cxy, cyx, cyy = c[..., 0, 0], c[..., 0, 1], c[..., 1, 0], c[..., 1, 1]
    trace = cxx + cyy
    cross = kxx * cyy + kyy * cxx - kxy * cyx - kyx * cxy
    size = np.linalg.norm(k, axis=(-2, -1)) * np.linalg.norm(c, axis=(-2, -1))
    cross = np.where(np.abs(cross) <= _ROUNDING * size, 0.0, cross)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        equivalent = cross / trace
        # The difference kxx - K_e without its cancellation: the diagonal parts are the same number.
        shift_x = (cxx * (kxx - kyy) + kxy * cyx + kyx * cxy) / trace
        shift_y = (cyy * (kyy - kxx) + kxy * cyx + kyx * cxy) / trace
        shifted = shift_x * shift_y - kxy * kyx
    return _RouthCoefficients(
        trace_damping=trace,
        det_damping=cxx * cyy - cxy * cyx,
        det_stiffness=kxx * kyy - kxy * kyx,
        cross=cross,
        equivalent_stiffness=equivalent,
        det_shifted=shifted,
    )


def _verdicts(routh: _RouthCoefficients) -> NDArray[np.str_]:
    """Return `Stability` of every point; with K_e > 0 two determinants' signs decide."""
    det_c, shifted = np.broadcast_arrays(routh.det_damping, routh.det_shifted)
    possible = routh.may_be_stable
    verdict = np.full(np.shape(possible), str(Stability.ALWAYS_UNSTABLE), dtype="U18")
    verdict[possible & (det_c > 0.0) & (shifted <= 0.0)] = Stability.ALWAYS_STABLE
    verdict[possible & (det_c > 0.0) & (shifted > 0.0)] = Stability.THRESHOLD
    verdict[possible & (det_c == 0.0) & (shifted < 0.0)] = Stability.ALWAYS_STABLE
    verdict[possible & (det_c < 0.0) & (shifted < 0.0)] = Stability.REVERSED_THRESHOLD
    unknown = np.isnan(routh.trace_damping + routh.det_damping + routh.det_stiffness + routh.cross)
    verdict[unknown] = ""
    return verdict


def rigid_thresholds(
    stiffness: ArrayLike,
    damping: ArrayLike,
    speed: ArrayLike,
    *,
    load: ArrayLike | None = None,
    radial_clearance: ArrayLike | None = None,
) -> _WhirlThresholds:
    """Return the critical mass and whirl frequency of a rigid rotor over whole arrays.

    stiffness, damping : (..., 2, 2) arrays [N/m], [N s/m]
    speed : Shaft speed [rad/s], broadcast against the leading dimensions.
    load, radial_clearance : [N], [m]; for the dimensionless critical mass.

    m x'' + C x' + K x = 0 has the characteristic polynomial

        m^2 s^4 + m tr(C) s^3 + (m tr(K) + det C) s^2 + q s + det K,
        q = K_xx C_yy + K_yy C_xx - K_xy C_yx - K_yx C_xy.

    A pair of roots lies at +-i nu where m nu^2 = K_e = q/tr(C) and nu^2 = det(K - K_e I)/det C,
    hence M_cr = K_e det C/det(K - K_e I) (Dal Eq. 22-24). Routh and Hurwitz want tr C, q and det K
    above zero and det C K_e > m det(K - K_e I). So where one of the three is not above zero no mass
    is stable (a marginal case counts as unstable: it does not decay); otherwise

    ======== =============== ==================
    det C    det(K - K_e I)  stability
    ======== =============== ==================
    > 0      > 0             threshold
    >= 0     <= 0            always_stable
    <= 0     >= 0            always_unstable
    < 0      < 0             reversed_threshold
    ======== =============== ==================

    with both zero counting as unstable.
    """
    routh = routh_coefficients(stiffness, damping)
    omega = np.asarray(speed, dtype=float)
    verdict = _verdicts(routh)
    exists = (verdict == Stability.THRESHOLD) | (verdict == Stability.REVERSED_THRESHOLD)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        gamma2 = np.where(exists, routh.det_shifted / routh.det_damping, np.nan)
        mass = np.where(exists, routh.equivalent_stiffness / gamma2, np.nan)
        whirl = np.sqrt(gamma2)
        ratio = whirl / omega
        scale = (
            np.nan
            if load is None or radial_clearance is None
            else np.asarray(radial_clearance) * omega**2 / np.asarray(load)
        )
        dimensionless = mass * scale
    shape = np.broadcast_shapes(np.shape(mass), np.shape(ratio), np.shape(dimensionless))
    return _WhirlThresholds(
        stability=np.broadcast_to(verdict, shape),
        critical_mass=np.broadcast_to(mass, shape),
        whirl_frequency=np.broadcast_to(whirl, shape),
        whirl_frequency_ratio=np.broadcast_to(ratio, shape),
        critical_mass_dimensionless=np.broadcast_to(dimensionless, shape),
    )


def rigid_threshold(
    stiffness: ArrayLike,
    damping: ArrayLike,
    speed: float,
    *,
    load: float | None = None,
    radial_clearance: float | None = None,
) -> WhirlThreshold:
    """Return the critical mass and whirl frequency of a rigid rotor at one operating point.

    stiffness, damping : (2, 2) arrays [N/m], [N s/m]
    speed : [rad/s]
    load, radial_clearance : [N], [m]; for the dimensionless critical mass.
    Raises InputError: A coefficient is not finite, or the speed is not above zero.

    Examples
    --------
    A plain film carries no load and whirls at half the speed: K_xy = -K_yx = C omega/2.

    >>> import numpy as np
    >>> threshold = rigid_threshold([[1.0, 5.0], [-5.0, 1.0]], np.eye(2), speed=10.0)
    >>> str(threshold.stability), threshold.critical_mass, threshold.whirl_frequency_ratio
    ('threshold', 0.04, 0.5)
    """
    for name, value in (("stiffness", stiffness), ("damping", damping)):
        if np.shape(value) != (2, 2) or not np.all(np.isfinite(value)):
            raise InputError("must be a 2 x 2 matrix of finite numbers", key=name, value=value)
    if not (np.isfinite(speed) and speed > 0.0):
        raise InputError("must be above 0 (rad/s)", key="speed", value=speed)
    found = rigid_thresholds(
        stiffness, damping, speed, load=load, radial_clearance=radial_clearance
    )

    def number(value: Array) -> float | None:
        return float(value) if np.isfinite(value) else None

    return WhirlThreshold(
        stability=Stability(str(found.stability)),
        critical_mass=number(found.critical_mass),
        whirl_frequency=number(found.whirl_frequency),
        whirl_frequency_ratio=number(found.whirl_frequency_ratio),
        critical_mass_dimensionless=number(found.critical_mass_dimensionless),
    )


_RATIOS = np.linspace(0.0, 2.5, 51)
"""Whirl over shaft frequencies at which the film is solved; from the last on K and C are kept."""
_FINE = np.linspace(0.0, _RATIOS[-1], 5001)[1:]
_TOLERANCE = 1e-9


@dataclass(frozen=True)
class FrequencyScan:
    """A(i nu) of a bearing's journal over the whirl frequency, (2, 2).

    law : A(s) [N/m] at any s [1/s].
    speed : Of the shaft [rad/s].
    curve : A(i nu) at arrays of nu over the shaft's frequency, interpolated.
    """

    law: Callable[[complex], ComplexArray]
    speed: float
    curve: Callable[[Array], ComplexArray]

    @classmethod
    def of(cls, law: Callable[[complex], ComplexArray], speed: float) -> FrequencyScan:
        """Solve the film at the frequencies of the scan."""
        values = np.array([law(1j * ratio * speed) for ratio in _RATIOS])
        from scipy.interpolate import CubicSpline

        return cls(law, speed, CubicSpline(_RATIOS, values))

    def threshold(self) -> tuple[Stability, float | None]:
        """Return the verdict, and the whirl frequency ratio at the threshold if there is one."""
        crossings = self._crossings()
        masses = np.array([mass for mass, _ in crossings])
        if not masses.size:
            size = np.abs(np.linalg.det(self.curve(_FINE[:1])[0])) ** 0.5 / self.speed**2
            stable = self.unstable_eigenvalues(float(size)) == 0
            return (Stability.ALWAYS_STABLE if stable else Stability.ALWAYS_UNSTABLE), None
        between = np.sqrt(masses[1:] * masses[:-1])
        counts = [
            self.unstable_eigenvalues(float(mass))
            for mass in (0.5 * masses[0], *between, 2.0 * masses[-1])
        ]
        if counts[0] == 0:
            for (_, ratio), count in zip(crossings, counts[1:], strict=True):
                if count > 0:
                    return Stability.THRESHOLD, self._refined(ratio)
            return Stability.ALWAYS_STABLE, None
        if counts[-1] == 0:
            return Stability.REVERSED_THRESHOLD, self._refined(crossings[-1][1])
        return Stability.ALWAYS_UNSTABLE, None

    def unstable_eigenvalues(self, mass: float) -> int:
        """Count the eigenvalues with a positive real part of a rotor of `mass` per bearing [kg]."""
        last = self.curve(_RATIOS[-1:])[0]
        stiffness, damping = last.real, last.imag / (_RATIOS[-1] * self.speed)
        fastest = max(
            np.abs(damping).max() / mass, np.sqrt(np.abs(stiffness).max() / mass), self.speed
        )
        beyond = np.geomspace(_RATIOS[-1], 1e4 * fastest / self.speed, 4001)[1:]
        outer = stiffness + 1j * self.speed * beyond[:, None, None] * damping
        frequency = self.speed * np.concatenate([_FINE, beyond])
        film = np.concatenate([self.curve(_FINE), outer])
        film = film - mass * frequency[:, None, None] ** 2 * np.eye(2)
        film = np.concatenate([self.curve(_RATIOS[:1]), film])
        phase = np.unwrap(np.angle(np.linalg.det(film)))
        return round((2.0 * np.pi - (phase[-1] - phase[0])) / np.pi)

    def _crossings(self) -> list[tuple[float, float]]:
        """Return masses at which an eigenvalue is i nu, ascending, and nu over the speed."""
        values = _misfit(self.curve(_FINE), self.speed * _FINE)
        found = []
        for i in np.flatnonzero(values[1:] * values[:-1] < 0.0):
            share = values[i] / (values[i] - values[i + 1])
            ratio = float(_FINE[i] + share * (_FINE[i + 1] - _FINE[i]))
            loads = np.linalg.eigvals(self.curve(np.array([ratio]))[0])
            real = loads[np.argmin(np.abs(loads.imag))]
            # A change of sign without a crossing: K_e passes through infinity.
            if real.real > 0.0 and abs(real.imag) < 1e-2 * real.real:
                found.append((float(real.real) / (ratio * self.speed) ** 2, ratio))
        return sorted(found)

    def _refined(self, ratio: float) -> float:
        """Return threshold's ratio without the interpolation."""

        def off(value: float) -> float:
            return float(_misfit(self.law(1j * value * self.speed), value * self.speed))

        low, high = ratio - 0.01, ratio + 0.01
        if low <= 0.0 or off(low) * off(high) > 0.0:
            return ratio
        from scipy.optimize import brentq

        return float(brentq(off, low, high, xtol=_TOLERANCE))  # type: ignore[arg-type]


def _misfit(film: ComplexArray, frequency: Array | float) -> Array:
    nu = np.asarray(frequency)
    return threshold_misfit(film.real, film.imag / nu[..., None, None], nu)


def threshold_misfit(stiffness: Array, damping: Array, frequency: Array) -> Array:
    """Return det(K - K_e I) - nu^2 det C, relative to its size: zero at a threshold.

    Zero as well without stiffness and damping across: there is nothing to lose its balance.
    """
    routh = routh_coefficients(stiffness, damping)
    squeezed = frequency**2 * routh.det_damping
    size = np.abs(routh.det_stiffness) + np.abs(squeezed)
    off = np.where(size > 0.0, routh.det_shifted - squeezed, 0.0)
    return off / np.where(size > 0.0, size, 1.0)
