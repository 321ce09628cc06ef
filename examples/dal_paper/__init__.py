"""A. Dal's paper on a bearing with variable viscosity, computed again claim by claim.

``python examples/dal_paper`` computes the film points, judges every claim and writes the page.
The claims are data (``claims.csv``, ``tolerances.csv``), the page's words a template (``page.md``).

A. Dal, "Effects of the shaft speed on stiffness and damping coefficients of hydrodynamic
bearing-shaft system under variable viscosity".
"""
