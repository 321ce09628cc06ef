"""`rotorsim explore`: a local page with sliders, and results that follow them.

Solutions and pictures are made in processes of their own; the page keeps the newest request of each
kind only. NiceGUI serves the page and all it needs from this machine.
"""

from __future__ import annotations

import asyncio
import contextlib
import multiprocessing
import socket
import tempfile
from concurrent.futures import Executor, ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..bearing.description import point_status, point_text
from ..errors import InputError, RotorsimError
from ..files.scenario import Scenario
from ..rows import QUANTITIES, RPM, number, show_units, table_html
from ..study.explore import Knob, knobs, point_of, speeds_about, table_over_speed, varied

_SHOWN = ("eccentricity_ratio", "min_film_thickness", "max_pressure", "max_temperature",
          "power_loss", "side_flow", "critical_mass", "whirl_frequency_ratio")  # fmt: skip
_SETTLED = 0.35
"""Seconds without a change after which the scenario's own mesh is taken."""
_STYLE = """
.nicegui-content { padding: 12px; }
.rotorsim table { border-collapse: collapse; width: 100%; font-size: 14px; }
.rotorsim th, .rotorsim td { padding: 2px 8px; text-align: left; border-bottom: 1px solid #8884; }
.rotorsim td:not(:first-child) { white-space: nowrap; }
.rotorsim .number { text-align: right; font-variant-numeric: tabular-nums; }
.rotorsim .good { color: #1b7a3d; font-weight: 600 }
.rotorsim .bad { color: #c0392b; font-weight: 600 }
.rotorsim, .rotorsim > div { min-width: 0; max-width: 100%; }
.rotorsim .stale { opacity: 0.4; }
.rotorsim .note { color: #c05621 } /* read on white and on black */
/* On a phone the results stay in sight while a slider moves. */
@media (max-width: 599px) {
  .entries { max-height: 36vh; overflow-y: auto; flex-wrap: nowrap; padding-right: 12px;
    max-width: none !important; }
}
.rotorsim svg { width: 100%; height: auto; background: #fff; border-radius: 6px; }
"""


def _point_outcome(text: str, units: str, fine: bool) -> dict[str, Any]:
    """Solve the scenario of `text`; return numbers, verdict and pictures, or what is wrong.

    Returns: ``rows`` (see `_Row`), ``verdicts``, ``notes``, ``pictures`` (SVG); or
        ``error``.
    """
    from .figures.bearing import bearing_drawing, film_profiles
    from .figures.style import figure_bytes, model_label

    show_units(units)
    try:
        scenario = Scenario.from_text(text, "the scenario")
        point, curves = point_of(scenario, fine)
    except RotorsimError as error:
        return {"error": str(error)}
    rows = [_row(name, point_text(point, name), getattr(point, name)) for name in _SHOWN]
    verdicts = []
    for curve in curves:
        if curve.growth_rate is None or not np.isfinite(curve.growth_rate[0]):
            continue
        rate, model = float(curve.growth_rate[0]), model_label(curve.choices["thermal_model"])
        label = f"{QUANTITIES['growth_rate'].label}, {model}"
        rows.append(_row("growth_rate", number(rate), rate, label))
        said = "unstable" if rate > 0.0 else "undamped" if rate == 0.0 else "stable"
        verdicts.append((f"verdict, {model}", said))
    pictures = []
    if point.fields is not None and point.converged:
        drawing = bearing_drawing(point, next(scenario.cases()).bearing)
        # Constrained layout draws everything twice; the drawing has nothing that needs it.
        drawing.set_layout_engine("none")
        drawing.axes[0].set_position((0.0, 0.1, 1.0, 0.9))
        pictures = [_svg(figure_bytes(drawing))]
        if fine:
            pictures.append(_svg(figure_bytes(film_profiles([point], size=(6.4, 2.8)))))
    notes = [point.message] if point.message else []
    status = "" if point.converged else point_status(point)
    return {"rows": rows, "verdicts": verdicts, "status": status, "pictures": pictures,
            "notes": [*notes, *point.warnings]}  # fmt: skip


_Row = tuple[str, str, str, str, float | None]
"""Label, text, unit, name in `QUANTITIES`, SI value (None: there is none, or not one alone)."""


def _row(name: str, text: str, value: float | None, label: str = "") -> _Row:
    """Return the row of a result; words have no unit."""
    quantity = QUANTITIES[name]
    unit = quantity.unit if text[-1:].isdigit() else ""
    return (label or quantity.label, text, unit, name, value)


def _compared(name: str, value: float | None, base: float | None) -> tuple[str, str]:
    """Return the baseline's text, and the change from it: in per cent, or in its unit.

    In its unit where a share says nothing: temperatures, and rates of either sign.

    value, base : SI.
    """
    if base is None:
        return ("", "")
    quantity = QUANTITIES[name]
    if value is None:
        return (quantity.text(base), "")
    change = value - base
    if quantity.offset or name == "growth_rate":
        unit = "K" if quantity.unit == "°C" else quantity.unit
        return (quantity.text(base), f"{change * quantity.factor:+.1f} {unit}")
    return (quantity.text(base), f"{100.0 * change / base:+.1f} %" if base else "")


def _map_outcome(text: str, units: str, fine: bool, speeds: list[float]) -> dict[str, Any]:
    """Solve over speed; return the threshold speeds in words and the stability map as SVG."""
    from ..study.main_job import map_of
    from .figures.map import stability_map
    from .figures.style import figure_bytes

    show_units(units)
    try:
        scenario = Scenario.from_text(text, "the scenario")
        table = table_over_speed(scenario, speeds, fine)
        rotor, here = scenario.rotor, float(scenario.speeds[-1])
        found = _thresholds(table, rotor)
        if rotor is not None and rotor.rigid_mass is None:
            figure = _growth(table, rotor, here)
        else:
            marks = None if rotor is None else {"here": (here, rotor.total_mass)}
            figure = stability_map(map_of(scenario, table).dataset.isel(radial_clearance=0),
                                   marks=marks)  # fmt: skip
    except RotorsimError as error:
        return {"error": str(error)}
    return {"thresholds": found, "pictures": [_svg(figure_bytes(figure))]}


def _thresholds(table: Any, rotor: Any) -> list[_Row]:
    """Return a row for each thermal model's thresholds."""
    from ..study.stability import stability_curves
    from .figures.style import model_label

    if rotor is None:
        return []
    quantity, rows = QUANTITIES["threshold_speed"], []
    for curve in stability_curves(table, rotor):
        speeds = [float(speed) for speed in curve.threshold_speeds]
        text = ", ".join(map(quantity.text, speeds)) or "none on the map"
        label = f"{quantity.label}, {model_label(curve.choices['thermal_model'])}"
        rows.append(_row("threshold_speed", text, speeds[0] if len(speeds) == 1 else None, label))
    return rows


def _growth(table: Any, rotor: Any, here: float) -> Any:
    """Return the figure of the growth rate over speed, for a rotor that is not rigid."""
    from ..study.stability import stability_curves
    from .figures.style import model_label, model_style, new_axes

    figure, axes = new_axes(1, 1, (6.6, 4.9))
    for curve in stability_curves(table, rotor):
        if curve.growth_rate is not None:
            name = curve.choices["thermal_model"]
            axes[0, 0].plot(
                curve.speed * RPM, curve.growth_rate, label=model_label(name), **model_style(name)
            )
    axes[0, 0].axhline(0.0, color="k", lw=1.0)
    axes[0, 0].axvline(here * RPM, color="0.5", lw=1.0)
    axes[0, 0].set(xlabel=QUANTITIES["speed"].axis, ylabel=QUANTITIES["growth_rate"].axis)
    axes[0, 0].legend()
    return figure


def _svg(data: bytes) -> str:
    text = data.decode()
    return text[text.index("<svg") :]


def _report(text: str, units: str, folder: str) -> str:
    from ..study.main_job import compute
    from ..study.sweep import as_table, sweep_points
    from .report import write_report

    show_units(units)
    scenario = Scenario.from_text(text, "explored.toml")
    speeds = speeds_about(scenario, 12)
    scenario = scenario.replace(**{"operating.speed": speeds})
    points = sweep_points(list(scenario.cases()), speeds, workers=1)
    results = compute(scenario, points, as_table(points, scenario))
    return str(write_report(results, Path(folder) / "report.html"))


def _ready(text: str) -> None:
    """Load and compile what the first request needs."""
    _point_outcome(text, "si", False)


class _Page:
    """One browser window: the values, and what follows them."""

    units = "si"
    """Of all windows: what is shown is one setting of the process."""

    def __init__(self, scenario: Scenario, pool: Executor) -> None:
        self.scenario, self.pool = scenario, pool
        self.knobs = knobs(scenario)
        self.values = {knob.path: knob.value for knob in self.knobs}
        self.version = 0
        self.moved = asyncio.Event()
        self.pinned: dict[str, float] = {}
        self.point: dict[str, Any] = {}
        self.chart: dict[str, Any] = {}
        self.tasks: list[asyncio.Task[None]] = []
        self.build()

    def build(self) -> None:
        from nicegui import context, ui

        ui.add_css(_STYLE)
        dark = ui.dark_mode(None)  # as the system's
        with ui.header().classes("items-center gap-4 py-2"):
            ui.label("rotorsim explore").classes("text-lg font-bold")
            ui.label(self.scenario.title).classes("ellipsis gt-xs")
            ui.space()
            ui.toggle(
                {"si": "SI", "us": "US"}, value=self.units, on_change=self.change_units
            ).props("toggle-color=white toggle-text-color=primary")
            ui.button("Pin as baseline", on_click=self.pin)
            ui.button("Save as TOML", on_click=self.save)
            ui.button("Report", on_click=self.report)
            ui.switch("Dark").props("color=grey-5").bind_value(dark, "value")
        with ui.row().classes("w-full items-start gap-6"):
            with ui.column().classes("entries gap-1").style("flex: 1 1 270px; max-width: 420px"):
                self.panel = ui.column().classes("w-full gap-1")
                self.fields()
            with ui.column().classes("rotorsim").style("flex: 1 1 340px; max-width: 560px"):
                self.state = ui.label("solving").classes("text-sm")
                self.table = ui.html("", sanitize=False).classes("w-full")
                self.notes = ui.html("", sanitize=False).classes("note text-sm")
                chart = ui.html("", sanitize=False).classes("w-full")
            with ui.column().classes("rotorsim").style("flex: 2 1 420px; max-width: 760px"):
                first, second = (ui.html("", sanitize=False).classes("w-full") for _ in range(2))
            self.pictures = [first, second, chart]
        loop = asyncio.get_running_loop()
        self.tasks = [loop.create_task(job) for job in (self.follow(), self.follow_map())]
        context.client.on_disconnect(lambda: [task.cancel() for task in self.tasks])

    def fields(self) -> None:
        """Build a slider and a number for each entry, in the units shown."""
        from nicegui import ui

        self.panel.clear()
        with self.panel:
            for knob in self.knobs:
                shown = knob.shown(self.values[knob.path])
                low, high = knob.shown(knob.low), knob.shown(knob.high)
                step = float(f"{(high - low) / 200:.1g}")
                ui.label(knob.label).classes("text-sm mt-1")
                with ui.row().classes("w-full items-center no-wrap gap-3"):
                    field = ui.number(
                        value=float(f"{shown:.5g}"),
                        step=step,
                        format="%.5g",
                        suffix=knob.unit,
                        on_change=partial(self.change, knob),
                    )
                    name = f'aria-label="{knob.label}"'
                    field.classes("w-32 shrink-0").props(f"dense outlined {name}")
                    slider = ui.slider(min=low, max=high, step=step, value=shown).props(name)
                    slider.bind_value(field, "value")

    def change(self, knob: Knob, event: Any) -> None:
        """Take a value over."""
        if event.value is not None:
            self.values[knob.path] = knob.taken(float(event.value))
            self.version += 1
            self.moved.set()

    def change_units(self, event: Any) -> None:
        """Show everything in other units."""
        _Page.units = event.value
        show_units(event.value)
        self.fields()
        self.version += 1
        self.moved.set()

    def text(self) -> str:
        """Return the text of the scenario as it stands."""
        changed = {knob: self.values[knob.path] for knob in self.knobs
                   if self.values[knob.path] != knob.value or knob.path[-1] in _ALWAYS}  # fmt: skip
        return varied(self.scenario, changed).text

    async def asked(self, job: Any, *options: Any) -> tuple[int, dict[str, Any]]:
        """Answer of a process to the present values, and their version."""
        version, units = self.version, self.units
        try:
            text = self.text()
        except InputError as error:
            return version, {"error": str(error)}
        loop = asyncio.get_running_loop()
        call = partial(job, text, units, *options)
        return version, await loop.run_in_executor(self.pool, call)

    async def follow(self) -> None:
        """Solve the point coarsely while values change, and in full when they rest."""
        while True:
            self.moved.clear()
            version, self.point = await self.asked(_point_outcome, False)
            self.show("coarse mesh")
            if not await self.rested(version):
                continue
            fine = asyncio.create_task(self.asked(_point_outcome, True))
            moved = asyncio.create_task(self.moved.wait())
            await asyncio.wait({fine, moved}, return_when=asyncio.FIRST_COMPLETED)
            if fine.done():
                self.point = fine.result()[1]
                self.show("the scenario's mesh")
                await moved
            else:
                fine.cancel()

    async def follow_map(self) -> None:
        """Draw the map on the coarse mesh at every rest, then on the scenario's own."""
        seen = -1
        while True:
            if seen == self.version:
                await asyncio.sleep(0.05)
                continue
            seen, self.chart = await self.asked(_map_outcome, False, self.speeds())
            self.show_map()
            if not await self.rested(seen):
                continue
            version, chart = await self.asked(_map_outcome, True, self.speeds())
            if version == self.version:
                self.chart = chart
                self.show_map()

    def speeds(self) -> list[float]:
        """Return the speeds of the map, past the present one [rad/s]."""
        speeds, here = speeds_about(self.scenario, 9), self.values["operating", "speed"] / RPM
        return [float(speed) for speed in np.linspace(speeds[0], max(speeds[-1], 1.1 * here), 9)]

    async def rested(self, version: int) -> bool:
        """Wait a moment; return whether nothing has changed."""
        await asyncio.sleep(_SETTLED)
        return version == self.version

    def show(self, mesh: str) -> None:
        """Put numbers, verdict and pictures of the point in place."""
        point = self.point
        wrong = point.get("error", "")
        self.state.set_text(wrong or f"{point['status'] or 'converged'} on {mesh}")
        # What is still shown belongs to the values before.
        for place, name in [(self.state, "bad"), (self.table, "stale"), (self.notes, "stale")]:
            place.classes(add=name if wrong else "", remove="" if wrong else name)
        if wrong:
            return
        head, results = ["", "now", ""], self.rows()
        rows = [row[:3] for row in results]
        if self.pinned:
            head += ["baseline", "change"]
            rows = [(*row[:3], *_compared(*row[3:], self.pinned.get(row[0]))) for row in results]
        rows = [(*verdict, *[""] * (len(head) - 2)) for verdict in point["verdicts"]] + rows
        self.table.set_content(table_html(head, rows, texts=1))
        self.notes.set_content("".join(f"<p>{_escaped(note)}</p>" for note in point["notes"]))
        for place, picture in zip(self.pictures[:2], point["pictures"], strict=False):
            place.set_content(picture)

    def show_map(self) -> None:
        """Put the map in place, and the threshold speeds into the table."""
        if "error" not in self.chart:
            self.pictures[2].set_content(self.chart["pictures"][0])
            if self.point:
                self.show(self.state.text.partition(" on ")[2])

    def rows(self) -> list[_Row]:
        """Return the results shown: of the point, and what the map adds."""
        return [*self.point.get("rows", ()), *self.chart.get("thresholds", ())]

    def pin(self) -> None:
        """Keep the present numbers beside the coming ones."""
        self.pinned = {label: value for label, _, _, _, value in self.rows() if value is not None}
        self.show(self.state.text.partition(" on ")[2])

    def save(self) -> None:
        """Offer the scenario as a file for download."""
        from nicegui import ui

        try:
            ui.download.content(self.text(), "explored.toml")
        except InputError as error:
            ui.notify(str(error), type="negative")

    async def report(self) -> None:
        """Write the report of the present values and hand it over."""
        from nicegui import ui

        ui.notify("The report is being computed.")
        with tempfile.TemporaryDirectory() as folder:
            loop = asyncio.get_running_loop()
            try:
                path = await loop.run_in_executor(
                    self.pool, partial(_report, self.text(), self.units, folder)
                )
            except RotorsimError as error:
                ui.notify(str(error), type="negative")
                return
            ui.download.content(Path(path).read_text(encoding="utf-8"), "report.html")


_ALWAYS = ("speed", "radial_clearance")
"""Entries that may be lists in the file: the page has one value."""


def _escaped(text: str) -> str:
    from html import escape

    return escape(text)


def serve(scenario: Scenario, *, port: int = 8090, units: str = "si", browser: bool = True) -> None:
    """Serve the page at 127.0.0.1 until interrupted.

    scenario : Where the values begin.
    units : ``si`` or ``us`` at first.
    browser : Open the page in the user's browser.
    Raises InputError: NiceGUI is not installed, or something else is served at the port.
    """
    try:
        from nicegui import app, ui
    except ModuleNotFoundError:
        raise InputError(
            'needs NiceGUI: python -m pip install "rotorsim[explore]"', key="explore"
        ) from None

    with socket.socket() as trial:
        if trial.connect_ex(("127.0.0.1", port)) == 0:
            raise InputError("is in use; try another one", key="--port", value=port)
    show_units(units)
    _Page.units = units
    pool = ProcessPoolExecutor(2, multiprocessing.get_context("spawn"), _ready, (scenario.text,))
    for _ in range(2):
        pool.submit(int)

    def page() -> None:
        _Page(scenario, pool)

    app.on_shutdown(lambda: pool.shutdown(wait=False, cancel_futures=True))
    ui.page("/", title=f"rotorsim: {scenario.title}")(page)
    with contextlib.suppress(KeyboardInterrupt):
        ui.run(host="127.0.0.1", port=port, show=browser, reload=False, show_welcome_message=False,
               title="rotorsim")  # fmt: skip
