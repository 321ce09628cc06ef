"""Shafts as Timoshenko beam elements: mesh, element matrices, assembly.

Sources: Nelson, J. Mech. Des. 102 (1980) 793; Friswell, Penny, Garvey & Lees, Dynamics of Rotating
Machines (2010), ch. 5; shear coefficient: Cowper, J. Appl. Mech. 33 (1966) 335.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..model.shaft import STEEL, Coupling, Disc, Material, Section
from ..threads import on_one_blas_thread
from .rotor import Node, Rotor

_MIN_ELEMENTS, _MAX_ELEMENTS = 20, 100
"""Of the whole shaft, where the mesh rule decides."""
_SAME_PLACE = 1e-6
"""Of the shaft's length: places nearer than this share a node."""
_POINTS = 5
"""Gauss points of an element: exact for its mass matrix with constant section."""
_UNKNOWNS = ("x", "y", "theta_x", "theta_y")


@dataclass(frozen=True)
class Beam:
    """A shaft with its discs, from its drawing (SI).

    sections : Those of layer 1 follow one another from the left end.
    material : Of sections without one of their own.
    shear : With False the beam is that of Rayleigh: rotary inertia without shear.
    axial_force : Along the whole shaft, tension above 0 [N].
    internal_damping : Viscous and rotating: force -b K_s (dr/dt - i Omega r) on r = x + i y [s].
    clockwise : Sense of rotation seen from the left end; z then runs from left to right, else from
        right to left. It decides the signs of the slopes.
    modal_damping : Ratio of every mode of the free shaft at rest, rotating as `internal_damping`.
    Raises InputError: There is no section, one overlaps another of its layer or leaves the shaft,
        or a disc does.
    """

    sections: tuple[Section, ...]
    discs: tuple[Disc, ...] = ()
    material: Material = STEEL
    shear: bool = True
    axial_force: float = 0.0
    internal_damping: float = 0.0
    clockwise: bool = True
    couplings: tuple[Coupling, ...] = ()
    modal_damping: float = 0.0

    def __post_init__(self) -> None:
        # Copies: `span` tells equal sections apart.
        object.__setattr__(self, "sections", tuple(replace(section) for section in self.sections))
        if not any(section.layer == 1 for section in self.sections):
            raise InputError("is missing: a shaft needs a section", key="rotor.section")
        if not (math.isfinite(self.internal_damping) and self.internal_damping >= 0.0):
            raise InputError(
                "must be 0 or more (s)", key="rotor.internal_damping", value=self.internal_damping
            )
        if not math.isfinite(self.axial_force):
            raise InputError("must be finite (N)", key="rotor.axial_force", value=self.axial_force)
        if not 0.0 <= self.modal_damping < 1.0:
            raise InputError(
                "must lie between 0 and 1", key="rotor.modal_damping", value=self.modal_damping
            )
        self._check_layers()
        for i, coupling in enumerate(self.couplings):
            slack = _SAME_PLACE * self.length
            if not slack < coupling.at < self.length - slack:
                raise InputError(
                    f"must lie within the shaft, between 0 and {self.length:g} m",
                    key=f"coupling[{i}].at", value=coupling.at,
                )  # fmt: skip
            if any(abs(coupling.at - other.at) <= slack for other in self.couplings[:i]):
                raise InputError(
                    "another coupling stands at this place", key=f"coupling[{i}].at",
                    value=coupling.at,
                )  # fmt: skip
        for i, disc in enumerate(self.discs):
            self.check_place(disc.at, f"rotor.disc[{i}].at")

    def _check_layers(self) -> None:
        slack = _SAME_PLACE * self.length
        for layer in {section.layer for section in self.sections}:
            spans = sorted(self.span(s) for s in self.sections if s.layer == layer)
            for (_, end), (start, _) in pairwise(spans):
                if start < end - slack or (layer == 1 and start > end + slack):
                    word = "overlaps" if start < end else "leaves a gap to"
                    raise InputError(
                        f"{word} the section before, which ends at {end:g} m; a sleeve needs "
                        "layer = 2", key="rotor.section.at", value=start,
                    )  # fmt: skip
            if spans[0][0] < -slack or spans[-1][1] > self.length + slack:
                raise InputError(
                    f"leaves the shaft, which goes from 0 to {self.length:g} m",
                    key="rotor.section.at", value=spans[0][0],
                )  # fmt: skip

    def outer_radius(self, at: float) -> float:
        """Return the outer radius of the shaft at a place [m], the larger one at a step."""
        spans = [(section, *self.span(section)) for section in self.sections]
        return max(
            float(self.at(np.array([at]), section)[1][0])
            for section, left, right in spans
            if left - 1e-9 <= at <= right + 1e-9
        )

    def disc_size(self, disc: Disc) -> tuple[float, float]:
        """Return radius and width [m] of a steel disc of the same mass and polar inertia."""
        shaft = self.outer_radius(disc.at)
        outer = math.sqrt(max(2.0 * disc.polar_inertia / disc.mass - shaft**2, 1.2 * shaft**2))
        area = math.pi * (outer**2 - shaft**2)
        return outer, disc.mass / (STEEL.density * area)

    @property
    def length(self) -> float:
        """Length of the shaft [m]."""
        return sum(section.length for section in self.sections if section.layer == 1)

    def check_place(self, at: float, key: str) -> None:
        """Refuse a place off the shaft."""
        slack = _SAME_PLACE * self.length
        if not (math.isfinite(at) and -slack <= at <= self.length + slack):
            raise InputError(
                f"must lie on the shaft, from 0 to {self.length:g} m", key=key, value=at
            )

    def span(self, section: Section) -> tuple[float, float]:
        """Return the left and right end of a section [m]."""
        start = section.at
        if start is None:
            start = 0.0
            for other in self.sections:
                if other is section:
                    break
                if other.layer == 1:
                    start = other.length + (start if other.at is None else other.at)
        return start, start + section.length

    def mesh(self, places: Sequence[float] = (), refinement: int = 1) -> Array:
        """Return nodes (n,) [m] from the left end: section ends, discs, `places`, and between them.

        A coupling has two nodes at its place.

        places : Where a node is needed: supports, seals, probes, loads [m].
        refinement : Number of parts into which every element is cut.

        Elements are shorter than the section's outer diameter and a twentieth of the shaft, but no
        shorter than a hundredth of it, unless a section says how many it has.
        """
        spans = [(*self.span(section), section) for section in self.sections]
        ends = [end for start, stop, _ in spans for end in (start, stop)]
        inner = [
            start + (stop - start) * i / section.elements
            for start, stop, section in spans
            if section.elements is not None
            for i in range(1, section.elements)
        ]
        cuts = [coupling.at for coupling in self.couplings]
        discs = [disc.at for disc in self.discs]
        fixed = _merged([*ends, *inner, *discs, *cuts, *places], self.length)
        nodes = [fixed[0]]
        for left, right in pairwise(fixed):
            middle = 0.5 * (left + right)
            here = [s for start, stop, s in spans if start <= middle <= stop]
            count = refinement
            if not any(section.elements for section in here):
                longest = min(*(s.outer_diameter for s in here), self.length / _MIN_ELEMENTS)
                longest = max(longest, self.length / _MAX_ELEMENTS)
                count *= math.ceil((right - left) / longest * (1.0 - 1e-9))
            nodes += [left + (right - left) * i / count for i in range(1, count + 1)]
        double = [fixed[int(np.abs(np.array(fixed) - cut).argmin())] for cut in cuts]
        return np.array(sorted([*nodes, *double]))

    def at(self, z: Array, layer_section: Section) -> tuple[Array, Array]:
        """Return the inner and outer radius (n,) [m] of a section at places z (n,) [m]."""
        start, stop = self.span(layer_section)
        t = (z - start) / (stop - start)
        inner = layer_section.inner_diameter
        outer = layer_section.outer_diameter
        inner = 0.5 * (inner + t * (layer_section.inner_right - inner))
        outer = 0.5 * (outer + t * (layer_section.outer_right - outer))
        return inner, outer

    def properties(self, z: Array) -> tuple[Array, Array, Array, Array]:
        """Return EI, kGA, mass and rotary inertia per length at z (n,) [m].

        Returns bending, shear, mass, inertia : (n,) arrays. E I [N m^2], kappa G A [N], rho A
            [kg/m], rho I [kg m]; sums over the layers.
        """
        total = np.zeros((4, z.size))
        middle = float(np.mean(z))
        for section in self.sections:
            start, stop = self.span(section)
            if not start <= middle <= stop:
                continue
            inner, outer = self.at(z, section)
            material = section.material or self.material
            area = math.pi * (outer**2 - inner**2)
            second = math.pi / 4.0 * (outer**4 - inner**4)
            kappa = _shear_coefficient(inner / outer, material.poisson_ratio)
            if section.stiffness:
                total[0] += material.youngs_modulus * second
                total[1] += kappa * material.shear * area
            total[2] += material.density * area
            total[3] += material.density * second
        if not np.all(total[0] > 0.0):
            raise InputError(
                "has no section with stiffness here", key="rotor.section", value=middle
            )
        return total[0], total[1], total[2], total[3]


def _shear_coefficient(radius_ratio: float | Array, poisson_ratio: float) -> float | Array:
    """Return Cowper's shear coefficient of a circle; `radius_ratio` is inner over outer."""
    m2 = np.square(radius_ratio)
    first = (1.0 + m2) ** 2
    return (
        6.0 * (1.0 + poisson_ratio) * first
        / ((7.0 + 6.0 * poisson_ratio) * first + (20.0 + 12.0 * poisson_ratio) * m2)
    )  # fmt: skip


def beam_rotor(beam: Beam, places: Sequence[float] = (), refinement: int = 1) -> Rotor:
    """Assemble the rotor of a shaft.

    places : Where supports, seals, probes and loads need a node [m].
    refinement : See `Beam.mesh`.
    Returns: Unknowns x, y, theta_x = -dy/dz, theta_y = dx/dz at each node; its `bearing_nodes` are
        the nodes at `places`, or the ends without them.
    """
    for place in places:
        beam.check_place(place, "rotor.places")
    nodes = beam.mesh(places, refinement)
    size = 2 * nodes.size
    mass, stiffness, gyroscopic, geometric, joints = np.zeros((5, size, size))
    for i, (left, right) in enumerate(pairwise(nodes)):
        here = slice(2 * i, 2 * i + 4)
        if left == right:
            coupling = min(beam.couplings, key=lambda one: abs(one.at - left))
            springs = np.diag([coupling.stiffness, coupling.angular_stiffness])
            joints[here, here] += np.kron([[1.0, -1.0], [-1.0, 1.0]], springs)
            mass[[2 * i, 2 * i + 2], [2 * i, 2 * i + 2]] += 0.5 * coupling.mass
            continue
        translation, rotation, bending, tension = _element_matrices(beam, left, right)
        mass[here, here] += translation + rotation
        gyroscopic[here, here] += 2.0 * rotation
        stiffness[here, here] += bending
        geometric[here, here] += tension
    names = [""] * nodes.size
    for disc in beam.discs:
        i = _nearest_node(nodes, disc.at)
        mass[2 * i, 2 * i] += disc.mass
        mass[2 * i + 1, 2 * i + 1] += disc.transverse_inertia
        gyroscopic[2 * i + 1, 2 * i + 1] += disc.polar_inertia
        names[i] = disc.name or names[i]
    # Quadrature leaves them symmetric but for rounding.
    mass, stiffness, gyroscopic, geometric = (
        0.5 * (part + part.T) for part in (mass, stiffness, gyroscopic, geometric)
    )
    damping = beam.internal_damping * stiffness
    stiffness = stiffness + beam.axial_force * geometric + joints
    if beam.modal_damping:
        damping = damping + _modal(mass, stiffness, beam.modal_damping)
    both = _BothPlanes(nodes.size, 1.0 if beam.clockwise else -1.0)
    carried = [_nearest_node(nodes, place) for place in places] or [0, nodes.size - 1]
    return Rotor(
        mass=both.alike(mass),
        damping=both.alike(damping),
        gyroscopic=both.crossed(gyroscopic),
        stiffness=both.alike(stiffness),
        circulatory=both.crossed(damping),
        nodes=tuple(
            Node(name or f"node{i}", _UNKNOWNS, float(z))
            for i, (name, z) in enumerate(zip(names, nodes, strict=True))
        ),
        unbalance=np.zeros(nodes.size, dtype=complex),
        bearing_nodes=tuple(dict.fromkeys(carried)),
        kind="beam",
        parameters={"length": beam.length},
    )


def _modal(mass: Array, stiffness: Array, ratio: float) -> Array:
    """Return the damping matrix of one plane that gives every free mode a damping ratio."""
    from scipy.linalg import eigh

    try:
        squares, shapes = eigh(stiffness, mass)
    except np.linalg.LinAlgError:
        raise InputError(
            "needs a shaft with mass", key="rotor.modal_damping", value=ratio
        ) from None
    # A free shaft's rigid motions, whose squares are zero but for rounding, are not damped.
    squares = np.where(squares > 1e-12 * squares[-1], squares, 0.0)
    momentum = mass @ shapes
    return np.asarray((momentum * (2.0 * ratio * np.sqrt(squares))) @ momentum.T)


def _element_matrices(beam: Beam, left: float, right: float) -> tuple[Array, Array, Array, Array]:
    """Return the matrices (4, 4) of the element from `left` to `right` [m], in one plane.

    Returns translation, rotation : Consistent mass of the translation and of the rotation (rotary
        inertia) [kg, kg m, kg m^2].
    Returns bending : Stiffness, shear included [N/m, N, N m].
    Returns tension : Geometric stiffness of a unit tension [1/m, 1, m].

    The unknowns are displacement and slope of the cross section at both ends. The shape functions
    are the exact static ones of a uniform Timoshenko beam, with Phi = 12 E I/(kappa G A l^2) at the
    element's middle; energies are integrated by Gauss' rule, which is exact for a uniform element
    and lets the section vary along a tapered one.
    """
    length = right - left
    place, weight = np.polynomial.legendre.leggauss(_POINTS)
    s, weight = 0.5 * (1.0 + place), 0.5 * length * weight
    bending, shear, mass, inertia = beam.properties(left + s * length)
    if beam.shear:
        middle = beam.properties(np.array([0.5 * (left + right)]))
        phi = float(12.0 * middle[0][0] / (middle[1][0] * length**2))
    else:
        phi = 0.0
    scale = 1.0 / (1.0 + phi)
    one, two, three = np.ones_like(s), s**2, s**3
    deflection = scale * np.array(
        [
            2.0 * three - 3.0 * two - phi * s + (1.0 + phi) * one,
            length * (three - (2.0 + 0.5 * phi) * two + (1.0 + 0.5 * phi) * s),
            -2.0 * three + 3.0 * two + phi * s,
            length * (three - (1.0 - 0.5 * phi) * two - 0.5 * phi * s),
        ]
    )
    steepness = scale / length * np.array(
        [
            6.0 * two - 6.0 * s - phi * one,
            length * (3.0 * two - (4.0 + phi) * s + (1.0 + 0.5 * phi) * one),
            -6.0 * two + 6.0 * s + phi * one,
            length * (3.0 * two - (2.0 - phi) * s - 0.5 * phi * one),
        ]
    )  # fmt: skip
    slope = scale * np.array(
        [
            6.0 / length * (two - s),
            3.0 * two - (4.0 + phi) * s + (1.0 + phi) * one,
            6.0 / length * (s - two),
            3.0 * two - (2.0 - phi) * s,
        ]
    )
    curvature = scale / length * np.array(
        [
            6.0 / length * (2.0 * s - one),
            6.0 * s - (4.0 + phi) * one,
            6.0 / length * (one - 2.0 * s),
            6.0 * s - (2.0 - phi) * one,
        ]
    )  # fmt: skip
    elastic = (curvature * (weight * bending)) @ curvature.T
    if beam.shear:
        strain = steepness - slope
        elastic += (strain * (weight * shear)) @ strain.T
    return (
        (deflection * (weight * mass)) @ deflection.T,
        (slope * (weight * inertia)) @ slope.T,
        elastic,
        (steepness * weight) @ steepness.T,
    )


@on_one_blas_thread
def buckling_load(beam: Beam, supports: Sequence[float]) -> float:
    """Return the force [N] at which the shaft buckles between supports that do not yield.

    supports : Places [m]. Infinite with fewer than two, or where a joint lets the shaft go.
    """
    from scipy.linalg import LinAlgError, eigh

    if len(set(supports)) < 2:
        return math.inf
    free, pressed = (
        beam_rotor(replace(beam, axial_force=force), supports) for force in (0.0, -1.0)
    )
    held = [free.first_unknown[node] + k for node in free.bearing_nodes for k in (0, 1)]
    kept = np.setdiff1d(np.arange(len(free.stiffness)), held)
    elastic, softened = (np.array(one.stiffness)[kept[:, None], kept] for one in (free, pressed))
    softening = elastic - softened
    try:
        return 1.0 / float(eigh(softening, elastic, eigvals_only=True)[-1])
    except LinAlgError:
        return math.inf


@dataclass(frozen=True)
class _BothPlanes:
    """From matrices of one plane, on u, du/dz at each node from the left, to the rotor's.

    In the plane of x: u = x, slope = theta_y; in that of y: u = y, slope = -theta_x. Along the
    shaft the slope is d/ds, s from the left, so that it changes its sign where z runs to the left.
    """

    nodes: int
    sign: float

    @property
    def planes(self) -> tuple[Array, Array]:
        """Matrices (4n, 2n) from the unknowns of a plane to the rotor's."""
        x, y = np.zeros((2, 4, 2))
        x[0, 0], x[3, 1] = 1.0, self.sign
        y[1, 0], y[2, 1] = 1.0, -self.sign
        eye = np.eye(self.nodes)
        return np.asarray(np.kron(eye, x), float), np.asarray(np.kron(eye, y), float)

    def alike(self, plane: Array) -> Array:
        """Put the same matrix into both planes."""
        x, y = self.planes
        return x @ plane @ x.T + y @ plane @ y.T

    def crossed(self, plane: Array) -> Array:
        """Put the matrix into the rows of x on y, minus it into those of y on x."""
        x, y = self.planes
        return x @ plane @ y.T - y @ plane @ x.T


def _nearest_node(nodes: Array, place: float) -> int:
    """Return the number of the node at `place` [m]."""
    return int(np.abs(nodes - place).argmin())


def _merged(places: Sequence[float], length: float) -> list[float]:
    """Return the ascending places, those that nearly coincide once."""
    found: list[float] = []
    for place in sorted(places):
        if not found or place - found[-1] > _SAME_PLACE * length:
            found.append(place)
    return found


def with_unbalance(rotor: Rotor, planes: Sequence[tuple[float, float, float]]) -> Rotor:
    """Return the rotor with unbalances (position [m], mass times radius [kg m], phase [rad])."""
    positions = np.array([node.position for node in rotor.nodes])
    unbalance = np.array(rotor.unbalance)
    for at, amount, phase in planes:
        unbalance[_nearest_node(positions, at)] += amount * np.exp(1j * phase)
    return replace(rotor, unbalance=unbalance)
