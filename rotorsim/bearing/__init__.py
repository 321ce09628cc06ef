"""One bearing: its operating points, its coefficients, and the table of them over speed."""
