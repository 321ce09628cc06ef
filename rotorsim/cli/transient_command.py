"""The command `transient`: heat in time."""

from __future__ import annotations

from pathlib import Path

from .options import OutputFolder, ScenarioArgument
from .output import DONE, INCOMPLETE, Output

_MOST_ROWS = 24


def transient(output: Output, scenario: ScenarioArgument, folder: OutputFolder = Path()) -> int:
    r"""Let shaft and bush warm up in time, as \[transient] says: clearance, film, stability.

    Example: rotorsim transient warming.toml
    """
    import numpy as np

    from ..files.scenario import load_scenario
    from ..rows import QUANTITIES, heads
    from ..show.figures import transient_plot
    from ..show.job import record_transient, save_figures
    from ..study.transient import simulate_transient
    from .tables import grid

    loaded = load_scenario(scenario)
    found = simulate_transient(
        loaded, keep_fields=True, progress=lambda step: output.note(f"{step.time:.4g} s")
    )
    figure = transient_plot(found, loaded.title)
    files = save_figures([("transient", figure)], folder / "figures" / scenario.stem, ("png",))
    files.append(
        record_transient(found, loaded, folder / "logs" / f"{scenario.stem}-transient.rrd")
    )
    output.document(found.describe() | {"files": files})
    if not (output.json or output.quiet):
        celsius, micro = QUANTITIES["max_temperature"], QUANTITIES["radial_clearance"]
        table = grid(
            loaded.title,
            *heads("s", "rpm", "shaft °C", "bush °C", "hottest °C", "c µm", "h_min µm"),
            "growth 1/s",
        )  # fmt: skip
        count = len(found.steps)
        rows = np.unique(np.linspace(0, count - 1, min(count, _MOST_ROWS)).round().astype(int))
        for k in sorted({*rows.tolist(), *found.moments().values()}):
            point = found.points[k]
            table.add_row(
                f"{found.time[k]:.4g}", QUANTITIES["speed"].text(point.speed),
                celsius.text(float(found.shaft_temperature[k])),
                celsius.text(float(found.bush_temperature[k])),
                celsius.text(point.max_temperature), micro.text(float(found.clearance[k])),
                micro.text(point.min_film_thickness), f"{found.growth_rate[k]:.4g}",
            )  # fmt: skip
        output.show(table, found.verdict(), *(str(path) for path in files))
    return DONE if found.converged else INCOMPLETE
