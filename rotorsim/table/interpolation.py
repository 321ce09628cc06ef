"""Coefficients between the tabulated speeds: a monotone cubic through the converged points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import OutOfRangeError, TableError

Array = NDArray[np.float64]

_SPEED_TOLERANCE = 1e-9
"""Relative; two speeds nearer than this are the same one written in different units."""


@dataclass(frozen=True, eq=False)
class CoefficientInterpolator:
    """Speed to (K, C), vectorised; exact at the tabulated speeds, never beyond them.

    Attributes
    ----------
    speeds : (n,) array
        Tabulated speeds [rad/s], ascending.
    converged : (n,) bool array
        Which of them may be used.
    cubic : (4, n, 9) array
        Coefficients, highest power first, of the cubic in ``speed - speeds[i]`` for the interval
        above speed i (constant for the last): kxx kxy kyx kyy cxx cxy cyx cyy load. A compiled
        integrator can evaluate these itself.

    Notes
    -----
    PCHIP (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984) overshoots nowhere, so it makes
    no stiffness or damping that its neighbours do not have. A point that did not converge cuts the
    curve: nothing is interpolated across it.
    """

    speeds: Array
    converged: NDArray[np.bool_]
    cubic: Array

    @classmethod
    def from_columns(
        cls, speeds: Array, converged: NDArray[np.bool_], columns: Array
    ) -> CoefficientInterpolator:
        """Fit (n, 9) `columns` over ascending `speeds` [rad/s]."""
        from scipy.interpolate import PchipInterpolator

        cubic = np.zeros((4, *columns.shape))
        cubic[3] = columns
        edges = np.flatnonzero(np.diff(np.concatenate([[0], converged.astype(int), [0]])))
        for start, stop in edges.reshape(-1, 2):
            if stop - start > 1:
                known = np.isfinite(columns[start:stop]).all(axis=0)
                run = columns[start:stop][:, known]
                fit = PchipInterpolator(speeds[start:stop], run, axis=0)
                cubic[:, start : stop - 1, known] = fit.c
        return cls(speeds, converged, cubic)

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest tabulated speed [rad/s]."""
        return float(self.speeds[0]), float(self.speeds[-1])

    def columns(self, speed: ArrayLike, gaps: Literal["raise", "nan"] = "raise") -> Array:
        """Evaluate the (..., 9) columns at `speed` [rad/s]; see `__call__`."""
        omega = np.asarray(speed, dtype=float)
        low, high = self.bounds
        slack_low, slack_high = low * _SPEED_TOLERANCE, high * _SPEED_TOLERANCE
        inside = (omega >= low - slack_low) & (omega <= high + slack_high)
        if not inside.all():
            raise OutOfRangeError(
                f"the table holds speeds from {low:.6g} to {high:.6g} rad/s",
                key="speed",
                value=float(omega[~inside].flat[0]) if omega.ndim else float(omega),
            )
        i = np.clip(np.searchsorted(self.speeds, omega, side="right") - 1, 0, None)
        d = (omega - self.speeds[i])[..., None]
        c = self.cubic
        result = ((c[0][i] * d + c[1][i]) * d + c[2][i]) * d + c[3][i]
        if self.converged.all():
            return result
        return self._mask_gaps(result, omega, i, gaps)

    def _mask_gaps(
        self, result: Array, omega: Array, i: NDArray[np.intp], gaps: Literal["raise", "nan"]
    ) -> Array:
        above = np.append(self.converged[1:], True)
        on_knot = np.abs(omega - self.speeds[i]) <= _SPEED_TOLERANCE * self.speeds[i]
        bad = ~(self.converged[i] & (on_knot | above[i]))
        if not bad.any():
            return result
        if gaps == "nan":
            return np.where(bad[..., None], np.nan, result)
        k = int(np.atleast_1d(i)[np.atleast_1d(bad)][0])
        around = self.speeds[k : k + 2]
        failed = [f"{s:.6g}" for s in around if not self.converged[self.speeds == s][0]]
        raise TableError(
            f"the operating point at {' and '.join(failed)} rad/s did not converge, so the table "
            "knows no coefficients next to it; solve it again or choose another speed",
            key="speed",
            value=float(np.atleast_1d(omega)[np.atleast_1d(bad)][0]),
        )

    def __call__(
        self, speed: ArrayLike, gaps: Literal["raise", "nan"] = "raise"
    ) -> tuple[Array, Array]:
        """Stiffness [N/m] and damping [N s/m] at `speed` [rad/s].

        Parameters
        ----------
        speed : array
        gaps : {"raise", "nan"}
            What to do next to points that did not converge.

        Returns
        -------
        stiffness, damping : speed.shape + (2, 2) arrays

        Raises
        ------
        OutOfRangeError
            A speed lies outside the tabulated ones.
        TableError
            A neighbour did not converge and `gaps` is "raise".
        """
        values = self.columns(speed, gaps)
        shape = (*values.shape[:-1], 2, 2)
        return values[..., :4].reshape(shape), values[..., 4:8].reshape(shape)
