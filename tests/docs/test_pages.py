"""Pages of the site: links and anchors, words, generated pages, the man page, offline help."""

import importlib
import re
import sys
import tomllib
from pathlib import Path

import pytest

from kilter.cli import main
from kilter.cli.guide import shipped
from kilter.tell.guide_pages import as_text, topics

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import build_man  # noqa: E402
import build_options  # noqa: E402
from build_second_sources import names_in  # noqa: E402
from claims import CLAIM, claims, sentences  # noqa: E402

PAGES = sorted(DOCS.rglob("*.md"))
SITE = [page for page in PAGES if "contributing" not in page.parts]
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]*))?\)")
WORDS = 1500
"""Largest number of words of a page that is no reference."""
QUESTIONS = (
    "cad", "loads", "tilt", "order", "straps", "start-states", "arches", "bricks", "packing",
    "many", "agents", "what-helps",
)  # fmt: skip
"""Guides, in the order of the landing page."""


def text_of(page: Path) -> str:
    return re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)


def anchors(page: Path) -> set[str]:
    """Anchors of a page that a repository and the site give to the same heading."""
    found = set()
    for heading in re.findall(r"^#+ (.*)$", text_of(page), flags=re.M):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
        kept = re.sub(r"[^\w\s-]", "", heading).strip().lower()
        if re.sub(r"\s", "-", kept) == re.sub(r"[-\s]+", "-", kept):
            found.add(re.sub(r"\s", "-", kept))
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.relative_to(DOCS).as_posix())
def test_links_and_anchors_lead_somewhere(page):
    for target, anchor in LINK.findall(text_of(page)):
        if re.match(r"https?:", target):
            continue
        place = (page.parent / target).resolve() if target else page
        assert place.exists(), target
        if anchor:
            assert anchor in anchors(place), f"{target}#{anchor}"


def test_links_of_the_site_stay_in_the_site_and_in_the_offline_help():
    pages = topics()
    for page in SITE:
        for target, _ in LINK.findall(text_of(page)):
            place = (page.parent / target).resolve()
            if not target or re.match(r"https?:", target) or place.suffix == ".webp":
                continue
            if place.suffix == ".md":
                assert place in SITE, f"{page.name}: {target}"
                assert place in pages.values() or place.parent.name in ("docs", "python"), target
            elif place.parent.name == "examples":
                assert place.name in shipped(), f"{page.name}: {target}"
            else:
                assert DOCS in place.parents, f"{page.name}: {target}"


@pytest.mark.parametrize("page", SITE, ids=lambda p: p.relative_to(DOCS).as_posix())
def test_a_page_is_short(page):
    if "reference" not in page.parts:
        assert len(page.read_text(encoding="utf-8").split()) <= WORDS


def test_each_question_has_its_guide_in_one_click():
    landing = (DOCS / "index.md").read_text(encoding="utf-8")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert tuple(re.findall(r"^- \[.*\]\(guides/([\w-]+)\.md\)", landing, re.M)) == QUESTIONS
    assert tuple(re.findall(r"^- \[.*\]\(docs/guides/([\w-]+)\.md\)", readme, re.M)) == QUESTIONS
    assert sorted(p.stem for p in (DOCS / "guides").glob("*.md")) == sorted(QUESTIONS)


def test_a_guide_ends_with_a_decision_and_its_limits():
    for name in QUESTIONS:
        text = (DOCS / f"guides/{name}.md").read_text(encoding="utf-8")
        assert "## Limits of the answer" in text, name
        assert "## Decide" in text, name


def test_generated_pages_are_as_their_programs_write_them():
    assert build_options.PAGE.read_text(encoding="utf-8") == build_options.page()
    assert build_man.PAGE.read_text(encoding="utf-8") == build_man.page()


def test_the_man_page_has_the_exit_codes_of_the_reference():
    assert ".TP\n.B 130\ninterrupted (Ctrl\\-C)" in build_man.page()


@pytest.mark.parametrize("topic", sorted(topics()))
def test_a_page_is_readable_in_a_terminal(topic):
    text = as_text(topics()[topic].read_text(encoding="utf-8"), 80)
    prose = [line for line in text.splitlines() if not line.startswith("    ")]
    assert not [line for line in prose if "](" in line or "**" in line]
    assert not [line for line in prose if len(line) > 80 and " " in line]
    linked = re.search(r"See also: kilter help (.*)", text, flags=re.S)
    names = linked[1].replace("\n", " ").split(", ") if linked else []
    known = {*topics(), *(p.stem for p in SITE)}
    assert [name for name in names if name.strip() not in known] == []


def test_each_topic_is_a_single_page():
    pages = [p for p in SITE if p.parent.name not in ("docs", "python")]
    assert len(topics()) == len(pages)


def test_help_lists_pages_and_prints_a_page_or_the_options_of_a_command(capsys):
    assert main(["help"]) == 0
    assert "\n  cad " in capsys.readouterr().out
    assert main(["help", "exit-codes"]) == 0
    assert capsys.readouterr().out.startswith("EXIT CODES\n\nA script")
    assert main(["help", "plan"]) == 0
    assert capsys.readouterr().out.startswith("Usage: kilter plan")
    assert main(["help", "exit-code"]) == 2
    assert "did you mean 'exit-codes'" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["tower", "crane.ldr"])
def test_an_example_may_be_written_twice_but_replaces_nothing_else(
    name, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    assert main(["example", name]) == 0
    [path] = tmp_path.iterdir()
    written = path.read_bytes()
    assert main(["example", name]) == 0
    assert path.read_bytes() == written
    path.write_text("mine", encoding="utf-8")
    assert main(["example", name]) == 2
    assert "another content" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mine"
    assert main(["example", name, "--force"]) == 0
    assert path.read_bytes() == written


def test_the_wheel_has_the_pages_and_the_files_of_the_guides():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    included = project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    for name in shipped():
        assert included[f"examples/{name}"] == f"kilter/examples/{name}"
    for kind in ("tutorials", "guides", "reference", "explanation"):
        assert included[f"docs/{kind}"] == f"kilter/pages/{kind}"


@pytest.mark.slow
def test_made_examples_are_as_their_program_makes_them(tmp_path):
    pytest.importorskip("compas_assembly", reason="pip install 'kilter[compas]'")
    pytest.importorskip("OCP", reason="pip install 'kilter[step]'")
    sys.path.insert(0, str(ROOT / "tests/files"))
    import numpy as np
    from make_examples import arch, stand

    import kilter

    arch(tmp_path / "arch-compas.json")
    stand(tmp_path / "stand.FCStd")
    for path in tmp_path.iterdir():
        made, kept = kilter.load(path), kilter.load(ROOT / "examples" / path.name)
        assert made.names == kept.names
        assert np.array_equal(made.geometry.center, kept.geometry.center)


CLAIMS = tomllib.loads((DOCS / "claims.toml").read_text(encoding="utf-8"))["claim"]


def test_each_claim_of_the_site_has_its_entry_and_each_entry_its_sentence():
    found = claims()
    missing = [
        (page, sentence)
        for page, sentence in found
        if not [c for c in CLAIMS if c["page"] == page and c["text"] in sentence]
    ]
    assert missing == []
    idle = [c for c in CLAIMS if not [s for p, s in found if p == c["page"] and c["text"] in s]]
    assert idle == []


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda c: c["text"])
def test_a_claim_names_what_is_behind_it(claim):
    if "by" in claim:
        path, _, name = claim["by"].partition("::")
        assert (ROOT / path).is_file(), path
        if name.startswith("test_"):
            assert name in names_in(path)
        else:
            assert name in (ROOT / path).read_text(encoding="utf-8")
    for place, number in claim.get("constants", {}).items():
        module, _, name = place.rpartition(".")
        assert getattr(importlib.import_module(module), name) == number
        assert {str(number), f"{number:,}"} & set(re.findall(r"[\d,]*\d", sentence_of(claim)))


def sentence_of(claim: dict[str, str]) -> str:
    return next(s for p, s in claims() if p == claim["page"] and claim["text"] in s)


def test_absolute_words_and_numbers_of_time_memory_and_size_are_claims():
    text = "It always holds. It takes 3 s. A page has 2 MB. Two parts touch.\n\n| 40 bricks | b |\n"
    assert [bool(CLAIM.search(s)) for s in sentences(text)] == [
        True,
        True,
        True,
        False,
        True,
        False,
    ]


def test_a_figure_has_the_verdict_of_its_assumption(tmp_path, monkeypatch, capsys):
    pytest.importorskip("OCP", reason="pip install 'kilter[step]'")
    monkeypatch.chdir(tmp_path)
    assert main(["example", "stand.FCStd"]) == 0
    for words, verdict in ((["--assume", "joined"], "stable"), ([], "unstable")):
        assert main(["draw", "stand.FCStd", *words, "-o", "a.svg"]) == 0
        printed = capsys.readouterr()
        assert f"a.svg: verdict {verdict}" in printed.out + printed.err
