"""Headless Chromium with software rendering; a page must make no request."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from opened_page import Opened

import kilter
from kilter.analysis.everything import everything
from kilter.scenes import scene
from kilter.show.page import render

CHROMIUM = os.environ.get("KILTER_CHROMIUM") or shutil.which("chromium")
ARGUMENTS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-unsafe-swiftshader",
    "--use-gl=angle",
    "--use-angle=swiftshader",
]


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    """The browser of the system, driven by playwright."""
    driver = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not here: pip install 'kilter[browser]'"
    )
    if CHROMIUM is None:
        pytest.skip("chromium is not here: apt-get install chromium")
    # playwright uses a new, empty profile
    with driver.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture
def without_webgl(chromium: Any) -> Iterator[Any]:
    """An empty page in a browser without WebGL; page errors fail the test."""
    page = chromium.new_page()
    faults: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.add_init_script(
        "{ const own = HTMLCanvasElement.prototype.getContext;"
        " HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {"
        " return kind.startsWith('webgl') ? null : own.call(this, kind, ...rest); }; }"
    )
    yield page
    assert not faults
    page.close()


@pytest.fixture(scope="session")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Function that writes the page of a scene, once per session, and returns its path."""
    folder = tmp_path_factory.mktemp("pages")

    def written(name: str) -> Path:
        path = folder / f"{name}.html"
        if not path.exists():
            path.write_text(render(everything(scene(name)), name), encoding="utf-8")
        return path

    return written


@pytest.fixture
def opened(chromium: Any, pages: Callable[[str], Path]) -> Iterator[Callable[..., Opened]]:
    """Function that opens the page of a scene, assembly or file; page errors fail the test."""
    contexts, all_ = [], []

    def open_(what: Any, **options: Any) -> Opened:
        options.setdefault("viewport", {"width": 1360, "height": 900})
        context = chromium.new_context(**options)
        contexts.append(context)
        one = Opened(context.new_page())
        all_.append(one)
        if isinstance(what, kilter.Assembly):
            path = pages("paper-figure-8").parent / f"assembly-{len(all_)}-{id(what)}.html"
            path.write_text(render(everything(what), "an assembly"), encoding="utf-8")
        else:
            path = what if isinstance(what, Path) else pages(what)
        return one.open(path.as_uri())

    yield open_
    for one in all_:
        assert not one.faults
        assert [url for url in one.asked if not url.startswith("file://")] == []
        assert len(one.asked) == 1
    for context in contexts:
        context.close()
