"""Text from users is shown letter by letter, wherever it is shown."""

from __future__ import annotations

import io
import json
from pathlib import Path

import pytest
from command_line import called
from scenario_texts import SMALL

from rotorsim.errors import InputError
from rotorsim.show.figures.style import new_figure
from rotorsim.text import caption, markdown, printable


def test_control_characters_of_a_file_name_do_not_reach_the_terminal() -> None:
    assert str(InputError("no", source="a\x1b[31m.toml", key="b\0")) == r"a\x1b[31m.toml: b\x00: no"
    assert printable("Füße µm, 軸受") == "Füße µm, 軸受"
    assert printable("\udcff") == r"\udcff"


@pytest.mark.parametrize("title", ["50% $\\frac{1$", "$", "$a$", "$$", "a_{b} $x^$"])
def test_dollars_begin_no_formula_in_a_figure(title: str) -> None:
    figure = new_figure(3.0, 2.0, title)
    figure.savefig(io.BytesIO(), format="svg")
    assert figure.get_suptitle() == caption(title)


def test_markdown_is_shown_letter_by_letter() -> None:
    assert markdown("# [A](b) $c$ <d>") == r"\# \[A\]\(b\) \$c\$ \<d\>"


@pytest.mark.parametrize("title", ["Drawing 12 [/A]", "[bold]x", "[link=a]b", "50% $\\\\frac{1$"])
def test_any_title_is_checked_and_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], title: str
) -> None:
    path = tmp_path / "case.toml"
    path.write_text(f'title = "{title}"\n{SMALL}', encoding="utf-8")
    shown = called(capsys, "check", path)
    assert shown.returncode == 0, shown.stderr
    assert title.replace("\\\\", "\\") in shown.stdout


def test_a_date_in_an_error_is_text_in_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "case.toml"
    path.write_text(SMALL.replace('"100 um"', "1979-05-27"), encoding="utf-8")
    shown = called(capsys, "check", path, "--json")
    assert shown.returncode == 2
    assert json.loads(shown.stdout)["error"]["value"] == "1979-05-27"
