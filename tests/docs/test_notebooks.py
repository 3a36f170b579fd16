"""The notebooks of the folder examples run, print the kept text, and stay small."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))
LARGEST = 100_000
"""Largest notebook [bytes]."""


def cells(path: Path) -> list[dict[str, object]]:
    return json.loads(path.read_text(encoding="utf-8"))["cells"]  # type: ignore[no-any-return]


def test_there_is_a_notebook_for_each_user_and_for_the_paper() -> None:
    names = {path.stem for path in NOTEBOOKS}
    assert names == {"designer", "robot_planner", "architect", "paper_figures"}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_small_and_complete(path: Path) -> None:
    assert path.stat().st_size < LARGEST
    first, *others = cells(path)
    assert "".join(first["source"]).startswith("# ")  # type: ignore[arg-type]
    assert 'pip install "kilter[' in "".join(first["source"])  # type: ignore[arg-type]
    code = [cell for cell in others if cell["cell_type"] == "code"]
    assert all(cell["execution_count"] is None for cell in code)
    outputs = [output for cell in code for output in cell["outputs"]]  # type: ignore[attr-defined]
    assert not [output for output in outputs if output["output_type"] == "error"]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert str(ROOT) not in json.dumps(outputs)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_prints_the_kept_text(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("nbclient", reason="pip install 'kilter[notebook]'")
    pytest.importorskip("ipykernel", reason="pip install 'kilter[notebook]'")
    pytest.importorskip("OCP", reason="pip install 'kilter[step]'")
    monkeypatch.syspath_prepend(ROOT / "docs")
    from run_notebooks import main

    monkeypatch.setattr(sys, "argv", ["run_notebooks.py", "--compare", path.stem])
    assert main() == 0
