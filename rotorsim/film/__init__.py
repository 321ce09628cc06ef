"""The film: thickness, viscosity across it, pressure, heat, equilibrium, and its linearisation.

Read in this order: `mesh` and `geometry` (thickness over the generalised displacements), `layers`,
`flow_law` and `operator` (Dowson's equation on cells), `rupture` (one module for each condition),
`problem` (a film and its state), `linearization` (K and C), `flow` and `energy` (heat), `thd` (the
fixed point), `equilibrium` and `solution` (the displacements under a load).
"""
