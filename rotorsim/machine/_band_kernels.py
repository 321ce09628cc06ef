"""Compiled kernels of `rotorsim.machine.spectrum` on band matrices."""

from __future__ import annotations

import numpy as np

from ..compiled import compiled

_kernel = compiled(error_model="numpy", fastmath={"contract", "reassoc"}, nogil=True)


@_kernel
def times(band, x, transposed):
    """Multiply a band (2 width + 1, n), or its transposed, by columns (n, k)."""
    width, n = band.shape[0] // 2, band.shape[1]
    result = np.zeros_like(x)
    for d in range(2 * width + 1):
        for j in range(max(0, width - d), min(n, n + width - d)):
            if band[d, j] != 0.0:
                to, of = (j, j + d - width) if transposed else (j + d - width, j)
                for k in range(x.shape[1]):
                    result[to, k] += band[d, j] * x[of, k]
    return result


@_kernel
def expand(lu, pivots, near, far, basis, hessenberg, start, stop):
    """Grow the basis from `start` to `stop` vectors, two at a time, orthogonalised twice.

    The operator takes (a, b) to (q, a - q) with A q = near a + far b, A factored by LAPACK's gbtrf.
    Bands are transposed, (n, 2 width + 1) and (n, 3 width + 1) of `lu`; basis vectors are rows.
    """
    n = lu.shape[0]
    w = (lu.shape[1] - 1) // 3
    block = np.empty((2, 2 * n))
    while start < stop:
        for b in range(2):
            v, q = basis[start + b], block[b]
            q[:n] = 0.0
            for j in range(n):
                for i in range(max(0, j - w), min(n, j + w + 1)):
                    q[i] += near[j, w + i - j] * v[j] + far[j, w + i - j] * v[n + j]
            for j in range(n):
                p = pivots[j]
                q[j], q[p] = q[p], q[j]
                for i in range(j + 1, min(n, j + w + 1)):
                    q[i] -= lu[j, 2 * w + i - j] * q[j]
            for j in range(n - 1, -1, -1):
                q[j] /= lu[j, 2 * w]
                for i in range(max(0, j - 2 * w), j):
                    q[i] -= lu[j, 2 * w + i - j] * q[j]
            for i in range(n):
                q[n + i] = v[i] - q[i]
        size = start + 2
        for _ in range(2):
            for k in range(size):
                v = basis[k]
                first, second = 0.0, 0.0
                for i in range(2 * n):
                    first += v[i] * block[0, i]
                    second += v[i] * block[1, i]
                hessenberg[k, start] += first
                hessenberg[k, start + 1] += second
                for i in range(2 * n):
                    block[0, i] -= first * v[i]
                    block[1, i] -= second * v[i]
        for b in range(2):
            for _ in range(2 * b):
                along = np.dot(basis[size], block[1])
                hessenberg[size, start + 1] += along
                block[1] -= along * basis[size]
            length = np.sqrt(np.dot(block[b], block[b]))
            hessenberg[size + b, start + b] = length
            # Without a direction left the vector is zero, and adds an eigenvalue 0 of the inverse.
            basis[size + b] = block[b] / length if length > 0.0 else 0.0 * block[b]
        start = size
