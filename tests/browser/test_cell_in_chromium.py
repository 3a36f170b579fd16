"""The output of a notebook cell in a browser without a network."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import kilter
from kilter.scenes import scene

pytestmark = pytest.mark.browser


def _drawn(page: Any) -> Any:
    """The inner frame, once it has drawn; the browser replaces its first, empty frame."""
    for _ in range(900):
        for frame in page.frames[1:]:
            if frame.evaluate("Boolean(window.kilter && window.kilter.firstPicture)"):
                return frame
        page.wait_for_timeout(100)
    raise AssertionError("no picture")


@pytest.mark.parametrize("kind", ["check", "region", "plan"])
def test_a_cell_opens_and_turns_without_a_network(chromium: Any, tmp_path: Path, kind: str) -> None:
    shown = getattr(kilter, kind)(scene("tower")).show(height=500)
    path = tmp_path / "cell.html"
    path.write_text(f"<!doctype html><body>{shown._repr_html_()}</body>", encoding="utf-8")
    page = chromium.new_page()
    page.context.set_offline(True)
    faults: list[str] = []
    asked: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
    page.on("request", lambda request: asked.append(request.url))
    page.goto(path.as_uri())
    frame = _drawn(page)
    assert frame.locator(".stage").first.is_visible()
    assert faults == []
    assert [url for url in asked if not url.startswith(("file:", "about:", "data:", "blob:"))] == []
    assert page.locator("iframe").bounding_box()["height"] == 500
    page.close()
