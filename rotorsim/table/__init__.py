"""The speed-indexed table of coefficients: container, look-up, files.

It knows nothing of films or rotors: whatever has K and C over speed can become a table.
"""

from .coefficients import Coefficients
from .container import CoefficientTable
from .interpolation import CoefficientInterpolator

__all__ = ["CoefficientInterpolator", "CoefficientTable", "Coefficients"]
