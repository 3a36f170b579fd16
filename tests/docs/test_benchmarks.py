"""The benchmarks beside the peers: truths, harness, and a page that says what its rows say."""

import importlib
import importlib.util
import sys
from argparse import Namespace
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from kilter.analysis.decision.judge import judge

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks" / "peers"
DOCS = FOLDER.parents[1] / "docs"
MODULES = ("closed_forms", "question", "tools", "results", "page", "plot")
OWN = ("kilter, equilibrium", "HiGHS", "linprog", "factorisation")
"""Tools that need nothing that kilter does not."""


@pytest.fixture(scope="module")
def peers() -> Iterator[SimpleNamespace]:
    """The modules of the harness; their plain names are free again afterwards."""
    before = set(sys.modules)
    sys.path.insert(0, str(FOLDER))
    try:
        found = {name: importlib.import_module(name) for name in MODULES}
        spec = importlib.util.spec_from_file_location("peers_main", FOLDER / "__main__.py")
        found["main"] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(found["main"])
        yield SimpleNamespace(**found)
    finally:
        sys.path.remove(str(FOLDER))
        for name in set(sys.modules) - before:
            if Path(getattr(sys.modules[name], "__file__", None) or "/").parent == FOLDER:
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
        assert (DOCS / name).read_text(encoding="utf-8") == text, name


def test_one_row_told_otherwise_changes_the_page(peers, tmp_path):
    [path, *_] = sorted(peers.results.FOLDER.glob("*.csv"))
    about, rows = peers.results.read(path)
    (tmp_path / path.name).write_bytes(path.read_bytes())
    assert peers.page.made(tmp_path)["benchmarks.md"].count("**wrong**") > 0
    told = [row for row in rows if row.family == "angles" and row.answer == row.truth]
    flipped = {"holds": "falls", "falls": "holds"}
    changed = peers.tools.Row(**{**told[0].to_dict(), "answer": flipped[told[0].answer]})
    rows[rows.index(told[0])] = changed
    before = peers.page.made(tmp_path)["benchmarks.md"]
    peers.results.write(tmp_path / path.name, about, rows)
    after = peers.page.made(tmp_path)["benchmarks.md"]
    assert after.count("**wrong**") == before.count("**wrong**") + 1


def test_no_name_of_a_host_and_no_path_is_kept(peers):
    for path in peers.results.FOLDER.glob("*.csv"):
        text = path.read_text(encoding="utf-8")
        assert "/home/" not in text
        assert "/tmp/" not in text
        assert "File " not in text
