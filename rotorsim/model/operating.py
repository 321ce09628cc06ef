"""What fixes the journal's position: an eccentricity ratio or a load."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import InputError


@dataclass(frozen=True)
class EccentricityTarget:
    """The journal at a given eccentricity ratio; the load it carries is a result.

    Below 1 in a bore; between tilting pads it may be more.
    """

    eccentricity_ratio: float

    def __post_init__(self) -> None:
        if not 0.0 < self.eccentricity_ratio < math.inf:
            raise InputError(
                "must be above 0",
                key="operating.eccentricity_ratio",
                value=self.eccentricity_ratio,
            )


@dataclass(frozen=True)
class LoadTarget:
    """A given static load [N] along x; the position is searched."""

    load: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.load) and self.load > 0.0):
            raise InputError("must be above 0", key="operating.load", value=self.load)


Target = EccentricityTarget | LoadTarget
