"""The pose at rest by the least motion: the search with a reach from the gaps of the drawn pose.

`kilter.settle` with `nearest=True` uses it. Parts do not fall, tip or roll in this search.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kilter.analysis.settled_pose.near_points import find_near_points
from kilter.analysis.settled_pose.rest import RestResult
from kilter.analysis.settled_pose.rest_search import SearchResult, search_rest
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.analysis.settled_pose.settle_tolerances import REACH
from kilter.assembly import Assembly
from kilter.contact import ContactSet

MARGIN = 3.0
"""Default reach, in multiples of the widest gap or overlap that was found."""
WIDER = 10.0
"""Factor of the default reach in a second attempt, if more pairs of parts come within it."""
WIDEST = 0.1
"""Largest reach of a second attempt, over the median size of the parts [-]: within a larger reach
nearly all faces of the parts are candidates."""
FITS = "the normals of their free-form faces are fits, and change from round to round"
"""Cause of gaps that do not close between curved faces without a formula."""


def find_nearest_rest(
    bodies: RigidBodies, contacts: ContactSet, *, reach: float | None, tell: Callable[[str], None]
) -> tuple[RestResult, float]:
    """Search for a pose at rest by the least motion; return it and the reach [length unit].

    Arguments: `contacts`: contacts of the drawn pose, whose gaps give the default reach.
    """
    found, used = _search(bodies, contacts, reach, tell)
    if _between_fits(found, contacts):
        found = replace(found, why=f"{found.why}; {FITS}")
    rest = RestResult(
        found.state,
        found.bodies,
        ways=((),) * len(bodies.mass),
        parts=found.parts,
        depth=found.depth,
        why=found.why,
        rounds=found.rounds,
        points=found.points,
    )
    return rest, used


def _search(
    bodies: RigidBodies, contacts: ContactSet, most: float | None, tell: Callable[[str], None]
) -> tuple[SearchResult, float]:
    """Search with the given reach, or with one or two reaches from the gaps of the drawn pose."""
    if most is not None:
        return search_rest(bodies, reach=most, most=most, progress=tell), most
    reach = _default_reach(bodies.drawn, contacts)
    found = search_rest(bodies, reach=reach, most=None, progress=tell)
    wide = min(WIDER * reach, WIDEST * _median_size(bodies.drawn))
    nothing_near = found.state == "not-found" and found.rounds == 0 and found.points is None
    if wide <= reach or not (found.state == "falls" or nothing_near):
        return found, reach
    if not _more_pairs(bodies, (reach, wide), found.parts):
        return found, reach
    tell("wider reach")
    wider = search_rest(bodies, reach=wide, most=None, progress=tell)
    return (wider, wide) if wider.state == "at-rest" else (found, reach)


def _between_fits(found: SearchResult, contacts: ContactSet) -> bool:
    """Whether a failed search names a pair of parts that touch at faces with fitted normals."""
    index = found.bodies.drawn.index
    parts = {index[name] for name in found.parts}
    return found.state == "not-found" and any(
        pair.kind == "free-form" and set(pair.ends) == parts for pair in contacts.open_pairs
    )


def _more_pairs(bodies: RigidBodies, reaches: tuple[float, float], parts: tuple[str, ...]) -> bool:
    """Whether more pairs with one of `parts` come within the second, wider reach.

    Without `parts`, every pair counts.
    """
    assembly = bodies.assembly()
    pairs = []
    for distance in reaches:
        points = find_near_points(assembly, distance, distance)
        bearing = points.take(points.bears)
        pairs.append(set(zip(bearing.part_a.tolist(), bearing.part_b.tolist(), strict=True)))
    falling = {assembly.index_of(name) for name in parts or assembly.names}
    return any(falling.intersection(pair) for pair in pairs[1] - pairs[0])


def _default_reach(assembly: Assembly, contacts: ContactSet) -> float:
    """Reach from the widest gap and the deepest overlap of the drawn pose [length unit]."""
    size = _median_size(assembly)
    gaps = [overlap.depth for overlap in contacts.overlaps]
    gaps += [abs(pair.gap) for pair in contacts.near if abs(pair.gap) < size]
    gaps += [neighbour.gap for neighbour in contacts.neighbours]
    return MARGIN * max([REACH / MARGIN * size, *gaps])


def _median_size(assembly: Assembly) -> float:
    """Median size of the parts that are not held [length unit]."""
    geometry = assembly.geometry
    return float(np.median(geometry.size[~geometry.grounded]))
