"""What is computed for the paper, and its computation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

from ..bearing.operating_point import OperatingPoint
from ..model import Case, MeshSize, RupturedFriction, ThermalModel
from ..study.sweep import Progress, available_cores, sweep_points
from .paper import (
    CLEARANCES,
    PAPER_MESH,
    RAD_PER_RPM,
    SPEEDS_RPM,
    TOP_RPM,
    VALIDATION_CLEARANCE,
    Walls,
    dal_case,
)
from .results import ISOTHERMAL, LIQUID, THD, WHOLE, PaperResults, Run
from .variants import VARIANTS

WALL_SPEEDS_RPM = (500.0, 2500.0, 5000.0, 7500.0, 10000.0, 12500.0, 15000.0)
VALIDATION_SPEEDS_RPM = (2000.0, 4000.0)
"""The paper names no speed for Fig. 2: two that are common in such tests."""
VALIDATION_ECCENTRICITIES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
FILM_SPEEDS_RPM = (2500.0, 5000.0, 7500.0, 10000.0, 12500.0, 15000.0)


@dataclass(frozen=True)
class Group:
    """Cases that share their speeds."""

    labels: tuple[object, ...]
    cases: tuple[Case, ...]
    speeds_rpm: tuple[float, ...]


@dataclass(frozen=True)
class Study:
    """Everything to be computed."""

    mesh: MeshSize
    main: Group
    walls: Group
    validation: Group
    variants: Group
    films: Group

    @property
    def size(self) -> int:
        """Number of operating points."""
        groups = (self.main, self.walls, self.validation, self.variants, self.films)
        return sum(len(group.cases) * len(group.speeds_rpm) for group in groups)


def paper_study(mesh: MeshSize = PAPER_MESH) -> Study:
    """Figures 2 to 8, the tables, the walls and the variants on `mesh`."""
    return Study(
        mesh=mesh,
        main=_curves(mesh, (Walls.AMBIENT,), (ISOTHERMAL, THD), (LIQUID, WHOLE), SPEEDS_RPM),
        walls=_curves(
            mesh,
            (Walls.CONDUCTION, Walls.CONDUCTION_SHAFT, Walls.INSULATED),
            (THD,),
            (LIQUID,),
            WALL_SPEEDS_RPM,
        ),
        validation=_validation(mesh),
        variants=_variants(mesh),
        films=Group(
            labels=(ISOTHERMAL, THD),
            cases=tuple(dal_case(CLEARANCES[0], model, mesh=mesh) for model in ThermalModel),
            speeds_rpm=FILM_SPEEDS_RPM,
        ),
    )


def _curves(
    mesh: MeshSize,
    walls: Sequence[Walls],
    models: Sequence[str],
    frictions: Sequence[str],
    speeds: tuple[float, ...],
) -> Group:
    runs = [
        Run(model, clearance, wall, friction)
        for wall in walls
        for model in models
        for clearance in CLEARANCES
        for friction in frictions
    ]
    cases = [
        dal_case(
            run.radial_clearance,
            ThermalModel(run.thermal_model),
            walls=run.walls,
            mesh=mesh,
            friction=RupturedFriction(run.friction),
        )
        for run in runs
    ]
    return Group(tuple(runs), tuple(cases), speeds)


def _validation(mesh: MeshSize) -> Group:
    labels = [
        (wall, eps)
        for wall in (Walls.AMBIENT, Walls.CONDUCTION)
        for eps in VALIDATION_ECCENTRICITIES
    ]
    cases = [
        dal_case(
            VALIDATION_CLEARANCE, ThermalModel.THD, walls=wall, mesh=mesh, eccentricity_ratio=eps
        )
        for wall, eps in labels
    ]
    return Group(tuple(labels), tuple(cases), VALIDATION_SPEEDS_RPM)


def _variants(mesh: MeshSize) -> Group:
    labels = [(variant.key, model) for variant in VARIANTS for model in ThermalModel]
    cases = [
        variant.change(dal_case(CLEARANCES[0], model, walls=variant.walls, mesh=mesh))
        for variant in VARIANTS
        for model in ThermalModel
    ]
    return Group(tuple(labels), tuple(cases), (TOP_RPM,))


def compute(
    study: Study,
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> PaperResults:
    """Solve every point of `study`.

    Parameters
    ----------
    study : Study
    executor : Executor, optional
        Any with the `concurrent.futures` interface; by default processes on this machine.
    workers : int, optional
        Number of processes; 1 computes in this one.
    progress : callable, optional
        ``progress(done, total, point)`` after each point.

    Returns
    -------
    PaperResults
        A point that did not converge is in it with its status; claims that rest on it cannot be
        decided.
    """
    counter = _Counter(study.size, progress)

    def solve(group: Group, keep: Callable[..., object] | None = None) -> list[OperatingPoint]:
        speeds = [rpm * RAD_PER_RPM for rpm in group.speeds_rpm]
        few = len(group.cases) * len(speeds) < 4 * available_cores() or keep is not None
        return sweep_points(
            group.cases,
            speeds,
            executor=None if keep else executor,
            workers=1 if keep or (few and executor is None) else workers,
            progress=counter,
            solve_case=keep,
        )

    curves: dict[Run, tuple[OperatingPoint, ...]] = {}
    for group in (study.main, study.walls):
        for run, points in _by_case(group, solve(group)):
            assert isinstance(run, Run)
            curves[run] = points
    validation = _by_speed(study.validation, solve(study.validation))
    variants = solve(study.variants)
    pairs = zip(VARIANTS, variants[::2], variants[1::2], strict=True)
    films = solve(study.films, solve_with_fields)
    return PaperResults(
        mesh=study.mesh,
        curves=curves,
        validation=validation,
        variants={variant.key: (cold, warm) for variant, cold, warm in pairs},
        films={
            (str(model), rpm): point
            for model, points in _by_case(study.films, films)
            for rpm, point in zip(study.films.speeds_rpm, points, strict=True)
        },
    )


def solve_with_fields(case: Case, speed: float, *, initial: object = None) -> object:
    """`rotorsim.bearing.solve.solve_case`, the fields kept."""
    from ..bearing.solve import WarmStart, solve_case

    warm = initial if isinstance(initial, WarmStart) else None
    return solve_case(case, speed, initial=warm, keep_fields=True)


class _Counter:
    """One count over several sweeps."""

    def __init__(self, total: int, progress: Progress | None) -> None:
        self.total, self.progress, self.done = total, progress, 0

    def __call__(self, _done: int, _total: int, point: OperatingPoint) -> None:
        self.done += 1
        if self.progress is not None:
            self.progress(self.done, self.total, point)


def _by_case(
    group: Group, points: Sequence[OperatingPoint]
) -> list[tuple[object, tuple[OperatingPoint, ...]]]:
    count = len(group.speeds_rpm)
    return [
        (label, tuple(points[i * count : (i + 1) * count])) for i, label in enumerate(group.labels)
    ]


def _by_speed(
    group: Group, points: Sequence[OperatingPoint]
) -> dict[tuple[Walls, float], tuple[OperatingPoint, ...]]:
    """Fig. 2: curves over the eccentricity, one for each kind of wall and speed."""
    found: dict[tuple[Walls, float], list[OperatingPoint]] = {}
    for label, row in _by_case(group, points):
        assert isinstance(label, tuple)
        for rpm, point in zip(group.speeds_rpm, row, strict=True):
            found.setdefault((label[0], rpm), []).append(point)
    return {key: tuple(row) for key, row in found.items()}
