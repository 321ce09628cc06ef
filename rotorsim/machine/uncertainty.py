"""Tolerances on the inputs carried through to thresholds: what a drawing's tolerance means."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import InputError, RotorsimError, interruption

_Mapper = Callable[[Callable[[Any], Any], Iterable[Any]], Iterable[Any]]


class SampleError(RotorsimError):
    """The function has no result for a sample; the message says why."""


@dataclass(frozen=True)
class Tolerance:
    """Distribution of one input.

    spread : Half width of a uniform distribution, standard deviation of a normal one; above 0.
    kind : {"uniform", "normal"}. A normal distribution is cut off at four standard deviations.
    """

    nominal: float
    spread: float
    kind: Literal["uniform", "normal"] = "uniform"

    def __post_init__(self) -> None:
        if not math.isfinite(self.nominal):
            raise InputError("must be finite", key="nominal", value=self.nominal)
        if not (math.isfinite(self.spread) and self.spread > 0.0):
            raise InputError("must be above 0", key="spread", value=self.spread)
        if self.kind not in ("uniform", "normal"):
            raise InputError("must be uniform or normal", key="kind", value=self.kind)

    def from_unit(self, unit: ArrayLike) -> Array:
        """Return the values at cumulative probabilities `unit`, 0 to 1."""
        u = np.asarray(unit, dtype=float)
        if self.kind == "uniform":
            return self.nominal + self.spread * (2.0 * u - 1.0)
        from scipy.special import ndtr, ndtri

        tail = ndtr(-4.0)
        return self.nominal + self.spread * np.asarray(ndtri(tail + u * (1.0 - 2.0 * tail)))


@dataclass(frozen=True, eq=False)
class Propagation:
    """Samples of inputs and what they lead to.

    inputs, outputs : mapping of str to (n,) array. NaN in an output: not defined for that sample
        (no threshold, say), or failed.
    failures : tuple of (int, str). Samples whose evaluation raised, and why.
    """

    inputs: Mapping[str, Array]
    outputs: Mapping[str, Array]
    failures: tuple[tuple[int, str], ...] = ()

    def quantile(self, output: str, probability: ArrayLike = (0.05, 0.5, 0.95)) -> Array:
        """Return the quantiles of an output over the samples where it is defined."""
        values = self._output(output)
        values = values[np.isfinite(values)]
        if not values.size:
            return np.full(np.shape(probability), np.nan)
        return np.asarray(np.quantile(values, np.asarray(probability, dtype=float)))

    def probability_above(self, output: str, limit: float) -> tuple[float, float]:
        """Return the probability that an output is above `limit`, and its standard error.

        Samples where it is not defined count as not above, failed ones not at all: of
        ``growth_rate`` above 0 it is the probability of instability.
        """
        true = self._output(output) > limit
        keep = np.ones(true.size, dtype=bool)
        keep[[i for i, _ in self.failures]] = False
        n = int(keep.sum())
        if n == 0:
            return math.nan, math.nan
        p = float(np.mean(true[keep]))
        # Wilson's centre keeps the error above zero where no sample, or every one, is true.
        centre = (p * n + 2.0) / (n + 4.0)
        return p, math.sqrt(centre * (1.0 - centre) / (n + 4.0))

    def importance(self, output: str) -> dict[str, float]:
        """Return Spearman's rank correlation of each input with an output, strongest first."""
        from scipy.stats import rankdata

        values = self._output(output)
        good = np.isfinite(values)
        result = dict.fromkeys(self.inputs, 0.0)
        if good.sum() < 3 or np.ptp(values[good]) == 0.0:
            return result
        rank = rankdata(values[good])
        for name, column in self.inputs.items():
            result[name] = float(np.corrcoef(rankdata(column[good]), rank)[0, 1])
        return dict(sorted(result.items(), key=lambda item: -abs(item[1])))

    def first_order_index(self, output: str) -> dict[str, float]:
        """Return the share of an output's variance that each input explains alone, largest first.

        Estimates of first-order Sobol' indices Var(E[Y|X_i])/Var(Y). They add up to
        `explained_variance` about, not to 1: what is left are interactions of inputs and bends
        that a quadratic does not follow.

        Least squares on a sum of one quadratic for each input (straight lines where there are fewer
        than three samples for each coefficient): a few coefficients are known well from some
        dozens of samples. What the scatter feigns is subtracted from each share. NaN with fewer
        samples than coefficients.
        """
        return self._additive_fit(output)[0]

    def explained_variance(self, output: str) -> float:
        """Return adjusted R^2 of the fit behind `first_order_index`; NaN where there is none."""
        return self._additive_fit(output)[1]

    def _additive_fit(self, output: str) -> tuple[dict[str, float], float]:
        """Return the first-order shares, largest first, and the adjusted R^2."""
        values = self._output(output)
        good = np.isfinite(values)
        y = values[good] - values[good].mean() if good.any() else values[good]
        size = y.size
        if size < 3 or np.ptp(y) == 0.0:
            return dict.fromkeys(self.inputs, 0.0 if size >= 3 else math.nan), math.nan
        powers = 2 if size >= 3 * (2 * len(self.inputs) + 1) else 1
        columns = {name: _features(column[good], powers) for name, column in self.inputs.items()}
        x = np.hstack(list(columns.values()))
        free = size - x.shape[1] - 1
        if free < 1:
            return dict.fromkeys(self.inputs, math.nan), math.nan
        inverse = np.linalg.pinv(x.T @ x)
        coefficients = inverse @ (x.T @ y)
        scatter = float(np.sum((y - x @ coefficients) ** 2)) / free
        variance = float(np.sum(y**2)) / (size - 1)
        shares = {}
        for number, (name, part) in enumerate(columns.items()):
            place = slice(number * powers, (number + 1) * powers)
            explained = float(np.sum((part @ coefficients[place]) ** 2))
            feigned = scatter * float(np.trace(inverse[place, place] @ (part.T @ part)))
            shares[name] = max(0.0, (explained - feigned) / (size - 1) / variance)
        ordered = dict(sorted(shares.items(), key=lambda item: -item[1]))
        return ordered, max(0.0, 1.0 - scatter / variance)

    def _output(self, name: str) -> Array:
        if name not in self.outputs:
            known = ", ".join(self.outputs) or "none"
            raise InputError(f"no such output; there are {known}", key="output", value=name)
        return self.outputs[name]


def _features(column: Array, powers: int) -> Array:
    """Return the powers of the standardised input, without their means, (n, powers)."""
    z = column - column.mean()
    z = z / (z.std() or 1.0)
    x = z[:, None] ** np.arange(1, powers + 1)
    return x - x.mean(axis=0)


def _sample_inputs(
    tolerances: Mapping[str, Tolerance],
    count: int,
    seed: int = 0,
) -> list[dict[str, float]]:
    """Draw `count` sets of inputs from a Sobol' sequence.

    count : Rounded up to a power of two, at which the sequence is balanced.
    seed : The same seed draws the same samples.
    """
    from scipy.stats import qmc

    if not tolerances:
        raise InputError("at least one input needs a tolerance", key="tolerances")
    if count < 2:
        raise InputError("must be 2 or more", key="count", value=count)
    sequence = qmc.Sobol(len(tolerances), rng=np.random.default_rng(seed))
    unit = sequence.random_base2(math.ceil(math.log2(count)))
    columns = {n: t.from_unit(unit[:, i]) for i, (n, t) in enumerate(tolerances.items())}
    return [{n: float(c[i]) for n, c in columns.items()} for i in range(len(unit))]


def propagate(
    function: Callable[[dict[str, float]], Mapping[str, float | None]],
    tolerances: Mapping[str, Tolerance],
    count: int = 128,
    seed: int = 0,
    mapper: _Mapper = map,
) -> Propagation:
    """Carry tolerances through `function`.

    function : Inputs by name to outputs by name, for example ``threshold_speed`` [rad/s] and
        ``critical_mass`` [kg]; None or NaN: not defined there. It must be picklable where `mapper`
        uses processes.
    count, seed : As for `_sample_inputs`.
    mapper : ``map``, or the ``map`` of any executor.
    """
    samples = _sample_inputs(tolerances, count, seed)
    results = list(mapper(_Guarded(function), samples))
    failures = tuple((i, r) for i, r in enumerate(results) if isinstance(r, str))
    good = [r for r in results if not isinstance(r, str)]
    names = list(dict.fromkeys(name for r in good for name in r))
    inputs = {n: np.array([s[n] for s in samples]) for n in tolerances}
    return Propagation(inputs, {n: _column(results, n) for n in names}, failures)


def _column(results: Sequence[Mapping[str, float | None] | str], name: str) -> Array:
    values = [None if isinstance(r, str) else r.get(name) for r in results]
    return np.array([np.nan if v is None else float(v) for v in values])


@dataclass(frozen=True)
class _Guarded:
    """The function, with one sample's failure kept to that sample."""

    function: Callable[[dict[str, float]], Mapping[str, float | None]]

    def __call__(self, sample: dict[str, float]) -> Mapping[str, float | None] | str:
        try:
            return self.function(sample)
        except SampleError as error:
            return str(error)
        except Exception as error:
            if stop := interruption(error):
                raise stop from None
            return f"{type(error).__name__}: {error}"
