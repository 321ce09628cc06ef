"""What tolerances on a drawing mean: the film solved for many samples of its inputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..machine.machine import Machine
from ..machine.modes import modes
from ..machine.support import ConstantSupport, MatrixTable, Support, TableSupport
from ..machine.thresholds import ThresholdSpeed, threshold_speeds
from ..machine.uncertainty import Propagation, SampleError, Tolerance, propagate
from ..model import Case, LoadTarget, MeshSize
from ..rotor import Rotor
from ..rows import RPM
from .planes import changed, with_mesh
from .sweep import model_digest, refuse_other_sources

if TYPE_CHECKING:
    from ..bearing.operating_point import OperatingPoint
    from ..files.scenario import Scenario
    from ..model.tolerances import ToleranceSettings

Array = NDArray[np.float64]

_INPUTS = {
    "radial_clearance": "radial_clearance",
    "viscosity": "viscosity",
    "load": "applied_load",
    "supply_temperature": "supply_temperature",
}
"""Names in a scenario's ``[tolerances]``, and of the change that each makes to a case."""

_SPEEDS = 6
_REFINEMENTS = 2
_BATCH = 4


@dataclass(frozen=True)
class _FilmThreshold:
    """From sampled inputs to thresholds, by solving the film: the function that is propagated.

    operating_speed : [rad/s]
    speeds : Between which the threshold is looked for, ascending [rad/s].
    """

    case: Case
    rotor: Rotor
    operating_speed: float
    speeds: tuple[float, ...]

    def __call__(self, sample: Mapping[str, float]) -> dict[str, float | None]:
        """Thresholds of one sample.

        sample : ``radial_clearance`` [m], ``viscosity`` (a factor), ``load`` [N],
            ``supply_temperature`` [K].
        Returns: ``growth_rate`` at the operating speed [1/s], above 0 where unstable;
            ``critical_mass`` of a rigid rotor there [kg] and its ``whirl_frequency_ratio``, None
            without a threshold; ``threshold_speed`` [rad/s], the lowest at which the rotor loses
            its stability, None where none lies within the speeds; ``stable_throughout`` and
            ``unstable_throughout``, 1 or 0.
        Raises SampleError: The film did not converge.
        """
        case = changed(self.case, {_INPUTS[name]: value for name, value in sample.items()})
        points = self._along(case, sorted({*self.speeds, self.operating_speed}))
        at = points[self.operating_speed]
        crossings = self._thresholds(points)
        for _ in range(_REFINEMENTS):
            # The film is solved where the threshold was found, which makes it exact there.
            lost = next((c.speed for c in crossings if c.becomes_unstable), None)
            if lost is None or min(abs(lost / s - 1.0) for s in points) < 1e-4:
                break
            points |= self._along(case, [lost])
            crossings = self._thresholds(points)
        rates = [self._growth(point) for point in points.values()]
        found = [c.speed for c in crossings if c.becomes_unstable]
        return {
            "growth_rate": self._growth(at),
            "critical_mass": at.critical_mass,
            "whirl_frequency_ratio": at.whirl_frequency_ratio,
            "threshold_speed": found[0] if found else None,
            "stable_throughout": float(max(rates) < 0.0),
            "unstable_throughout": float(min(rates) >= 0.0),
        }

    def _along(self, case: Case, speeds: Sequence[float]) -> dict[float, OperatingPoint]:
        """Points at ascending speeds, each starting from the one before."""
        from ..bearing.solve import solve_case

        points, warm = {}, None
        for speed in speeds:
            point, warm = solve_case(case, speed, initial=warm)
            if not point.converged:
                why = f": {point.message}" if point.message else ""
                raise SampleError(
                    f"the film at {speed * RPM:.0f} rpm did not converge "
                    f"({point.status.value.replace('_', ' ')}{why})"
                )
            points[speed] = point
        return points

    def _growth(self, point: OperatingPoint) -> float:
        """Largest real part of the eigenvalues [1/s]."""
        film = _support({point.speed: point})
        found = modes(Machine.on_identical(self.rotor, film), point.speed)
        return float(found.largest_growth_rate[0])

    def _thresholds(self, points: Mapping[float, OperatingPoint]) -> list[ThresholdSpeed]:
        machine = Machine.on_identical(self.rotor, _support(points))
        return threshold_speeds(machine, subdivisions=1)


def _support(points: Mapping[float, OperatingPoint]) -> Support:
    """Film of one or more speeds, with its pads."""
    from ..bearing.interpolation import CoefficientInterpolator

    ordered = [points[speed] for speed in sorted(points)]
    if ordered[0].pads:
        return MatrixTable.of_points(ordered, [0.0] * len(ordered))
    if len(ordered) == 1:
        return ConstantSupport(ordered[0].stiffness, ordered[0].damping)
    columns = np.array([[*p.stiffness.ravel(), *p.damping.ravel(), p.load] for p in ordered])
    speeds = np.array(sorted(points))
    good = np.ones(speeds.size, dtype=bool)
    return TableSupport(CoefficientInterpolator.from_columns(speeds, good, columns))


@dataclass(frozen=True, eq=False)
class ToleranceStudy:
    """Distribution of thresholds under tolerances (SI).

    radial_clearance : Nominal [m].
    operating_speed : [rad/s]
    nominal : Outputs (see `_FilmThreshold`) without any deviation.
    probability_of_instability, standard_error : At the operating speed.
    importance : Rank correlation of each input with the growth rate at the operating speed,
        strongest first.
    share_of_variance : First-order Sobol' index for the same output, by regression (see
        `rotorsim.machine.Propagation.first_order_index`); they need not add up to 1.
    explained_variance : Adjusted R^2 of that regression.
    """

    thermal_model: str
    radial_clearance: float
    rotor: Rotor
    operating_speed: float
    tolerances: Mapping[str, Tolerance]
    nominal: Mapping[str, float | None]
    samples: Propagation
    probability_of_instability: float
    standard_error: float
    importance: Mapping[str, float]
    share_of_variance: Mapping[str, float]
    explained_variance: float

    @property
    def most_important(self) -> str:
        """Input that matters most for the stability at the operating speed."""
        return next(iter(self.importance))


def study_tolerances(
    scenario: Scenario,
    settings: ToleranceSettings | None = None,
    *,
    rotor: Rotor | None = None,
    operating_speed: float | None = None,
    radial_clearance: float | None = None,
    thermal_model: str | None = None,
    mesh: MeshSize | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> ToleranceStudy:
    """Sample the tolerances, solve the film for every sample, and say what it means.

    settings : The scenario's ``[tolerances]`` by default.
    rotor : The scenario's by default.
    operating_speed : [rad/s]; by default the orbit's where it is constant, else the highest.
    radial_clearance, thermal_model : Which of the scenario's; by default the only clearance, and
        ``thd`` where there is a choice.
    mesh : In place of the scenario's.
    executor : Where to compute; by default processes on this machine.
    workers : Number of processes; 1 computes in this one.
    progress : ``progress(done, total)`` in samples.
    Raises InputError: No tolerances, no rotor, or a spread that reaches below zero.
    """
    settings = settings or scenario.tolerances
    if settings is None:
        raise InputError(
            'is missing: write for example [tolerances] radial_clearance = "5 um"', key="tolerances"
        )
    rotor = rotor or scenario.rotor
    if rotor is None:
        raise InputError("is missing: thresholds need a rotor", key="rotor")
    scenario = scenario if mesh is None else with_mesh(scenario, mesh)
    models = [str(model) for model in scenario.thermal_models]
    model = thermal_model or ("thd" if "thd" in models else models[0])
    case = scenario.case(radial_clearance, model)
    speed = operating_speed or _operating_speed(scenario)
    function = _FilmThreshold(case, rotor, speed, _search_speeds(scenario, speed))
    tolerances = _tolerances_of(case, settings)
    try:
        nominal = function({name: t.nominal for name, t in tolerances.items()})
    except SampleError as error:
        raise InputError(f"without any deviation {error}", key="tolerances") from error
    samples = propagate(
        function, tolerances, settings.samples, seed=settings.seed,
        mapper=_mapper(executor, workers, progress),
    )  # fmt: skip
    if len(samples.failures) == len(next(iter(samples.inputs.values()))):
        raise InputError(f"no sample could be solved: {samples.failures[0][1]}", key="tolerances")
    p, error = samples.probability_above("growth_rate", 0.0)
    return ToleranceStudy(
        thermal_model=model,
        radial_clearance=case.bearing.radial_clearance,
        rotor=rotor,
        operating_speed=speed,
        tolerances=tolerances,
        nominal=nominal,
        samples=samples,
        probability_of_instability=p,
        standard_error=error,
        importance=samples.importance("growth_rate"),
        share_of_variance=samples.first_order_index("growth_rate"),
        explained_variance=samples.explained_variance("growth_rate"),
    )


def _tolerances_of(case: Case, settings: ToleranceSettings) -> dict[str, Tolerance]:
    """Distributions about the nominal values of `case`; viscosity as a factor about 1."""
    nominal = {
        "radial_clearance": case.bearing.radial_clearance,
        "viscosity": 1.0,
        "supply_temperature": case.thermal.supply_temperature,
    }
    if isinstance(case.target, LoadTarget):
        nominal["load"] = case.target.load
    tolerances = {}
    for name, spread in settings.spreads.items():
        if name not in nominal:
            raise InputError(
                "goes with operating.load; with an eccentricity ratio the load is a result",
                key=f"tolerances.{name}",
            )
        kind = (spread.distribution or settings.distribution).value
        tolerance = Tolerance(nominal[name], spread.absolute(nominal[name]), kind)
        reach = tolerance.spread * (4.0 if kind == "normal" else 1.0)
        if not reach < nominal[name]:
            raise InputError(
                f"reaches below zero: {nominal[name]:.6g} - {reach:.6g}", key=f"tolerances.{name}"
            )
        tolerances[name] = tolerance
    return tolerances


def _operating_speed(scenario: Scenario) -> float:
    settings = scenario.orbit
    if settings is not None and isinstance(settings.speed, float):
        return settings.speed
    return float(scenario.speeds[-1])


def _search_speeds(scenario: Scenario, operating_speed: float) -> tuple[float, ...]:
    """Speeds of the scenario's range; half to one and a half times a single one."""
    low, high = float(scenario.speeds[0]), float(scenario.speeds[-1])
    if not high > low:
        low, high = 0.5 * operating_speed, 1.5 * operating_speed
    low, high = min(low, operating_speed), max(high, operating_speed)
    return tuple(float(s) for s in np.geomspace(low, high, _SPEEDS))


def _mapper(
    executor: Executor | None,
    workers: int | None,
    progress: Callable[[int, int], None] | None,
) -> Callable:
    """``map`` on the executor, or on this machine's processes, a few samples at a time."""
    from .sweep import available_cores, map_on_processes

    if executor is not None:
        if workers is not None:
            raise InputError("not together with an executor", key="workers", value=workers)
        return lambda function, samples: executor.map(_Elsewhere(function), samples)
    count = available_cores() if workers is None else workers
    if count < 1:
        raise InputError("must be 1 or more", key="workers", value=workers)

    def mapped(function: Callable, samples: Sequence) -> list:
        batches = [samples[i : i + _BATCH] for i in range(0, len(samples), _BATCH)]

        def report(done: int) -> None:
            if progress is not None:
                progress(min(done * _BATCH, len(samples)), len(samples))

        used = min(count, max(1, math.ceil(len(batches) / 2)))
        done = map_on_processes(_Batch(function), batches, used, report)
        return [result for batch in done for result in batch]

    return mapped


@dataclass(frozen=True)
class _Elsewhere:
    """The function for workers that may have another program, which they refuse to use."""

    function: Callable
    model: str = field(default_factory=model_digest)

    def __call__(self, sample: Any) -> Any:
        refuse_other_sources(self.model)
        return self.function(sample)


@dataclass(frozen=True)
class _Batch:
    """The function on several samples: fewer, larger pieces of work travel to the workers."""

    function: Callable

    def __call__(self, samples: Sequence) -> list:
        return [self.function(sample) for sample in samples]
