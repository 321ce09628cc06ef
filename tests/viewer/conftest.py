"""A recording with realistic contents (short bearing, closed form), a viewer without a screen."""

from __future__ import annotations

import io
import os
import socket
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from PIL import Image
from sample_results import campbell_of, chart_of, orbit_of
from scipy.linalg import expm

from rotorsim.orbit import Orbit
from rotorsim.show.recording import RecordingContents, write_recording
from rotorsim.show.viewer import viewer_program
from rotorsim.study.orbits import FilmFrame

R, L, C, MU, ECC = 0.05, 0.08, 100e-6, 0.0277, 0.5
PHI = np.arctan2(np.pi * np.sqrt(1 - ECC**2), 4 * ECC)
CENTRE = ECC * C * np.array([np.cos(PHI), np.sin(PHI)])
MASS = 6000.0
SPEEDS = np.linspace(500, 15000, 30) * np.pi / 30
MODELS = ("isothermal", "thd")


def viscosity(model: str, speed: np.ndarray | float) -> np.ndarray | float:
    return MU * (np.exp(-0.55 * np.asarray(speed) / SPEEDS[-1]) if model == "thd" else 1.0)


def load(model: str, speed: float) -> float:
    shape = ECC / (1 - ECC**2) ** 2 * np.sqrt(16 * ECC**2 + np.pi**2 * (1 - ECC**2))
    return viscosity(model, speed) * speed * R * L * (L / C) ** 2 / 4 * shape


def coefficients(model: str, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Short bearing, half Sommerfeld (closed form), x along the load."""
    e, p = ECC, np.pi**2
    q = 1.0 / (p * (1 - e**2) + 16 * e**2) ** 1.5
    root = np.sqrt(1 - e**2)
    big = p + (32 + p) * e**2 + 2 * (16 - p) * e**4
    k = np.array(
        [
            [4 * q * big / (1 - e**2), np.pi * q * big / (e * root)],
            [
                -np.pi * q * (p - 2 * p * e**2 - (16 - p) * e**4) / (e * root),
                4 * q * (2 * p + (16 - p) * e**2),
            ],
        ]
    )
    cross = -8 * q * (p + 2 * (p - 8) * e**2)
    c = np.array(
        [
            [2 * np.pi * q * (p + 2 * (24 - p) * e**2 + p * e**4) / (e * root), cross],
            [cross, 2 * np.pi * q * root * (p + 2 * (p - 8) * e**2) / e],
        ]
    )
    w = load(model, speed)
    return k * w / C, c * w / (C * speed)


def system(model: str, speed: float, mass: float) -> np.ndarray:
    k, c = coefficients(model, speed)
    return np.block([[np.zeros((2, 2)), np.eye(2)], [-k / mass, -c / mass]])


def eigenvalues(model: str, mass: float) -> np.ndarray:
    rows = []
    for speed in SPEEDS:
        values = np.linalg.eigvals(system(model, speed, mass))
        if rows:  # match the previous row, so that columns are branches
            order = [int(np.abs(values - old).argmin()) for old in rows[-1]]
            values = values[order] if len(set(order)) == 4 else values
        rows.append(values)
    return np.array(rows)


def orbit(model: str, speed: float, revolutions: float = 60.0, per_turn: int = 100) -> Orbit:
    count = int(revolutions * per_turn) + 1
    t = np.linspace(0.0, revolutions * 2 * np.pi / speed, count)
    step = expm(system(model, speed, MASS) * (t[1] - t[0]))
    state = np.array([0.02 * C, 0.0, 0.0, 0.0])
    states = np.empty((count, 4))
    for i in range(count):
        states[i] = state
        state = step @ state
    k, c = coefficients(model, speed)
    force = -(states[:, :2] @ k.T + states[:, 2:] @ c.T) - np.array([load(model, speed), 0.0])
    return orbit_of(
        t, CENTRE[0] + states[:, 0], CENTRE[1] + states[:, 1], speed, radial_clearance=C,
        thermal_model=model, equilibrium=(float(CENTRE[0]), float(CENTRE[1])), fx=force[:, 0],
        fy=force[:, 1], samples_per_revolution=per_turn,
    )  # fmt: skip


def film(model: str, speed: float) -> FilmFrame:
    n, m = 156, 48
    theta = PHI + np.pi + (np.arange(n) + 0.5) * 2 * np.pi / n
    y = (np.arange(m) + 0.5) * L / m - L / 2
    a = theta - PHI - np.pi
    mu = viscosity(model, speed)
    wave = np.clip(ECC * np.sin(a) / (1 + ECC * np.cos(a)) ** 3, 0, None)
    pressure = 3 * mu * speed / C**2 * wave[:, None] * (L**2 / 4 - y**2)
    rise = 45.0 * speed / SPEEDS[-1] * np.where(a < 3.6, np.sin(a / 2.3) ** 2, 0.35)
    temperature = 313.15 + rise[:, None] * (1 - 0.3 * (2 * y / L) ** 2)
    warm = model == "thd"
    return FilmFrame(
        model, speed, theta, y, pressure, temperature if warm else None,
        float(temperature.max()) + 5.0 if warm else None, R, C, CENTRE,
    )  # fmt: skip


def stability_chart() -> xr.Dataset:
    mass = np.linspace(50, 12000, 60)
    growth = {
        model: np.array(
            [[np.linalg.eigvals(system(model, s, m)).real.max() for m in mass] for s in SPEEDS]
        )
        for model in MODELS
    }
    return chart_of(SPEEDS, mass, growth, ("speed", "mass"))


def sample_contents() -> RecordingContents:
    speed = 10000 * np.pi / 30
    curves = []
    for model in MODELS:
        values = eigenvalues(model, MASS)
        growth = values.real.max(axis=1)
        crossing = np.flatnonzero((growth[:-1] < 0) & (growth[1:] >= 0))
        thresholds = ()
        if crossing.size:
            i = crossing[0]
            weight = -growth[i] / (growth[i + 1] - growth[i])
            at = float(SPEEDS[i] + weight * (SPEEDS[i + 1] - SPEEDS[i]))
            now = values[i][values[i].real.argmax()]
            thresholds = ((at, float(abs(now.imag))),)
        curves.append(campbell_of(SPEEDS, values, model, thresholds=thresholds))
    return RecordingContents(
        title="Short bearing: heating decides",
        summary=(
            "At **10 000 rpm** with a rotor of **6000 kg** per bearing:\n\n"
            "| model | eigenvalue | motion |\n|---|---|---|\n"
            "| isothermal | -3.1 1/s | decays |\n| THD | +4.2 1/s | **grows** |\n\n"
            "Neglecting the oil's heating calls this rotor stable. It is not.\n"
        ),
        orbits=tuple(orbit(model, speed) for model in MODELS),
        films=tuple(film(model, s) for model in MODELS for s in SPEEDS),
        modes=tuple(curves),
        maps=(stability_chart(),),
        rotor_mass=MASS,
    )


class HeadlessViewer:
    """The wheel's own viewer, drawing on the CPU, reachable from this machine only.

    It opens one file; without one it waits for what is sent to its `port`.
    """

    def __init__(self, recording: Path | None, folder: Path) -> None:
        program = str(viewer_program())
        environment = dict(
            os.environ,
            WGPU_BACKEND="vulkan",
            VK_ICD_FILENAMES=str(software_driver()),
            XDG_RUNTIME_DIR=str(folder),
            HOME=str(folder),
        )
        # In a home folder of its own: no user's settings are read or changed.
        subprocess.run(
            [program, "analytics", "disable"], env=environment, capture_output=True, check=True
        )
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        command = [program, "--headless", "--bind", "127.0.0.1", "--port", str(self.port)]
        command += [] if recording is None else [str(recording)]
        command += ["--memory-limit", "2GB", "--window-size", "1280x800"]
        self._shown: dict[str, str] = {}
        self.output = (folder / "viewer.log").open("w")
        self.process = subprocess.Popen(
            command, env=environment, stdout=self.output, stderr=self.output
        )
        try:
            self.wait_until_loaded(empty=recording is None)
        except BaseException:
            self.close()
            raise

    def wait_until_loaded(self, empty: bool = False, seconds: float = 60.0) -> None:
        """Wait for a recording with timelines; `empty`: for the viewer alone."""
        from rerun.experimental import ViewerClient

        address = f"rerun+http://127.0.0.1:{self.port}/proxy"
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            assert self.process.poll() is None, "the viewer ended"
            try:
                self.client = ViewerClient.connect(address)
                state = self.client.get_state()
            except Exception:  # not listening yet; the deadline decides
                time.sleep(0.2)
                continue
            if empty:
                return
            if state.recordings and state.recordings[0].timelines and not state.loading:
                return
            time.sleep(0.2)
        raise AssertionError("the viewer did not load the recording in time")

    def shown(self) -> dict[str, str]:
        """Names and ids of the views on the page in front (the viewer lists all pages' views)."""
        found = self._shown
        if found:
            return found
        for view in self.client.get_state().views:
            try:
                self.client.take_screenshot(view_id=view.view_id)
            except ConnectionError as problem:
                if "NotFound" not in str(problem):
                    raise
                continue
            found[view.name] = view.view_id
        return found

    def picture(self, name: str, alike: int = 4, seconds: float = 30.0) -> np.ndarray:
        """Pixels (rows, columns, 3) of a view once several pictures running are the same."""
        view_id = next(view for title, view in self.shown().items() if title.startswith(name))
        deadline, last, count = time.monotonic() + seconds, b"", 0
        while count < alike:
            assert time.monotonic() < deadline, "the view did not settle"
            png = self.client.take_screenshot(view_id=view_id)
            count = count + 1 if png == last else 0
            last = png
            time.sleep(0.1)
        with Image.open(io.BytesIO(last)) as image:
            return np.asarray(image.convert("RGB")).astype(int)

    def close(self) -> None:
        self.process.terminate()
        self.process.wait(20)
        self.output.close()


def software_driver() -> Path | None:
    """Mesa's Vulkan driver that draws on the CPU."""
    found = sorted(Path("/usr/share/vulkan/icd.d").glob("lvp_icd*.json"))
    return found[0] if found else None


@pytest.fixture(scope="session")
def contents() -> RecordingContents:
    return sample_contents()


@pytest.fixture
def open_viewer(tmp_path):
    """Start a viewer on a recording, or an empty one."""
    if software_driver() is None:
        pytest.skip("no Vulkan driver for the CPU (Debian: mesa-vulkan-drivers)")
    if viewer_program() is None:
        pytest.skip("the rerun-sdk wheel has no viewer here")
    opened = []

    def opener(path: Path | None = None) -> HeadlessViewer:
        opened.append(HeadlessViewer(path, tmp_path))
        return opened[-1]

    yield opener
    for viewer in opened:
        viewer.close()


@pytest.fixture
def open_page(contents, open_viewer, tmp_path):
    """Write the sample with one page in front, and open it."""

    def opener(page: str) -> HeadlessViewer:
        return open_viewer(write_recording(tmp_path / "sample.rrd", contents, page=page))

    return opener
