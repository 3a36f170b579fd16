"""A page of the workbench in the browser, with a user who clicks and presses keys."""

from __future__ import annotations

import json
import shlex
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import trimesh
from opened_page import Opened

from kilter import Assembly, Box, Part, Pose
from kilter.cli import main
from kilter.tell.words import VERDICTS
from kilter.workbench.server import Workbench

ANSWERED = (
    "(() => { const d = document.getElementById('banner').dataset; const s = window.bench.session;"
    " return d.stale === 'false' && ['complete', 'problem'].includes(d.phase)"
    " && d.state === String(s.state); })()"
)


TOUCHED = ("click", "fill", "press", "select_option", "focus", "check", "uncheck", "inner_text")
"""Methods of a page that need a visible element."""
OPEN_PANEL = (
    "selector => { const panel = document.querySelector(selector)?.closest('.panel');"
    " if (panel?.hidden) document.getElementById(panel.id.replace('panel-', 'open-')).click();"
    " document.querySelector(selector)?.closest('details')?.setAttribute('open', ''); }"
)


class PagePanels:
    """A page of playwright whose user opens the panel of an element before the element is used."""

    def __init__(self, page: Any) -> None:
        self._page = page

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._page, name)
        if name not in TOUCHED:
            return method

        def shown(selector: str, *values: Any, **options: Any) -> Any:
            if selector.startswith("#"):
                self._page.evaluate(OPEN_PANEL, selector.split()[0].split(":")[0])
            return method(selector, *values, **options)

        return shown


class WorkbenchPage(Opened):
    """A page of the workbench with a user who clicks."""

    def __init__(self, page: Any, bench: Workbench, folder: Path) -> None:
        super().__init__(page)
        self.page = PagePanels(page)
        self.bench, self.folder = bench, folder

    def begin(self) -> WorkbenchPage:
        self.page.goto(self.bench.url)
        self.until("Boolean(window.bench && window.bench.session)")
        return self

    def plan_was_stopped(self) -> bool:
        """Whether the page says that the plan was stopped, or has the part of it that was found."""
        found = str(self.js("JSON.stringify(window.bench.tabs.results.get('plan') ?? null)"))
        return "stopped" in self.text("sheet-error") or '"interrupted":true' in found

    def answered(self) -> WorkbenchPage:
        """Wait for the complete answer of the present state."""
        self.until(ANSWERED, 60)
        return self

    def after(self, act: Callable[[], Any]) -> WorkbenchPage:
        """Act, wait until the server has taken the change, and wait for its complete answer."""
        state = self.js("window.bench.session.state")
        act()
        self.until(f"window.bench.session.state > {state}")
        return self.answered()

    def click(self, selector: str) -> WorkbenchPage:
        return self.after(lambda: self.page.click(selector))

    def enter(self, field: str, text: str) -> WorkbenchPage:
        """Write into a field and press Enter."""
        self.page.fill(f"#{field}", text)
        return self.after(lambda: self.page.press(f"#{field}", "Enter"))

    def act(self, action: dict[str, Any]) -> WorkbenchPage:
        """Send an action without a control."""
        return self.after(lambda: self.js("action => window.bench.act(action)", action))

    def choose(self, *names: str) -> WorkbenchPage:
        self.js(
            "names => { const all = window.kilter.page.parts.full_names;"
            " window.kilter.choose(names.map(n => all.indexOf(n))); }",
            list(names),
        )
        return self

    def tab_to(self, selector: str) -> WorkbenchPage:
        """Press the tab key until an element has the focus."""
        for _ in range(160):
            if self.js("s => document.activeElement.matches(s)", selector):
                return self
            self.page.keyboard.press("Tab")
        raise AssertionError(f"the tab key does not reach {selector}")

    def press(self, *keys: str) -> WorkbenchPage:
        for key in keys:
            self.page.keyboard.press(key)
        return self

    def choices(self) -> dict[str, Any]:
        return self.js("window.bench.session.choices")

    def exported(self, kind: str) -> bytes:
        """A file that the server makes of the present state."""
        address = self.bench.url.replace("/?", f"/export/{kind}?")
        with urllib.request.urlopen(address, timeout=60) as answer:
            made: bytes = answer.read()
        return made

    def command_agrees(self, capsys: Any, monkeypatch: Any) -> dict[str, Any]:
        """Run the shown command, and compare its whole answer with the page; returns the answer."""
        session = self.js("window.bench.session")
        if session["command_needs_save"]:
            self.page.click("#save")
            self.until("!window.bench.session.dirty")
        words = shlex.split(self.text("command"))
        assert words[0] == "kilter"
        monkeypatch.chdir(self.folder)
        capsys.readouterr()
        main([*words[1:], "--json"])
        printed: dict[str, Any] = json.loads(capsys.readouterr().out)
        shown = json.loads(self.exported("answer.json"))
        for answer in (printed, shown):
            del answer["seconds"]
        assert printed == shown
        assert self.text("verdict") == VERDICTS[printed["verdict"]]
        moving = self.js(
            "(window.kilter.found.moving || []).map(k => window.kilter.page.parts.full_names[k])"
        )
        assert moving == [part["name"] for part in printed["parts"] if part["moves"]]
        return printed


def loaded() -> Assembly:
    """A block on a block, and a block beside them at a gap that is open."""
    base = Part("base", Box([6, 2, 1]), Pose([0, 0, -0.5]), grounded=True)
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    high = Part("high", Box([1, 1, 1]), Pose([0.2, 0, 1.5]))
    side = Part("side", Box([1, 1, 1]), Pose([2, 0, 0.5]))
    return Assembly([base, low, high, side], friction=0.5)


GAP = 0.035
"""Distance of each loose part from the board [mm]."""
DESK = {
    "board": ([120, 80, 4], [0, 0, 62]),
    "leg-1": ([10, 10, 60], [-50, 0, 30]),
    "leg-2": ([10, 10, 60], [50, 0, 30]),
    "bracket": ([20, 4, 20], [0, 42, 62]),
    "stand": ([30, 30, 80], [120, 0, 40]),
    "led-1": ([6, 6, 4], [-20, 0, 66 + GAP]),
    "led-2": ([6, 6, 4], [20, 0, 66 + GAP]),
}
"""Size and centre of each part [mm]: a board on two legs, a bracket that is glued to its side, a
stand beside it, and two parts that hang above the board."""
FLOATS = {"lost": ([6, 6, 4], [0, 0, 90])}
"""A part that hangs far above the board."""


def desk_page(user: Any, folder: Path, parts: dict[str, Any], **options: Any) -> WorkbenchPage:
    """The page of a desk, as a mesh file in mm with choices that add a floor."""
    page: WorkbenchPage = user(None, **options)
    lines, first = [], 1
    for name, (size, center) in parts.items():
        box = trimesh.creation.box(size)
        lines.append(f"o {name}")
        lines += ["v {:.6f} {:.6f} {:.6f}".format(*point) for point in box.vertices + center]
        lines += ["f {} {} {}".format(*face) for face in box.faces + first]
        first += len(box.vertices)
    (folder / "desk.obj").write_text("\n".join(lines) + "\n")
    choices = {"kilter": 1, "file": "desk.obj", "units": "mm", "floor": True}
    (folder / "desk.kilter.json").write_text(json.dumps(choices))
    page.act({"do": "open", "file": "desk.kilter.json"})
    return page
