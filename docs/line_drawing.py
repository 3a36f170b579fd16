"""Small line drawings of assemblies that stand or fall, as SVG in the reader's light or dark theme.

A `View` looks along a level axis, or from above, at shapes given in the frame of the scene. It is
scaled to its panel. Held parts are hatched; the shape of an arrow shows the kind of motion, as
its colour does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.tell.palette import GROUND, PALETTE, ROLES

WIDTH, HEIGHT, MARGIN, FOOT = 300.0, 160.0, 14.0, 12.0
"""Width and height of a picture, margin of a panel, and height of its caption [px]."""
REACH, GAP, HEAD = 34.0, 8.0, 6.0
"""Distances of the tip and tail of an arrow from its centre of mass; size of its head [px]."""
MARK = 4.5
"""Radius of a centre of mass [px]."""
STEPS = 48
"""Sides of the polygon that represents a circle."""
WAYS = {"falls": "unstable", "returns": "stable", "free": "ink"}
Path2 = Array
"""Points of a line, shape (n, 2)."""


def _themed(theme: str) -> str:
    """Style rules for the elements outside the parts."""
    colour = {name: getattr(ROLES[name], theme) for name in ROLES}
    ways = "".join(f".{way}{{stroke:{colour[role]}}}" for way, role in WAYS.items())
    heads = "".join(f".{way}.head{{fill:{colour[role]}}}" for way, role in WAYS.items())
    return (
        f"{ways}{heads}.rim{{stroke:{colour['surface']}}}.limit{{stroke:{colour['ink']}}}"
        f"text{{fill:{colour['soft']};stroke:{colour['surface']}}}"
        f".held,.part{{stroke:{colour['edge']}}}"
    )


STYLE = (
    "path,circle{fill:none;stroke-width:1.3;stroke-linejoin:round;stroke-linecap:round}"
    ".held{fill:url(#held)}.behind{fill-opacity:.45}.rim{stroke-width:5.5}"
    ".falls,.returns,.free{stroke-width:2.2}.head{stroke-width:1}"
    ".held,.part{fill-rule:evenodd}.limit{stroke-dasharray:4 3}"
    "text{font:10px system-ui,sans-serif;paint-order:stroke;stroke-width:3;stroke-linejoin:round}"
    + "".join(f".p{k}{{fill:{colour}}}" for k, colour in enumerate(PALETTE))
    + _themed("light")
    + f"@media(prefers-color-scheme:dark){{{_themed('dark')}}}"
)
HATCH = (
    '<pattern id="held" width="6" height="6" patternUnits="userSpaceOnUse" '
    'patternTransform="rotate(45)">'
    f'<path d="M0 0H6V6H0z" style="fill:{GROUND};stroke:none"/>'
    f'<path d="M0 0V6" style="stroke:{ROLES["hatch"].light};stroke-width:2"/></pattern>'
)


def arc(center: ArrayLike, radius: float, start: float, end: float) -> Path2:
    """Points of an arc [angles in degrees]."""
    turn = np.radians(np.linspace(start, end, 1 + max(4, int(abs(end - start) * STEPS / 360))))
    return np.asarray(center) + radius * np.column_stack([np.cos(turn), np.sin(turn)])


@dataclass
class View:
    """A view of the scene in a fixed direction.

    Attributes
    ----------
    right, up : ndarray, shape (3,)
        Directions of the page in the frame of the scene.
    name : str
        Caption below the panel, if there are several.
    close : bool
        Whether the view has its own scale.
    """

    right: Array
    up: Array
    name: str = ""
    close: bool = False
    shapes: list[tuple[str, Path2]] = field(default_factory=list)
    ways: list[tuple[str, Path2, Path2 | None, bool]] = field(default_factory=list)
    turns: list[tuple[str, Path2, float]] = field(default_factory=list)
    centers: list[Path2] = field(default_factory=list)
    limits: list[Path2] = field(default_factory=list)

    def flat(self, point: ArrayLike) -> Path2:
        """A point of the scene on the page."""
        return np.array([self.right, self.up]) @ np.asarray(point, dtype=float)

    # shapes -----------------------------------------------------------------------------

    def held(self, points: ArrayLike, behind: bool = False) -> None:
        """A held outline, closed."""
        self.shapes.append(("held behind" if behind else "held", np.asarray(points, dtype=float)))

    def part(self, points: ArrayLike, number: int = 0) -> None:
        """The outline of a free part, closed."""
        self.shapes.append((f"part p{number}", np.asarray(points, dtype=float)))

    # motions ----------------------------------------------------------------------------

    def center(self, point: ArrayLike) -> None:
        """A centre of mass."""
        self.centers.append(np.asarray(point, dtype=float))

    def limit(self, point: ArrayLike) -> None:
        """Position of the centre of mass at the limit."""
        self.limits.append(np.asarray(point, dtype=float))

    def way(
        self, kind: str, start: ArrayLike, about: ArrayLike | None = None, left: bool = False
    ) -> None:
        """Motion of a centre of mass (falls, returns, free), about a point or level."""
        middle = None if about is None else np.asarray(about, dtype=float)
        self.ways.append((kind, np.asarray(start, dtype=float), middle, left))

    def turn(self, kind: str, about: ArrayLike, radius: float) -> None:
        """A turn about a point, shown over it."""
        self.turns.append((kind, np.asarray(about, dtype=float), radius))

    def bounds(self) -> Array:
        """Lower left and upper right corner of all elements, shape (2, 2) [length unit]."""
        every = [points for _, points in self.shapes]
        every += [point[None] for point in (*self.centers, *self.limits)]
        every += [about[None] + [0, radius] for _, about, radius in self.turns]
        points = np.vstack(every)
        return np.array([np.nanmin(points, axis=0), np.nanmax(points, axis=0)])


@dataclass
class Panel:
    """A view at its position in the picture.

    Attributes
    ----------
    view : View
    middle : ndarray, shape (2,)
        Middle of the view [length unit].
    at : ndarray, shape (2,)
        Position of this middle in the picture [px].
    scale : float
        Scale of the view [px/length unit].
    """

    view: View
    middle: Path2
    at: Path2
    scale: float
    lines: list[str] = field(default_factory=list)

    def px(self, points: Path2) -> Path2:
        """Positions in the picture [px]."""
        return self.at + self.scale * (points - self.middle) * [1, -1]

    def path(self, look: str, points: Path2, closed: bool = False) -> None:
        """A line through points of the picture; a NaN point ends a line and begins the next."""
        pieces = np.split(points, np.flatnonzero(np.isnan(points[:, 0])))
        words = "".join(
            "M"
            + "L".join(f"{x:.1f} {y:.1f}" for x, y in piece[~np.isnan(piece[:, 0])])
            + ("z" if closed else "")
            for piece in pieces
        )
        self.lines.append(f'<path class="{look}" d="{words}"/>')

    def arrow(self, kind: str, points: Path2) -> None:
        """An arrow with a rim along points of the picture; its head is at the last point."""
        along = points[-1] - points[-2]
        along = along / np.hypot(*along)
        across = np.array([-along[1], along[0]])
        tip = points[-1]
        shaft = np.vstack([points[:-1], tip - HEAD * along])
        head = [tip, tip - HEAD * along * 1.3 + 0.62 * HEAD * across]
        head.append(tip - HEAD * along * 1.3 - 0.62 * HEAD * across)
        self.path("rim", shaft)
        self.path("rim", np.array(head), closed=True)
        self.path(kind, shaft)
        self.path(f"{kind} head", np.array(head), closed=True)

    def branches(self, kind: str, sides: Sequence[Path2]) -> None:
        """An arrow away for a fall, two arrows away for a free motion, two back for a return."""
        for points in sides[: 1 if kind == "falls" else 2]:
            self.arrow(kind, points[::-1] if kind == "returns" else points)

    def way(self, kind: str, start: Path2, about: Path2 | None, left: bool) -> None:
        """See `View.way`."""
        order = (-1, 1) if left else (1, -1)
        here, reach = self.px(start), np.linspace(GAP, REACH, 9)
        if about is None:
            self.branches(kind, [here + np.outer(reach, [s, 0]) for s in order])
            return
        pivot = self.px(about)
        arm = here - pivot
        radius = np.hypot(*arm)
        first = np.arctan2(arm[1], arm[0])
        level = np.sign(-arm[1]) or 1.0
        turned = reach / max(radius, REACH / 1.2)
        turns = [first + s * level * turned for s in order]
        self.branches(
            kind, [pivot + radius * np.column_stack([np.cos(t), np.sin(t)]) for t in turns]
        )

    def turned(self, kind: str, about: Path2, radius: float) -> None:
        """See `View.turn`."""
        arm = radius * self.scale
        start = 0.0 if kind == "free" else GAP
        turned = np.linspace(start, REACH, 9) / max(arm, REACH / 1.6)
        sides = [np.column_stack([np.sin(t), -np.cos(t)]) for t in (turned, -turned)]
        self.branches(kind, [self.px(about) + arm * side for side in sides])

    def center(self, point: Path2) -> None:
        """A quartered circle."""
        x, y = self.px(point)
        ink, paper = ROLES["ink"].light, ROLES["surface"].light
        self.lines.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{MARK}" style="fill:{paper};stroke:{ink}"/>'
            f'<path style="fill:{ink};stroke:none" d="M{x:.1f} {y:.1f}v-{MARK}a{MARK} {MARK} 0 0 1 '
            f'{MARK} {MARK}zv{MARK}a{MARK} {MARK} 0 0 1 -{MARK} -{MARK}z"/>'
        )

    def limit(self, point: Path2) -> None:
        """A dashed level line with a word."""
        here = self.px(point)
        self.path("limit", here + np.array([[-30, 0], [30, 0]]))
        x, y = here + np.array([38, 3])
        self.lines.append(f'<text x="{x:.1f}" y="{y:.1f}">limit</text>')

    def drawn(self) -> str:
        """SVG of the view: shapes, then limits, motions and centres of mass above them."""
        for look, points in self.view.shapes:
            self.path(look, self.px(points), closed=True)
        for point in self.view.limits:
            self.limit(point)
        for way in self.view.ways:
            self.way(*way)
        for turn in self.view.turns:
            self.turned(*turn)
        for point in self.view.centers:
            self.center(point)
        return "".join(self.lines)


def panels(views: Sequence[View]) -> list[Panel]:
    """The views side by side, with a common scale and height; close views have their own scale."""
    bounds = np.array([view.bounds() for view in views])
    level = [k for k, view in enumerate(views) if not view.close and view.up[2]]
    bounds[level, 0, 1] = bounds[level, 0, 1].min(initial=np.inf)
    bounds[level, 1, 1] = bounds[level, 1, 1].max(initial=-np.inf)
    size = bounds[:, 1] - bounds[:, 0]
    far = [k for k, view in enumerate(views) if not view.close]
    size[[k for k, view in enumerate(views) if view.close]] = size[far].max(initial=0)
    foot = FOOT if len(views) > 1 else 0.0
    room = WIDTH - (len(views) + 1) * 1.6 * MARGIN
    scale = min(room / size[:, 0].sum(), (HEIGHT - 2 * MARGIN - foot) / size[:, 1].max())
    slack = (WIDTH - scale * size[:, 0].sum()) / (len(views) + 1)
    left = slack * np.arange(1, len(views) + 1) + scale * (np.cumsum(size[:, 0]) - size[:, 0])
    found = []
    for k, view in enumerate(views):
        at = np.array([left[k] + scale * size[k, 0] / 2, (HEIGHT - foot) / 2])
        own = np.max((bounds[k, 1] - bounds[k, 0]) / size[k]) if view.close else 1.0
        found.append(Panel(view, bounds[k].mean(axis=0), at, scale / own))
    return found


def picture(views: Sequence[View], title: str) -> str:
    """The views as a single SVG, with captions if there are several."""
    drawn = []
    for panel in panels(views):
        drawn.append(panel.drawn())
        if len(views) > 1:
            x = panel.at[0]
            drawn.append(f'<text x="{x:.1f}" y="{HEIGHT - 4:g}" text-anchor="middle">'
                         f"{escape(panel.view.name)}</text>")  # fmt: skip
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" '
        f'aria-label="{escape(title)}"><style>{STYLE}</style><defs>{HATCH}</defs>'
        f"{''.join(drawn)}</svg>\n"
    )
