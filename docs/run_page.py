"""Execute a documentation page, as a reader would who types everything it shows.

In a scratch folder, top to bottom: `python` blocks are run, all of a page in one namespace;
lines of `console` blocks that begin with `$ rotorsim` are commands; a block with a caption is a
file of that name. What the page shows as output (the rest of a console block, or a `text` block
right after python) is compared: words exactly, numbers to two parts in a hundred, `...` stands for
anything. Figures that the page shows from `images/PAGE/` must be made by it.

``python docs/run_page.py PAGE.md`` checks; with ``--write`` it puts the new output and figures into
the page.
"""

from __future__ import annotations

import argparse
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import chdir, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FENCE = re.compile(r"^```(?P<info>[^\n`]*)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL)
FIGURE = re.compile(r"!\[[^\]]*\]\((?P<path>[^)]*images/[^)]+)\)")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
RELATIVE, ABSOLUTE = 0.02, 1e-9
LIKE_A_TERMINAL = {"COLUMNS": "96", "TERM": "dumb", "NO_COLOR": "1", "MPLBACKEND": "agg"}
LIKE_A_TERMINAL["PYTHONUNBUFFERED"] = "1"  # warnings and results in the order they are said
PROGRESS = re.compile(r"after \d+ s\b")


@dataclass(frozen=True)
class Block:
    """A fenced block: what it is called, what it holds, where it stands in the page."""

    language: str
    caption: str
    body: str
    start: int
    end: int


@dataclass(frozen=True)
class Output:
    """What a block printed, what the page shows, and where that stands."""

    source: str
    found: str
    shown: str
    start: int
    end: int


def blocks(page: str) -> list[Block]:
    """Fenced blocks of a page."""
    found = []
    for match in FENCE.finditer(page):
        info, body, start = match["info"].strip(), match["body"], match.start("body")
        caption = ""
        if info.startswith("{code-block}"):
            info = info.removeprefix("{code-block}").strip()
            options = re.match(r"(?::[\w-]+:[^\n]*\n)+\n?", body)
            if options:
                named = re.search(r":caption: *(\S+)", options[0])
                caption = named[1] if named else ""
                body, start = body[options.end() :], start + options.end()
        found.append(Block(info, caption, body, start, match.end("body")))
    return found


def run(page: str) -> list[Output]:
    """Execute a page in the current folder; what it prints where it shows output."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    outputs: list[Output] = []
    printed = None
    for block in blocks(page):
        if block.caption:
            Path(block.caption).write_text(block.body, encoding="utf-8")
        elif block.language == "console":
            found = run_console(block.body)
            outputs.append(Output(block.body, found, block.body, block.start, block.end))
        elif block.language == "python":
            printed = (block.body, run_python(block, page, namespace))
            continue
        elif block.language == "text" and printed is not None:
            outputs.append(Output(*printed, block.body, block.start, block.end))
        printed = None
    return outputs


def run_python(block: Block, page: str, namespace: dict[str, Any]) -> str:
    """Execute a python block; a traceback names the page's line."""
    line = page.count("\n", 0, block.start)
    text = io.StringIO()
    with redirect_stdout(text):
        exec(compile("\n" * line + block.body, "page", "exec"), namespace)
    return text.getvalue()


def run_console(body: str) -> str:
    """Run the block's commands; the block as it should read."""
    lines = [line for line in body.splitlines() if line.startswith("$ ")]
    shown, code = [], 0
    for number, line in enumerate(lines):
        shown.append(line)
        if line == "$ echo $?":
            shown.append(str(code))
            continue
        command = shlex.split(line[2:])
        if command[0] != "rotorsim":
            raise ValueError(f"only rotorsim is run in a console block: {line}")
        done = subprocess.run(
            [sys.executable, "-m", *command],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            env={**os.environ, **LIKE_A_TERMINAL, "PYTHONPATH": os.pathsep.join(sys.path)},
        )
        code = done.returncode
        asked = lines[number + 1 : number + 2] == ["$ echo $?"]
        if code != 0 and not asked:
            raise RuntimeError(f"{line}: exit code {code}\n{done.stdout}")
        rows = done.stdout.rstrip().splitlines()
        shown += [row.rstrip() for row in rows if not PROGRESS.search(row)]
    return "\n".join(shown) + "\n"


def agree(found: str, shown: str) -> bool:
    """Whether the output is what the page shows."""
    rest, first = found, True
    for part in re.split(r"^\.\.\.$|\s\.\.\.\s", shown, flags=re.MULTILINE):
        place = _match(rest, part, anchored=first)
        if place is None:
            return False
        rest, first = rest[place:], False
    return shown.rstrip().endswith("...") or not rest.strip()


def _match(text: str, part: str, *, anchored: bool) -> int | None:
    """End of the first place in `text` that reads like `part`; None if there is none."""
    if not part.strip():
        return 0
    words = NUMBER.split(part)
    pattern = r"\s*" if anchored else ""
    pattern += f"({NUMBER.pattern})".join(
        r"\s+".join(re.escape(word) for word in re.split(r"\s+", piece)) for piece in words
    )
    wanted = [float(number) for number in NUMBER.findall(part)]
    for match in re.finditer(pattern, text):
        if anchored and match.start() != 0:
            break
        if all(map(close, map(float, match.groups()), wanted)):
            return match.end()
    return None


def close(a: float, b: float) -> bool:
    """Whether two numbers count as the same."""
    return abs(a - b) <= ABSOLUTE + RELATIVE * max(abs(a), abs(b))


def figures(page: str, name: str) -> Iterator[str]:
    """Files that the page shows from the folder of its own figures."""
    for match in FIGURE.finditer(page):
        folder, _, file = match["path"].rpartition("/")
        if folder.endswith(f"images/{name}"):
            yield file


def differences(path: Path) -> list[str]:
    """Run a page in the current folder; what it shows that is not so."""
    page = path.read_text(encoding="utf-8")
    wrong = [
        f"{path.name}: output differs\n--- shown\n{output.shown}--- found\n{output.found}"
        for output in run(page)
        if not agree(output.found, output.shown)
    ]
    missing = [file for file in figures(page, path.stem) if not Path(file).is_file()]
    return wrong + [f"{path.name}: does not make {file}" for file in missing]


def rewrite(path: Path, images: Path) -> None:
    """Run a page in the current folder; put its output and figures where they belong."""
    page = path.read_text(encoding="utf-8")
    for output in reversed(run(page)):
        if not agree(output.found, output.shown):
            page = page[: output.start] + output.found + page[output.end :]
    path.write_text(page, encoding="utf-8")
    for file in figures(page, path.stem):
        target = images / path.stem / file
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)


def main() -> int:
    """Check or rewrite pages."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--write", action="store_true", help="put the new output into the page")
    given = parser.parse_args()
    os.environ.update(LIKE_A_TERMINAL)
    images = Path(__file__).resolve().parent / "images"
    wrong = []
    for path in given.pages:
        path = path.resolve()
        with tempfile.TemporaryDirectory() as folder, chdir(folder):
            if given.write:
                rewrite(path, images)
            else:
                wrong += differences(path)
    print("\n".join(wrong), end="")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parent.parent)
    sys.exit(main())
