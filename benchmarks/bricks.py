"""CPU time of reading and checking models of toy bricks.

    python benchmarks/bricks.py [FILE or NUMBER ...]

A FILE is any file that `kilter.load` reads, including BrickGPT structures. A NUMBER is the number
of bricks of a random model; the default is 10 to 5,000. The first model runs twice, and its first
run is not shown.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import kilter
from kilter.assembly.part import BRICK_PLATES
from kilter.scenes.random_bricks import random_bricks

SIZES = ("10", "30", "100", "300", "1000", "2000", "5000")


def text_of(count: int) -> str:
    """A random model as BrickGPT text."""
    model = random_bricks(count, seed=count)
    rows = zip(model.corner.tolist(), model.size.tolist(), strict=True)
    return "".join(f"{a}x{b} ({x},{y},{z // BRICK_PLATES})\n" for (x, y, z), (a, b, _) in rows)


def files(asked: list[str], folder: Path) -> Iterator[Path]:
    """Yield the file of each requested model."""
    for one in asked:
        if one.isdigit():
            path = folder / f"random-{one}.txt"
            path.write_text(text_of(int(one)), encoding="utf-8")
            yield path
        else:
            yield Path(one)


def main() -> None:
    """Print a row for each model."""
    asked = sys.argv[1:] or list(SIZES)
    print(f"{'model':24}{'bricks':>8}{'bonds':>8}{'read':>9}{'check':>9}  verdict")
    with tempfile.TemporaryDirectory() as folder:
        paths = list(files([asked[0], *asked], Path(folder)))
        for k, path in enumerate(paths):
            start = time.process_time()
            assembly = kilter.load(path)
            read = time.process_time()
            verdict = kilter.check(assembly)
            done = time.process_time()
            if k:
                counts = f"{len(assembly) - 1:>8}{len(assembly.bonds):>8}"
                seconds = f"{read - start:>9.3f}{done - read:>9.3f}"
                print(f"{path.stem:24}{counts}{seconds}  {verdict.verdict}")


if __name__ == "__main__":
    main()
