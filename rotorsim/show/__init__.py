"""What shows results: figures, recordings for the viewer, reports."""
