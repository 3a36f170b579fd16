"""Pictures of the pages and of the workbench, taken in Chromium: ``python docs/draw_pages.py``.

They show the words and colours of kilter, so take them again after a change of either. The browser
is that of the tests: Playwright with the Chromium of the system, or of ``KILTER_CHROMIUM``.
"""

from __future__ import annotations

import io
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

import kilter
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.workbench.server import Workbench

FOLDER = Path(__file__).resolve().parent / "images"
SIZE = {"width": 1320, "height": 880}
"""Size of the window [px]."""
FILM = (880, 587)
"""Size of the pictures of the walkthrough [px]."""
FILM_QUALITY = 29
"""Quality of the compression of the walkthrough, up to 100; a larger value gives a larger file."""
REST = 2200
"""Time for which each picture of the walkthrough is shown [ms]."""
ARGUMENTS = ["--no-sandbox", "--enable-unsafe-swiftshader", "--use-gl=angle"]
ANSWERED = (
    "(() => { const d = document.getElementById('banner').dataset; const s = window.bench.session;"
    " return d.stale === 'false' && ['complete', 'problem'].includes(d.phase)"
    " && d.state === String(s.state); })()"
)


def until(page: Any, script: str) -> None:
    """Wait until a script of the page returns true."""
    while not page.evaluate(script):
        page.wait_for_timeout(30)


def shot(page: Any) -> Image.Image:
    """The picture of a page at rest."""
    page.mouse.move(5, 5)
    page.wait_for_timeout(1500)
    return Image.open(io.BytesIO(page.screenshot())).convert("RGB")


def save(image: Image.Image, name: str) -> None:
    """Write a picture to the folder of the pictures."""
    image.save(FOLDER / f"{name}.webp", quality=80, method=6)


def reports(page: Any, folder: Path) -> None:
    """The pictures of two reports and of a plan."""
    for name, subject, act in (
        ("report-unstable", scene("paper-figure-8"), ""),
        (
            "report-gravity-ball",
            scene("corner-wedges"),
            "window.kilter.ask([-0.5, -0.6, -0.62]); window.kilter.ball.set(window.kilter.down)",
        ),
        ("plan-page", kilter.plan(arch(9, ratio=0.3, friction=0.6, planar=False)), "step"),
    ):
        path = folder / f"{name}.html"
        kilter.report(subject, path, title=name.removesuffix("-page"))
        page.goto(path.as_uri())
        until(page, "Boolean(window.kilter && window.kilter.firstPicture)")
        if act == "step":
            until(page, "document.querySelectorAll('#strip button').length > 5")
            page.click("#strip li:nth-child(7) button")
        elif act:
            page.evaluate(f"() => {{ {act}; }}")
        save(shot(page), name)


def walkthrough(page: Any, folder: Path) -> None:
    """The workbench with an arch: friction, margins, a missing stone, supports, the saved state."""
    kilter.dump(scene("arch"), folder / "arch.kilter.json")
    frames: list[Image.Image] = []

    def after(act: Callable[[], Any]) -> None:
        state = page.evaluate("window.bench.session.state")
        act()
        until(page, f"window.bench.session.state > {state}")
        until(page, ANSWERED)
        frames.append(shot(page))

    def enter(mu: str) -> None:
        page.fill("#friction-number", mu)
        page.press("#friction-number", "Enter")

    def tab(name: str) -> None:
        page.click(f"#tab-{name}")
        until(page, f"window.bench.tabs.results.has('{name}')")
        frames.append(shot(page))

    with Workbench(None, folder=folder) as bench:
        page.goto(bench.url)
        until(page, "Boolean(window.bench && window.bench.session)")
        # the name of the temporary folder is of no interest
        page.evaluate("document.getElementById('listed-folder').textContent = 'arches'")
        frames.append(shot(page))
        after(lambda: page.click("#listed button"))
        page.click("#open-forces")
        after(lambda: enter("0.3"))
        after(lambda: enter("0.5"))
        tab("margin")
        page.select_option("#limit-case", "0")
        frames.append(shot(page))
        save(frames[-1], "workbench")
        tab("plan")
        page.fill("#find", "voussoir-10")
        page.press("#find", "Enter")
        after(lambda: page.click("#do-leave-out"))
        tab("hold")
        page.fill("#find", "")
        after(lambda: page.click("#undo"))
        page.click("#save")
        until(page, "!window.bench.session.dirty")
        page.click("#tab-changes")
        frames.append(shot(page))
    small = [frame.resize(FILM, Image.Resampling.LANCZOS) for frame in frames]
    small[0].save(
        FOLDER / "workbench-walkthrough.webp",
        save_all=True,
        append_images=small[1:],
        duration=REST,
        loop=0,
        quality=FILM_QUALITY,
        method=6,
    )


def main() -> None:
    """Take all pictures, or those of `reports` or `walkthrough` alone."""
    parts = {"reports": reports, "walkthrough": walkthrough}
    chromium = os.environ.get("KILTER_CHROMIUM") or shutil.which("chromium")
    with sync_playwright() as playwright, TemporaryDirectory() as name:
        os.environ["XDG_STATE_HOME"] = name  # without the recent files of the user
        browser = playwright.chromium.launch(executable_path=chromium, args=ARGUMENTS)
        page = browser.new_page(viewport=SIZE)
        for part in sys.argv[1:] or parts:
            parts[part](page, Path(name))
        browser.close()


if __name__ == "__main__":
    main()
