"""A hook of mkdocs: what is made from the library of scenes each time the site is built.

That is the gallery, and the live page that the home page holds in a frame. Nothing of it is kept
in the repository. ``KILTER_GALLERY=3`` builds the first three scenes only, for a quick look.
"""

from __future__ import annotations

import html
import os
from typing import Any

PAGE = "gallery.md"
LIVE = "corner-wedges"
"""The scene of the home page: its ball has a region with an inside and an outside."""
EFFORT = 1
"""Of what friction guarantees, a scene; what is open then says so."""
WORDS = {
    "stable": "Stable",
    "settles": "Settles",
    "potentially-stable": "Potentially stable",
    "unstable": "Unstable",
    "undecided": "Undecided",
}


def chosen() -> list[Any]:
    """The scenes of the gallery, in the order of the library."""
    from kilter.scenes import SCENES

    limit = os.environ.get("KILTER_GALLERY")
    return list(SCENES.values())[: int(limit) if limit else None]


def drawn(scene: Any) -> tuple[bytes, str]:
    """The picture of a scene, and what to say of it."""
    import kilter
    from kilter.show.canvas import rendered

    verdict = kilter.check(scene.build(), effort=EFFORT)
    picture = rendered(kilter.draw(verdict), ".png")
    entry = (
        f"\n## {scene.name}\n\n"
        f"{html.escape(scene.title)} ({html.escape(scene.source)}).\n\n"
        f"**{WORDS[verdict.verdict]}.** {html.escape(verdict.summary)}\n\n"
        f"![{scene.name}: {WORDS[verdict.verdict]}](gallery/{scene.name}.png){{ loading=lazy }}\n"
    )
    return picture, entry


def live() -> str:
    """The page of `kilter report` of the scene that the home page shows."""
    import kilter
    from kilter.scenes import scene

    return kilter.report(scene(LIVE), title="Six wedges in a corner").html


def on_files(files: Any, *, config: Any) -> Any:
    """Add the live page and the pictures, and the gallery in place of what only introduces it."""
    from mkdocs.structure.files import File

    files.append(File.generated(config, f"live/{LIVE}.html", content=live()))

    page = files.get_file_from_path(PAGE)
    parts = [page.content_string]
    for scene in chosen():
        picture, entry = drawn(scene)
        files.append(File.generated(config, f"gallery/{scene.name}.png", content=picture))
        parts.append(entry)
    files.remove(page)
    files.append(File.generated(config, PAGE, content="".join(parts)))
    return files
