"""Full disks, missing extras, and the offline page of a state of the workbench."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pytest
from driver import Page

import kilter
from kilter.cli import main
from kilter.scenes import scene
from kilter.workbench import session
from kilter.workbench.server import Workbench

pytestmark = pytest.mark.slow


EMPTY_STEP = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A folder in a file system of 256 kB with Figure 8."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = shutil.which("mount")
    words = [mount or "", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(place)]
    if mount is None or subprocess.run(words, capture_output=True, check=False).returncode:
        pytest.skip("mounting a small file system is not allowed here")
    kilter.dump(scene("paper-figure-8"), place / "f8.kilter.json")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def fill(place: Path) -> Path:
    """Fill a file system with a single file."""
    path = place / "filler"
    with path.open("wb", buffering=0) as file:
        try:
            while file.write(os.urandom(4096)):
                pass
        except OSError:
            return path
    return path


def test_on_a_full_disk_no_choice_is_lost_and_a_sentence_states_it(small_disk: Path) -> None:
    with Workbench(small_disk / "f8.kilter.json") as bench:
        page = Page(bench)
        page.opened()
        page.after(do="friction", mu=0.4)
        assert page.say(do="save")["saved"] == "f8.choices.kilter.json"
        saved = (small_disk / "f8.choices.kilter.json").read_bytes()
        filler = fill(small_disk)
        # the change is answered, though it cannot be kept beside the file
        held = page.after(do="hold", parts=["C3"], on=True)
        expected = kilter.check(scene("paper-figure-8").with_grounded(["C3"]).with_friction(0.4))
        assert held["check"]["verdict"] == expected.verdict
        assert "not kept beside the file" in page.last["session"]["message"]
        assert "No space left" in page.last["session"]["message"]
        reply = page.say(do="save")
        assert not reply["ok"]
        assert "No space left" in reply["error"]
        # neither the saved choices nor the session are damaged
        assert (small_disk / "f8.choices.kilter.json").read_bytes() == saved
        assert page.last["session"]["choices"]["held"] == ["C3"]
        assert page.last["session"]["dirty"]
        # with space again, the next change keeps all, and saving works
        filler.unlink()
        page.after(do="loose", on=True)
        assert page.last["session"]["message"] == ""
        assert page.say(do="save")["ok"]
        page.close()
    choices = json.loads((small_disk / "f8.choices.kilter.json").read_text())
    assert (choices["held"], choices["friction"]) == (["C3"], 0.4)
    with Workbench(small_disk / "f8.kilter.json") as bench:
        page = Page(bench)
        page.opened()
        assert len(page.last["session"]["changes"]) == 3
        page.close()


def test_a_missing_extra_is_named_with_its_installation(
    page: Page, bench: Workbench, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert bench.session is not None
    monkeypatch.setattr(session, "find_spec", lambda name: None)
    page.after(do="hold", parts=["C3"], on=True)
    missing = page.last["session"]["missing"]
    assert any('pip install "kilter[step]"' in sentence for sentence in missing)
    assert any('pip install "kilter[figures]"' in sentence for sentence in missing)
    monkeypatch.undo()
    page.after(do="undo")
    present = {"OCP": "step", "matplotlib": "figures"}
    for module, extra in present.items():
        installed = session.find_spec(module) is not None
        named = any(f"kilter[{extra}]" in s for s in page.last["session"]["missing"])
        assert named != installed


def test_a_step_file_without_the_extra_names_the_installation(
    folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The processes that read files begin with a module that hides the STEP reader."""
    (tmp_path / "sitecustomize.py").write_text("import sys\nsys.modules['OCP'] = None\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    (folder / "part.step").write_text(EMPTY_STEP)
    with Workbench(None, folder=folder) as bench:
        page = Page(bench)
        reply = page.say(do="open", file="part.step")
        page.close()
    assert not reply["ok"]
    assert "kilter[step]" in f"{reply['error']} {reply['hint']}"


class _Text(HTMLParser):
    """The words of a page that a reader sees, without programs and styles."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []
        self._skipped = 0

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self._skipped += tag in ("script", "style")

    def handle_endtag(self, tag: str) -> None:
        self._skipped -= tag in ("script", "style")

    def handle_data(self, data: str) -> None:
        if not self._skipped:
            self.words.append(data)


def words_of(html: str) -> str:
    """The visible words of HTML, separated by single spaces."""
    parser = _Text()
    parser.feed(html)
    return re.sub(r"\s+", " ", " ".join(parser.words)).strip()


@pytest.mark.parametrize(
    "actions",
    [
        [{"do": "hold", "parts": ["C3"], "on": True}],
        [{"do": "friction", "mu": 0.4}, {"do": "load", "part": "C3", "force": [0, 0, -5]}],
        [{"do": "leave_out", "parts": ["C3"], "on": True}],
    ],
    ids=["held", "friction", "left out"],
)
def test_the_report_of_a_state_has_the_words_of_the_page(
    actions: list[dict], page: Page, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for action in actions:
        page.after(**action)
    shown = page.last["answer"]
    saved = page.say(do="save")["saved"]
    monkeypatch.chdir(folder)
    assert main(["report", saved, "-o", "state.html", "--quiet"]) == 0
    text = (folder / "state.html").read_text(encoding="utf-8")
    script = re.search(r'<script id="data" type="application/json">(.*?)</script>', text)
    assert script is not None
    data = json.loads(script[1])
    for key in ("verdict", "sentence", "level", "words", "moves", "down"):
        assert data["given"][key] == shown["given"][key], key
    # each line of the answer in full stands in both pages
    offline, live = words_of(text), words_of(shown["html"])
    assert shown["given"]["sentence"] in live
    assert len(shown["facts"]) > 5
    for term, words in shown["facts"]:
        line = re.sub(r"\s+", " ", f"{term} {words}")
        assert line in live
        assert line in offline
