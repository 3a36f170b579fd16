"""Names of pages, figures and films: their endings, and the titles of pages."""

from __future__ import annotations

from pathlib import Path

from kilter.errors import InputError
from kilter.validate import LARGEST

__all__ = [
    "FILMS",
    "PAGES",
    "require_ending",
    "require_figure",
    "require_film",
    "title_of",
]

PAGES = (".html", ".htm")
"""File endings of pages; no input file has them, so a typing error cannot overwrite an input."""
FILMS = (".glb",)
"""Endings of films."""


def require_ending(out: str | Path, endings: tuple[str, ...], what: str, also: str = "") -> None:
    """Reject an output name with a wrong ending, so that no input file is overwritten."""
    if Path(out).suffix.lower() not in endings:
        hint = f"use a name that ends in {', '.join(endings)}{also}"
        raise InputError(f"not a file name for a {what}", file=str(out), hint=hint)


def require_film(what: str, view: tuple[float, float] | None) -> None:
    """Reject options that do not apply to a film, before any computation."""
    if what != "assembly":
        raise InputError(
            f"a {what} has no motion", hint="write a figure: out.svg, out.png or out.pdf"
        )
    if view is not None:
        raise InputError("a film has no view", hint="leave the view out; its viewer turns the film")


def require_figure(out: str | Path | None, view: tuple[float, float] | None) -> None:
    """Reject a file ending or a view that cannot be drawn, before any computation."""
    from kilter.show.canvas import SUFFIXES, require

    if out is not None:
        require_ending(out, SUFFIXES, "figure", f", or in {', '.join(FILMS)} for a film")
    # not `isfinite`: it fails for an integer of hundreds of digits
    if view is not None and not all(abs(angle) < LARGEST for angle in view):
        raise InputError(
            f"the view is {view[0]!s:.20} {view[1]!s:.20}",
            hint="give two angles in degrees",
            option="give two angles in degrees: --view -32 22",
        )
    require()


def title_of(source: str) -> str:
    """Name of a file without its folders and endings, as a title."""
    if source == "-":
        return "standard input"
    return Path(source).resolve().name.removesuffix(".json").removesuffix(".kilter")
