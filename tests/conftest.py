"""Hypothesis profiles: quick without slow tests, one by default, a patient one for nightly runs."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

import rotorsim

# Programs started by tests take the same package: not what lies in the folder they start in.
os.environ["PYTHONSAFEPATH"] = "1"
# A shell starts what runs in its background deaf to interruptions, and so is what that starts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile(
    "ci", max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("nightly", parent=settings.get_profile("ci"), max_examples=2000)
settings.register_profile("quick", parent=settings.get_profile("ci"), max_examples=30)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))


def pytest_configure(config: pytest.Config) -> None:
    """Take fewer random examples where slow tests are left out."""
    if config.option.markexpr == "not slow" and "HYPOTHESIS_PROFILE" not in os.environ:
        settings.load_profile("quick")


def pytest_report_header() -> str:
    return f"rotorsim {rotorsim.__version__} from {Path(rotorsim.__file__).parent}"


@pytest.fixture(scope="session", autouse=True)
def _cache_of_the_tests_own(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep force maps in a folder of this session, shared by its workers; solve each film anew."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    os.environ.setdefault("ROTORSIM_CACHE", str(Path(folder) / "rotorsim-cache"))
    os.environ.setdefault("ROTORSIM_FRESH", "1")
