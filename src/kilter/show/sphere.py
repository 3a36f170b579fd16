"""Figure of the stable region on the sphere of directions of gravity.

Each point of the sphere is a direction of gravity in the frame of the assembly. Two pictures show
opposite halves of the sphere; the left half contains the recommended direction.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array, Mask
from kilter.show.canvas import INK, PAPER, legend, new_figure, title
from kilter.show.painter import Camera
from kilter.tell.csv_cells import REST_SIGNS
from kilter.tell.numbers import angle as angle_words
from kilter.tell.palette import ROLES
from kilter.tell.tables import region_sentence

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from kilter.analysis.regions.region import Region


FILL, BORDER = ROLES["stable-fill"].light, ROLES["stable"].light
BALL, GRID, GIVEN = (ROLES[name].light for name in ("page", "line", "ink"))
PALE = ROLES["soft"].light
REST_MARKS = {
    "minimum": ("D", GIVEN),
    "free": ("o", PALE),
    "balanced": ("P", PALE),
    "open": ("d", PALE),
}
"""Markers and colours of places of rest, by state."""
SAMPLES = 241
"""Number of samples across a half of the ball that fill the region; the border is exact."""
AROUND = np.linspace(0.0, 2 * np.pi, 721)
"""Angles of the points of a great circle [rad]."""
ON = 1e-7
"""Distance to a facet below which a direction counts as on it [-]."""


def draw_region(region: Region) -> Figure:
    """Draw the directions of gravity for which an assembly stays together.

    Raises `InputError` if matplotlib is not installed.
    """
    figure = new_figure(7.0, 4.3)
    given = region.assemblies[0].down
    middle = region.center if region.center is not None else given
    entries: dict[str, Any] = {}
    for k, (camera, words) in enumerate(_halves(middle)):
        axes = figure.add_axes((0.02 + 0.49 * k, 0.16, 0.47, 0.74))
        axes.set(xlim=(-1.3, 1.3), ylim=(-1.22, 1.22), aspect="equal")
        axes.set_axis_off()
        _draw_ball(axes, camera)
        entries |= _fill(axes, region, camera)
        entries |= _border(axes, region, camera)
        entries |= _marks(axes, region, camera, given)
        _axes_of_frame(axes, camera)
        axes.text(0, -1.24, words, ha="center", va="top", fontsize=8.5, color=PALE)
    sentence, wide = region_sentence(region.kind, friction=region.friction), ""
    if region.half_angle_deg not in (None, 0.0, 180.0):
        wide = f" The largest margin is {angle_words(region.half_angle_deg)}."
    inner = "" if region.exact else " More directions may be stable."
    title(figure, f"{sentence}{wide}{inner}", "" if region.kind == "none" else "stable")
    legend(figure, [(sign, words) for words, sign in entries.items()], columns=3)
    return figure


def _halves(middle: Array) -> list[tuple[Camera, str]]:
    """Two opposite cameras that together show the whole sphere, each with a caption.

    The first sees `middle` slightly from the side.
    """
    azimuth = float(np.degrees(np.arctan2(middle[0], -middle[1])))
    if np.hypot(middle[0], middle[1]) < ON:
        azimuth = 0.0
    height = float(np.degrees(np.arcsin(np.clip(middle[2], -1, 1))))
    elevation = float(np.clip(height, -55.0, 55.0))
    azimuth += -28.0
    near = Camera.at(azimuth, elevation)
    far = Camera.at(azimuth + 180.0, -elevation)
    return [(near, "from one side"), (far, "from the other side")]


def _draw_ball(axes: Axes, camera: Camera) -> None:
    """Draw the sphere with its parallels and meridians."""
    from matplotlib.patches import Circle

    axes.add_patch(Circle((0, 0), 1.0, facecolor=BALL, edgecolor=PALE, linewidth=0.9))
    circle = np.stack([np.cos(AROUND), np.sin(AROUND), 0 * AROUND], axis=-1)
    for angle in np.radians([-60, -30, 0, 30, 60]):
        _line(axes, circle * np.cos(angle) + [0, 0, np.sin(angle)], camera, GRID, 0.5)
    for angle in np.radians(range(0, 180, 30)):
        across = np.array([np.cos(angle), np.sin(angle), 0.0])
        meridian = np.outer(np.cos(AROUND), across) + np.outer(np.sin(AROUND), [0, 0, 1.0])
        _line(axes, meridian, camera, GRID, 0.5)


def _line(axes: Axes, points: Array, camera: Camera, colour: str, width: float) -> bool:
    """Draw the near side of a curve on the sphere; return whether anything was drawn."""
    flat = camera.flat(points)
    near = points @ camera.towards >= -ON
    flat[~near] = np.nan
    axes.plot(*flat.T, color=colour, linewidth=width, solid_capstyle="round", zorder=2 + width / 9)
    return bool(near.any())


def _fill(axes: Axes, region: Region, camera: Camera) -> dict[str, Any]:
    """Fill a region of full dimension on the sphere; return its legend entry."""
    from matplotlib.patches import Circle, Patch

    if region.dimension < 3:
        return {}
    across = np.linspace(-1.0, 1.0, SAMPLES)
    x, y = np.meshgrid(across, across)
    # samples beyond the rim take the value on the rim, so that the fill reaches it
    size = np.maximum(np.hypot(x, y), 1.0)
    u, v = x / size, y / size
    depth = np.sqrt(np.maximum(1.0 - u**2 - v**2, 0.0))
    points = u[..., None] * camera.right + v[..., None] * camera.up
    points = points + depth[..., None] * camera.towards
    inside = np.ones(x.shape)
    if len(region.cone.facets):
        inside = (points @ region.cone.facets.T).min(axis=-1)
    if (inside > 0).any():
        drawn = axes.contourf(x, y, inside, levels=[0.0, 2.0], colors=[FILL], zorder=1.5)
        drawn.set_clip_path(Circle((0, 0), 1.0, transform=axes.transData))
        drawn.set_alpha(0.85)
    return {"stable directions": Patch(facecolor=FILL, edgecolor=BORDER)}


def _border(axes: Axes, region: Region, camera: Camera) -> dict[str, Any]:
    """Draw the boundary of a region as great circles; a flat region is drawn itself.

    Return its legend entry.
    """
    from matplotlib.lines import Line2D

    if region.dimension < 2:
        return {}
    flat_region = region.dimension == 2
    normals = region.equations if flat_region else region.cone.facets
    for normal in normals:
        circle = _arc(normal, region.cone.facets)
        _line(axes, circle, camera, BORDER, 3.4 if flat_region else 1.8)
    if not flat_region:
        return {}
    return {"stable directions": Line2D([], [], color=BORDER, linewidth=3.4)}


def _arc(normal: Array, facets: Array) -> Array:
    """Points of the great circle about `normal` that satisfy all facets; NaN elsewhere."""
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    # the ends, where a facet is met, are among the samples
    ends = np.arctan2(-(facets @ first), facets @ second)
    angles = np.sort(np.concatenate([AROUND, ends % (2 * np.pi), (ends + np.pi) % (2 * np.pi)]))
    circle = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second)
    allowed: Mask = np.asarray((circle @ facets.T >= -ON).all(axis=1))
    return np.where(allowed[:, None], circle, np.nan)


def _marks(axes: Axes, region: Region, camera: Camera, given: Array) -> dict[str, Any]:
    """Draw stable directions, the recommended direction, places of rest, and given gravity.

    Return their legend entries.
    """
    single = np.vstack([region.rays, region.lines, -region.lines])
    entries: dict[str, Any] = {}
    if region.dimension == 1:
        entries["stable direction"] = _dots(axes, single, camera, "o", BORDER, 9)
    elif region.center is not None:
        sign = _dots(axes, region.center[None], camera, "*", BORDER, 11)
        entries["largest margin"] = sign
    for state, sign in REST_SIGNS.items():
        rests = [rest.down for rest in region.rests if rest.state == state]
        if rests:
            marker, colour = REST_MARKS[state]
            shown = _dots(axes, np.array(rests), camera, marker, colour, 7)
            entries[f"rest: {sign}"] = shown
    entries["gravity as given"] = _dots(axes, given[None], camera, "X", GIVEN, 7)
    return entries


def _dots(axes: Axes, points: Array, camera: Camera, sign: str, colour: str, size: float) -> Any:
    """Draw directions on the near side as markers, and return the marker for the legend."""
    from matplotlib.lines import Line2D

    style: dict[str, Any] = {
        "marker": sign,
        "color": colour,
        "markersize": size,
        "markeredgecolor": PAPER,
        "markeredgewidth": 0.9,
        "linestyle": "none",
    }
    near = points[points @ camera.towards >= -ON]
    axes.plot(*camera.flat(near).T, zorder=5, clip_on=False, **style)
    return Line2D([], [], **style)


def _axes_of_frame(axes: Axes, camera: Camera) -> None:
    """Write the names of the axes at the points where they leave the near side of the sphere."""
    for name, axis in zip("xyz", np.eye(3), strict=True):
        for sign, word in ((1.0, f"+{name}"), (-1.0, f"\N{MINUS SIGN}{name}")):
            point = sign * axis
            if point @ camera.towards < -ON:
                continue
            x, y = camera.flat(point)
            axes.plot(x, y, ".", color=PALE, markersize=4, zorder=3)
            style: dict[str, Any] = {"fontsize": 8.5, "color": INK, "ha": "center", "va": "center"}
            size = float(np.hypot(x, y))
            aside = np.array([x, y]) / size if size > 0.2 else np.array([0.0, 1.0])
            x, y = [x, y] + 0.13 * aside
            axes.text(float(x), float(y), word, zorder=6, **style)
