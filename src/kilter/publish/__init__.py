"""Pages, figures and films of answers: `report`, `view`, `draw`, `animate`.

The answers are computed first (`kilter.analysis.everything`) and then passed to the drawing
functions (`kilter.show`), which compute nothing.
"""

from kilter.publish.answer_figures import answer_to_draw, draw
from kilter.publish.films import (
    FILMS,
    PAGES,
    animate,
    require_ending,
    require_figure,
    require_film,
    require_movement,
    title_of,
)
from kilter.publish.offline_page import Report, report

__all__ = [
    "FILMS",
    "PAGES",
    "Report",
    "animate",
    "answer_to_draw",
    "draw",
    "report",
    "require_ending",
    "require_figure",
    "require_film",
    "require_movement",
    "title_of",
]
