"""Rotors: rigid, Jeffcott, beam elements, given matrices, all of one class."""

from .beam import Beam, beam_rotor, with_unbalance
from .rotor import Node, Rotor

__all__ = ["Beam", "Node", "Rotor", "beam_rotor", "with_unbalance"]
