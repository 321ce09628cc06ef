"""Figures, recordings for the viewer and reports of results."""
