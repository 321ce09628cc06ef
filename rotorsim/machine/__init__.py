"""Rotors on their bearings: thresholds, modes, stability maps, state space and control."""
