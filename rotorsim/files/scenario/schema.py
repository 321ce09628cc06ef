"""The scenario file's tables: every key, its kind and its default (see docs: scenario format).

Only what a single entry can tell is checked here; what entries say together is checked in `build`.
"""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from ...model import (
    BushModel,
    Cavitation,
    Inception,
    InletModel,
    RupturedFriction,
    ShaftModel,
    ThermalModel,
    ViscosityResponse,
)
from .fields import (
    AS_LIST,
    AS_TABLE,
    Viscosity,
    as_tuple,
    choice,
    choice_or_temperature,
    dynamic_or_kinematic,
    one_or_more,
    quantity,
    range_or_list,
    written_as,
)
from .settings import BearingProfile, Design, OrbitForce, OrbitKind, RotorKind, Station
from .tolerances import DEFAULT_SAMPLES, Distribution, Spread, spread_of

Length = Annotated[float, quantity("length", "50 mm")]
Clearance = Annotated[float, quantity("length", "100 um")]
Angle = Annotated[float, quantity("angle", "90 deg", "any")]
Temperature = Annotated[float, quantity("temperature", "40 degC")]
Speed = Annotated[float, quantity("speed", "3000 rpm")]
ViscosityPoint = Annotated[tuple[Temperature, Annotated[Viscosity, dynamic_or_kinematic]], as_tuple]
Mass = Annotated[float, quantity("mass", "1200 kg")]
Duration = Annotated[float, quantity("time", "0.2 s")]
Instant = Annotated[float, quantity("time", "0.1 s", "not_negative")]
Forces = Annotated[
    list[Annotated[float, quantity("force", "500 N", "any")]], Field(min_length=2, max_length=2)
]
Phases = Annotated[
    list[Annotated[float, quantity("angle", "90 deg", "any")]], Field(min_length=2, max_length=2)
]
MAX_COUNT = 100_000


class Table(BaseModel):
    """A TOML table: unknown keys refused, nothing converted silently."""

    model_config: ClassVar[ConfigDict] = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False
    )


class GrooveTable(Table):
    """``[[bearing.groove]]``."""

    center: Angle = Field(examples=["90 deg"])
    extent: Annotated[float, quantity("angle", "20 deg")] = Field(examples=["20 deg"])
    length: Length | None = None
    supply_pressure: Annotated[float, quantity("pressure", "70 kPa", "not_negative")] = 0.0
    supply_temperature: Temperature | None = None
    sealed_ends: bool = True
    end_land: Length | None = None


class ArcTable(Table):
    """``[[bearing.arc]]``."""

    start: Angle = Field(examples=["-90 deg"])
    end: Angle = Field(examples=["90 deg"])
    preload: float = Field(default=0.0, ge=0.0, lt=1.0)
    offset: float = Field(default=0.5, ge=0.0, le=1.0)


class BearingTable(Table):
    """``[bearing]``."""

    journal_radius: Length = Field(examples=["50 mm"])
    length: Length = Field(examples=["80 mm"])
    radial_clearance: Annotated[list[Clearance], one_or_more] = Field(examples=["100 um"])
    bush_outer_radius: Length | None = None
    groove: Annotated[list[GrooveTable], one_or_more] = Field(default=[])
    arc: Annotated[list[ArcTable], one_or_more] = Field(default=[])
    profile: Annotated[BearingProfile, choice(BearingProfile)] | None = None
    preload: float | None = Field(default=None, ge=0.0, lt=1.0)
    offset: float | None = Field(default=None, ge=0.0, le=1.0)
    tilt: list[Annotated[float, quantity("slope", "0.1 mm/m", "any")]] = Field(
        default=[0.0, 0.0], min_length=2, max_length=2
    )
    roughness: Annotated[float, quantity("length", "1 um", "not_negative")] = 0.0


class LubricantTable(Table):
    """``[lubricant]``."""

    viscosity: Annotated[Viscosity, dynamic_or_kinematic] | None = Field(
        default=None, examples=["0.0277 Pa*s"]
    )
    reference_temperature: Temperature | None = None
    viscosity_temperature_coefficient: (
        Annotated[float, quantity("temperature coefficient", "0.034 / delta_degC", "not_negative")]
        | None
    ) = None
    iso_vg: float | None = Field(default=None, gt=5.0, le=5000.0)
    viscosity_index: float | None = Field(default=None, ge=0.0, le=100.0)
    viscosity_points: (
        list[Annotated[tuple[Temperature, Annotated[Viscosity, dynamic_or_kinematic]], as_tuple]]
        | None
    ) = Field(default=None, min_length=2, max_length=2)
    density: Annotated[float, quantity("density", "860 kg/m^3")] | None = None
    specific_heat: Annotated[float, quantity("specific heat")] | None = None
    thermal_conductivity: Annotated[float, quantity("thermal conductivity")] | None = None


class MeshTable(Table):
    """``film.mesh``; defaults and bounds are `MeshSize`'s own."""

    circumferential: int | None = None
    axial: int | None = None
    cross_film: int | None = None
    bush_radial: int | None = None


class FilmTable(Table):
    """``[film]``."""

    cavitation: Annotated[Cavitation, choice(Cavitation)] = Cavitation.REYNOLDS
    inception: Annotated[Inception, choice(Inception)] = Inception.MAX_FILM
    mesh: MeshTable = MeshTable()
    ruptured_friction: Annotated[RupturedFriction, choice(RupturedFriction)] = (
        RupturedFriction.LIQUID
    )
    viscosity_response: Annotated[ViscosityResponse, choice(ViscosityResponse)] = (
        ViscosityResponse.FROZEN
    )
    frequency_ratio: Annotated[list[float], one_or_more] = Field(default=[], max_length=64)
    rotations: bool = False


class ThermalTable(Table):
    """``[thermal]``."""

    models: Annotated[list[Annotated[ThermalModel, choice(ThermalModel)]], one_or_more] = Field(
        default=[ThermalModel.ISOTHERMAL]
    )
    inlet: Annotated[InletModel, choice(InletModel)] = InletModel.FRESH
    shaft: Annotated[
        ShaftModel | float, choice_or_temperature(ShaftModel, ["ambient", "insulated"])
    ] = ShaftModel.AMBIENT
    bush: Annotated[BushModel, choice(BushModel)] = BushModel.AMBIENT
    ambient_temperature: Temperature | None = None
    supply_temperature: Temperature | None = None
    hot_oil_carry_over: float = Field(default=1.0, ge=0.0, le=1.0, examples=[0.8])
    bush_conductivity: Annotated[float, quantity("thermal conductivity")] | None = None
    bush_heat_transfer: (
        Annotated[float, quantity("heat transfer coefficient", None, "not_negative")] | None
    ) = None


class SpeedRangeTable(Table):
    """``{ start, stop, count }`` of speeds."""

    start: Speed = Field(examples=["500 rpm"])
    stop: Speed = Field(examples=["15000 rpm"])
    count: int = Field(ge=1, le=MAX_COUNT, examples=[30])


class MassRangeTable(Table):
    """``{ start, stop, count }`` of masses."""

    start: Mass = Field(examples=["100 kg"])
    stop: Mass = Field(examples=["3000 kg"])
    count: int = Field(ge=1, le=MAX_COUNT, examples=[100])


class SpeedRampTable(Table):
    """``{ start, stop, duration, hold }`` of an orbit."""

    start: Speed = Field(examples=["3000 rpm"])
    stop: Speed = Field(examples=["15000 rpm"])
    duration: Annotated[float, quantity("time", "2 s")] = Field(examples=["2 s"])
    hold: Annotated[float, quantity("time", "0.5 s", "not_negative")] = 0.0


class OperatingTable(Table):
    """``[operating]``."""

    speed: Annotated[
        Annotated[SpeedRangeTable, Tag(AS_TABLE)] | Annotated[list[Speed], Tag(AS_LIST)],
        Discriminator(written_as),
        range_or_list,
    ] = Field(examples=["3000 rpm"])
    eccentricity_ratio: float | None = Field(default=None, gt=0.0, lt=1.0)
    load: Annotated[float, quantity("force", "10 kN")] | None = None
    load_direction: Angle = 0.0


class RotorTable(Table):
    """``[rotor]``; which keys go with which kind: `build.rotor`."""

    kind: Annotated[RotorKind, choice(RotorKind)] = RotorKind.RIGID
    mass: Mass | None = None
    disc_mass: Mass | None = None
    journal_mass: Mass | None = None
    shaft_stiffness: Annotated[float, quantity("stiffness", "10 MN/m")] | None = None
    disc_damping: Annotated[float, quantity("damping", "200 N*s/m", "not_negative")] | None = None
    unbalance: Annotated[float, quantity("unbalance", "500 g*mm", "not_negative")] = 0.0


class LoadTable(Table):
    """When a load acts, and on which station."""

    start: Instant = 0.0
    stop: Duration | None = None
    on: Annotated[Station, choice(Station)] = Station.JOURNAL


class StepTable(LoadTable):
    """``[orbit.step]``."""

    force: Forces = Field(examples=[["500 N", "0 N"]])


class HarmonicTable(LoadTable):
    """``[orbit.harmonic]``."""

    force: Forces = Field(examples=[["500 N", "0 N"]])
    frequency: Annotated[float, quantity("speed", "50 Hz")] = Field(examples=["50 Hz"])
    phase: Phases = [0.0, 0.0]


class BaseMotionTable(Table):
    """``[orbit.base_motion]``."""

    displacement: list[Annotated[float, quantity("length", "10 um", "any")]] = Field(
        min_length=2, max_length=2, examples=[["10 um", "0 um"]]
    )
    frequency: Annotated[float, quantity("speed", "50 Hz")] = Field(examples=["50 Hz"])
    phase: Phases = [0.0, 0.0]
    start: Instant = 0.0
    stop: Duration | None = None


class BaseShockTable(Table):
    """``[orbit.base_shock]``."""

    acceleration: list[Annotated[float, quantity("acceleration", "10 m/s^2", "any")]] = Field(
        min_length=2, max_length=2, examples=[["10 m/s^2", "0 m/s^2"]]
    )
    duration: Duration = Field(examples=["11 ms"])
    start: Instant = 0.0


class ActuatorTable(Table):
    """``[orbit.actuator]``; which keys go with which design: `actuator.actuator_settings`."""

    on: bool = True
    design: Annotated[Design, choice(Design)] = Design.LQR
    force_limit: Annotated[float, quantity("force", "1 kN")] | None = None
    displacement_scale: Annotated[float, quantity("length", "0.5 um")] | None = None
    force_scale: Annotated[float, quantity("force", "100 N")] | None = None
    stiffness: Annotated[float, quantity("stiffness", "5 MN/m", "not_negative")] | None = None
    damping: Annotated[float, quantity("damping", "20 kN*s/m", "not_negative")] | None = None
    decay_ratio: float | None = Field(default=None, ge=0.0, le=1.0, examples=[0.02])


class OrbitTable(Table):
    """``[orbit]``."""

    kind: Annotated[OrbitKind, choice(OrbitKind)] | None = None
    force: Annotated[OrbitForce, choice(OrbitForce)] = OrbitForce.LINEAR
    speed: Annotated[
        Annotated[SpeedRampTable, Tag(AS_TABLE)] | Annotated[Speed, Tag(AS_LIST)],
        Discriminator(written_as),
    ] = Field(examples=["15000 rpm"])
    revolutions: int | None = Field(default=None, ge=1, le=1_000_000)
    initial_displacement: list[Annotated[float, quantity("length", "1 um", "any")]] = Field(
        default=[0.0, 0.0], min_length=2, max_length=2
    )
    initial_velocity: list[Annotated[float, quantity("velocity", "5 mm/s", "any")]] = Field(
        default=[0.0, 0.0], min_length=2, max_length=2
    )
    radial_clearance: Clearance | None = None
    static_load: bool = True
    unbalance: bool | None = None
    step: StepTable | None = None
    harmonic: HarmonicTable | None = None
    base_motion: BaseMotionTable | None = None
    base_shock: BaseShockTable | None = None
    actuator: ActuatorTable | None = None
    samples_per_revolution: int = Field(default=64, ge=16, le=4096)
    steady_only: bool = False


class StabilityTable(Table):
    """``[stability]``."""

    mass: Annotated[
        Annotated[MassRangeTable, Tag(AS_TABLE)] | Annotated[list[Mass], Tag(AS_LIST)],
        Discriminator(written_as),
        range_or_list,
    ] = Field(examples=["1200 kg"])


class TolerancesTable(Table):
    """``[tolerances]``: about the nominal values."""

    radial_clearance: Annotated[Spread, spread_of("radial_clearance")] | None = None
    viscosity: Annotated[Spread, spread_of("viscosity")] | None = None
    load: Annotated[Spread, spread_of("load")] | None = None
    supply_temperature: Annotated[Spread, spread_of("supply_temperature")] | None = None
    distribution: Annotated[Distribution, choice(Distribution)] = Distribution.UNIFORM
    samples: int = Field(default=DEFAULT_SAMPLES, ge=8, le=MAX_COUNT)
    seed: int = Field(default=0, ge=0, le=2**31)


class ScenarioTables(Table):
    """The whole file."""

    title: str = Field(default="", max_length=500)
    bearing: BearingTable
    lubricant: LubricantTable
    film: FilmTable = FilmTable()
    thermal: ThermalTable = ThermalTable()
    operating: OperatingTable
    rotor: RotorTable | None = None
    orbit: OrbitTable | None = None
    stability: StabilityTable | None = None
    tolerances: TolerancesTable | None = None
