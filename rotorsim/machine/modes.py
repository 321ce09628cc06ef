"""Modes of a machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, ComplexArray
from ..errors import InputError
from ..threads import on_one_blas_thread
from .branches import Modes
from .machine import Machine
from .spectrum import MachineSpectrum, all_eigenmodes
from .tracking import track_modes

_FEWEST, _MOST = 12, 48
"""Pairs of modes of a large machine."""
_REACH = 3.0
"""Up to this multiple of the highest speed all modes are wanted, if no more than `_MOST` pairs."""


@on_one_blas_thread
def modes(machine: Machine, speed: ArrayLike | None = None, count: int | None = None) -> Modes:
    """Return the modes of a machine over speed, as continuous branches.

    Parameters
    ----------
    machine : Machine
    speed : float or (n,) array, optional
        Ascending [rad/s]; by default the longest run of tabulated speeds with coefficients.
    count : int, optional
        Pairs of eigenvalues, the lowest ones. By default all of a machine of up to 48 unknowns; of
        a larger one 12, or up to 48 until three times the highest speed is reached: higher modes
        are neither critical nor driven by films, seals or internal damping.

    Returns
    -------
    Modes
        Its `parameter` is the speed. At one speed the branches ascend in undamped frequency.
    """
    speeds = known_speeds(machine) if speed is None else np.atleast_1d(np.asarray(speed, float))
    if not speeds.size:
        raise InputError("no point of the table converged", key="speed")
    spectrum = machine_spectrum(machine, speeds, count)
    if spectrum.complete:
        found = track_modes(spectrum, speeds)
    else:
        # There are some more, among which those that are wanted may come and go.
        wanted = spectrum.count
        found = track_modes(spectrum, speeds, wanted=2 * wanted)
        reach = np.argsort(found.undamped_frequency.min(axis=0), kind="stable")
        found = found.columns(np.sort(reach[: 2 * wanted]))
    if speeds.size == 1:
        found = found.columns(np.lexsort((-found.eigenvalues[0].imag, found.undamped_frequency[0])))
    return replace(found, planes=machine.rotor.planes)


def machine_spectrum(machine: Machine, speeds: Array, count: int | None = None) -> MachineSpectrum:
    """Return the modes of a machine at any of its speeds: all, or the lowest `count` pairs."""
    if count is not None:
        return MachineSpectrum(machine, count)
    top = float(np.max(np.abs(speeds), initial=0.0))
    spectrum = MachineSpectrum(machine, _FEWEST)
    while not spectrum.complete and spectrum.count < _MOST:
        found = spectrum(top)
        if found is None or np.abs(found.values).max(initial=0.0) >= _REACH * top:
            break
        spectrum = replace(spectrum, count=2 * spectrum.count)
    return spectrum


def known_speeds(machine: Machine) -> Array:
    """Return longest run of tabulated speeds [rad/s] at which all supports have coefficients."""
    speeds = machine.speeds
    if not speeds.size:
        return speeds
    known = np.isfinite(machine.matrices(speeds)[2]).all(axis=(-2, -1))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], known.astype(int), [0]])))
    runs = edges.reshape(-1, 2)
    if not runs.size:
        return np.zeros(0)
    start, stop = runs[np.argmax(runs[:, 1] - runs[:, 0])]
    return speeds[start:stop]


@on_one_blas_thread
def eigenvalues_over_speed(machine: Machine, speeds: Array) -> tuple[ComplexArray, Array]:
    """Return all eigenvalues and their accuracy (n, k) at speeds (n,), in no particular order.

    NaN where a support has no coefficients.
    """
    matrices = machine.state_matrix(speeds)
    values = np.full(matrices.shape[:-1], np.nan, dtype=complex)
    accuracy = np.full(values.shape, np.nan)
    for i in np.flatnonzero(np.isfinite(matrices).all(axis=(-2, -1))):
        found = all_eigenmodes(matrices[i], machine.size)
        values[i], accuracy[i] = found.values, found.accuracy
    return values, accuracy
