"""The commands report and view: output, rejected input, server and watched files."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest

import kilter
from kilter.cli import main
from kilter.errors import InputError
from kilter.files.fingerprint import fingerprint
from kilter.publish import offline_page
from kilter.scenes import scene
from kilter.scenes.stacks import tower as tower_of
from kilter.scenes.walls import wall_of


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), "tower.kilter.json")
    return tmp_path


@pytest.mark.slow
def test_report_writes_one_page_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", "tower.kilter.json", "-o", "out.html"]) == 0
    page = Path("out.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")
    assert page.rstrip().endswith("</html>")
    said = capsys.readouterr()
    assert said.out == ""
    assert "out.html: verdict stable" in said.err


@pytest.mark.slow
def test_report_exits_with_0_whatever_the_verdict_and_may_be_quiet(
    capsys: pytest.CaptureFixture[str],
) -> None:
    kilter.dump(scene("hanging-brick"), "h.json")
    assert main(["report", "h.json", "-o", "h.html", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.slow
def test_more_parts_than_a_browser_can_show_are_refused_before_anything_is_asked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tower = scene("tower")
    monkeypatch.setattr(offline_page, "MOST", len(tower))
    assert kilter.report(tower).verdict == "stable"
    monkeypatch.setattr(offline_page, "MOST", len(tower) - 1)
    with pytest.raises(InputError, match=r"a page of 6 parts .* up to 5; .* assembly\.without"):
        kilter.report(tower)
    assert main(["report", "tower.kilter.json", "-o", "out.html"]) == 2
    assert "--without NAME" in capsys.readouterr().err
    assert not Path("out.html").exists()


@pytest.mark.slow
def test_a_page_grows_by_a_kilobyte_a_part() -> None:
    walls = [wall_of(bricks) for bricks in (4000, 5000)]  # both above the row limit of tables
    small, large = (len(kilter.report(wall).html) for wall in walls)
    assert 100 < (large - small) / (len(walls[1]) - len(walls[0])) < 1024


@pytest.mark.slow
def test_the_command_on_the_page_makes_the_page_again() -> None:
    words = ["report", "tower.kilter.json", "--down", "0.1", "0", "-1", "--without", "cube-5"]
    words += ["--friction", "0.25", "--gap", "0.001", "-o", "a b.html", "--quiet"]
    assert main(words) == 0
    first = Path("a b.html").read_text(encoding="utf-8")
    import html
    import shlex

    found = re.search(r"<dt>command</dt><dd><code>(.*?)</code>", first)
    assert found is not None
    again = shlex.split(html.unescape(found[1]))
    assert again[0] == "kilter"
    Path("a b.html").unlink()
    assert main([*again[1:], "--quiet"]) == 0
    seconds = re.compile(r"<dt>seconds</dt><dd>.*?</dd>")
    second = Path("a b.html").read_text(encoding="utf-8")
    assert seconds.sub("", second) == seconds.sub("", first)


@pytest.mark.slow
def test_margins_are_on_the_page_up_to_a_size_and_above_it_where_asked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import kilter.analysis.everything as module

    kilter.dump(tower_of(2), "two.json")
    written = ["report", "two.json", "-o", "two.html", "--quiet"]
    assert main(written) == 0
    assert 'id="margins"' in Path("two.html").read_text(encoding="utf-8")
    monkeypatch.setattr(module, "MARGIN_PARTS", 1)
    assert main(written) == 0
    page = Path("two.html").read_text(encoding="utf-8")
    assert 'id="margins"' not in page
    assert "the page computes margins for up to 1 free parts" in page
    assert main([*written, "--margins"]) == 0
    page = Path("two.html").read_text(encoding="utf-8")
    assert 'id="margins"' in page
    assert "--margins</code>" in page


@pytest.mark.slow
def test_a_page_of_eighteen_parts_of_step_has_less_than_a_megabyte() -> None:
    file = Path(__file__).resolve().parents[3] / "shared" / "data" / "cax-if" / "as1-oc-214.stp"
    pytest.importorskip("OCP")
    if not file.exists():
        pytest.skip("real data is not here: ../shared/data beside the checkout")
    made = kilter.report(kilter.load(file, ground=["plate"]))
    assert len(made.html.encode()) < 1e6


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "-o out.html"),
        (["-o", "tower.kilter.json"], "ends in .html"),
        (["-o", "part.stl"], "ends in .html"),
        (["-o", "nowhere/out.html"], "cannot be written"),
        (["-o", "out.html", "--down", "0", "0", "0"], "down"),
        (["-o", "out.html", "--ground", "nobody"], "nobody"),
    ],
)
def test_report_refuses_with_one_sentence(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = Path("tower.kilter.json").read_bytes()
    assert main(["report", "tower.kilter.json", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert Path("tower.kilter.json").read_bytes() == before
    assert not Path("out.html").exists()


def test_an_input_that_is_named_like_a_page_is_not_written_over(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("tower.kilter.json").rename("tower.html")
    assert main(["report", "tower.html", "-o", "tower.html"]) == 2
    assert "overwritten" in capsys.readouterr().err


@pytest.mark.slow
def test_a_page_that_was_there_is_replaced_whole() -> None:
    Path("out.html").write_text("old")
    assert main(["report", "tower.kilter.json", "-o", "out.html", "--quiet"]) == 0
    assert Path("out.html").read_text(encoding="utf-8").startswith("<!doctype")
    assert sorted(p.name for p in Path().iterdir()) == ["out.html", "tower.kilter.json"]


def test_a_change_of_a_file_or_of_a_mesh_that_it_names_is_seen(tmp_path: Path) -> None:
    first = fingerprint("tower.kilter.json")
    assert fingerprint("tower.kilter.json") == first
    data = json.loads(Path("tower.kilter.json").read_text())
    data["parts"][0] = {"name": "base", "mesh": "base.stl"}
    Path("tower.kilter.json").write_text(json.dumps(data))
    second = fingerprint("tower.kilter.json")
    assert second != first
    Path("base.stl").write_text("solid")
    third = fingerprint("tower.kilter.json")
    assert third != second
    os.utime("base.stl", ns=(1, 1))
    assert fingerprint("tower.kilter.json") != third
    folder = fingerprint(".")
    Path("new.stl").write_text("solid")
    assert fingerprint(".") != folder
    assert fingerprint("gone.json") == ()
    data["parts"][0] = {"name": "base", "mesh": {"vertices": [], "faces": []}}
    Path("inline.kilter.json").write_text(json.dumps(data))
    assert [name for name, _, _ in fingerprint("inline.kilter.json")] == ["inline.kilter.json"]
