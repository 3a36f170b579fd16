"""One answer, however it is asked for: the command's JSON, the function, page and notebook."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path
from typing import Any

import pytest

import kilter
import kilter.analysis.everything as module
from kilter.assembly import Assembly
from kilter.cli import main
from kilter.errors import InputError
from kilter.scenes import SCENES, scene
from kilter.tell.check_facts import forces_phrase
from kilter.tell.facts import facts
from kilter.tell.html import html_of
from kilter.tell.region_facts import region_phrase
from kilter.tell.text import text_of

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples").glob("*.json"))
WORK = {"check": 45, "orient": 12, "region": 12, "margin": 4}
"""Parts above which a question takes long, so that it is asked with the slow tests."""
EACH = {"check": 1, "contacts": 1}
"""Of other questions every third scene is always asked."""
EFFORT = {"check": 0.0, "margin": 0.0}
"""Quick: it is the voice that is asked about."""


PARTS = {name: len(scene(name).parts) for name in SCENES}


def asked(command: str) -> list[Any]:
    """The scenes of a command; the slow ones marked."""
    limit = WORK.get(command, 100)
    small = [name for name in SCENES if PARTS[name] <= limit]
    few = small[:: EACH.get(command, 3)]
    return [pytest.param(n, marks=() if n in few else pytest.mark.slow) for n in SCENES]


def timeless(data: Any) -> Any:
    """Answers without what a clock says."""
    if isinstance(data, dict):
        return {key: timeless(value) for key, value in data.items() if key != "seconds"}
    return [timeless(one) for one in data] if isinstance(data, list) else data


def said(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    capsys.readouterr()
    code = main(list(words))
    return code, capsys.readouterr().out


def agree(command: str, path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Ask the command and the function of its name."""
    effort = EFFORT.get(command)
    options = [] if effort is None else ["--effort", str(effort)]
    code, out = said(capsys, command, str(path), "--json", *options)
    function = getattr(kilter, command)
    try:
        answer = function(kilter.load(path), **({} if effort is None else {"effort": effort}))
    except InputError:
        assert (code, out) == (2, "")
        return
    assert code in (0, 1, 3, 4)
    told, known = json.loads(out), json.loads(json.dumps(answer.to_dict()))
    if known.get("guarantee") == "open":  # how far the search came is up to the clock
        told.pop("friction", None), known.pop("friction", None)
    assert timeless(told) == timeless(known)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("command", "name"),
    [
        pytest.param(command, *one.values, marks=one.marks)
        for command in ("check", "contacts", "orient", "region", "margin")
        for one in asked(command)
    ],
)
def test_a_command_answers_as_its_function_does(
    command: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"{name}.kilter.json"
    kilter.dump(scene(name), path)
    agree(command, path, capsys)


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_an_example_is_answered_alike(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    agree("check", path, capsys)


@pytest.mark.slow
@pytest.mark.parametrize("name", asked("region"))
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
