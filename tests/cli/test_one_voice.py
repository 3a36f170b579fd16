"""One answer in every voice: terminal, page and notebook."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path

import pytest

import kilter
import kilter.analysis.everything as module
from kilter.assembly import Assembly
from kilter.cli import main
from kilter.scenes import scene
from kilter.tell.check_facts import forces_phrase
from kilter.tell.facts import facts
from kilter.tell.html import html_of
from kilter.tell.region_facts import region_phrase
from kilter.tell.text import text_of


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["tower", "paper-figure-8", "slope-with-friction", "wall-with-lintel"]
)
def test_page_notebook_and_terminal_tell_the_same_facts(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAP_PARTS", 0)  # its programs take most of the time
    assembly = scene(name)
    verdict = kilter.check(assembly, effort=0)
    answer = verdict.to_dict()
    told = [(term, words) for term, words in facts(answer) if term != "seconds"]
    page = kilter.report(assembly, effort=0).html
    on_page = [(html.unescape(a), html.unescape(b)) for a, b in terms(page)]
    shown = html.unescape(verdict._repr_html_())
    text = text_of(answer)
    listed = [one for one in told if one[0] != "level"]  # that is said above, in the banner
    assert [one for one in on_page if one in told] == listed
    if "level" in dict(told):
        assert f'"level":{json.dumps(dict(told)["level"])}' in page
    assert html.escape(verdict.sentence) in page
    for term, words in told:
        assert words in text, term
        assert words in shown, term
    assert verdict.sentence in text
    assert verdict.sentence in shown


def terms(page: str) -> list[tuple[str, str]]:
    """The terms of the list of a page that says what a verdict rests on."""
    lists = [part.partition("</dl>")[0] for part in page.split("<dl>")[1:]]
    [one] = [part for part in lists if "<dt>parts</dt>" in part]
    return re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", one)


@pytest.mark.slow
def test_the_greatest_force_is_one_number_everywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arch = scene("arch")
    verdict = kilter.check(arch, effort=0)
    phrase = forces_phrase(verdict.to_dict()["forces"])
    assert phrase is not None
    number = re.match(r"up to ([\d.]+ kN) ", phrase)
    assert number is not None
    monkeypatch.setattr(module, "MAP_PARTS", 0)
    assert f'"force_words":"{phrase}"' in kilter.report(arch, effort=0).html
    pytest.importorskip("matplotlib")
    kilter.draw(verdict, tmp_path / "arch.svg")
    assert f"largest {number[1]}" in (tmp_path / "arch.svg").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_page_orients_as_orient_does_with_friction(monkeypatch: pytest.MonkeyPatch) -> None:
    block = scene("slope-with-friction")
    answer = kilter.orient(block)
    monkeypatch.setattr(module, "MAP_PARTS", 0)
    page = html.unescape(kilter.report(block, effort=0).html)
    assert answer.sentence in page
    region = kilter.region(block).to_dict()
    assert region["friction"]
    words = region_phrase(region["kind"], region["half_angle_deg"], friction=True)
    assert f"<dt>stable directions</dt><dd>{words}</dd>" in page


def test_what_was_not_measured_is_not_told() -> None:
    shown = kilter.check(scene("trough"), effort=0)
    assert shown.to_dict()["instability"] is None
    assert "kappa" not in shown._repr_html_()


def test_names_are_harmless_in_every_voice() -> None:
    part = kilter.Part("<b>\x1b[31m\n", kilter.Box([1, 1, 1]), grounded=True)
    answer = kilter.check(Assembly([part])).to_dict()
    assert "\x1b" not in text_of(answer)
    assert "<b>" not in html_of(answer)
    assert "\x1b" not in html_of(answer)


def test_a_program_that_calls_main_keeps_its_warnings(capsys: pytest.CaptureFixture[str]) -> None:
    import warnings

    before = list(warnings.filters)
    assert main(["--version"]) == 0
    assert warnings.filters == before
