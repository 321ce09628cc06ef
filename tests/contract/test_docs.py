"""The documentation: builds without a warning, asks nobody for anything, and is true.

Every page with code is executed; what it shows as output is compared with what it prints. The
tables of scenario keys and public names are held against the program.
"""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import typing
from enum import Enum
from pathlib import Path
from types import ModuleType

import pytest
from pydantic import BaseModel
from pydantic.fields import FieldInfo

import rotorsim
from rotorsim.files.scenario.schema import ScenarioTables
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


def test_site_builds_without_warnings_and_holds_every_page(site):
    for page in PAGES:
        assert (site / page.relative_to(DOCS).with_suffix(".html")).is_file(), page


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


def test_equations_are_drawn_by_the_browser_alone(site):
    text = (site / "theory" / "pressure.html").read_text(encoding="utf-8")
    assert text.count("<math") > 20
    assert "$" not in re.sub(r"<(script|style|pre|code)\b.*?</\1>", "", text, flags=re.S)


def test_images_are_small_and_shown():
    shown = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for image in DOCS.glob("images/**/*.png"):
        assert image.stat().st_size <= LARGEST_IMAGE, image
        assert image.relative_to(DOCS / "images").as_posix() in shown, image


def _tables(annotation: object) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [found for part in typing.get_args(annotation) for found in _tables(part)]


def _keys(model: type[BaseModel], prefix: str = "") -> dict[str, FieldInfo]:
    found: dict[str, FieldInfo] = {}
    for name, field in model.model_fields.items():
        inner = _tables(field.annotation)
        found[prefix + name] = field
        for table in inner:
            found |= _keys(table, f"{prefix}{name}.")
    return found


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "needed"
    value = field.default
    if value is None or isinstance(value, BaseModel) or value in ("", []):
        return ""
    entries = value if isinstance(value, list) else [value]
    texts = [
        e.value if isinstance(e, Enum) else str(e).lower() if isinstance(e, bool) else f"{e:g}"
        for e in entries
    ]
    return f"`[{', '.join(texts)}]`" if isinstance(value, list) else f"`{texts[0]}`"


def test_every_scenario_key_is_listed_with_its_default():
    page = (DOCS / "scenario.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `([\w.]+)` \| ([^|]*) \|", page, re.M))
    keys = _keys(ScenarioTables)
    for name, field in keys.items():
        if name in rows:
            assert rows[name].strip() == _default(field), name
        else:  # a whole section has its heading
            assert _tables(field.annotation), f"docs/scenario.md does not list {name}"
            assert f"`[{name}]`" in page, name
    assert set(rows) <= set(keys)


def test_public_names_are_in_the_reference():
    page = (DOCS / "api.md").read_text(encoding="utf-8")
    for name in rotorsim.__all__:
        if name != "__version__":
            assert re.search(rf"rotorsim\.{name}$", page, re.M), f"docs/api.md does not list {name}"


def test_every_status_is_explained():
    page = (DOCS / "how-to" / "statuses.md").read_text(encoding="utf-8")
    for status in [*SolveStatus, *Stability]:
        assert f"`{status.value}`" in page, status
