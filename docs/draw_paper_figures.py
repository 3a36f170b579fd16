"""Figures 5, 6 and 7 of the paper, drawn from the assembly of Figure 8.

``python docs/draw_paper_figures.py`` draws the pictures and writes their statements to the page.

The paper draws these figures freehand, about no assembly. Here kilter computes each of them. The
reachable set Q holds q = sum_i m_i dr_i of every displacement dp that the contacts allow:

    z(g) = -max over q in Q of q.g

Figure 5: the normal cones of the vertices of Q are the sets of directions with the same optimal
displacement. Figure 6: Q in the plane, and the lines on which z is constant. Figure 7: the walk of
the paper over the sets of a facet of the diamond |g|_1 = 1.

References
----------
Mattikalli, Khosla, Repetto and Baraff (1993), Figures 5, 6 and 7, equations (9) to (11).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import kilter
from kilter.analysis.turning.stability_map import StabilityMap, stability_map
from kilter.analysis.turning.walk import WalkFacet, walk
from kilter.arrays import Array
from kilter.mechanics.program import Program, build_program
from kilter.scenes import paper
from kilter.show.canvas import INK, PAPER, encode_figure, new_figure
from kilter.tell.numbers import number
from kilter.tell.palette import PALETTE, ROLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DOCS = Path(__file__).resolve().parent
PAGE = DOCS / "contributing/paper-figures.md"
ARC = np.linspace(0.0, 1.0, 33)[:, None]
"""Shares of the way along an arc between two directions [-]."""
STABLE, ACROSS, SOFT = (ROLES[name].light for name in ("stable", "unstable", "soft"))
VIEWS = {"from the front": 1.0, "from the back": -1.0}
"""Position of the eye on the y axis, up to its sign: the front is at -y."""
SHIFT = np.array([0.02, 0.02])
"""Distance of words from their point [length unit of the picture]."""
BEHIND = {"facecolor": PAPER, "edgecolor": "none", "alpha": 0.8, "pad": 1.5}
"""Look of the paper behind words."""
SAME_Z = 1e-9
"""Largest difference of equal values of z [kg x length unit]."""


def example(planar: bool = False) -> Program:
    """Program of Figure 8 of the paper, in the plane or in space."""
    assembly = paper.figure_8(planar=planar)
    return build_program(assembly, kilter.contacts(assembly))


def example_sets(planar: bool = False) -> StabilityMap:
    """Sets of the example, with vertices sorted by x, y and z.

    The search finds the vertices in an order that depends on rounding, and so on the machine.
    """
    sets = stability_map(example(planar))
    order = np.lexsort(np.round(sets.vertices / SAME_Z).T[::-1])
    rank = np.argsort(order)
    facets = tuple(rank[corners] for corners in sets.facets)
    return replace(sets, vertices=sets.vertices[order], facets=facets)


# Figure 5 -------------------------------------------------------------------------------


def rays_around(sets: StabilityMap, vertex: int) -> Array:
    """Corners of a set of directions on the unit sphere, in order around the set, shape (k, 3)."""
    rays = sets.partition(vertex)
    middle = rays.mean(axis=0)
    first = rays[0] - middle * (rays[0] @ middle) / (middle @ middle)
    second = np.cross(middle, first) / np.linalg.norm(middle)
    return rays[np.argsort(np.arctan2(rays @ second, rays @ first))]


def arcs(rays: Array) -> Array:
    """Points on the great circles between successive directions, shape (m, 3), closed."""
    ends = np.roll(rays, -1, axis=0)
    points = np.vstack([a + ARC * (b - a) for a, b in zip(rays, ends, strict=True)])
    return points / np.linalg.norm(points, axis=1)[:, None]


def hemisphere(axes: Axes, sets: StabilityMap, side: float) -> None:
    """Draw the sets on the half of the sphere that faces the eye; z is up."""
    for vertex in range(len(sets.vertices)):
        points = arcs(rays_around(sets, vertex))
        flat = np.column_stack([side * points[:, 0], points[:, 2]])
        behind = -side * points[:, 1] < 0
        if behind.all():
            continue
        flat[behind] /= np.maximum(np.linalg.norm(flat[behind], axis=1), 1e-12)[:, None]
        colour = PALETTE[vertex % len(PALETTE)]
        axes.fill(*flat.T, facecolor=colour, edgecolor=INK, linewidth=0.9, alpha=0.75)
    for vertex in range(len(sets.vertices)):
        middle = sets.partition(vertex).mean(axis=0)
        if -side * middle[1] > 0:
            place = np.array([side * middle[0], middle[2]]) / np.linalg.norm(middle)
            axes.text(*place, str(1 + vertex), ha="center", va="center", fontsize=10, color=INK)
    stable = stable_corners(sets)
    seen = stable[-side * stable[:, 1] > -SAME_Z]
    axes.plot(side * seen[:, 0], seen[:, 2], "*", color=STABLE, markersize=15, mec=PAPER)
    axes.annotate("", (0, -1.32), (0, -1.06), arrowprops={"arrowstyle": "-|>", "color": INK})
    axes.text(0.06, -1.24, "g as drawn in Figure 8", fontsize=8, color=INK)
    axes.set(xlim=(-1.1, 1.1), ylim=(-1.4, 1.1), aspect="equal")
    axes.axis("off")


def stable_corners(sets: StabilityMap) -> Array:
    """Corners of the stable directions, at which z is 0, shape (k, 3)."""
    return sets.normals[sets.offsets <= SAME_Z]


def figure_5() -> tuple[Figure, str]:
    """The sets of directions of gravity with the same optimal displacement, and their number."""
    sets = example_sets()
    figure = new_figure(8.0, 4.6)
    for k, (name, side) in enumerate(VIEWS.items()):
        axes = figure.add_axes((0.02 + 0.49 * k, 0.02, 0.47, 0.88))
        hemisphere(axes, sets, side)
        axes.set_title(name, fontsize=9, color=SOFT)
    count = len(stable_corners(sets))
    stars = "The star is the stable direction" if count == 1 else f"The {count} stars are stable"
    return figure, (
        f"The sphere of directions of gravity has {len(sets.vertices)} sets. All directions in a "
        f"set have the same optimal displacement. {stars}: z is 0 there."
    )


# Figure 6 -------------------------------------------------------------------------------


def turns(sets: StabilityMap, vertex: int) -> list[float]:
    """Angles from -z toward +x between which a vertex stays optimal in the plane [deg]."""
    rays = sets.partition(vertex)
    return sorted(np.degrees(np.arctan2(rays[:, 0], -rays[:, 2])).tolist())


def middle_turn(sets: StabilityMap, vertex: int) -> Array:
    """Direction of gravity in the middle of those for which a vertex is optimal, shape (3,)."""
    angle = np.radians(np.mean(turns(sets, vertex)))
    return np.array([np.sin(angle), 0.0, -np.cos(angle)])


def optimal_when_upright(sets: StabilityMap) -> int:
    """Vertex with the least z for gravity along -z; of several, the one with the greatest x."""
    height = sets.vertices[:, 2]
    lowest = np.flatnonzero(height <= height.min() + SAME_Z)
    return int(lowest[sets.vertices[lowest, 0].argmax()])


def figure_6() -> tuple[Figure, str]:
    """The reachable set in the plane, lines of constant z, and the limits of a vertex."""
    sets = example_sets(planar=True)
    best = optimal_when_upright(sets)
    gravity = middle_turn(sets, best)
    least = float(sets.z(gravity[None])[0])
    figure = new_figure(6.0, 5.6)
    axes = figure.add_axes((0.13, 0.09, 0.84, 0.89))
    q = sets.vertices[:, [0, 2]]
    middle = q.mean(axis=0)
    corners = q[np.argsort(np.arctan2(*(q - middle).T))]
    fill = ROLES["stable-fill"].light
    axes.fill(*corners.T, facecolor=fill, alpha=0.35, edgecolor=INK)
    draw_levels(axes, q[best], gravity, least)
    for ray in sets.partition(best):
        along = np.array([ray[2], -ray[0]])
        ends = q[best] + np.outer([-1.2, 1.2], along)
        axes.plot(*ends.T, color=INK, linestyle=(0, (5, 3)), linewidth=1.2)
        shown = ends[ends[:, 0] < 2.0]  # within the axes
        axes.text(*shown[shown[:, 1].argmin()] + [0.03, 0.05], "limit", fontsize=9, color=INK)
    axes.plot(*q[best], "o", color=INK, markersize=6)
    axes.text(*q[best] - 0.16, "optimal vertex", ha="right", fontsize=9, color=INK)
    axes.text(*middle, "displacements\nthat the contacts allow", ha="center", va="center",
              fontsize=9, color=INK)  # fmt: skip
    axes.set(aspect="equal", xlim=(-1.5, 2.3), ylim=(-2.2, 2.2))
    axes.tick_params(colors=INK, labelsize=8)
    axes.set_xlabel("sum of mass x displacement along x [kg m]", fontsize=9, color=INK)
    axes.set_ylabel("sum of mass x displacement along z [kg m]", fontsize=9, color=INK)
    low, high = (number(round(angle, 6) + 0.0, 4) for angle in turns(sets, best))
    return figure, (
        f"The optimal vertex has z = {number(least, 3)} kg m for the drawn g. The vertex stays "
        f"optimal while gravity turns between {low} and {high} deg from -z toward +x. At each "
        "limit the line of constant z lies along an edge of the set."
    )


def draw_levels(axes: Axes, vertex: Array, gravity: Array, least: float) -> None:
    """Draw three lines of constant z, the last through the optimal vertex, and gravity."""
    g = gravity[[0, 2]]
    along = np.array([-g[1], g[0]])
    for share in (0.0, 0.5, 1.0):
        z = share * least
        foot = vertex + (least - z) * g  # q.g is -z on the line
        axes.plot(*(foot + np.outer([-1.4, 1.5], along)).T, color=ACROSS, linewidth=1.4)
        place = foot - 1.45 * along
        axes.text(*place, f"z = {number(z + 0.0, 3)}", ha="right", fontsize=9, color=ACROSS)
    start = np.array([-0.6, -1.3])
    axes.annotate("", start + 0.7 * g, start, arrowprops={"arrowstyle": "-|>", "color": INK})
    axes.text(*(start + SHIFT), "g", fontsize=11, color=INK)


# Figure 7 -------------------------------------------------------------------------------


def longest_walk() -> WalkFacet:
    """The facet of the diamond with the most steps of the walk."""
    return max(walk(example(), every=True).facets, key=lambda facet: len(distinct(facet)))


def distinct(facet: WalkFacet) -> Array:
    """Directions of a walk without repetitions, shape (k, 3)."""
    steps = np.abs(np.diff(facet.path, axis=0)).max(axis=1)
    kept: Array = facet.path[np.append(True, steps > 1e-4)]  # longer than the epsilon step
    return kept


def figure_7() -> tuple[Figure, str]:
    """The walk over the sets of a facet of the diamond, drawn in the plane of the facet."""
    sets, facet = example_sets(), longest_walk()
    corners = np.diag(facet.signs)
    flat = np.array([[0.0, 0.0], [0.5, np.sqrt(0.75)], [1.0, 0.0]])
    figure = new_figure(7.0, 5.8)
    axes = figure.add_axes((0.06, 0.03, 0.88, 0.92))
    for vertex in range(len(sets.vertices)):
        shares = share_of_facet(sets, vertex, corners)
        if len(shares):
            colour = PALETTE[vertex % len(PALETTE)]
            axes.fill(*(shares @ flat).T, facecolor=colour, alpha=0.75, edgecolor=INK)
            place = shares.mean(axis=0) @ flat + [0.0, 0.12]
            axes.text(*place, str(1 + vertex), ha="center", fontsize=10, color=INK)
    axes.plot(*flat[[0, 1, 2, 0]].T, color=INK, linewidth=1.2)
    label_corners(axes, corners, flat)
    path = distinct(facet)
    heights = sets.z(path)
    at = np.abs(path) @ flat
    for a, b in pairwise(at):
        axes.annotate("", b, a, arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1.8})
    for k, (place, z) in enumerate(zip(at, heights, strict=True)):
        axes.plot(*place, "o", color=INK, markersize=5)
        words = f"{'abcdefgh'[k]}: z = {number(float(z), 3)}"
        axes.text(*(place + SHIFT), words, fontsize=9, color=INK, bbox=BEHIND)
    axes.set(aspect="equal")
    axes.axis("off")
    listed = ", ".join(number(float(z), 3) for z in heights)
    return figure, (
        f"The walk starts at a and takes {len(path) - 1} steps: z rises through {listed} kg m. "
        "Each step ends at the best direction of its set, and a short step enters the next set."
    )


def share_of_facet(sets: StabilityMap, vertex: int, corners: Array) -> Array:
    """Corners of the intersection of a set with a facet, as shares of its corners, shape (k, 3).

    The set has q.g of its vertex as the largest; each other vertex cuts the facet along a line.
    """
    shares = np.eye(3)
    for other in sets.vertices:
        height = shares @ corners @ (sets.vertices[vertex] - other)
        kept: list[Array] = []
        for k in range(len(shares)):
            here, there = height[k - 1], height[k]
            if (here > SAME_Z and there < -SAME_Z) or (here < -SAME_Z and there > SAME_Z):
                kept.append(shares[k - 1] + here / (here - there) * (shares[k] - shares[k - 1]))
            if there >= -SAME_Z:
                kept.append(shares[k])
        shares = np.array(kept).reshape(-1, 3)
    flat = len(shares) < 3 or np.linalg.matrix_rank(shares, tol=1e-6) < 3
    return shares[:0] if flat else shares


def label_corners(axes: Axes, corners: Array, flat: Array) -> None:
    """Write the direction of gravity at each corner of a facet."""
    for corner, place in zip(corners, flat, strict=True):
        axis = int(np.abs(corner).argmax())
        name = f"g along {'-' if corner[axis] < 0 else '+'}{'xyz'[axis]}"
        shift = 0.03 if place[1] > 0 else -0.05
        axes.text(place[0], place[1] + shift, name, ha="center", fontsize=9, color=INK)


# all ------------------------------------------------------------------------------------

FIGURES: dict[str, Callable[[], tuple[Any, str]]] = {
    "5": figure_5,
    "6": figure_6,
    "7": figure_7,
}
"""The function of each figure: it returns the picture and its statement."""


def with_statement(page: str, name: str, statement: str) -> str:
    """The page with a new statement below the picture of a figure."""
    picture = rf"(!\[[^\]]*\]\(../images/paper-figure-{name}\.\w+\)\n\n)[^\n]*\n"
    changed, count = re.subn(picture, lambda found: f"{found[1]}{statement}\n", page)
    if count != 1:
        raise ValueError(f"the page has {count} pictures of figure {name}")
    return changed


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8")
    for figure_name, draw in FIGURES.items():
        picture, sentence = draw()
        (DOCS / "images" / f"paper-figure-{figure_name}.svg").write_bytes(
            encode_figure(picture, ".svg")
        )
        text = with_statement(text, figure_name, sentence)
    PAGE.write_text(text, encoding="utf-8")
