"""Pages, figures and films of answers: `report`, `view`, `draw`, `animate`.

The answers are computed first (`kilter.analysis.everything`) and then passed to the drawing
functions (`kilter.show`), which compute nothing.
"""

from kilter.publish.answer_figures import answer_to_draw, draw
from kilter.publish.films import animate
from kilter.publish.offline_page import Report, report
from kilter.publish.output_files import (
    FILMS,
    PAGES,
    require_ending,
    require_figure,
    require_film,
    title_of,
)

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
    "title_of",
]
