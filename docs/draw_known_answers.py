"""The pictures of the known answers of second order: ``python docs/draw_known_answers.py``.

Each is drawn from its scene in `kilter.scenes.balance`: where its contacts are, how they curve, and
where the centres of mass lie; of what the scene leaves open, as how thick a plank is, the drawing
chooses. Below a limit, and the limit is marked where it is a place of the centre of mass.
"""

from __future__ import annotations

from pathlib import Path

import known_several  # noqa: F401 - enters its recipes
import known_single  # noqa: F401 - enters its recipes
from known_drawing import RECIPES, Drawing
from line_drawing import picture

from kilter.scenes.balance import CASES, ROLLING, Case

FOLDER = Path(__file__).resolve().parent / "images" / "known"


def drawn(case: Case) -> str:
    """The picture of a case as SVG."""
    told = Drawing(case)
    RECIPES[case.number](told)
    return picture(told.views, f"{case.number}: {case.title}")


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    for one in (*CASES, *ROLLING):
        (FOLDER / f"{one.number}.svg").write_text(drawn(one), encoding="utf-8")
