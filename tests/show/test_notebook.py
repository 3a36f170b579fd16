"""Display of answers in a notebook; in a Jupyter kernel if it is installed."""

from __future__ import annotations

import html
import re
from typing import Any

import pytest

import kilter
from kilter import InputError
from kilter.notebook import Shown, cell
from kilter.scenes import scene


def page_in(shown: str) -> str:
    [text] = re.findall(r'srcdoc="([^"]*)"', shown)
    return html.unescape(text)


ANSWERS = [
    lambda: kilter.check(scene("tower")),
    lambda: kilter.region(scene("corner-wedges")),
    lambda: kilter.plan(scene("tower")),
]


@pytest.mark.slow
@pytest.mark.parametrize("ask", ANSWERS, ids=["verdict", "region", "plan"])
def test_a_cell_has_the_page_that_report_writes(ask: Any) -> None:
    answer = ask()
    shown = answer.show(height=333, title='<"me">')
    assert isinstance(shown, Shown)
    subject = {
        kilter.Verdict: lambda: answer.assembly,
        kilter.Region: lambda: answer.assemblies[0],
        kilter.Order: lambda: answer,
    }[type(answer)]()
    frame = shown._repr_html_()
    assert _untimed(page_in(frame)) == _untimed(kilter.report(subject, title='<"me">').html)
    assert "height:333px" in frame
    assert frame.count("<iframe") == frame.count("</iframe>") == 1
    assert "allow-same-origin" not in frame


def _untimed(page: str) -> str:
    """Remove the times of the answer."""
    return re.sub(r"\d+(\.\d+)?(e-\d+)? ?m?s\b", "", page)


@pytest.mark.slow
def test_a_viewer_without_programs_gets_a_figure() -> None:
    pytest.importorskip("matplotlib")
    drawn = kilter.check(scene("tower")).show()._repr_svg_()
    assert drawn is not None
    assert "<svg" in drawn[:600]
    assert "<script" not in drawn
    none = kilter.plan(scene("tower"), kilter.PlanRules(hold=0))
    assert none.found or none.show()._repr_svg_() is None


@pytest.mark.slow
def test_what_cannot_be_shown_is_told() -> None:
    towers = [scene("tower"), scene("tower")]
    with pytest.raises(InputError, match=r"belongs to 2 assemblies, but a page shows one"):
        kilter.common_region(towers).show()
    with pytest.raises(InputError, match="the height is 'tall'; give a whole number of pixels"):
        cell(kilter.check(scene("tower")), height="tall")  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_kernel_of_jupyter_shows_it() -> None:
    pytest.importorskip("ipykernel")
    pytest.importorskip("nbclient")
    import nbformat
    from nbclient import NotebookClient

    source = "import kilter\nkilter.check(kilter.example('tower')).show()"
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    NotebookClient(notebook, kernel_name="python3", timeout=120).execute()
    [output] = notebook.cells[0].outputs
    assert output.output_type == "execute_result"
    assert "Stable" in page_in(output.data["text/html"])
    assert output.data["text/plain"].startswith("<Shown: <Verdict: stable")
    assert "<svg" in output.data["image/svg+xml"]
