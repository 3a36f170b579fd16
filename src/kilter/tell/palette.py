"""Colours and their meaning, in light and dark.

Pages, figures, sheets, films, notebooks and docs take all their colours from this module. Readers
with any colour blindness can distinguish the signs, and words have sufficient contrast. A word or
a shape repeats the meaning of every colour. Figures use the light colours.

References
----------
M. Okabe, K. Ito, Color universal design, 2008.
W3C, Web Content Accessibility Guidelines 2.2, 1.4.3 and 1.4.11.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Role:
    """A colour of the pages and pictures, with its meaning."""

    light: str
    dark: str
    """The colour as #rrggbb in a light and in a dark theme."""
    use: str
    """One of "sign", "word", "fill", "ground"."""
    says: str
    """Meaning of the colour."""


ROLES = {
    "stable": Role("#0066b4", "#4fa8f0", "sign", "stable: a verdict, a region and its boundary"),
    "unstable": Role("#c24e00", "#ff8a3d", "sign", "unstable, and motion: arrows, edges, ghosts"),
    "force": Role("#006b50", "#4fdcab", "sign", "contact force, line of thrust"),
    "limit": Role("#6a0018", "#fff3b0", "sign", "force at the limit of its friction or bond"),
    "patch": Role("#a3307f", "#e070b8", "sign", "contact patch"),
    "open": Role(
        "#f5b800", "#e8b400", "sign", "open pair: the geometry does not determine its contact"
    ),
    "ink": Role("#1b2530", "#e8edf2", "sign", "text, gravity, loads"),
    "undecided": Role("#5b6673", "#8d99ad", "word", "undecided, unknown"),
    "grip": Role("#0066b4", "#4fa8f0", "word", "part held by a hand, drawn in stripes"),
    "link": Role("#005a8d", "#7cc8f7", "word", "link"),
    "soft": Role("#5b6673", "#a3afbb", "word", "text of less weight"),
    "focus": Role("#0066b4", "#7cc8f7", "fill", "element with the keyboard focus"),
    "picked": Role("#ffdb00", "#ffdb00", "fill", "picked part, drawn in stripes; brick to add"),
    "stable-fill": Role("#4aa3dc", "#3b9bd8", "fill", "stable directions of the ball"),
    "stable-edge": Role("#ffffff", "#0b1620", "fill", "rim of the boundary of the region"),
    "unstable-fill": Role(
        "#f3c19b", "#b5754a", "fill", "unstable directions of unknown instability"
    ),
    "undecided-fill": Role("#f0e4a0", "#b39a2f", "fill", "undecided directions"),
    "blank": Role("#cfd5dc", "#56616d", "fill", "directions that are not mapped"),
    "edge": Role("#22303c", "#0a0f14", "fill", "edges of parts"),
    "hatch": Role("#8f969e", "#565e67", "fill", "stripes of held parts"),
    "line": Role("#d8dde3", "#35404b", "ground", "rules and frames"),
    "surface": Role("#ffffff", "#1c232b", "ground", "cards, rims of arrows"),
    "page": Role("#f3f4f6", "#12171d", "ground", "the page"),
    "stage-top": Role("#fbfcfd", "#2a333d", "ground", "behind the picture, above"),
    "stage-bottom": Role("#dfe5ec", "#171d24", "ground", "behind the picture, below"),
    "stage-floor": Role("#cfd5dc", "#39424c", "ground", "floor under an assembly"),
}
"""Colours by name; each is a CSS property of this name."""
GROUND = "#c3c8ce"
"""Colour of held parts under their stripes. Part colours are equal in light and dark."""
PALETTE = (
    "#7fb2d9",
    "#e8c268",
    "#7cc4a8",
    "#d9a3c0",
    "#a8c6e8",
    "#c9b38c",
    "#9fa8da",
    "#b7d17a",
)
"""Colours of free parts, in the order in which parts get them. They are pale, so that signs stand
out."""
BODIES = ("#9494f2", "#f0e070", "#40b0d0", "#f07494", "#a0f0b0", "#d09464")
"""Colours of bodies of joined parts, in the order of the bodies. Every two of them differ for
readers with any colour blindness."""
RAMP = ("#fff6de", "#fdd68c", "#f3a14b", "#d55e00", "#8c3006")
"""Scale of instability or of the use of bonds. Its lightness falls from none to the most, so that
it can be read without hue."""
VERDICT_ROLE = {
    "stable": "stable",
    "found": "stable",
    "held": "stable",
    "settles": "stable",
    "potentially-stable": "stable",
    "balanced": "stable",
    "unstable": "unstable",
    "impossible": "unstable",
    "fails": "unstable",
    "none": "unstable",
}
"""Role of each verdict. Every other verdict has the role undecided."""


def ink_of(verdict: str) -> str:
    """Return the text colour for a verdict on a white background.

    Examples
    --------
    >>> ink_of("settles") == ROLES["stable"].light, ink_of("?") == ROLES["undecided"].light
    (True, True)
    """
    return ROLES[VERDICT_ROLE.get(verdict, "undecided")].light


def rgb(text: str) -> tuple[int, int, int]:
    """Return red, green and blue of a colour like "#1a2b3c", each from 0 to 255.

    Examples
    --------
    >>> rgb("#ff8000")
    (255, 128, 0)
    """
    red, green, blue = (int(text[k : k + 2], 16) for k in (1, 3, 5))
    return red, green, blue


def as_css() -> str:
    """Return the style sheet with all colours, for light and dark backgrounds."""
    light, dark = (
        _properties([getattr(role, theme) for role in ROLES.values()]) for theme in _THEMES
    )
    ramp = f"--ramp: {', '.join(RAMP)}; --bodies: {', '.join(BODIES)}; --ground: {GROUND};"
    return (
        f":root {{ color-scheme: light; {light} {ramp} }}\n"
        "@media (prefers-color-scheme: dark) "
        f'{{ :root:not([data-theme="light"]) {{ color-scheme: dark; {dark} }} }}\n'
        f':root[data-theme="dark"] {{ color-scheme: dark; {dark} }}\n'
    )


_THEMES = ("light", "dark")


def _properties(colours: list[str]) -> str:
    return " ".join(f"--{name}: {colour};" for name, colour in zip(ROLES, colours, strict=True))
