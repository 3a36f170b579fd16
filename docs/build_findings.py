"""The picture of the findings, from the table on their page: ``python docs/build_findings.py``.

The lower configuration is drawn `ENLARGED` times as far from the initial blocks as it is.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import kilter
from kilter.arrays import Array
from kilter.scenes import scene
from kilter.show.canvas import encode_figure
from kilter.show.figures import draw_assembly

DOCS = Path(__file__).resolve().parent
SCENE = "paper-figure-1-in-space"
PICTURE = DOCS / "images" / "finding-figure-1b.svg"
ENLARGED = 20
VIEW = (-35.0, 28.0)


def moved(names: tuple[str, ...]) -> Array:
    """Shifts [m] and rotation vectors [rad] of the page's table, shape (N, 6)."""
    motion = np.zeros((len(names), 6))
    for line in (DOCS / "contributing/findings.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if cells[0] in names:
            motion[names.index(cells[0])] = [float(cell) for cell in cells[1:]]
    return motion


def picture() -> bytes:
    """The initial blocks, and their lower configuration, much enlarged."""
    assembly = scene(SCENE)
    fall = ENLARGED * moved(assembly.names)
    verdict = kilter.check(assembly)
    return encode_figure(draw_assembly(verdict, view=VIEW, contacts=False, fall=fall), ".svg")


if __name__ == "__main__":
    PICTURE.write_bytes(picture())
