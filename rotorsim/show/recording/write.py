"""From contents to a file that opens laid out."""

from __future__ import annotations

from pathlib import Path

import rerun as rr

from ...atomic import replacing
from ...errors import InputError
from ...orbit.analysis import once_per_turn
from ...text import markdown
from .charts import send_eigenvalues, send_operating_point
from .contents import RecordingContents
from .film_view import log_films
from .layout import layout
from .orbit_view import log_orbit
from .runs import SAMPLE_LIMIT
from .series_view import log_series

APPLICATION = "rotorsim"


def write_recording(
    path: str | Path, contents: RecordingContents, *, page: str = "Overview"
) -> Path:
    """Write a recording for the rerun viewer.

    path : str or Path. Ends in ``.rrd``, usually ``logs/NAME.rrd``; missing folders are made. An
        existing file is replaced only once the new one is whole.
    page : The page shown first, one of `rotorsim.show.recording.layout`.
    Returns: The file written.
    Raises InputError: The path does not end in ``.rrd``.

    Nothing is sent anywhere: the stream writes to the file alone. Two identical runs give files
    that differ in their time stamps only (``rerun rrd compare --unordered`` says so).
    """
    target = Path(path)
    if target.suffix.lower() != ".rrd" or not target.name:
        raise InputError(
            "a recording's name must end in .rrd, for example logs/dal.rrd", key="path", value=path
        )
    # A fresh identity each time: a viewer that still shows the old file would mix the two.
    stream = rr.RecordingStream(APPLICATION, send_properties=False)
    with replacing(target) as temporary:
        with stream:
            stream.save(temporary, default_blueprint=layout(contents, page))
            log_contents(stream, contents)
        stream.disconnect()
    return target


def log_contents(stream: rr.RecordingStream, contents: RecordingContents) -> None:
    """Write everything to an open stream (a file's, or a running viewer's)."""
    text = f"# {markdown(contents.title)}\n\n{contents.summary}{_notes(contents)}"
    stream.log("summary", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
    for run in contents.runs:
        log_orbit(stream, run)
        log_series(stream, run)
    if contents.films:
        log_films(stream, contents.films, contents.runs)
    plane = contents.eigenvalue_chart
    for chart in (*contents.map_charts, plane, *contents.cascade_charts, contents.spectrum_chart):
        if chart is not None:
            chart.log(stream)
    if plane is not None:
        send_eigenvalues(stream, plane, contents.modes, contents.runs)
    for chart, one in zip(contents.map_charts, contents.maps, strict=True):
        speeds = one["speed"].values
        send_operating_point(stream, chart, speeds, contents.rotor_mass, contents.runs)


def _notes(contents: RecordingContents) -> str:
    lines = [
        "",
        "## How to read it",
        "- Timelines: `time` [s], `milli-revolutions` (1000 is one turn of the shaft) and"
        " `speed_rpm` (film and eigenvalues from speed to speed).",
        "- Orbits: x along the load, y 90 degrees ahead in the direction of rotation"
        " (counter-clockwise); at the white line the journal touches the bush.",
        "- Bearing: true proportions but for the clearance, whose exaggeration is written there;"
        " the film's height is its pressure, or its temperature: the mean across the film, whose"
        " hottest place the caption gives, too.",
    ]
    if any(once_per_turn(orbit) is not None for orbit in contents.orbits):
        lines.append("- Red points: the journal once per turn of the shaft, in the steady part.")
    if any(film.time is not None for film in contents.films):
        lines.append(
            "- The film follows the journal in the first and the last turns; between them it is"
            " shown at some whole turns of the shaft. Its caption says when."
        )
    thinned = [run.heading for run in contents.runs if run.samples > SAMPLE_LIMIT]
    if thinned:
        lines.append(
            f"- More than {SAMPLE_LIMIT:,} samples, thinned evenly here: {', '.join(thinned)}."
        )
    return "\n".join(["", *lines])
