"""A hook of mkdocs that adds the gallery and the live pages of six assemblies to the site.

Both are computed from the library of scenes in each build and are not kept in the repository.
``KILTER_GALLERY=3`` builds only the first three scenes, for a quick look.
"""

from __future__ import annotations

import html
import os
import re
from pathlib import Path
from typing import Any

PAGE = "gallery.md"
LIVE = (
    "corner-wedges",
    "arch",
    "paper-figure-8",
    "wall-with-opening",
    "keystone",
    "mortared-corbel",
)
"""Scenes with a live page; the first is that of the home page: its ball has a region with an inside
and an outside."""
EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
"""Files of the guides, which readers of the site download."""
EFFORT = 1
"""Effort of each verdict with friction."""
WORDS = {
    "stable": "Stable",
    "settles": "Settles",
    "potentially-stable": "Potentially stable",
    "balanced": "Balanced",
    "unstable": "Unstable",
    "undecided": "Undecided",
}


def chosen() -> list[Any]:
    """The scenes of the gallery, in the order of the library."""
    from kilter.scenes import SCENES

    limit = os.environ.get("KILTER_GALLERY")
    return list(SCENES.values())[: int(limit) if limit else None]


def drawn(scene: Any) -> tuple[bytes, str]:
    """The picture of a scene, and its entry in the gallery."""
    import kilter
    from kilter.show.canvas import encode_figure

    verdict = kilter.check(scene.build(), effort=EFFORT)
    picture = encode_figure(kilter.draw(verdict), ".png")
    entry = (
        f"\n## {scene.name}\n\n"
        f"{html.escape(scene.title)} ({html.escape(scene.source)}).\n\n"
        f"**{WORDS[verdict.verdict]}.** {html.escape(verdict.summary)}\n\n"
        f"![{scene.name}: {WORDS[verdict.verdict]}](gallery/{scene.name}.png){{ loading=lazy }}\n"
    )
    return picture, entry


def live(name: str) -> str:
    """The page of `kilter report` of a scene."""
    import kilter
    from kilter.scenes import SCENES

    title = SCENES[name].title
    return kilter.report(SCENES[name].build(), title=f"{title[0].upper()}{title[1:]}").html


def on_files(files: Any, *, config: Any) -> Any:
    """Add the live page and the pictures, and replace the introduction by the whole gallery."""
    from mkdocs.structure.files import File

    from kilter.scenes import SCENES

    for name in LIVE:
        files.append(File.generated(config, f"live/{name}.html", content=live(name)))
    for path in sorted(EXAMPLES.iterdir()):
        files.append(File.generated(config, f"examples/{path.name}", content=path.read_bytes()))

    page = files.get_file_from_path(PAGE)
    links = [f"- [{SCENES[name].title}](live/{name}.html)\n" for name in LIVE]
    parts = [page.content_string, "\n", *links]
    for scene in chosen():
        picture, entry = drawn(scene)
        files.append(File.generated(config, f"gallery/{scene.name}.png", content=picture))
        parts.append(entry)
    files.remove(page)
    files.append(File.generated(config, PAGE, content="".join(parts)))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Shorten links to examples: in a clone this folder is beside docs, on the site within it."""
    return re.sub(r"\]\(\.\./((?:\.\./)*examples/)", r"](\1", markdown)
