"""A page as headless Chromium shows it: the document after its script ran, and its console."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from tempfile import TemporaryDirectory

CHROMIUM = next(
    (
        found
        for name in ("chromium", "chromium-browser", "google-chrome")
        if (found := shutil.which(name))
    ),
    None,
)
NO_CHROMIUM = "no chromium on the PATH: what the page's script does is not tested"

_SWITCHES = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-logging=stderr",
    "--virtual-time-budget=3000",
)


@dataclass(frozen=True)
class Element:
    """One element: its tag, its attributes, and the text in it and below it."""

    tag: str
    attributes: dict[str, str | None]
    text: list[str]

    @property
    def words(self) -> str:
        """Its text with single spaces."""
        return " ".join(" ".join(self.text).split())


class Document(HTMLParser):
    """The elements of an HTML text, in their order; scripts and styles have no words."""

    _VOID = ("meta", "link", "input", "br", "img")

    def __init__(self, html: str) -> None:
        super().__init__()
        self.elements: list[Element] = []
        self._open: list[Element] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        element = Element(tag, dict(attrs), [])
        self.elements.append(element)
        if tag not in self._VOID:
            self._open.append(element)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append(Element(tag, dict(attrs), []))

    def handle_endtag(self, tag: str) -> None:
        while self._open and self._open.pop().tag != tag:
            pass

    def handle_data(self, data: str) -> None:
        if not self._open or self._open[-1].tag not in ("script", "style"):
            for element in self._open:
                element.text.append(data)

    def by_id(self, name: str) -> Element:
        """The one element with this id."""
        (found,) = (e for e in self.elements if e.attributes.get("id") == name)
        return found

    def all(self, tag: str) -> list[Element]:
        """All elements of a tag."""
        return [element for element in self.elements if element.tag == tag]


@dataclass(frozen=True)
class Shown:
    """What the browser made of a page, and what its console said."""

    document: Document
    console: list[str]


def show(page: Path, address: str = "") -> Shown:
    """Open a page with an address behind its name (``#t=5``), wait for its script, look."""
    assert CHROMIUM is not None, NO_CHROMIUM
    with TemporaryDirectory() as profile:
        done = subprocess.run(
            [
                CHROMIUM,
                *_SWITCHES,
                f"--user-data-dir={profile}",
                "--dump-dom",
                f"{page.as_uri()}{address}",
            ],
            capture_output=True,
            text=True,
            timeout=120,
            check=True,
        )
    console = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    return Shown(Document(done.stdout), console)
