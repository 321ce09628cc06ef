"""Studies: sweeps over speed and other axes, tolerances, orbits and stability of a scenario."""
