"""The README says what is true: its commands, its Python, the files it links to."""

from __future__ import annotations

import itertools
import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SETUP = [line for line in README.splitlines() if line.startswith("python -m pip install ")]


def test_exactly_two_setup_commands_one_running_and_one_testing():
    run, test = (command.split(" && ") for command in SETUP)
    assert run[1].startswith("python -m rotorsim run ")
    assert test[1] == "python -P -m pytest"  # -P: the installed package, not this folder


def test_the_first_command_runs_a_shipped_scenario():
    scenario = SETUP[0].split()[-1]
    assert (ROOT / scenario).is_file()


def test_the_extra_of_the_second_command_brings_the_test_tools():
    extra = re.search(r"\[(\w+)\]", SETUP[1])
    assert extra is not None
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = " ".join(project["optional-dependencies"][extra[1]])
    for tool in ("pytest", "hypothesis", "pyarrow"):
        assert tool in needed


def test_ci_runs_the_test_command_as_printed():
    """`.ci/run` takes the command from here by this pattern: it must find that one alone."""
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    pattern = re.search(r"grep -E '(.*)' README.md", script)
    assert pattern is not None
    assert [line for line in README.splitlines() if re.search(pattern[1], line)] == [SETUP[1]]


def test_links_lead_somewhere():
    links = re.findall(r"\]\(([^)#]+)\)", README)
    assert links
    for link in links:
        assert link.startswith("https://") or (ROOT / link).exists(), link


def test_the_python_example_runs(monkeypatch, capsys):
    (code,) = re.findall(r"```python\n(.*?)```", README, flags=re.S)
    monkeypatch.chdir(ROOT)
    exec(compile(code, "README.md", "exec"), {})
    assert capsys.readouterr().out.startswith("converged ")


def test_every_dependency_is_explained():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    listed = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    groups = [project["dependencies"], *project["optional-dependencies"].values()]
    for requirement in itertools.chain(*groups):
        name = re.match(r"[A-Za-z0-9-]+", requirement)
        assert name is not None
        assert name[0] == "rotorsim" or re.search(rf"\| .*\b{name[0]}\b", listed), name[0]


def test_the_public_names_exist_and_are_typed():
    import rotorsim

    missing = [name for name in rotorsim.__all__ if not hasattr(rotorsim, name)]
    assert missing == []
    source = (ROOT / "rotorsim" / "__init__.py").read_text(encoding="utf-8")
    typed = source.split("if TYPE_CHECKING:")[1].split("__version__")[0]
    assert all(re.search(rf"\b{name}\b", typed) for name in rotorsim.__all__ if name[0] != "_")


def test_one_version_everywhere():
    import rotorsim

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    cited = re.search(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text(), re.M)
    assert cited is not None
    assert rotorsim.__version__ == project["version"] == cited[1]
