"""The workbench through a forwarded port, and below a path of a reverse proxy, in Chromium."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from forwarding import Forwarding
from workbench_page import WorkbenchPage

import kilter
from kilter.scenes import scene
from kilter.workbench.server import Workbench

pytestmark = pytest.mark.browser

HUB = "hub.localhost"
"""A name that browsers look up on this machine; for the workbench it is a foreign name."""
PREFIX = "/user/x/proxy/8899"
WAYS = {
    "a forwarded port": ("localhost", {}, ()),
    "a notebook on this machine": ("127.0.0.1", {"prefix": PREFIX}, ()),
    "a hub": (HUB, {"prefix": PREFIX}, (HUB,)),
    "a proxy that replaces the host": (HUB, {"prefix": PREFIX, "host": "127.0.0.1:8899"}, (HUB,)),
}
"""Host name in the browser, options of the proxy, and host names that the workbench allows."""


@pytest.fixture
def through(
    chromium: Any, tmp_path: Path
) -> Iterator[Callable[..., tuple[WorkbenchPage, Forwarding]]]:
    """Function that opens Figure 8 through a forwarded port; it returns page and port."""
    kilter.dump(scene("paper-figure-8"), tmp_path / "f8.kilter.json")
    ends: list[Callable[[], Any]] = []

    def open_(
        host: str, options: dict[str, str], hosts: tuple[str, ...]
    ) -> tuple[WorkbenchPage, Forwarding]:
        bench = Workbench(tmp_path / "f8.kilter.json", hosts=hosts).__enter__()
        ends.append(lambda: bench.__exit__())
        port = Forwarding(bench.port, **options).__enter__()
        ends.append(lambda: port.__exit__())
        context = chromium.new_context(viewport={"width": 1360, "height": 900})
        ends.append(context.close)
        page = WorkbenchPage(context.new_page(), bench, tmp_path)
        page.page.goto(port.url(bench.url, host))
        return page, port

    yield open_
    for end in reversed(ends):
        end()


@pytest.mark.parametrize("way", WAYS)
def test_a_user_acts_exports_drops_and_saves_through(
    way: str, through: Callable, tmp_path: Path
) -> None:
    page, port = through(*WAYS[way])
    page.until("Boolean(window.bench && window.bench.session && window.bench.session.file)")
    page.answered().choose("C3").click("#do-hold")
    held = scene("paper-figure-8").with_grounded(["C3"])
    with page.page.expect_download() as download:
        page.page.select_option("#export", "answer.json")
    download.value.save_as(tmp_path / "answer.json")
    assert json.loads((tmp_path / "answer.json").read_text())["verdict"] == (
        kilter.check(held).verdict
    )
    page.page.click("#save")
    page.until("!window.bench.session.dirty")
    saved = kilter.load(tmp_path / page.js("window.bench.session.saved"))
    assert [part.grounded for part in saved.parts] == [part.grounded for part in held.parts]
    # a file is sent and opened from the address without its last slash
    page.page.goto(page.page.url.replace("/?", "?"))
    page.until("Boolean(window.bench && window.bench.session && window.bench.session.file)")
    page.answered()
    page.page.click("#open-file")
    tower = tmp_path / "tower.kilter.json"
    kilter.dump(scene("tower"), tower)
    page.after(lambda: page.page.set_input_files("#files", tower))
    # the connection of the page returns through the same way
    page.js("window.bench.link.socket.close()")
    page.until("!document.getElementById('connection').hidden")
    page.until("document.getElementById('connection').hidden")
    assert page.text("title") == "tower.kilter.json"
    assert page.faults == []
    # every request was within the path of the proxy
    start = f":{port.port}{port.prefix}"
    assert all(start in url for url in page.asked if url.startswith("http"))
    assert all(path.startswith(port.prefix) for path in port.paths)


def test_a_name_that_is_not_allowed_is_named_with_the_option(through: Callable) -> None:
    page, _ = through(HUB, {"prefix": PREFIX}, ())
    assert f"--host {HUB}" in page.page.inner_text("body")
    # a proxy that replaces the host hides the name: only the origin of the connection shows it
    page, _ = through(HUB, {"prefix": PREFIX, "host": "127.0.0.1:8899"}, ())
    page.until("!document.getElementById('connection').hidden")
    assert f"--host {HUB}" in page.text("connection")
    assert page.js("window.bench.session") is None
