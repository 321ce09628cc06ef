"""The film: thickness, viscosity across it, pressure, heat, equilibrium, and its linearisation.

Read in this order: `mesh` and `geometry` (where), `layers` and `operator` (Dowson's equation on
cells), `cavitation` (complementarity), `linearized` (K and C), `flow` and `energy` (heat), `thd`
(the fixed point), `equilibrium` and `solution` (the journal's position).
"""
