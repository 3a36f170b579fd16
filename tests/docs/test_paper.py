"""The paper: its text and its pictures; benchmarks."""

import importlib
import importlib.util
import re
import sys
from argparse import Namespace
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

import kilter
from kilter.analysis.decision.judge import judge
from kilter.analysis.turning.stability_map import StabilityMap
from kilter.analysis.turning.virtual_work import VirtualWork
from kilter.scenes import SCENES, paper
from kilter.show.canvas import encode_figure

FOLDER = Path(__file__).resolve().parents[2] / "paper"
WITHOUT_DOI = {"mattikalli1993", "trimesh"}
"""A conference paper whose DOI is not known, and a program."""


def text() -> str:
    return (FOLDER / "paper.md").read_text(encoding="utf-8").split("---\n", 2)[2]


def entries() -> dict[str, str]:
    content = (FOLDER / "paper.bib").read_text(encoding="utf-8")
    return dict(re.findall(r"@\w+\{(\w+),(.*?)\n\}", content, flags=re.DOTALL))


def test_the_length_is_the_one_that_the_journal_requires():
    words = len(re.sub(r"\[@[^]]*\]|#", " ", text()).split())
    assert 750 <= words <= 1750  # joss.readthedocs.io/en/latest/paper.html


def test_each_citation_is_listed_and_each_entry_is_cited_with_its_doi():
    assert set(re.findall(r"@(\w+)", text())) == set(entries())
    without = {key for key, fields in entries().items() if "doi " not in fields}
    assert without == WITHOUT_DOI


def test_the_sections_are_those_that_the_journal_requires():
    titles = re.findall(r"(?m)^# (.+)$", text())
    assert titles[:2] == ["Summary", "Statement of need"]
    assert titles[-1] == "References"


@pytest.mark.slow
def test_the_paper_compiles(tmp_path):
    pypandoc = pytest.importorskip("pypandoc", reason="pip install pypandoc_binary")
    out = tmp_path / "paper.html"
    options = ["--citeproc", "--standalone", f"--bibliography={FOLDER / 'paper.bib'}"]
    pypandoc.convert_file(str(FOLDER / "paper.md"), "html", extra_args=options, outputfile=out)
    page = out.read_text(encoding="utf-8")
    assert "Stability of Assemblies" in page
    assert "???" not in page  # a citation without an entry


DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "contributing/paper-figures.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def drawing() -> Iterator[ModuleType]:
    """The script that draws the figures."""
    sys.path.insert(0, str(DOCS))
    try:
        yield importlib.import_module("draw_paper_figures")
    finally:
        sys.path.remove(str(DOCS))
        del sys.modules["draw_paper_figures"]


@pytest.fixture(scope="module")
def sets(drawing: ModuleType) -> StabilityMap:
    return drawing.example_sets()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["5", "6", "7"])
def test_page_and_picture_have_the_numbers_of_today(drawing, name):
    """``python docs/draw_paper_figures.py`` writes them anew."""
    figure, statement = drawing.FIGURES[name]()
    assert f"](../images/paper-figure-{name}.svg)\n\n{statement}\n" in PAGE
    saved = (DOCS / "images" / f"paper-figure-{name}.svg").read_text(encoding="utf-8")
    words = r">([^<>]+)</text>"
    fresh = encode_figure(figure, ".svg").decode()
    assert re.findall(words, saved) == re.findall(words, fresh)
    assert drawing.with_statement(PAGE, name, "new") != PAGE
    with pytest.raises(ValueError, match="0 pictures"):
        drawing.with_statement("", name, "new")


@pytest.mark.slow
def test_each_direction_has_the_displacement_of_its_set(drawing, sets):
    """Figure 5: the displacement program of a random direction gives the vertex of its set."""
    work = VirtualWork(drawing.example())
    for gravity in np.random.default_rng(5).normal(size=(40, 3)):
        q = work.solve(gravity).q * work.unit.mass
        vertex = sets.vertices[(sets.vertices @ gravity).argmax()]
        assert q == pytest.approx(vertex, abs=1e-9)


@pytest.mark.slow
def test_the_star_is_stable_and_a_degree_beside_it_is_not(drawing, sets):
    [star] = drawing.stable_corners(sets)
    assembly = paper.figure_8()
    assert kilter.check(assembly, down=star).first_order == "stable"
    across = np.linalg.svd(star[None])[2][1:]
    for angle in np.radians(np.arange(0, 360, 45)):
        beside = star + np.tan(np.radians(1)) * (np.array([np.cos(angle), np.sin(angle)]) @ across)
        assert kilter.check(assembly, down=beside).verdict == "unstable"


@pytest.mark.slow
def test_a_vertex_is_optimal_exactly_between_its_limits(drawing):
    """Figure 6: the limits are the slope of the chamfer, 60 deg, and the vertical."""
    flat = drawing.example_sets(planar=True)
    best = drawing.optimal_when_upright(flat)
    low, high = drawing.turns(flat, best)
    assert (low, high) == pytest.approx((0, 60), abs=1e-9)
    work = VirtualWork(drawing.example(planar=True))

    def is_optimal(degrees: float) -> bool:
        """Whether the displacement program gives the vertex for this direction of gravity."""
        angle = np.radians(degrees)
        q = work.solve(np.array([np.sin(angle), 0.0, -np.cos(angle)])).q * work.unit.mass
        return bool(np.abs(q - flat.vertices[best]).max() < 1e-9)

    assert is_optimal(low + 0.1)
    assert is_optimal(high - 0.1)
    assert not is_optimal(low - 0.1)
    assert not is_optimal(high + 0.1)


@pytest.mark.slow
def test_the_walk_rises_to_the_best_direction_of_its_facet(drawing, sets):
    """Figure 7: no direction on a fine grid of the facet has a greater z than the end."""
    facet = drawing.longest_walk()
    heights = sets.z(drawing.distinct(facet))
    assert (np.diff(heights) > 0).all()
    shares = np.random.default_rng(7).dirichlet([0.5, 0.5, 0.5], 2000)
    assert sets.z(shares * facet.signs).max() <= heights[-1] + 1e-9
    areas = [drawing.share_of_facet(sets, k, np.diag(facet.signs)) for k in range(12)]
    inside = [np.linalg.det(np.vstack([a[0], b, c])) for a in areas if len(a)
              for b, c in pairwise(a[1:])]  # fmt: skip
    assert np.abs(inside).sum() == pytest.approx(1, abs=1e-9)  # the sets cover the facet


def test_each_figure_is_an_example_or_a_picture():
    shown = set(re.findall(r"`(paper-figure-[\w-]+)`", PAGE))
    assert shown <= set(SCENES)
    figures = {int(re.findall(r"\d+", name)[0]) for name in shown}
    pictures = {int(name) for name in re.findall(r"\(../images/paper-figure-(\d+)\.svg\)", PAGE)}
    assert figures | pictures == set(range(1, 13))
    assert not figures & pictures
    kinds = {SCENES[name].source for name in shown}
    assert {"F3(a)", "F3(b)", "F3(c)", "F3(d)"} <= kinds


FOLDER_BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks" / "peers"
DOCS_BENCHMARKS = FOLDER_BENCHMARKS.parents[1] / "docs"
MODULES = ("closed_forms", "question", "tools", "results", "page", "plot")
OWN = ("kilter, equilibrium", "HiGHS", "linprog", "factorisation")
"""Tools that need nothing that kilter does not."""


@pytest.fixture(scope="module")
def peers() -> Iterator[SimpleNamespace]:
    """The modules of the harness; their plain names are free again afterwards."""
    before = set(sys.modules)
    sys.path.insert(0, str(FOLDER_BENCHMARKS))
    try:
        found = {name: importlib.import_module(name) for name in MODULES}
        spec = importlib.util.spec_from_file_location(
            "peers_main", FOLDER_BENCHMARKS / "__main__.py"
        )
        found["main"] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(found["main"])
        yield SimpleNamespace(**found)
    finally:
        sys.path.remove(str(FOLDER_BENCHMARKS))
        for name in set(sys.modules) - before:
            if (
                Path(getattr(sys.modules[name], "__file__", None) or "/").parent
                == FOLDER_BENCHMARKS
            ):
                del sys.modules[name]


@pytest.mark.quick(1)
@pytest.mark.parametrize("family", ["limits", "angles", "masses", "sizes"])
def test_what_closed_forms_say_is_proved(peers, family):
    """Each limit has a case on both sides, and the certificate agrees with the closed form."""
    cases = [case for case in peers.closed_forms.CASES.values() if case.family == family]
    assert {case.holds for case in cases} == {True, False}
    for case in cases:
        found = judge(peers.question.Question(case.build()).program)
        assert found.stable is case.holds, case.name


@pytest.mark.slow
@pytest.mark.parametrize("tool", OWN)
def test_an_answer_is_measured(peers, tool):
    case = peers.closed_forms.CASES["side 1e-2, 1.02"]
    row = peers.tools.answered(case, peers.tools.TOOLS[tool])
    assert row.answer in ("falls", "")
    assert row.truth == "falls"
    assert (row.bricks, row.points) == (2, 8)
    assert row.seconds > 0
    assert row.runs == peers.tools.RUNS
    assert row.peak >= 0


@pytest.mark.slow
def test_what_is_missing_is_left_out_and_said(peers, tmp_path, monkeypatch, capsys):
    """Rows that a file has are kept; a tool that is not installed brings none."""
    asked = []

    def here(cases, tool, seconds, gib):
        asked.append(tool.name)
        return [peers.tools.answered(case, tool) for case in cases]

    gone = peers.tools.Tool("MuJoCo", "no_such_package", "ask_mujoco.settle", "gone")
    monkeypatch.setattr(peers.main, "measured", here)
    monkeypatch.setitem(peers.main.TOOLS, "MuJoCo", gone)
    chosen = Namespace(
        o=tmp_path / "here.csv", only=["side 1e-2, 0.98"], tools=[OWN[0], "MuJoCo"],
        seconds=60.0, gib=8.0, again=False,
    )  # fmt: skip
    peers.main.run(chosen)
    assert "MuJoCo: no_such_package is not installed, left out" in capsys.readouterr().out
    peers.main.run(chosen)
    assert asked == [OWN[0]]
    about, [row] = peers.results.read(chosen.o)
    assert (row.case, row.tool, row.answer) == ("side 1e-2, 0.98", OWN[0], "holds")
    assert {"kilter", "numpy", "cores"} <= set(about)


@pytest.mark.slow
def test_an_answer_over_its_time_is_ended(peers):
    """The limit is processor time, so that a busy machine changes nothing; others keep theirs."""
    case, tool = peers.closed_forms.CASES["wall-300"], peers.tools.TOOLS["HiGHS"]
    small = peers.closed_forms.CASES["wall-10"]
    inside, late = peers.main.measured([small, case], tool, seconds=0.5, gib=8.0)
    assert (inside.answer, late.answer) == ("holds", "time")
    assert inside.runs == peers.tools.RUNS >= 3
    assert late.seconds == 0.5
    assert peers.main.too_large(case, tool, {}) is False
    smaller = peers.tools.Row("walls", "wall-100", tool.name, 0, 0, "holds", "time", 1, 1, 0, "")
    assert peers.main.too_large(case, tool, {("wall-100", tool.name): smaller}) is True


def test_the_page_says_what_the_rows_say(peers):
    """`python benchmarks/peers --page` would change nothing."""
    for name, text in peers.page.made().items():
        assert (DOCS_BENCHMARKS / name).read_text(encoding="utf-8") == text, name


def test_one_row_told_otherwise_changes_the_page(peers, tmp_path):
    [path, *_] = sorted(peers.results.FOLDER.glob("*.csv"))
    about, rows = peers.results.read(path)
    (tmp_path / path.name).write_bytes(path.read_bytes())
    assert peers.page.made(tmp_path)["contributing/benchmarks.md"].count("**wrong**") > 0
    told = [row for row in rows if row.family == "angles" and row.answer == row.truth]
    flipped = {"holds": "falls", "falls": "holds"}
    changed = peers.tools.Row(**{**told[0].to_dict(), "answer": flipped[told[0].answer]})
    rows[rows.index(told[0])] = changed
    before = peers.page.made(tmp_path)["contributing/benchmarks.md"]
    peers.results.write(tmp_path / path.name, about, rows)
    after = peers.page.made(tmp_path)["contributing/benchmarks.md"]
    assert after.count("**wrong**") == before.count("**wrong**") + 1


def test_no_name_of_a_host_and_no_path_is_kept(peers):
    for path in peers.results.FOLDER.glob("*.csv"):
        text = path.read_text(encoding="utf-8")
        assert "/home/" not in text
        assert "/tmp/" not in text
        assert "File " not in text
