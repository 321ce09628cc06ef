"""What the pictures of a viewer show: where the circle, the journal's dot and colours are."""

from __future__ import annotations

import numpy as np
import pytest


def near(picture: np.ndarray, colour, tolerance: int = 12) -> np.ndarray:
    return np.abs(picture - np.array(colour)).max(axis=-1) <= tolerance


def assert_healthy(viewer) -> None:
    errors = [entry for entry in viewer.client.get_logs() if entry.level.upper() == "ERROR"]
    assert errors == []
    reports = {view.name: view.reports for view in viewer.client.get_state().views if view.reports}
    assert reports == {}


def circle_of(picture: np.ndarray) -> tuple[np.ndarray, float]:
    """Centre and radius in pixels of the clearance circle, from the grey of its line."""
    title = 26  # the view's title bar
    rows, columns = np.nonzero(near(picture[title:], (230, 230, 230), 25))
    rows = rows + title
    box = np.array([[columns.min(), rows.min()], [columns.max(), rows.max()]])
    assert np.ptp(box[:, 0]) == pytest.approx(np.ptp(box[:, 1]), abs=3)  # a circle
    return box.mean(axis=0), 0.25 * float(np.ptp(box, axis=0).sum())


def dot_of(picture: np.ndarray) -> np.ndarray:
    """Pixel position of the journal: the one light grey patch that is wider than any line."""
    patch = (picture.min(axis=-1) > 165) & (np.ptp(picture, axis=-1) < 8)
    patch[:26] = False
    for _ in range(2):
        for axis in (0, 1):
            patch &= np.roll(patch, 1, axis) & np.roll(patch, -1, axis)
    rows, columns = np.nonzero(patch)
    assert rows.size > 10
    assert max(np.ptp(rows), np.ptp(columns)) < 10
    return np.array([columns.mean(), rows.mean()])
