"""Tolerances: films of a bearing or a machine solved for many samples of its inputs."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..bearing.operating_point import OperatingPoint
from ..errors import InputError
from ..files.machine import MachineFile
from ..files.parameters import Parameter, Variant, spreads
from ..machine.machine import Machine
from ..machine.modes import machine_spectrum
from ..machine.support import ConstantSupport, MatrixTable, Support, TableSupport
from ..machine.thresholds import ThresholdSpeed, find_thresholds
from ..machine.uncertainty import Propagation, SampleError, Tolerance, propagate
from ..model import Case, LoadTarget, MeshSize, preferred_model
from ..model.machine import MachineTolerances
from ..model.tolerances import NORMAL_REACH, Spread, ToleranceSettings
from ..rotor import Rotor
from ..rows import RPM
from .changes import changed, machine_with_mesh, with_mesh
from .finished import model_digest
from .machine_analysis import MachineAnalysis, thermal_models
from .machine_supports import SupportState
from .processes import available_cores, map_on_processes
from .sweep import refuse_other_sources, sweep_points

if TYPE_CHECKING:
    from ..files.scenario import Scenario

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
_Solve = Callable[[Sequence[float]], dict[float, Any]]
_Assemble = Callable[[Mapping[float, Any]], Machine]


def _failure(point: OperatingPoint) -> str:
    why = f": {point.message}" if point.message else ""
    return (
        f"the film at {point.speed * RPM:.0f} rpm did not converge "
        f"({point.status.value.replace('_', ' ')}{why})"
    )


class _Threshold(ABC):
    """From sampled inputs to thresholds, by solving the films: the function that is propagated."""

    rotor: Rotor
    operating_speed: float
    speeds: tuple[float, ...]

    @abstractmethod
    def films(self, sample: Mapping[str, float]) -> tuple[_Solve, _Assemble]:
        """Return how a sample is solved at ascending speeds [rad/s], and its machine.

        Solving raises SampleError: A film or the static equilibrium did not converge.
        """

    def __call__(self, sample: Mapping[str, float]) -> dict[str, float | None]:
        """Return thresholds of one sample.

        Returns: ``growth_rate`` at the operating speed [1/s], above 0 where unstable;
            ``threshold_speed`` [rad/s], the lowest at which the rotor loses its stability, None
            where none lies within the speeds; ``stable_throughout`` and ``unstable_throughout``,
            1 or 0; of one film ``critical_mass`` of a rigid rotor at the operating speed [kg] and
            its ``whirl_frequency_ratio``, None without a threshold.
        """
        solve, assemble = self.films(sample)
        states = solve(sorted({*self.speeds, self.operating_speed}))
        crossings = _crossings(assemble, states)
        for _ in range(_REFINEMENTS):
            # The film is solved where the threshold was found, which makes it exact there.
            lost = next((c.speed for c in crossings if c.becomes_unstable), None)
            if lost is None or min(abs(lost / s - 1.0) for s in states) < 1e-4:
                break
            states |= solve([lost])
            crossings = _crossings(assemble, states)
        rates = {speed: _growth(assemble({speed: state}), speed) for speed, state in states.items()}
        found: dict[str, float | None] = {
            "growth_rate": rates[self.operating_speed],
            "threshold_speed": next((c.speed for c in crossings if c.becomes_unstable), None),
            "stable_throughout": float(max(rates.values()) < 0.0),
            "unstable_throughout": float(min(rates.values()) >= 0.0),
        }
        at = states[self.operating_speed]
        if isinstance(at, OperatingPoint):
            found["critical_mass"] = at.critical_mass
            found["whirl_frequency_ratio"] = at.whirl_frequency_ratio
        return found


def _crossings(assemble: _Assemble, states: Mapping[float, Any]) -> list[ThresholdSpeed]:
    speeds = np.array(sorted(states))
    return find_thresholds(machine_spectrum(assemble(states), speeds), speeds)


def _growth(machine: Machine, speed: float) -> float:
    """Return the growth rate of the least stable mode [1/s]."""
    found = machine_spectrum(machine, np.array([speed]))(speed)
    return math.nan if found is None else found.leading.real


@dataclass(frozen=True)
class _FilmThreshold(_Threshold):
    """A rotor on identical bearings of one film.

    operating_speed : [rad/s]
    speeds : Between which the threshold is looked for, ascending [rad/s].
    """

    case: Case
    rotor: Rotor
    operating_speed: float
    speeds: tuple[float, ...]

    def films(self, sample: Mapping[str, float]) -> tuple[_Solve, _Assemble]:
        """Return one film; a sample has the names of a scenario's ``[tolerances]``, SI."""
        from ..bearing.solve import solve_case

        case = changed(self.case, {_INPUTS[name]: value for name, value in sample.items()})

        def solve(speeds: Sequence[float]) -> dict[float, OperatingPoint]:
            points, warm = {}, None
            for speed in speeds:
                point, warm = solve_case(case, speed, initial=warm)
                if not point.converged:
                    raise SampleError(_failure(point))
                points[speed] = point
            return points

        return solve, lambda points: Machine.on_identical(self.rotor, _support(points))


@dataclass(frozen=True)
class _MachineThreshold(_Threshold):
    """A machine.

    parameters : By the names that samples use.
    operating_speed : [rad/s]
    speeds : Between which the threshold is looked for, ascending [rad/s].
    """

    machine: MachineFile
    parameters: Mapping[str, Parameter]
    thermal_model: str
    rotor: Rotor
    operating_speed: float
    speeds: tuple[float, ...]

    def films(self, sample: Mapping[str, float]) -> tuple[_Solve, _Assemble]:
        """Return all films of the machine."""
        variant = Variant(self.machine)
        for name, value in sample.items():
            variant = self.parameters[name].applied(variant, value)
        places = [at for one in self.parameters.values() for at in one.places]
        rotor = variant.machine.rotor_with_unbalance(more=places)

        def analysis(speeds: Sequence[float]) -> MachineAnalysis:
            return MachineAnalysis(variant, rotor, self.thermal_model, speeds, _swept_here)

        def solve(speeds: Sequence[float]) -> dict[float, list[SupportState]]:
            found = analysis(speeds).result()
            for state in found.supports:
                for point in state.points:
                    if not point.converged:
                        raise SampleError(f"{state.name}: {_failure(point)}")
            if not found.converged:
                raise SampleError("no static equilibrium")
            return {
                speed: [
                    SupportState(one.name, one.load[k : k + 1], one.points[k : k + 1])
                    for one in found.supports
                ]
                for k, speed in enumerate(speeds)
            }

        def assemble(states: Mapping[float, list[SupportState]]) -> Machine:
            speeds = sorted(states)
            joined = [
                SupportState(
                    parts[0].name, np.concatenate([one.load for one in parts]),
                    tuple(point for one in parts for point in one.points),
                )
                for parts in zip(*(states[speed] for speed in speeds), strict=True)
            ]  # fmt: skip
            return analysis(speeds).assembled(joined)

        return solve, assemble


def _swept_here(cases: list[Case], speeds: list[float]) -> list[OperatingPoint]:
    return sweep_points(cases, speeds, workers=1)


def _support(points: Mapping[float, OperatingPoint]) -> Support:
    """Return the film of one or more speeds, with its pads."""
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

    radial_clearance : Nominal [m]; None of a machine, whose bearings have each their own.
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
    radial_clearance: float | None
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
    source: Scenario | MachineFile,
    settings: ToleranceSettings | MachineTolerances | None = None,
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
    """Sample the tolerances, solve the films for every sample, and say what it means.

    settings : The file's ``[tolerances]`` by default.
    rotor : The scenario's by default; a machine has its own.
    operating_speed : [rad/s]. By default of a scenario the orbit's where it is constant, else the
        highest; of a machine that of the settings, the highest continuous one, or the highest.
    radial_clearance : Which of a scenario's; by default the only one.
    thermal_model : By default ``thd`` where there is a choice.
    mesh : In place of the file's.
    executor : Where to compute; by default processes on this machine.
    workers : Number of processes; 1 computes in this one.
    progress : ``progress(done, total)`` in samples.
    Raises InputError: No tolerances, no rotor, a parameter without a value to spread about, or a
        spread that reaches below zero.
    """
    settings = settings or source.tolerances
    if settings is None:
        example = 'radial_clearance = "5 um"'
        if isinstance(source, MachineFile):
            example = f'spread = {{ "{next(iter(source.bearings), "left")}.clearance" = "5 um" }}'
        raise InputError(f"is missing: write for example [tolerances] {example}", key="tolerances")
    if isinstance(source, MachineFile):
        assert isinstance(settings, MachineTolerances)
        function, tolerances = _of_machine(source, settings, operating_speed, thermal_model, mesh)
        model, clearance = function.thermal_model, None
    else:
        assert isinstance(settings, ToleranceSettings)
        scenario = source if mesh is None else with_mesh(source, mesh)
        rotor = rotor or scenario.rotor
        if rotor is None:
            raise InputError("is missing: thresholds need a rotor", key="rotor")
        model = thermal_model or preferred_model(scenario.thermal_models)
        case = scenario.case(radial_clearance, model)
        clearance = case.bearing.radial_clearance
        speed = operating_speed or _operating_speed(scenario)
        function = _FilmThreshold(case, rotor, speed, _search_speeds(scenario.speeds, speed))
        tolerances = _tolerances_of(case, settings)
    try:
        nominal = function({name: t.nominal for name, t in tolerances.items()})
    except SampleError as error:
        raise InputError(f"without any deviation {error}", key="tolerances") from error
    mapper = _mapper(executor, workers, progress)
    samples = propagate(function, tolerances, settings.samples, seed=settings.seed, mapper=mapper)
    if len(samples.failures) == len(next(iter(samples.inputs.values()))):
        raise InputError(f"no sample could be solved: {samples.failures[0][1]}", key="tolerances")
    p, error = samples.probability_above("growth_rate", 0.0)
    return ToleranceStudy(
        thermal_model=model,
        radial_clearance=clearance,
        rotor=function.rotor,
        operating_speed=function.operating_speed,
        tolerances=tolerances,
        nominal=nominal,
        samples=samples,
        probability_of_instability=p,
        standard_error=error,
        importance=samples.importance("growth_rate"),
        share_of_variance=samples.first_order_index("growth_rate"),
        explained_variance=samples.explained_variance("growth_rate"),
    )


def _of_machine(
    machine: MachineFile, settings: MachineTolerances, operating_speed: float | None,
    model: str | None, mesh: MeshSize | None,
) -> tuple[_MachineThreshold, dict[str, Tolerance]]:  # fmt: skip
    machine = machine_with_mesh(machine, mesh)
    known = thermal_models(machine)
    model = known[-1] if model is None else model
    if model not in known:
        raise InputError(f"must be one of {', '.join(known)}", key="thermal_model", value=model)
    operating = machine.operating
    speed = operating_speed or settings.speed
    speed = speed or (operating.continuous or operating.speeds)[-1]
    tolerances, parameters = {}, {}
    for one, spread in spreads(machine, settings.spread, "tolerances.spread").items():
        key = f"tolerances.spread.{one.name}"
        nominal = one.nominal(machine)
        if nominal is None:
            raise InputError("has no one value in the file to spread about", key=key)
        kind = (spread.distribution or settings.distribution).value
        tolerances[one.name] = _tolerance(nominal, spread, kind, key, one.sign != "any")
        parameters[one.name] = one
    speeds = _search_speeds(np.array(operating.speeds), speed)
    rotor = machine.rotor_with_unbalance()
    return _MachineThreshold(machine, parameters, model, rotor, speed, speeds), tolerances


def _tolerances_of(case: Case, settings: ToleranceSettings) -> dict[str, Tolerance]:
    """Return distributions about the nominal values of `case`; viscosity as a factor about 1."""
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
        tolerances[name] = _tolerance(nominal[name], spread, kind, f"tolerances.{name}")
    return tolerances


def _tolerance(
    nominal: float, spread: Spread, kind: str, key: str, unsigned: bool = True
) -> Tolerance:
    """Return the distribution about a nominal value, which an `unsigned` one keeps above zero."""
    size = spread.absolute(nominal)
    if not size > 0.0:
        raise InputError("must be a value with its unit: the nominal one is 0", key=key)
    reach = size * (NORMAL_REACH if kind == "normal" else 1.0)
    if unsigned and not reach < nominal:
        raise InputError(f"reaches below zero: {nominal:.6g} - {reach:.6g}", key=key)
    return Tolerance(nominal, size, kind)  # type: ignore[arg-type]


def _operating_speed(scenario: Scenario) -> float:
    settings = scenario.orbit
    if settings is not None and isinstance(settings.speed, float):
        return settings.speed
    return float(scenario.speeds[-1])


def _search_speeds(speeds: Array, operating_speed: float) -> tuple[float, ...]:
    """Return speeds of the file's range; half to one and a half times a single one."""
    low, high = float(speeds[0]), float(speeds[-1])
    if not high > low:
        low, high = 0.5 * operating_speed, 1.5 * operating_speed
    low, high = min(low, operating_speed), max(high, operating_speed)
    return tuple(float(s) for s in np.geomspace(low, high, _SPEEDS))


def _mapper(
    executor: Executor | None, workers: int | None, progress: Callable[[int, int], None] | None
) -> Callable:
    """Return ``map`` on the executor, or on this machine's processes, a few samples at a time."""
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
