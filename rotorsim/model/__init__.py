"""Frozen descriptions of what is computed: bearing, oil, settings, operating condition.

SI units throughout (Pa, m, s, kg, K, rad). Angles in the load frame: from the static load's line,
positive in the direction of rotation.
"""

from .bearing import Arc, Bearing, Feed, Groove, Pocket, Texture
from .case import Case
from .lubricant import ExponentialViscosity, Lubricant, ViscosityLaw, WaltherViscosity
from .operating import EccentricityTarget, LoadTarget, Target
from .pads import (
    LinePivot,
    Pad,
    PadInertia,
    Pivot,
    RigidPivot,
    SocketPivot,
    SpherePivot,
    SpringPivot,
    pad_inertia,
)
from .settings import (
    BushModel,
    Cavitation,
    FilmSettings,
    FlowRegime,
    Inception,
    InletModel,
    MeshSize,
    RoughnessPattern,
    RupturedFriction,
    ShaftModel,
    SurfaceRoughness,
    ThermalModel,
    ThermalSettings,
    ViscosityResponse,
    preferred_model,
)

__all__ = [
    "Arc",
    "Bearing",
    "BushModel",
    "Case",
    "Cavitation",
    "EccentricityTarget",
    "ExponentialViscosity",
    "Feed",
    "FilmSettings",
    "FlowRegime",
    "Groove",
    "Inception",
    "InletModel",
    "LinePivot",
    "LoadTarget",
    "Lubricant",
    "MeshSize",
    "Pad",
    "PadInertia",
    "Pivot",
    "Pocket",
    "RigidPivot",
    "RoughnessPattern",
    "RupturedFriction",
    "ShaftModel",
    "SocketPivot",
    "SpherePivot",
    "SpringPivot",
    "SurfaceRoughness",
    "Target",
    "Texture",
    "ThermalModel",
    "ThermalSettings",
    "ViscosityLaw",
    "ViscosityResponse",
    "WaltherViscosity",
    "pad_inertia",
    "preferred_model",
]
