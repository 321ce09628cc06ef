"""The page's sentences, their numbers taken from the results."""

from __future__ import annotations

import math

from .claim import PERCENT, Verdict
from .figures import WALL_NAMES
from .frames import best_orientation, score_frames
from .paper import CLEARANCES, Walls, bush_cooling_area
from .results import ISOTHERMAL, LIQUID, THD, WHOLE, PaperResults
from .tables import HEADLINES, sensitivity, wall_rows, wall_superheat, wall_verdicts
from .variants import DESIGN

C100 = CLEARANCES[0]


def force_and_friction(r: PaperResults) -> list[str]:
    """The halved force, the friction that is not, and the two counts of the ruptured sector."""
    force = r.at("load", ISOTHERMAL, C100) / 1e3
    warm = r.at("load", THD, C100) / 1e3
    cold = {f: r.at("friction_force", ISOTHERMAL, C100, friction=f) for f in (LIQUID, WHOLE)}
    fall = {f: r.reduction("friction_force", C100, friction=f) for f in (LIQUID, WHOLE)}
    return [
        f"The printed film forces, 30 kN and 20 kN, stand against {force:.1f} and {warm:.1f} kN: "
        f"{30.0 / force:.2f} and {20.0 / warm:.2f} of any integral of the pressure over the full "
        "bearing, while their ratio (33 % less) fits. One axial half seems to have been "
        "integrated. The friction is not halved.",
        f"Friction over the whole ruptured sector, as in Eq. 17, is {cold[WHOLE]:.0f} N cold and "
        f"falls by {fall[WHOLE]:.1f} %; counted with the sector's liquid fraction, which is what "
        f"heats the oil, it is {cold[LIQUID]:.0f} N and falls by {fall[LIQUID]:.1f} %. Of the "
        f"paper's pair the first count is {abs(cold[WHOLE] - 640.0):.0f} N and "
        f"{abs(fall[WHOLE] - 45.0):.1f} points away, the second "
        f"{abs(cold[LIQUID] - 640.0):.0f} N and {abs(fall[LIQUID] - 45.0):.1f} points: the 640 N "
        "belong to the whole sector, the 45 % lie nearer to the liquid count. Both are in the "
        "claims.",
    ]


def frame_remark(r: PaperResults) -> list[str]:
    """Which frame meets the paper's statements."""
    scores = score_frames(r)
    load, best_fit = scores[0], min(scores, key=lambda s: s.table_2)
    total = len(load.statements)
    most = max(s.held for s in scores)
    leaders = "; ".join(s.frame.label for s in scores if s.held == most)
    centers = max(s.held for s in scores if s.frame.along_centers)
    anywhere, printed = best_orientation(r), best_orientation(r, as_printed=True)
    first = "kxy is the highest", "kyx is negative", "kyy is the lowest positive one"
    signs = [s.frame.label for s in scores if all(s.statements[name] for name in first)]
    verdict = (
        "So the statements can hold together, in axes that the paper does not name"
        if anywhere.held == total
        else "So no choice of axes makes all of them hold together"
    )
    return [
        "The text does not say along what x and y lie. Of the first eight candidates below, the "
        "statements on sign and order of the stiffnesses (kxy highest, kyx negative, kyy lowest of "
        f"the positive ones) hold together in: {'; '.join(signs) or 'none'}. Most of the {total} "
        f"statements, {most}, hold in: {leaders}. Frames along the line of centres reach "
        f"{centers}. Table 2 is nearest with: {best_fit.frame.label} ({best_fit.table_2:.1f} "
        f"points root mean square; {load.table_2:.1f} in the load frame).",
        "A search over every direction of x, from the load and from the line of centres, with both "
        f"hands and both orders of the indices, finds {anywhere.held} of {total} at best "
        f"({anywhere.frame.label}: {anywhere.table_2:.1f} points from Table 2, "
        f"{anywhere.table_3:.1f} from Table 3); with right-handed axes and the indices as printed "
        f"{printed.held} ({printed.frame.label}). {verdict}. A frame picked because it fits "
        "would prove nothing: all verdicts on single coefficients are given in the load frame, "
        "which is what a designer uses, and a contradiction there may be one of axes.",
    ]


def designer_remarks(r: PaperResults) -> list[str]:
    """What the walls do, and what to believe."""
    rows = {row.walls: row for row in wall_rows(r) if row.radial_clearance == C100}
    cold, bush, free = rows[Walls.AMBIENT], rows[Walls.CONDUCTION], rows[Walls.CONDUCTION_SHAFT]
    isothermal = r.at("critical_mass", ISOTHERMAL, C100)
    agree = {
        walls: sum(judged[walls].verdict is Verdict.AGREES for _, judged in wall_verdicts(r))
        for walls in Walls
    }
    total = len(wall_verdicts(r))
    design = {
        key: cell.value
        for row in sensitivity(r)
        if row.variant.key == DESIGN
        for key, cell in row.cells.items()
    }
    counts = ", ".join(f"{n} with {WALL_NAMES[w]}" for w, n in agree.items())
    share = 100.0 * (cold.to_bush + cold.to_shaft) / cold.friction_power
    return [
        "The paper describes bush conduction (250 W/mK) with convection to the air (80 W/m2K), "
        "and leaves the shaft's temperature open. Its numbers follow from something else: walls "
        f"held at ambient temperature. Of the {total} heated numbers below these agree: {counts}.",
        f"Walls at ambient temperature take {share:.0f} % of the friction power "
        f"({cold.friction_power / 1e3:.1f} kW) out of the film at c = 100 um and 15 000 rpm: "
        f"{cold.to_bush / 1e3:.1f} kW through the bush alone. With 80 W/m2K and "
        f"{bush_cooling_area():.3f} m2 of bush surface that would need a bush "
        f"{wall_superheat(cold):.0f} K above the air: it cannot stay cold. Solved for, the bush "
        f"takes {bush.to_bush / 1e3:.2f} kW, nearly as if it were insulated.",
        f"The film then reaches {bush.temperature:.0f} degC instead of {cold.temperature:.0f} "
        f"degC, and heating lowers the film force by {bush.force_reduction:.0f} % (shaft at "
        f"ambient temperature) to {free.force_reduction:.0f} % (shaft without net heat) instead "
        f"of {cold.force_reduction:.0f} %. The critical mass falls from {isothermal:.0f} kg "
        f"without heating to {min(bush.critical_mass, free.critical_mass):.0f} kg to "
        f"{max(bush.critical_mass, free.critical_mass):.0f} kg, not to {cold.critical_mass:.0f} "
        f"kg: a rotor between {max(bush.critical_mass, free.critical_mass):.0f} and "
        f"{cold.critical_mass:.0f} kg per bearing is stable by the paper's numbers and unstable "
        "by its own equations.",
        "A designer should take the bush with conduction and the shaft without net heat for an "
        "air-cooled bearing, and treat cold walls as the optimistic limit that only forced "
        "cooling of bush and shaft comes near. Fresh oil at the inlet is optimistic in both: with "
        f"recirculated oil mixed in, the film force falls by {design['force_reduction']:.0f} % and "
        f"the critical mass to {design['mass']:.0f} kg. The isothermal numbers "
        f"({isothermal:.0f} kg) are no guide at this speed.",
    ]


def sensitivity_remark(r: PaperResults) -> str:
    """What numerics and model move."""
    rows = {row.variant.key: row for row in sensitivity(r)}
    lowered = [line for line in HEADLINES if line.key.endswith("_reduction")]

    def largest(*keys: str) -> float:
        changes = [abs(rows[key].cells[line.key].change) for key in keys for line in lowered]
        return max((change for change in changes if math.isfinite(change)), default=math.nan)

    def points(*keys: str) -> str:
        change = largest(*keys)
        return (
            f"{change:.1f} points"
            if math.isfinite(change)
            else "an unknown number of points (not converged)"
        )

    lost = [row.variant.label for row in rows.values() if row.status != "converged"]
    left = f" Left out where it did not converge: {'; '.join(lost)}." if lost else ""
    mesh = largest("mesh_half", "mesh_double")
    verdict = (
        f"An agreement within {PERCENT.size:g} points is not an accident of the mesh; it is one "
        "with the walls and the inlet chosen."
        if mesh < PERCENT.size
        else "The mesh alone can make or break an agreement."
    )
    walls = points("bush_conduction", "bush_conduction_free_shaft", "insulated")
    return (
        "One choice changed at a time. The percentages by which heating lowers force, friction, "
        f"pressure, kxx, cxx and critical mass move by at most {points('mesh_half')} with half "
        f"the mesh, {points('mesh_double')} with twice the mesh, "
        f"{points('half_sommerfeld', 'full_sommerfeld', 'jfo')} with the cavitation model, "
        f"{points('free_inception')} with the inception, "
        f"{points('inlet_mixing', 'inlet_periodic')} with the inlet model, "
        f"{points('friction_whole')} with the count of the ruptured sector and {walls} "
        f"with the walls. {verdict}{left}"
    )
