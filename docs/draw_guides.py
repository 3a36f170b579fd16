"""Pictures of the guides, drawn from the example files: ``python docs/draw_guides.py``."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageChops

from kilter.cli import main

DOCS = Path(__file__).resolve().parent
EXAMPLES = DOCS.parent / "examples"
WIDTH = 640
"""Width of a picture [px]."""
PICTURES = {
    "cad": "stand.FCStd",
    "loads": "stand.FCStd --assume joined --friction 0.4 --load pot=0,0,-60",
    "straps": "load.csv --floor --friction 0.35 --straps straps.json",
    "start-states": "desk.xml --friction 0.6",
    "thrust": "arch-compas.json --friction 0.6 --what thrust",
    "movement": "arch-compas.json --friction 0.6 --what movement --move support-right=0.01,0,0",
    "bricks": "crane.ldr",
    "packing": "pallet.csv --floor",
}
"""Options of `kilter draw` for each picture."""


def draw(name: str, options: str) -> None:
    """Draw a picture, without its empty margins, into the folder of the pictures."""
    file, *words = shlex.split(options)
    words = [str(EXAMPLES / w) if (EXAMPLES / w).is_file() else w for w in words]
    with TemporaryDirectory() as folder:
        out = Path(folder) / "out.png"
        code = main(["draw", str(EXAMPLES / file), *words, "-o", str(out), "--quiet"])
        if code:
            raise SystemExit(f"{name}: kilter draw ended with {code}")
        image = Image.open(out).convert("RGB")
    blank = Image.new("RGB", image.size, image.getpixel((0, 0)))
    image = image.crop(ImageChops.difference(image, blank).getbbox())
    image.thumbnail((WIDTH, WIDTH), Image.Resampling.LANCZOS)
    image.save(DOCS / f"images/guide-{name}.webp", quality=80, method=6)


if __name__ == "__main__":
    for name in sys.argv[1:] or PICTURES:
        draw(name, PICTURES[name])
