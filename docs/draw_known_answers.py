"""The pictures of the known answers of second order: ``python docs/draw_known_answers.py``.

Each picture is drawn from its scene in `tests/scenes/balance_cases.py`: positions and curvatures
of its contacts, and the centres of mass. The drawing chooses dimensions that the scene leaves open,
such as the thickness of a plank. A case is drawn below its limit. If the limit is a position of the
centre of mass, it is marked.
"""

from __future__ import annotations

import sys
from pathlib import Path

import known_several  # noqa: F401 - enters its recipes
import known_single  # noqa: F401 - enters its recipes
from known_drawing import RECIPES, Drawing
from line_drawing import picture

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from balance_cases import CASES, ROLLING, Case

FOLDER = Path(__file__).resolve().parent / "images" / "known"


def drawn(case: Case) -> str:
    """The picture of a case as SVG."""
    drawing = Drawing(case)
    RECIPES[case.number](drawing)
    return picture(drawing.views, f"{case.number}: {case.title}")


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    for known_case in (*CASES, *ROLLING):
        (FOLDER / f"{known_case.number}.svg").write_text(drawn(known_case), encoding="utf-8")
