"""Straight falls of groups of bodies that nothing supports.

All groups begin to fall at the same time, and a group stops where one of its parts meets a part
that has stopped. So the fall of a group is its shortest path to a supported part over the heights
c(part, other) that a part falls until it meets another part as drawn:

    fall(group) = min over its parts and others of  c(part, other) + fall(group of other)
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.planning.order.sweeps import Direction, Sweeps
from kilter.arrays import Array, Index, Mask, connected, members_by_label
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance
from kilter.contact.common.contact_search import begin_search
from kilter.contact.common.patches import Patches
from kilter.contact.pair_findings import find_families
from kilter.rigid import Pose

FEW_CURVED = 6
"""Largest number of curved surfaces of a part whose falls end on the exact surfaces in a search:
the exact height of a pair of parts costs a search for contacts."""


def straight_falls(
    sweeps: Sweeps, assembly: Assembly, group: Index, *, on_surfaces: Mask
) -> tuple[Array, Index]:
    """Lengths of the falls of groups of parts that fall at the same time.

    A fall ends before curved faces meet, by the distances of both parts from their triangles.

    Arguments: `group` (N,): group of each part; 0 is supported and does not fall, -1 is not there;
    `on_surfaces` (N,): parts of which two fall onto the exact curved surfaces. Returns `fall` (G,):
    length of the fall of each group [length unit], infinite if it leaves the scene; `onto` (G,):
    group on which it lands, or -1.
    """
    slack = assembly.geometry.slack
    x, y, z = assembly.down.tolist()
    direction: Direction = (x, y, z)
    count = int(group.max(initial=0)) + 1
    fall = np.full(count, np.inf)
    fall[0] = 0.0
    onto = np.full(count, -1)
    meets: dict[int, list[tuple[int, float, int, int]]] = {}
    for g in range(1, count):
        parts = np.flatnonzero(group == g)
        for part in parts.tolist():
            others, bounds = sweeps.under(np.array([part]), direction)
            for other, bound in zip(others.tolist(), bounds.tolist(), strict=True):
                if group[other] not in (g, -1):
                    meets.setdefault(int(group[other]), []).append((g, bound, part, other))
    waiting = [(0.0, 0)]
    done = np.zeros(count, dtype=bool)
    while waiting:
        length, landed = heapq.heappop(waiting)
        if done[landed] or length > fall[landed]:
            continue
        done[landed] = True
        for g, bound, part, other in sorted(meets.get(landed, ()), key=lambda entry: entry[1]):
            if done[g] or length + bound >= fall[g]:
                continue
            height = _height(sweeps, part, other, direction, slack)
            if on_surfaces[part] and on_surfaces[other] and length + height < fall[g]:
                exact = sweeps.heights(part, other, direction)
                if not exact[1] and np.isfinite(exact[0]):
                    height = _height_on_surfaces(sweeps, assembly, (part, other), exact[0])
            total = length + max(height, 0.0)
            if total < fall[g]:
                fall[g], onto[g] = total, landed
                heapq.heappush(waiting, (total, g))
    return fall, onto


def _height(sweeps: Sweeps, part: int, other: int, direction: Direction, slack: Array) -> float:
    """Length of the fall of a part on another, at most until their curved faces may meet.

    Arguments: `slack` (N,): distance of each part from its triangles [length unit].
    """
    height, exact = sweeps.heights(part, other, direction)
    return height if exact else max(height - float(slack[part] + slack[other]), 0.0)


# Fall of a single group, and the exact height above curved surfaces.


ROUNDS = 6
"""Largest number of Newton steps to the first contact of round faces."""
MOST_CURVED = 24
"""Largest number of curved faces of two parts whose distance in a fall is exact: each step is a
search for contacts of both parts, which takes about .4 s for a case of 100 faces."""
DEEP = 4.0
"""Overlap of two parts above which their distance is not that of the exact surfaces [slacks of both
parts]: they touch in any case."""
UPRIGHT = 0.05
"""Least component of a contact normal along the vertical for a step [-]."""
MOST_GROUPS = 200
"""Largest number of groups of parts whose straight falls are computed for an answer."""
EXACT = 1e-12
"""Newton step that ends the search [sizes of the part]."""


@dataclass(frozen=True, slots=True)
class StraightFall:
    """A straight fall until the first contact."""

    distance: float
    """Length of the fall [length unit]."""
    part: int
    """The falling part that meets another part first."""
    other: int
    """The part that it meets."""


def falling_distance(
    assembly: Assembly, sweeps: Sweeps, parts: Index, down: Array, *, enough: float = -np.inf
) -> StraightFall | None:
    """Find the first part that a group of parts meets if it falls straight down.

    Arguments: `parts` (n,): the falling parts; they move together; `down` (3,): unit direction of
    gravity; `enough`: length of a fall that ends the search, although another part may be met
    sooner [length unit]. Returns None if nothing is below the parts. A fall onto curved faces is
    that of their triangles if the two parts have more than `MOST_CURVED` such faces.
    """
    x, y, z = down.tolist()
    direction: Direction = (x, y, z)
    slack, curved = assembly.geometry.slack, np.diff(assembly.geometry.surfaces.start)
    # contacts without points: the pair never touches
    apart = {frozenset(entry.parts) for entry in assembly.contacts if not len(entry.points)}
    ways: list[tuple[float, int, int]] = []
    for part in parts.tolist():
        others, bounds = sweeps.under(np.array([part]), direction)
        outside = ~np.isin(others, parts)
        pairs = zip(bounds[outside].tolist(), others[outside].tolist(), strict=True)
        ways += [(bound, part, other) for bound, other in pairs]
    best: StraightFall | None = None
    for bound, part, other in sorted(ways):
        spare = float(slack[part] + slack[other])
        most = np.inf if best is None else best.distance + spare
        if bound >= most or frozenset((assembly.names[part], assembly.names[other])) in apart:
            continue
        distance, exact = sweeps.heights(part, other, direction)
        if not np.isfinite(distance) or distance >= most:
            continue
        few = curved[[part, other]].sum() <= MOST_CURVED
        few &= distance > enough or not sweeps.overlap(part, other)
        if not exact and few and distance > -DEEP * spare:
            distance = _height_on_surfaces(sweeps, assembly, (part, other), distance)
        if best is None or distance < best.distance:
            best = StraightFall(distance, part, other)
        if distance <= enough:
            break
    return best


def touching_gap(assembly: Assembly, contacts: ContactSet, fall: StraightFall) -> float:
    """Length of a fall up to which its two parts touch already [length unit]."""
    geometry, pair = assembly.geometry, [fall.part, fall.other]
    gap = float(contacts.searched.gap_of(geometry.size[pair].min()[None])[0])
    return max(gap, 2 * float(geometry.accuracy[pair].sum()))


def landings(
    assembly: Assembly, contacts: ContactSet, falling: Mask
) -> dict[int, tuple[int, float]]:
    """The first part that each part of a mask, shape (N,), meets in a straight fall, and its way.

    Parts of the mask that touch fall together. The other parts count as drawn. Parts with nothing
    below them, parts that touch the part below, and groups after the first `MOST_GROUPS` are left
    out.
    """
    a, b = contacts.patch_parts.T
    both = falling[a] & falling[b]
    label = np.where(falling, connected(len(falling), a[both], b[both]), -1)
    sweeps = Sweeps.of(contacts)
    least_gap = float(contacts.searched.gap_of(assembly.geometry.size).min())
    found: dict[int, tuple[int, float]] = {}
    for group in members_by_label(label)[:MOST_GROUPS]:
        fall = falling_distance(assembly, sweeps, group, assembly.down, enough=least_gap)
        if fall is not None and fall.distance > touching_gap(assembly, contacts, fall):
            found |= dict.fromkeys(group.tolist(), (fall.other, fall.distance))
    return found


def _height_on_surfaces(
    sweeps: Sweeps, assembly: Assembly, pair: tuple[int, int], distance: float
) -> float:
    """Length of the fall on the exact surfaces, from the length on the triangles [length unit]."""
    geometry, down, (part, other) = assembly.geometry, assembly.down, pair
    x, y, z = down.tolist()
    key = part, other, (x, y, z)
    if key in sweeps.falls:
        return sweeps.falls[key]
    slack = float(geometry.slack[part] + geometry.slack[other])
    size = float(min(geometry.size[part], geometry.size[other]))
    falling = replace(assembly.parts[part], grounded=False)
    still = replace(assembly.parts[other], grounded=True)
    found = distance
    for _ in range(ROUNDS):
        pose = falling.pose
        moved = replace(falling, pose=Pose(pose.position + found * down, pose.rotation))
        both = Assembly([moved, still], units=assembly.units, gravity=assembly.gravity)
        search = begin_search(both, Tolerance(gap=4 * slack), lambda stage: None)
        faces = find_families(search, unmodelled=False)
        near = Patches.join(
            [of.patches for of in (faces.smooth, faces.flat, faces.curved, faces.sharp)]
        )
        steep = np.abs(near.normal @ down)
        usable = steep > UPRIGHT
        if not usable.any():
            break
        step = float((near.gap[usable, 0] / steep[usable]).min())
        found += step
        if abs(step) <= EXACT * size:
            break
    result = found if abs(found - distance) <= 4 * slack / UPRIGHT else distance
    sweeps.falls[key] = result
    return result
