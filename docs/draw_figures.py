"""The figures of the pages, drawn by `kilter.draw`: ``python docs/draw_figures.py [NAME...]``.

They contain sentences and colours of kilter, so draw them again after a change of either.
"""

from __future__ import annotations

import contextlib
import re
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import kilter
from kilter.assembly import Assembly
from kilter.scenes import friction, scene
from kilter.scenes.arches import arch
from kilter.scenes.stacks import block_on_slope

FOLDER = Path(__file__).resolve().parent / "images"
LARGE, MIDDLE, SMALL = 1400, 560, 420
"""Widths of the figures [px]."""
QUALITY = 80
"""Quality of the WebP compression, up to 100; a larger value gives larger files [-]."""


def pallet(name: str) -> Assembly:
    """An assembly of the lashing tutorial, by its name in the code of that page."""
    page = FOLDER.parent / "guides/straps.md"
    names: dict[str, Any] = {}
    with TemporaryDirectory() as folder, contextlib.chdir(folder):
        for block in re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), flags=re.S):
            exec(block, names)
    assembly: Assembly = names[name]
    return assembly


FIGURES: dict[str, tuple[int, Callable[[], Assembly]]] = {
    "arch": (LARGE, lambda: scene("arch")),
    "figure-8": (LARGE, lambda: scene("paper-figure-8")),
    "level-proved": (MIDDLE, lambda: block_on_slope(20, friction=0.5)),
    "level-settles": (MIDDLE, lambda: arch(9, planar=False)),
    "level-equilibrium": (MIDDLE, friction.h_block),
    "level-unstable": (MIDDLE, lambda: block_on_slope(28, friction=0.5)),
    "hard-bracket": (SMALL, lambda: friction.bracket(1.5)),
    "hard-h": (SMALL, friction.h_block),
    "hard-a": (SMALL, friction.a_block),
    "hard-books": (SMALL, friction.books),
    "hard-trough": (SMALL, lambda: friction.trough(30, tilt=44)),
    "lashing-pallet": (SMALL, lambda: pallet("load")),
    "hard-wedge": (SMALL, lambda: friction.trough(60, tilt=45)),
}
"""Width and assembly of each figure."""
POLAR = "lashing-polar"
"""Figure of the horizontal accelerations that a lashed load carries."""


def write(name: str) -> None:
    """Draw a figure and write it as WebP; that of accelerations as SVG."""
    if name == POLAR:
        kilter.draw(kilter.transport(pallet("enough"))).savefig(FOLDER / f"{POLAR}.svg")
        return
    width, build = FIGURES[name]
    figure = kilter.draw(kilter.check(build()))
    resolution = width / figure.get_figwidth()
    options = {"quality": QUALITY, "method": 6}
    figure.savefig(FOLDER / f"{name}.webp", dpi=resolution, pil_kwargs=options)


if __name__ == "__main__":
    for figure_name in sys.argv[1:] or [*FIGURES, POLAR]:
        write(figure_name)
