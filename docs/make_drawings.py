"""Draw the frames of `conventions.md` and the theory pages: python docs/make_drawings.py."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle

FOLDER = Path(__file__).parent / "images" / "conventions"
SOLID, METAL, FILM, FORCE = "#e4e4e4", "#b8b8b8", "#9ec5de", "#b22222"


def place(radius: float | np.ndarray, angle: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a point of the picture at an angle of the load frame: x down, y to the right."""
    return radius * np.sin(angle), -radius * np.cos(angle)


def arrow(ax: Axes, start: tuple, end: tuple, color: str = "k", style: str = "-|>") -> None:
    """Draw an arrow from `start` to `end`."""
    look = {"arrowstyle": style, "color": color, "lw": 1.3, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", end, start, arrowprops=look)


def sweep(ax: Axes, radius: float, first: float, last: float, text: str, at: float = 0.5) -> None:
    """Draw an angle from `first` to `last` [deg] with its name."""
    angle = np.radians(np.linspace(first, last, 60))
    ax.plot(*place(radius, angle), "k", lw=1.0)
    arrow(ax, place(radius, angle[-3]), place(radius, angle[-1]))
    ax.text(*place(radius * 1.13, angle[int(59 * at)]), text, ha="center", va="center", size=11)


def load_frame(ax: Axes) -> None:
    """Draw journal, bush, load, axes, attitude angle and film thickness."""
    turn = np.linspace(0.0, 2.0 * math.pi, 361)
    ax.add_patch(Circle((0, 0), 1.55, fc=METAL, ec="k"))
    ax.add_patch(Circle((0, 0), 1.25, fc=FILM, ec="k"))
    centre = place(0.16, math.radians(52.0))
    ax.add_patch(Circle(centre, 1.0, fc=SOLID, ec="k"))
    ax.plot(*place(1.25, turn), "k", lw=1.2)
    for angle, name in ((0.0, "$x$, load line"), (90.0, "$y$")):
        tip = place(2.0, math.radians(angle))
        arrow(ax, (0, 0), tip)
        ax.text(*place(2.12 if angle else 2.1, math.radians(angle)), name, ha="center", va="center")
    arrow(ax, centre, (centre[0], centre[1] - 0.75), FORCE)
    ax.text(centre[0] + 0.07, centre[1] - 0.6, "$W$", color=FORCE, ha="left")
    ax.plot(0, 0, "k+", ms=9)
    ax.plot(*centre, "ko", ms=4)
    sweep(ax, 0.45, 0.0, 52.0, "$\\varphi$")
    ax.plot(*np.transpose([(0, 0), place(0.6, math.radians(52.0))]), "k:", lw=1.0)
    sweep(ax, 1.75, 0.0, 130.0, "$\\theta$", at=0.6)
    sweep(ax, 0.8, 190.0, 300.0, "$\\omega$")
    angle = math.radians(130.0)
    inner, outer = place(1.02, angle), place(1.25, angle)
    arrow(ax, inner, outer, style="<|-|>")
    ax.text(*place(1.4, math.radians(136.0)), "$h$", ha="center", va="center", size=11)
    ax.set(xlim=(-1.9, 2.4), ylim=(-2.35, 1.75))


def pad_frame(ax: Axes) -> None:
    """Draw one pad: pivot angle, offset, tilt."""
    first, last, pivot = 55.0, 125.0, 94.0
    angle = np.radians(np.linspace(first, last, 60))
    face, back = place(1.25, angle), place(1.6, angle)
    outline = np.column_stack(
        [np.append(face[0], back[0][::-1]), np.append(face[1], back[1][::-1])]
    )
    ax.add_patch(Polygon(outline, fc=METAL, ec="k"))
    ax.add_patch(Circle((0, 0), 1.0, fc=SOLID, ec="k"))
    tip = place(1.6, math.radians(pivot))
    low, high = place(1.78, math.radians(pivot - 4)), place(1.78, math.radians(pivot + 4))
    ax.add_patch(Polygon([tip, low, high], fc="w", ec="k"))
    arrow(ax, (0, 0), place(1.95, 0.0))
    ax.text(*place(2.07, 0.0), "$x$, load line", ha="center", va="center")
    sweep(ax, 0.7, 0.0, pivot, "$\\theta_p$")
    ax.plot(*np.transpose([(0, 0), tip]), "k:", lw=1.0)
    sweep(ax, 1.95, pivot - 20, pivot + 20, "$\\delta$", at=0.75)
    for name, at, side in (("leading edge", first, "top"), ("trailing edge", last, "bottom")):
        ax.text(*place(1.66, math.radians(at)), name, size=9, ha="left", va=side)
    sweep(ax, 0.8, 190.0, 300.0, "$\\omega$")
    ax.set(xlim=(-1.2, 2.6), ylim=(-2.2, 1.5))


def rotor_frame(ax: Axes) -> None:
    """Draw the axes along a rotor, seen from the side, and a probe's angle seen from the left."""
    for left, width, half in ((0.0, 0.8, 0.18), (0.8, 2.4, 0.28), (3.2, 0.8, 0.18)):
        ax.add_patch(Rectangle((left, -half), width, 2 * half, fc=SOLID, ec="k"))
    ax.add_patch(Rectangle((1.9, -0.85), 0.3, 1.7, fc=METAL, ec="k"))
    for at in (0.45, 3.55):
        ax.add_patch(Polygon([(at, -0.18), (at - 0.14, -0.45), (at + 0.14, -0.45)], fc="w", ec="k"))
    ax.plot([-0.2, 4.3], [0, 0], "k-.", lw=0.7)
    arrow(ax, (0.0, 1.2), (0.9, 1.2))
    ax.text(0.95, 1.2, "at, counted from the left end", va="center", size=9)
    arrow(ax, (2.05, 0.0), (2.05, -1.25))
    ax.text(2.12, -1.25, "$x$, load", va="center", size=9)
    arrow(ax, (3.9, 0.0), (4.35, 0.0))
    ax.text(4.35, 0.1, "$z$", size=10)
    centre = np.array([6.2, 0.0])
    ax.add_patch(Circle(centre, 0.6, fc=SOLID, ec="k"))
    angle = np.radians(np.linspace(0.0, 135.0, 60))
    # Seen along z: y lies 90 degrees ahead of x in the direction of rotation.
    across, up = -np.sin(angle), -np.cos(angle)
    ax.plot(centre[0] + 0.95 * across, centre[1] + 0.95 * up, "k", lw=1.0)
    way = [np.array([across[k], up[k]]) for k in (-3, -1)]
    arrow(ax, tuple(centre + 0.95 * way[0]), tuple(centre + 0.95 * way[1]))
    arrow(ax, tuple(centre), (6.2, -1.25))
    ax.text(6.27, -1.25, "$x$", va="center")
    arrow(ax, tuple(centre), (4.9, 0.0))
    ax.text(4.85, -0.2, "$y$", va="center")
    arrow(ax, tuple(centre + 1.4 * way[1]), tuple(centre + 0.6 * way[1]), "#0072B2")
    ax.text(*(centre + 1.45 * way[1]), "probe at 135°  ", color="#0072B2", size=9, ha="right")
    turn = np.radians(np.linspace(200.0, 320.0, 40))
    spin = centre[:, None] + 0.4 * np.stack([-np.sin(turn), -np.cos(turn)])
    ax.plot(*spin, "k", lw=1.0)
    arrow(ax, tuple(spin[:, -3]), tuple(spin[:, -1]))
    ax.text(6.2, 1.25, "seen from the left, turning clockwise", size=9, ha="center")
    ax.set(xlim=(-0.4, 7.9), ylim=(-1.5, 1.5))


def main() -> None:
    """Write all drawings."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    mpl.rcParams["mathtext.fontset"] = "stix"
    sizes = {load_frame: (4.6, 4.4), pad_frame: (4.4, 4.2), rotor_frame: (8.4, 3.2)}
    for draw, size in sizes.items():
        figure = Figure(figsize=size, dpi=130)
        ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        draw(ax)
        ax.set_aspect("equal")
        ax.set_axis_off()
        figure.savefig(FOLDER / f"{draw.__name__}.png", facecolor="w")


if __name__ == "__main__":
    main()
