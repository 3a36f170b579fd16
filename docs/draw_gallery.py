"""Draw the twelve thumbnails of README, each with the command that draws it.

python docs/draw_gallery.py    draw all, and write the table of README

Needs the extra `figures`. The site has all scenes (docs/build_gallery.py).
"""

from __future__ import annotations

import io
import re
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs/images/gallery"
WIDTH, HEIGHT = 300, 225
"""Size of a thumbnail [pixels]."""
COLUMNS = 4
BEGIN, END = "<!-- gallery: begin -->", "<!-- gallery: end -->"


class Entry(NamedTuple):
    """A thumbnail: the example, the words of its command around the file, and its caption."""

    scene: str
    command: str
    options: str
    caption: str


ENTRIES = (
    Entry("paper-figure-8", "draw", "-o out.png", "which parts move, and how"),
    Entry("arch", "draw", "-o out.png", "the forces between the stones"),
    Entry("wall-with-opening", "draw", "-o out.png", "a brick without a support"),
    Entry("three-cylinders", "draw", "-o out.png", "round parts with friction"),
    Entry("corner-wedges", "draw", "--what region -o out.png", "all stable directions"),
    Entry("paper-figure-10", "draw", "--what region -o out.png", "a fan of stable directions"),
    Entry("harmonic-stack", "draw", "-o out.png", "a stack at its limit"),
    Entry("tilted-wall", "draw", "-o out.png", "a leaning wall"),
    Entry("keystone", "plan", "-o out.png", "an order of assembly"),
    Entry("box-pile", "transport", "--friction 0.5 --figure out.png", "carried accelerations"),
    Entry("mortared-corbel", "draw", "-o out.png", "mortar that breaks at a limit"),
    Entry("cad-export", "draw", "-o out.png", "CAD with gaps and a thread"),
)


def words(entry: Entry) -> list[str]:
    """Arguments of the command of an entry."""
    return [entry.command, f"{entry.scene}.kilter.json", *entry.options.split()]


def table() -> str:
    """The table of README: thumbnails in rows of four, each with its command."""
    lines = ["<table>"]
    for k in range(0, len(ENTRIES), COLUMNS):
        lines.append("<tr>")
        for entry in ENTRIES[k : k + COLUMNS]:
            picture = f"docs/images/gallery/{entry.scene}.webp"
            lines += [
                f'<td><img src="{picture}" alt="{entry.caption}" width="{WIDTH}"><br>',
                f"{entry.caption}<br><code>kilter {' '.join(words(entry))}</code></td>",
            ]
        lines.append("</tr>")
    return "\n".join([*lines, "</table>"])


def with_table(readme: str) -> str:
    """Text of README with the present table."""
    block = f"{BEGIN}\n{table()}\n{END}"
    pattern = re.compile(rf"{re.escape(BEGIN)}.*?{re.escape(END)}", re.DOTALL)
    found, count = pattern.subn(lambda _: block, readme)
    if count != 1:
        raise ValueError(f"README.md has {count} blocks between {BEGIN} and {END}, not 1")
    return found


def draw(entry: Entry, folder: Path) -> Path:
    """Run the command of an entry in a folder, and return the picture."""
    from kilter import dump, example
    from kilter.cli import main

    file, out = folder / f"{entry.scene}.kilter.json", folder / f"{entry.scene}.png"
    dump(example(entry.scene), file)
    given = [str(file) if word == file.name else word for word in words(entry)]
    main([*(str(out) if word == "out.png" else word for word in given), "--quiet"])
    return out


def thumbnail(picture: Path) -> bytes:
    """A picture reduced to the size of a thumbnail, on white."""
    from PIL import Image, ImageOps

    from kilter.show.canvas import PAPER

    image = Image.open(picture).convert("RGB")
    image = ImageOps.pad(image, (WIDTH, HEIGHT), Image.Resampling.LANCZOS, color=PAPER)
    stream = io.BytesIO()
    image.save(stream, "WEBP", quality=70, method=6)
    return stream.getvalue()


def main() -> None:
    """Draw all thumbnails, and write the table of README."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for entry in ENTRIES:
            picture = thumbnail(draw(entry, Path(folder)))
            (FOLDER / f"{entry.scene}.webp").write_bytes(picture)
    readme = ROOT / "README.md"
    readme.write_text(with_table(readme.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
