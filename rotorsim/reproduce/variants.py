"""What else the model could have been: the choices whose weight the sensitivity table shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from ..model import Case, Cavitation, Inception, InletModel, MeshSize, RupturedFriction
from .paper import LITERAL_MESH, Walls


@dataclass(frozen=True)
class Variant:
    """One choice changed, all others kept.

    Attributes
    ----------
    key, label : str
    change : callable
        From the base case to the changed one.
    walls : Walls
    """

    key: str
    label: str
    change: Callable[[Case], Case]
    walls: Walls = Walls.AMBIENT


def _same(case: Case) -> Case:
    return case


def _mesh(factor: float) -> Callable[[Case], Case]:
    def change(case: Case) -> Case:
        old = case.film.mesh
        counts = (old.circumferential, old.axial, old.cross_film, old.bush_radial)
        around, along, across, radial = (max(4, round(factor * n / 2) * 2) for n in counts)
        return replace(case, film=replace(case.film, mesh=MeshSize(around, along, across, radial)))

    return change


def _literal_mesh(case: Case) -> Case:
    return replace(case, film=replace(case.film, mesh=LITERAL_MESH))


def _cavitation(model: Cavitation) -> Callable[[Case], Case]:
    return lambda case: replace(case, film=replace(case.film, cavitation=model))


def _inception(case: Case) -> Case:
    return replace(case, film=replace(case.film, inception=Inception.FREE))


def _inlet(model: InletModel) -> Callable[[Case], Case]:
    return lambda case: replace(case, thermal=replace(case.thermal, inlet=model))


def _friction(case: Case) -> Case:
    whole = RupturedFriction.WHOLE
    return replace(case, film=replace(case.film, ruptured_friction=whole))


BASE = "base"
DOUBLE_MESH = "mesh_double"
LITERAL = "mesh_as_printed"
DESIGN = "bush_conduction_free_shaft_mixing"
"""What an air-cooled bearing without a supply groove of its own comes nearest to."""
VARIANTS = (
    Variant(BASE, "base: the choices that give the paper's numbers", _same),
    Variant("mesh_half", "mesh halved in every direction", _mesh(0.5)),
    Variant(DOUBLE_MESH, "mesh doubled in every direction", _mesh(2.0)),
    Variant(LITERAL, "mesh as printed: 48 around, 156 along, 24 across", _literal_mesh),
    Variant(
        "half_sommerfeld",
        "cavitation: half Sommerfeld",
        _cavitation(Cavitation.HALF_SOMMERFELD),
    ),
    Variant(
        "full_sommerfeld",
        "cavitation: none (full Sommerfeld)",
        _cavitation(Cavitation.FULL_SOMMERFELD),
    ),
    Variant("jfo", "cavitation: mass-conserving (JFO)", _cavitation(Cavitation.JFO)),
    Variant("free_inception", "film begins where it will, not at maximum thickness", _inception),
    Variant("inlet_mixing", "inlet: recirculated and fresh oil mixed", _inlet(InletModel.MIXING)),
    Variant("inlet_periodic", "inlet: none, the oil goes round", _inlet(InletModel.PERIODIC)),
    Variant("friction_whole", "friction counts the whole ruptured sector", _friction),
    Variant("bush_conduction", "bush: conduction, 250 W/mK and 80 W/m2K", _same, Walls.CONDUCTION),
    Variant(
        "bush_conduction_free_shaft",
        "the same bush, shaft without net heat",
        _same,
        Walls.CONDUCTION_SHAFT,
    ),
    Variant(
        DESIGN,
        "that bush and shaft, and the mixing inlet",
        _inlet(InletModel.MIXING),
        Walls.CONDUCTION_SHAFT,
    ),
    Variant("insulated", "both walls insulated", _same, Walls.INSULATED),
)
