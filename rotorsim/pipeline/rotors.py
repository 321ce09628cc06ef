"""From a scenario's rotor to one that stands on a table's film."""

from __future__ import annotations

from ..model.rotor import JeffcottRotor, Rotor
from ..stability.over_speed import JeffcottShaft, RigidShaft, RotorOnFilm
from .wording import number


def rotor_on_film(rotor: Rotor | None) -> RotorOnFilm | None:
    """Rotor of a scenario for the linear analyses; None without one."""
    if rotor is None:
        return None
    if isinstance(rotor, JeffcottRotor):
        return JeffcottShaft(
            rotor.disc_mass, rotor.shaft_stiffness, rotor.journal_mass, rotor.disc_damping
        )
    return RigidShaft(rotor.mass)


def rotor_words(rotor: RotorOnFilm | None) -> str:
    """``rotor of 1200 kg per bearing``, ``Jeffcott rotor``; empty without one."""
    if rotor is None:
        return ""
    if isinstance(rotor, RigidShaft):
        return f"rotor of {number(rotor.mass)} kg per bearing"
    return "Jeffcott rotor" if isinstance(rotor, JeffcottShaft) else "rotor of your matrices"
