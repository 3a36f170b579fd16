"""The paper of the software has the required length, cites the listed works, and compiles."""

import re
from pathlib import Path

import pytest

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
