"""The documentation: builds without a warning, asks nobody for anything, and is true.

Every page with code is executed; what it shows as output is compared with what it prints. The
tables of scenario keys and public names are held against the program.
"""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from enum import Enum
from pathlib import Path
from types import ModuleType

import pytest

import rotorsim
from rotorsim.files.machine import MachineFile
from rotorsim.files.scenario import Scenario
from rotorsim.files.scenario.reader import makers_of, tables_of
from rotorsim.model.entries import Entry, entries
from rotorsim.status import SolveStatus, Stability

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted(
    page
    for page in DOCS.glob("**/*.md")
    if page.relative_to(DOCS).parts[0] not in {"_build", "_generated", "data", "validation"}
)
EXECUTED = [
    page for page in PAGES if re.search(r"^```(python|console)$", page.read_text("utf-8"), re.M)
]
LARGEST_IMAGE = 150_000
"""Bytes."""


def runner() -> ModuleType:
    """The script that executes pages."""
    spec = importlib.util.spec_from_file_location("run_page", DOCS / "run_page.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["run_page"] = module
    spec.loader.exec_module(module)
    return module


run_page = runner()


@pytest.mark.slow
@pytest.mark.parametrize("page", EXECUTED, ids=lambda page: page.stem)
def test_page_does_what_it_shows(page, tmp_path, monkeypatch):
    for name, value in run_page.LIKE_A_TERMINAL.items():
        monkeypatch.setenv(name, value)
    monkeypatch.syspath_prepend(str(DOCS.parent))
    monkeypatch.chdir(tmp_path)
    assert run_page.differences(page) == []


def test_the_three_tutorials_are_executed():
    assert len([page for page in EXECUTED if page.parent.name == "tutorials"]) >= 3


@pytest.mark.parametrize(
    ("found", "shown", "same"),
    [
        ("load 10.01 kN\n", "load 10.0 kN\n", True),
        ("load 10.5 kN\n", "load 10.0 kN\n", False),
        ("load 10.0 N\n", "load 10.0 kN\n", False),
        ("a 1\nb 2\nc 3\n", "a 1\n...\nc 3\n", True),
        ("a 1\nb 2\n", "a 1\n", False),
        ("residual 3e-14\n", "residual 8e-12\n", True),
        ("stable\n", "unstable\n", False),
    ],
)
def test_outputs_are_compared(found, shown, same):
    assert run_page.agree(found, shown) is same


@pytest.mark.slow
def test_a_page_that_tells_something_else_is_found(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    page.write_text("```python\nprint(2.5)\n```\n\n```text\n3.5\n```\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert len(run_page.differences(page)) == 1
    page.write_text("![x](../images/page/x.png)\n", encoding="utf-8")
    assert run_page.differences(page) == ["page.md: does not make x.png"]


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    pytest.importorskip("sphinx", reason="needs the extra docs")
    pytest.importorskip("myst_parser", reason="needs the extra docs")
    target = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-E"]
    done = subprocess.run(
        [*command, "-d", str(target / "doctrees"), str(DOCS), str(target / "html")],
        capture_output=True,
        encoding="utf-8",
    )
    assert done.returncode == 0, done.stderr
    return target / "html"


@pytest.mark.slow
def test_site_builds_without_warnings_and_holds_every_page(site):
    for page in PAGES:
        assert (site / page.relative_to(DOCS).with_suffix(".html")).is_file(), page


@pytest.mark.slow
def test_pages_ask_no_other_host_for_anything(site):
    """Links may lead away; what a page loads (scripts, styles, fonts, pictures) comes with it."""
    for page in site.glob("**/*.html"):
        text = page.read_text(encoding="utf-8")
        loaded = re.findall(r'<(?:script|img|iframe|source)\b[^>]*\bsrc="([^"]+)"', text)
        loaded += re.findall(r'<link\b[^>]*rel="(?:stylesheet|preload)"[^>]*href="([^"]+)"', text)
        away = [address for address in loaded if re.match(r"(https?:)?//", address)]
        assert not away, (page, away)
    for sheet in site.glob("_static/**/*.css"):
        assert not re.search(r"url\(['\"]?(https?:)?//", sheet.read_text(encoding="utf-8")), sheet


@pytest.mark.slow
def test_equations_are_drawn_by_the_browser_alone(site):
    text = (site / "theory" / "pressure.html").read_text(encoding="utf-8")
    assert text.count("<math") > 20
    assert "$" not in re.sub(r"<(script|style|pre|code)\b.*?</\1>", "", text, flags=re.S)


def test_images_are_small_and_shown():
    shown = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for image in DOCS.glob("images/**/*.png"):
        assert image.stat().st_size <= LARGEST_IMAGE, image
        assert image.relative_to(DOCS / "images").as_posix() in shown, image


SETTLED_TOGETHER = {
    "orbit.harmonic.on", "orbit.kind", "orbit.radial_clearance", "orbit.step.on", "orbit.unbalance",
    "thermal.ambient_temperature",
    "thermal.bush_conductivity", "thermal.bush_heat_transfer", "thermal.models",
    "thermal.supply_temperature",
}  # fmt: skip
"""Keys whose default depends on other keys: told in words."""


def _default(entry: Entry) -> str:
    if entry.is_needed:
        return "needed"
    value = entry.default
    if value in (None, "", ()) or not isinstance(value, tuple | Enum | bool | float | int):
        return ""
    if isinstance(value, tuple):
        if not all(isinstance(one, float | int) for one in value):
            return ""  # words or pairs
        return f"`[{', '.join(f'{one:g}' for one in value)}]`"
    if isinstance(value, Enum | bool):
        return f"`{value}`".lower()
    return f"`{value:g}`" if value < float("inf") else ""


def test_every_scenario_key_is_listed_with_its_default():
    page = (DOCS / "scenario.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `([\w.]+)` \| ([^|]*) \|", page, re.M))
    tables = tables_of(Scenario)
    keys = {".".join((*table, key)) for table in tables for key in tables[table]}
    for name in keys - set(rows):  # a whole section has its heading
        assert tuple(name.split(".")) in tables, f"docs/scenario.md does not list {name}"
        assert f"`[{name}]`" in page, name
    assert set(rows) <= keys


def test_defaults_of_scenario_keys_are_those_of_the_program():
    page = (DOCS / "scenario.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `([\w.]+)` \| ([^|]*) \|", page, re.M))
    checked = 0
    for path, makers in makers_of(Scenario).items():
        defaults: dict[str, set[str]] = {}  # a key of several kinds may have several
        for key, entry in (item for maker in makers for item in entries(maker).items()):
            name = ".".join((*path, key))
            defaults.setdefault(name, set()).add(_default(entry))
            if not all(key in entries(other) for other in makers):
                defaults[name].add("")  # the kind decides
        for name, allowed in defaults.items():
            if name in rows and name not in SETTLED_TOGETHER:
                assert rows[name].strip() in allowed, name
                checked += 1
    assert checked > 80


def test_every_key_of_machine_files_is_listed_with_its_default():
    page = (DOCS / "machine.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `([\w.]+)` \| ([^|]*) \|", page, re.M))
    tables = tables_of(MachineFile)
    keys = {".".join((*table, key)) for table in tables for key in tables[table]} | {"rotor.kind"}
    for name in keys - set(rows):
        assert tuple(name.split(".")) in tables, f"docs/machine.md does not list {name}"
        assert f"`[{name}]`" in page, name
    assert set(rows) <= keys
    checked = 0
    for path, makers in makers_of(MachineFile).items():
        for key, entry in (item for maker in makers for item in entries(maker).items()):
            name = ".".join((*path, key))
            if name in rows and name != "support.pedestal.damping":  # zeros
                text = (
                    f"`{entry.default}`" if entry.default and isinstance(entry.default, str) else ""
                )
                assert rows[name].strip() == (text or _default(entry)), name
                checked += 1
    assert checked > 60


def test_public_names_are_in_the_reference():
    page = (DOCS / "api.md").read_text(encoding="utf-8")
    for name in rotorsim.__all__:
        if name != "__version__":
            assert re.search(rf"rotorsim\.{name}$", page, re.M), f"docs/api.md does not list {name}"


def test_every_status_is_explained():
    page = (DOCS / "how-to" / "statuses.md").read_text(encoding="utf-8")
    for status in [*SolveStatus, *Stability]:
        assert f"`{status.value}`" in page, status
