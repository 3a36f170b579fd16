"""Headless Chromium with software rendering; a page must make no request."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from driver import Page as Link
from opened_page import Opened
from workbench_page import WorkbenchPage

import kilter
from kilter import Assembly
from kilter.analysis.everything import everything
from kilter.scenes import scene
from kilter.show.page import render
from kilter.workbench.server import Workbench
from served_workbench import bench, folder, no_earlier_session  # noqa: F401  fixtures

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


@pytest.fixture
def user(chromium: Any, bench: Workbench, folder: Path) -> Iterator[Callable[..., WorkbenchPage]]:
    """Function that opens a file of the folder on a page; page errors fail the test."""
    pages: list[WorkbenchPage] = []

    def open_(what: Assembly | str | None, **options: Any) -> WorkbenchPage:
        options.setdefault("viewport", {"width": 1040, "height": 680})
        context = chromium.new_context(**options)
        page = WorkbenchPage(context.new_page(), bench, folder)
        pages.append(page)
        # the file of the test before is closed without a page: each page is loaded once
        link = Link(bench)
        assert link.say(do="close")["ok"]
        link.close()
        for path in folder.iterdir():
            path.unlink()
        if isinstance(what, str):
            what = scene(what)
        if what is not None:
            kilter.dump(what, folder / "file.kilter.json")
        page.begin()
        if what is not None:
            page.after(lambda: page.page.click("#listed button"))
        return page

    yield open_
    for page in pages:
        # the browser itself reports a refused upload or export
        assert [fault for fault in page.faults if "status of 409" not in fault] == []
        assert all(url.startswith(("http://127.0.0.1", "blob:http://127")) for url in page.asked)
        page.page.context.close()
