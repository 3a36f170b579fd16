"""Drawings over the parts of a figure: contact patches, arrows of motion and force, names, gravity.

Arrows are in proportion to each other; the legend states the value of the longest.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.rigid import quaternion_to_matrix, screwed
from kilter.show.canvas import INK, PAPER, label
from kilter.show.painter import Camera
from kilter.show.shapes import place_shapes
from kilter.tell.numbers import force
from kilter.tell.palette import ROLES
from kilter.tell.words import GAINS
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly import Assembly


MOTION, FORCE, PATCH = (ROLES[name].light for name in ("unstable", "force", "patch"))
PATCH_FILL, PATCH_EDGE = (PATCH, 0.15), (PATCH, 0.7)
SHOWN = 0.02
"""Share of the longest arrow below which arrows are left out [-]."""
ARROWS = 400
"""Maximum number of arrows; the shortest are left out."""
GHOSTS = 60
"""Largest number of moving parts that are also drawn as displaced outlines."""
ARC = np.linspace(0.0, 1.5 * np.pi, 40)
"""Angles of the arrow of a rotation [rad]."""
GRAVITY_AT = (0.052, 0.80)
"""Start of the arrow of gravity [size of the figure]."""
FRAME_AT, FRAME = (30.0, 42.0), 24.0
"""Origin of the axes of the frame, and their length [pt]."""
PALE = ROLES["soft"].light
PLATE = (PAPER, 0.68)
"""Background colour of a name, and its opacity."""
HEAD = "-|>,head_width={},head_length={}"
CANDIDATES = 12
"""Number of largest faces of a part that are tried as the place of its name."""
HEAD_SIZE = 11.0
"""Size of an arrow head [pt]; heads of short arrows are smaller."""
KIND = {"potentially-stable": "a possible ", "undecided": "with the modelled contacts alone: "}
"""First words of the legend of a motion, for verdicts that do not assert that it occurs."""
STRAP = 2.2
"""Width of the line of a strap [pt]."""
HALO = 2.6
"""Width of the light outline around an arrow [pt]."""


def draw_patches(axes: Axes, verdict: Verdict, camera: Camera) -> list[tuple[Any, str]]:
    """Draw the contact patches over the parts; return the legend entry."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    contacts = verdict.contact_set
    flat, starts = camera.flat(contacts.points), contacts.patch_start
    outlines = [_outline_order(flat[a:b]) for a, b in pairwise(starts.tolist()) if b > a + 1]
    if not outlines:
        return []
    style: dict[str, Any] = {"facecolor": PATCH_FILL, "edgecolor": PATCH_EDGE, "linewidth": 0.9}
    axes.add_collection(PolyCollection(outlines, zorder=2, **style))
    count = len(contacts)
    return [(Patch(**style), f"{count} contact patch{'es' if count > 1 else ''}")]


def draw_straps(axes: Axes, assembly: Assembly, camera: Camera) -> list[tuple[Any, str]]:
    """Draw the paths of the straps as lines over the parts; return the legend entry."""
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D
    from matplotlib.patheffects import Normal, withStroke

    lines = [camera.flat(strap.points) for strap in assembly.straps]
    if not lines:
        return []
    outline = [withStroke(linewidth=STRAP + HALO, foreground=PAPER), Normal()]
    style: dict[str, Any] = {"linewidth": STRAP, "path_effects": outline, "zorder": 3}
    axes.add_collection(LineCollection(lines, colors=INK, **style))
    words = f"{len(lines)} strap{'s' if len(lines) > 1 else ''}"
    return [(Line2D([], [], color=INK, linewidth=STRAP), words)]


def _outline_order(flat: Array) -> Array:
    """Order of the corners of a convex patch by angle around its middle, as seen on the page."""
    apart = flat - flat.mean(axis=0)
    return flat[np.argsort(np.arctan2(apart[:, 1], apart[:, 0]), kind="stable")]


def draw_motion(
    axes: Axes, verdict: Verdict, camera: Camera, longest: float
) -> list[tuple[Any, str]]:
    """Draw arrows of the impending motion, and enlarged outlines of the displaced parts.

    `longest`: length of the longest arrow [length unit]. Returns the legend entries.
    """
    motion, geometry = verdict.motion, verdict.assembly.geometry
    if not motion.known:
        return _ghosts(axes, verdict, camera, 0.6 * longest)
    linear = np.where(motion.moves[:, None], motion.acceleration[:, :3], 0.0)
    most = float(np.linalg.norm(linear, axis=1).max())
    gravity = float(np.linalg.norm(verdict.assembly.gravity))
    words = f"{KIND.get(verdict.verdict, '')}first acceleration, longest {most / gravity:.3g} g"
    entries = draw_arrows(axes, camera, geometry.center, linear, longest, words)
    turning = motion.relative[:, 1]
    turns = np.flatnonzero(motion.moves & (turning > 0.1 * float(motion.relative.max())))
    for k in turns[np.argsort(-turning[turns], kind="stable")][:ARROWS]:
        _rotation_arrow(
            axes, camera, geometry.center[k], motion.acceleration[k, 3:], geometry.radius[k]
        )
    if len(turns):
        fastest = float(np.linalg.norm(motion.acceleration[turns, 3:], axis=1).max())
        entries.append((_sign(MOTION, "dotted"), f"rotation, fastest {fastest:.3g} rad/s²"))
    return entries + _ghosts(axes, verdict, camera, 0.6 * longest)


def draw_arrows(
    axes: Axes, camera: Camera, starts: Array, vectors: Array, longest: float, words: str
) -> list[tuple[Any, str]]:
    """Draw arrows in proportion to vectors; return the legend entry, which `words` describe.

    Arguments: `starts`, `vectors` (N, 3); `longest`: length of the longest arrow [length unit].
    """
    sizes = np.linalg.norm(vectors, axis=1)
    most = float(sizes.max(initial=0.0))
    shown = np.flatnonzero(sizes > SHOWN * most)
    for k in shown[np.argsort(-sizes[shown], kind="stable")][:ARROWS]:
        ends = camera.flat(np.array([starts[k], starts[k] + vectors[k] * longest / most]))
        _arrow(axes, ends, MOTION, float(sizes[k] / most))
    return [(_sign(MOTION), words)] if len(shown) else []


def _ghosts(axes: Axes, verdict: Verdict, camera: Camera, farthest: float) -> list[tuple[Any, str]]:
    """Draw the edges of the moving parts, displaced along their impending motion or the proof's.

    `farthest`: largest displacement of a point [length unit].
    """
    motion, assembly = verdict.motion, verdict.assembly
    moving = np.flatnonzero(motion.moves)
    screws = motion.screws(metres_per_unit(assembly.units))
    if len(moving) > GHOSTS or not screws[moving].any():
        return []
    center = assembly.geometry.center
    edges, paths = [], []
    for k, corners, pairs in _corners(assembly, moving):
        ends = corners[pairs]
        edges.append(ends)
        paths.append(screws[k, :3] + np.cross(screws[k, 3:], ends - center[k]))
    start, path = np.concatenate(edges), np.concatenate(paths)
    most = float(np.linalg.norm(path, axis=-1).max())
    words = "displaced parts, enlarged" if motion.known else f"parts displaced {GAINS}"
    return _outlines(axes, camera.flat(start + path * farthest / most), words)


def draw_fall(axes: Axes, verdict: Verdict, camera: Camera, end: Array) -> list[tuple[Any, str]]:
    """Draw the edges of the parts in the positions at the end of their fall.

    `end`, shape (N, 6): shift [length unit] and rotation vector [rad] of each part.
    """
    words = "after a small push, without friction"
    return draw_displaced(axes, verdict.assembly, camera, end, words)


def draw_displaced(
    axes: Axes, assembly: Assembly, camera: Camera, end: Array, words: str
) -> list[tuple[Any, str]]:
    """Draw the edges of displaced parts as dashed lines; return the legend entry with `words`.

    `end`, shape (N, 6): shift [length unit] and rotation vector [rad] of each part.
    """
    from scipy.spatial import ConvexHull

    center = assembly.geometry.center
    fallen = np.flatnonzero(end.any(axis=1))
    if len(fallen) > GHOSTS:
        return []
    lines = []
    for k, corners, pairs in _corners(assembly, fallen):
        turns, _ = screwed(np.append(np.zeros(3), end[k, 3:]), [1.0])
        flat = camera.flat((corners - center[k]) @ turns[0].T + center[k] + end[k, :3])
        # a ball has no feature edges: draw its outline on the page
        lines.append(flat[pairs if len(pairs) else ConvexHull(flat).simplices])
    return _outlines(axes, np.concatenate(lines), words)


def _corners(assembly: Assembly, parts: Index) -> list[tuple[int, Array, Index]]:
    """Index, vertices (m, 3) in the world, and feature edges (e, 2) of each of the given parts."""
    places = place_shapes(assembly)
    rows = []
    for k in parts.tolist():
        shape, matrix = places.shapes[places.shape[k]], quaternion_to_matrix(places.rotation[k])
        corners = shape.positions.astype(np.float64) @ matrix.T + places.position[k]
        rows.append((k, corners, shape.edges))
    return rows


def draw_outlines(
    axes: Axes, assembly: Assembly, camera: Camera, parts: Index, words: str
) -> list[tuple[Any, str]]:
    """Draw the edges of parts at rest as dashed lines; return the legend entry with `words`."""
    lines = [camera.flat(corners[pairs]) for _, corners, pairs in _corners(assembly, parts)]
    return _outlines(axes, np.concatenate(lines), words, PALE)


def _outlines(axes: Axes, lines: Array, words: str, colour: str = MOTION) -> list[tuple[Any, str]]:
    """Draw the outlines of parts as dashed lines; return the legend entry."""
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

    style: dict[str, Any] = {"linewidths": 0.9, "linestyles": (0, (4, 2.4)), "alpha": 0.75}
    axes.add_collection(LineCollection(list(lines), colors=colour, zorder=3, **style))
    sign = Line2D([], [], color=colour, linewidth=0.9, linestyle=(0, (4, 2.4)), alpha=0.75)
    return [(sign, words)]


def draw_forces(
    axes: Axes, verdict: Verdict, camera: Camera, longest: float
) -> list[tuple[Any, str]]:
    """Draw the contact force of each patch as a line through its centre of pressure.

    `longest`: length of the longest line [length unit]. Returns the legend entry.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

    forces = verdict.forces
    if forces is None:
        return []
    sizes = np.linalg.norm(forces.resultant, axis=1)
    most = float(sizes.max(initial=0.0))
    shown = np.isfinite(forces.center).all(axis=1) & (sizes > SHOWN * most)
    if not shown.any():
        return []
    half = forces.resultant[shown] / most * longest / 2
    middle = forces.center[shown]
    order = np.argsort(-sizes[shown], kind="stable")[:ARROWS]
    lines = list(camera.flat(np.stack([middle - half, middle + half], axis=1)[order]))
    style: dict[str, Any] = {"capstyle": "round"}
    halo = LineCollection(lines, colors=PAPER, linewidths=1.9 + HALO, zorder=4, **style)
    axes.add_collection(halo)
    axes.add_collection(LineCollection(lines, colors=FORCE, linewidths=1.9, zorder=5, **style))
    dot: dict[str, Any] = {"marker": "o", "markersize": 5.2, "markeredgecolor": PAPER}
    x, y = camera.flat(middle[order]).T
    axes.plot(x, y, linestyle="none", color=FORCE, zorder=5, **dot)
    words = f"contact forces (not unique), largest {force(most)}"
    return [(Line2D([], [], color=FORCE, linewidth=1.9, **dot), words)]


def draw_names(axes: Axes, assembly: Assembly, faces: list[tuple[int, Array]]) -> None:
    """Write the names of the parts on their visible faces, as plain text."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    style: dict[str, Any] = {"fontsize": 8.5, "color": INK, "va": "center"}
    for k, place in name_places(faces, len(assembly.parts)).items():
        x, y = np.clip(place, [left, bottom], [right, top])
        style["ha"] = "left" if x <= left else "right" if x >= right else "center"
        text = axes.text(float(x), float(y), label(assembly.names[k]), zorder=6, **style)
        text.set_parse_math(False)
        # a background instead of an outline, because an outlined text becomes a path in an SVG
        text.set_bbox({"boxstyle": "round,pad=0.12", "facecolor": PLATE, "edgecolor": "none"})


def name_places(faces: list[tuple[int, Array]], count: int) -> dict[int, Array]:
    """Position of each part's name: the middle of its largest visible face.

    `faces` lists the drawn faces as (part, corners), the farthest first. A part without such a
    face is not in the result.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    >>> name_places([(0, 2 * square), (0, square + 5), (1, 2 * square)], 2)
    {0: array([5.5, 5.5]), 1: array([1., 1.])}
    """
    if not faces:
        return {}
    part = np.array([k for k, _ in faces])
    middle = np.array([corners.mean(axis=0) for _, corners in faces])
    area = np.array([abs(_signed_area(corners)) for _, corners in faces])
    low = np.array([corners.min(axis=0) for _, corners in faces])
    high = np.array([corners.max(axis=0) for _, corners in faces])
    places = {}
    for k in range(count):
        candidates = np.flatnonzero(part == k)
        candidates = candidates[np.argsort(-area[candidates], kind="stable")][:CANDIDATES]
        for face in candidates:
            near = (low[face + 1 :] < middle[face]) & (high[face + 1 :] > middle[face])
            over = face + 1 + np.flatnonzero(near.all(axis=1))
            if not any(_is_within_polygon(middle[face], faces[j][1]) for j in over):
                places[k] = middle[face]
                break
    return places


def _signed_area(corners: Array) -> float:
    x, y = corners.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def _is_within_polygon(point: Array, corners: Array) -> bool:
    """Whether a point is inside a convex polygon of either orientation."""
    side = np.roll(corners, -1, axis=0) - corners
    to = point - corners
    turn = side[:, 0] * to[:, 1] - side[:, 1] * to[:, 0]
    return bool((turn > 0).all() or (turn < 0).all())


def draw_gravity(axes: Axes, camera: Camera) -> None:
    """Draw a downward arrow with a g for gravity, and the axes of the assembly's frame."""
    x, y = GRAVITY_AT
    place: dict[str, Any] = {"xycoords": "figure fraction", "textcoords": "figure fraction"}
    bold: dict[str, Any] = {"arrowstyle": HEAD.format(0.22, 0.5), "lw": 1.6, "shrinkA": 0}
    axes.annotate("", (x, y - 0.11), (x, y), arrowprops={**bold, "color": INK}, **place)
    axes.annotate("g", (x + 0.022, y - 0.09), color=INK, **place)
    points: dict[str, Any] = {"xycoords": "figure points", "textcoords": "figure points"}
    thin: dict[str, Any] = {"arrowstyle": HEAD.format(0.12, 0.3), "lw": 0.9, "shrinkA": 0}
    style: dict[str, Any] = {"fontsize": 8, "color": PALE, "ha": "center", "va": "center"}
    x, y = FRAME_AT
    for name, axis in zip("xyz", np.eye(3), strict=True):
        right, up = camera.flat(axis) * FRAME
        if np.hypot(right, up) > FRAME / 5:
            thin["color"] = PALE
            axes.annotate("", (x + right, y + up), (x, y), arrowprops=dict(thin), **points)
            end = (x + 1.38 * right, y + 1.38 * up)
            axes.annotate(name, end, end, **style, **points)


def _arrow(axes: Axes, ends: Array, colour: str, share: float) -> None:
    """Draw an arrow; `share` is its length over the longest arrow, and sizes its head."""
    from matplotlib.patches import FancyArrowPatch
    from matplotlib.patheffects import Normal, withStroke

    axes.add_patch(
        FancyArrowPatch(
            tuple(ends[0]),
            tuple(ends[1]),
            arrowstyle="-|>",
            mutation_scale=HEAD_SIZE * min(max(share / 0.3, 0.35), 1.0),
            shrinkA=0,
            shrinkB=0,
            linewidth=1.9,
            color=colour,
            zorder=5,
            path_effects=[withStroke(linewidth=1.9 + HALO, foreground=PAPER), Normal()],
        )
    )


def _rotation_arrow(
    axes: Axes, camera: Camera, center: Array, angular: Array, radius: float
) -> None:
    """Draw an arrow along three quarters of a circle around the axis of a rotation."""
    from matplotlib.patches import FancyArrowPatch
    from matplotlib.path import Path
    from matplotlib.patheffects import Normal, withStroke

    axis = angular / np.linalg.norm(angular)
    first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    circle = np.outer(np.cos(ARC), first) + np.outer(np.sin(ARC), second)
    flat = camera.flat(center + 0.38 * radius * circle)
    axes.add_patch(
        FancyArrowPatch(
            path=Path(flat),
            arrowstyle="-|>",
            mutation_scale=9,
            linewidth=1.4,
            linestyle=(0, (1.2, 1.0)),
            color=MOTION,
            fill=False,
            zorder=5,
            path_effects=[withStroke(linewidth=1.4 + HALO, foreground=PAPER), Normal()],
        )
    )


def _sign(colour: str, line: Any = "solid") -> Any:
    from matplotlib.lines import Line2D

    marker: dict[str, Any] = {"marker": ">", "markevery": [1], "markersize": 5}
    return Line2D([0, 1], [0, 0], color=colour, linewidth=1.9, linestyle=line, **marker)
