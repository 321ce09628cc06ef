"""A page in headless Chromium: what it says on its console, what it fetches, which images fail.

Spoken through the browser's debugging pipe (file descriptors 3 and 4, JSON between NUL bytes), so
that nothing need be installed beside the browser itself.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
_SECONDS = 60.0
_LAUNCHER = """
import fcntl, os, sys
# First out of the way of 3 and 4, then onto them.
pair = [fcntl.fcntl(int(one), fcntl.F_DUPFD, 100) for one in sys.argv[1:3]]
os.dup2(pair[0], 3)
os.dup2(pair[1], 4)
os.execv(sys.argv[3], sys.argv[3:])
"""
_IMAGES = "[...document.images].map(i => [i.complete && i.naturalWidth > 0, i.src.slice(0, 80)])"


@dataclass
class Visit:
    """What happened while a page was open."""

    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)
    images: list[str] = field(default_factory=list)
    broken_images: list[str] = field(default_factory=list)
    width: int = 0
    text: str = ""


class Pipe:
    """Commands to the browser, and its events."""

    def __init__(self, reader: int, writer: int) -> None:
        self.reader, self.writer = reader, writer
        self.number, self.rest = 0, b""
        self.events: list[dict[str, Any]] = []

    def call(self, method: str, session: str | None = None, **parameters: Any) -> dict[str, Any]:
        self.number += 1
        message: dict[str, Any] = {"id": self.number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        os.write(self.writer, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                assert "error" not in answer, answer
                return answer["result"]
            self.events.append(answer)

    def wait_for(self, method: str) -> None:
        while not any(event.get("method") == method for event in self.events):
            self.events.append(self.read())

    def read(self) -> dict[str, Any]:
        end = time.monotonic() + _SECONDS
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.reader], [], [], max(end - time.monotonic(), 0.0))
            data = os.read(self.reader, 1 << 16) if ready else b""
            assert data, "the browser does not answer"
            self.rest += data
        message, _, self.rest = self.rest.partition(b"\0")
        return json.loads(message)


@contextlib.contextmanager
def browser(profile: Path) -> Iterator[Pipe]:
    """Start the browser with a profile folder of its own; it ends with the block."""
    assert CHROMIUM is not None
    their_end, our_writer = os.pipe()
    our_reader, their_writer = os.pipe()
    options = [
        *("--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run"),
        *("--disable-extensions", "--disable-background-networking", "--disable-component-update"),
        "--remote-debugging-pipe",
    ]
    process = subprocess.Popen(
        [
            *(sys.executable, "-c", _LAUNCHER, str(their_end), str(their_writer)),
            *(CHROMIUM, *options, f"--user-data-dir={profile}"),
        ],
        pass_fds=(their_end, their_writer),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(their_end)
    os.close(their_writer)
    try:
        yield Pipe(our_reader, our_writer)
    finally:
        process.kill()
        process.wait()
        os.close(our_writer)
        os.close(our_reader)


@contextlib.contextmanager
def opened(page: Path, profile: Path) -> Iterator[tuple[Pipe, str]]:
    """Open a local page and wait until it is loaded; the browser ends with the block."""
    with browser(profile) as pipe:
        target = pipe.call("Target.createTarget", url="about:blank")["targetId"]
        session = pipe.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Network", "Runtime", "Log", "Page"):
            pipe.call(f"{domain}.enable", session)
        pipe.call("Page.navigate", session, url=page.as_uri())
        pipe.wait_for("Page.loadEventFired")
        yield pipe, session


def complaints(pipe: Pipe) -> list[str]:
    """Give what the page has said on its console, and its errors."""
    said = ("Log.entryAdded", "Runtime.consoleAPICalled", "Runtime.exceptionThrown")
    return [json.dumps(event["params"]) for event in pipe.events if event.get("method") in said]


def visit(page: Path, profile: Path) -> Visit:
    """Open a local page, wait until it is loaded, and tell what happened."""
    with opened(page, profile) as (pipe, session):
        seen = {
            name: pipe.call("Runtime.evaluate", session, expression=code, returnByValue=True)
            for name, code in {
                "images": _IMAGES,
                "text": "document.body.innerText",
                "width": "document.documentElement.scrollWidth",
            }.items()
        }
        events = pipe.events
    found = {name: answer["result"]["value"] for name, answer in seen.items()}
    return Visit(
        requests=[
            event["params"]["request"]["url"]
            for event in events
            if event.get("method") == "Network.requestWillBeSent"
        ],
        complaints=complaints(pipe),
        images=[source for _, source in found["images"]],
        broken_images=[source for whole, source in found["images"] if not whole],
        width=found["width"],
        text=found["text"],
    )
