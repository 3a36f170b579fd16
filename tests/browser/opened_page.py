"""A page in the browser, as the tests use it."""

from __future__ import annotations

import time
from typing import Any


class Opened:
    """A page in the browser, with its errors, messages and requests."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.faults: list[str] = []
        self.asked: list[str] = []
        page.on("pageerror", lambda error: self.faults.append(str(error)))
        page.on(
            "console",
            lambda said: self.faults.append(said.text) if said.type != "log" else None,
        )
        page.on("request", lambda request: self.asked.append(request.url))
        page.on("dialog", lambda dialog: self.faults.append(f"dialog {dialog.message}"))

    def open(self, url: str) -> Opened:
        self.page.goto(url)
        return self.until("Boolean(window.kilter && window.kilter.firstPicture)")

    def until(self, script: str, seconds: float = 30) -> Opened:
        """Wait until a script returns true; playwright's method would need `unsafe-eval`."""
        deadline = time.monotonic() + seconds
        while not self.page.evaluate(script):
            assert time.monotonic() < deadline, script
            self.page.wait_for_timeout(30)
        return self

    def js(self, script: str, *values: Any) -> Any:
        return self.page.evaluate(script, *values)

    def text(self, name: str) -> str:
        return self.page.inner_text(f"#{name}")

    def down(self) -> list[float]:
        return self.js("window.kilter.down")

    def slide(self, name: str, value: float) -> None:
        self.js(
            "([name, value]) => { const one = document.getElementById(name); one.value = value;"
            " one.dispatchEvent(new Event('input')); }",
            [name, value],
        )

    def drawn(self) -> bytes:
        """Screenshot of the picture at rest."""
        self.page.wait_for_timeout(400)
        return self.page.locator(".stage").screenshot()
