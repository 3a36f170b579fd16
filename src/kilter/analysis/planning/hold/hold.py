"""`kilter.hold`: search for the fewest supports with which an assembly holds.

The candidates are grips, fingers, props, vacuum cups and magnets (`kilter.contact.supports`). The
answer includes the proof that fewer supports are not enough
(`kilter.analysis.planning.hold.least_supports`), except for the verdict "undecided".
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.decision.cascade import Decision
from kilter.analysis.planning.hold.fixture import Fixture, StoppedMotion
from kilter.analysis.planning.hold.least_straps import find_least_straps
from kilter.analysis.planning.hold.least_supports import LeastSupports, find_least_supports
from kilter.analysis.planning.hold.supported import Supported
from kilter.arrays import TINY, Array, cross, unit_rows
from kilter.assembly import Assembly, Strap
from kilter.assembly.bonds import NOT_SET, require_no_bonds
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet, detect
from kilter.contact.fits.suggestions import require_apart
from kilter.contact.supports import Support
from kilter.errors import InputError
from kilter.tell.levels import require_level
from kilter.work import Work

# Candidate supports by keyword: grips of every part, props under parts, fingers on faces.


ROOM = 0.1
"""Room that a finger needs before a face, over the size of its part."""
LEAST_FACE = 0.05
"""Smallest face that gets a finger, as a fraction of the surface area of its part [-]."""
SAME_FACE = 6
"""Decimal digits to which triangles of the same face share normal and height."""


def candidates_of(
    assembly: Assembly, contacts: ContactSet, asked: Iterable[str | Support]
) -> list[Support]:
    """Candidate supports, from keywords such as "grips" and given supports, in the given order.

    Raises `InputError` if no candidate is given, a word is unknown, or a support does not fit the
    assembly.
    """
    candidates: list[Support] = []
    words = list(asked)
    if not words:
        raise InputError("there are no candidates for supports", hint=f"give {', '.join(WORDS)}")
    for word in words:
        if isinstance(word, Support):
            word.require_of(assembly)
            candidates.append(word)
        elif word in WORDS:
            candidates += WORDS[word](assembly, contacts)
        else:
            raise InputError(f"a candidate is {word!r:.60}", hint=f"give {', '.join(WORDS)}")
    return candidates


def _grips(assembly: Assembly, contacts: ContactSet) -> Iterator[Support]:
    for part in assembly:
        if not part.grounded:
            yield Support("grip", part.name)


def _props(assembly: Assembly, contacts: ContactSet) -> Iterator[Support]:
    """Yield candidate props under the centre of mass of each free part."""
    geometry, down = assembly.geometry, assembly.down
    for k, part in enumerate(assembly):
        if part.grounded:
            continue
        along, owner = _hits(assembly, geometry.center[k], down)
        heights = along[owner == k]
        if not len(heights):
            continue  # its centre of mass is not above any of it
        foot, below = heights.max(), (owner != k) & (along > 0)
        gap = float(contacts.searched.gap_of(geometry.size[[k]])[0])
        below &= along > foot - gap
        if not below.any():
            on = None
        else:
            nearest = np.flatnonzero(below)[along[below].argmin()]
            if along[nearest] <= foot + gap:
                continue  # no room
            under = assembly[int(owner[nearest])]
            on = None if under.grounded else under.name
        yield Support("prop", part.name, geometry.center[k] + foot * down, on=on)


def _fingers(assembly: Assembly, contacts: ContactSet) -> Iterator[Support]:
    """Yield candidate fingers on the accessible faces of each free part."""
    geometry = assembly.geometry
    for k, part in enumerate(assembly):
        if part.grounded:
            continue
        for number, (point, outward) in enumerate(_faces(geometry.corners_of(k)), 1):
            if assembly.planar and abs(outward[1]) > 0:
                continue
            along, owner = _hits(assembly, point, outward)
            away = float(ROOM * geometry.size[k])
            gap = float(contacts.searched.gap_of(geometry.size[[k]])[0])
            if ((owner != k) & (along > -gap) & (along < away)).any():
                continue
            name = f"finger {number} on {part.name}"
            yield Support("finger", part.name, point, -outward, mu=assembly.friction, name=name)


WORDS = {"grips": _grips, "props": _props, "fingers": _fingers}


def _faces(corners: Array) -> Iterator[tuple[Array, Array]]:
    """Yield centroid and outward normal of each larger flat face of triangles, shape (m, 3, 3)."""
    normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area, normal = np.linalg.norm(normal, axis=1) / 2, unit_rows(normal)
    middle = corners.mean(axis=1)
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    height = np.einsum("ij,ij->i", middle, normal) / max(size, TINY)
    keys = np.column_stack([normal, height]).round(SAME_FACE) + 0.0
    _, first, face = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    total = np.bincount(face.reshape(-1), area)
    center = np.stack(
        [np.bincount(face.reshape(-1), area * middle[:, axis]) for axis in range(3)], axis=1
    )
    for label in np.flatnonzero(total > LEAST_FACE * area.sum()):
        yield center[label] / total[label], normal[first[label]]


def _hits(assembly: Assembly, point: Array, direction: Array) -> tuple[Array, Array]:
    """Distances along a line at which it enters or leaves parts, and the index of each part."""
    g = assembly.geometry
    count = len(assembly)
    corners = [g.corners_of(k) for k in range(count)]
    owner = np.repeat(np.arange(count), [len(ring) for ring in corners])
    a, b, c = np.concatenate(corners).transpose(1, 0, 2)
    side = cross(np.broadcast_to(direction, c.shape), c - a)
    det = np.einsum("ij,ij->i", b - a, side)
    flat = np.abs(det) <= TINY
    scale = 1 / np.where(flat, 1.0, det)
    off = point - a
    u = np.einsum("ij,ij->i", off, side) * scale
    q = cross(off, b - a)
    v = (q @ direction) * scale
    along = np.einsum("ij,ij->i", c - a, q) * scale
    hit = ~flat & (u >= 0) & (v >= 0) & (u + v <= 1)
    return along[hit], owner[hit]


SEARCH = 36.0
"""Work of the search, relative to the work of an effort [-]; larger: longer searches.

At the default effort a search without result takes less than ten seconds of one core. With half of
this work, an assembly of 60 stones got 17 grips instead of 7."""


@question()
def hold(
    asked: Question,
    *,
    candidates: Iterable[str | Support] = ("grips",),
    straps: Iterable[Strap] | None = None,
    code: str | None = None,
    forward: ArrayLike = (1.0, 0.0, 0.0),
    most: int | None = None,
) -> Fixture:
    """Find the fewest supports with which an assembly holds, and prove that fewer are not enough.

    Parameters
    ----------
    assembly : Assembly, or path
        Assembly; `Assembly.without` omits parts that are not inserted yet.
    candidates : iterable of "grips", "props", "fingers" or Support
        Candidates: a grip on every part, a prop under every part, a finger on every flat
        face that is free, or the given supports.
    straps : iterable of Strap, optional
        Candidates of the only kind, in place of `candidates`: the answer has the fewest of these
        straps beside those of the assembly. The proof is one of equilibrium.
    code : str, optional
        With `straps`: the same straps must hold the load at every acceleration of this code of load
        securing, as in `kilter.transport`.
    forward : array_like, shape (3,)
        Direction of travel, for `code`.
    most : int, optional
        Largest number of supports to consider.
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. The assembly must reach it with its supports.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. It concerns the search
        of supports, too.

    Raises
    ------
    InputError
        If no candidate exists, a candidate does not fit the assembly, the code does not exist, or
        it is given without straps.

    See Also
    --------
    kilter.plan : parts that are held while the assembly is built.
    kilter.fastened : joints between parts.

    Examples
    --------
    >>> from kilter.scenes.arches import arch
    >>> half = arch(9, ratio=0.3, friction=0.6).without("voussoir-4")
    >>> hold(half)
    <Fixture: grip on voussoir-3, grip on voussoir-5>
    >>> hold(half, most=1)
    <Fixture: undecided, 2 or more>
    """
    assembly = asked.assembly
    if straps is None:
        require_no_bonds(assembly, "hold", NOT_SET)
        if code is not None:
            raise InputError(
                "a code of load securing needs candidate straps",
                hint="give straps=[...]",
                option="give them with --straps FILE.json",
            )
    asked = asked.but(require=require_level(asked.require))
    require = asked.require
    if most is not None and (isinstance(most, bool) or not isinstance(most, int) or most < 0):
        raise InputError(f"most is {most!r:.40}", hint="give a whole number, 0 or more")
    work = asked.work(SEARCH)
    contacts = detect.touching(asked)
    require_apart(assembly, contacts)
    if straps is not None:
        return find_least_straps(
            assembly,
            contacts,
            tuple(straps),
            code=code,
            forward=forward,
            require=require,
            effort=asked.effort,
            tell=work.stage,
        )
    wanted = [candidates] if isinstance(candidates, str | Support) else candidates
    given = Supported(assembly, contacts, candidates_of(assembly, contacts, wanted))
    seconds = {"contacts": time.perf_counter() - asked.begun}
    return _by_supports(given, asked, work, most, seconds)


def _by_supports(
    given: Supported, asked: Question, work: Work, most: int | None, seconds: dict[str, float]
) -> Fixture:
    """The fixture with the fewest supports."""
    started, interrupted, require = time.perf_counter(), False, asked.require
    work.stage("the fewest supports")
    try:
        least = find_least_supports(given, work, most=most, require=require, effort=asked.effort)
    except KeyboardInterrupt:
        least, interrupted = LeastSupports(None, 0, None, ()), True
    state = least.state
    decision = None if state is None else state.decision
    stated = [] if state is None else [given.stated("held", state)]
    stated += [given.stated("not fewer", entry.state) for entry in least.motions]
    seconds["solve"] = time.perf_counter() - started
    return Fixture(
        level=None if decision is None else decision.level,
        require=require,
        why=_why(decision),
        supports=None if state is None else given.held(state),
        least=least.least,
        motions=tuple(
            StoppedMotion(
                stopped_by=tuple(given.supports[k].name for k in sorted(entry.shares)),
                moving=entry.state.moving,
            )
            for entry in least.motions
        ),
        most=most,
        judged=given.asked,
        exhausted=least.complete and not work.over and not interrupted,
        interrupted=interrupted,
        time_limit=asked.time_limit if work.cut else None,
        seconds={key: round(value, 6) for key, value in seconds.items()},
        assembly=given.assembly,
        contacts=given.contacts,
        offered=given.supports,
        chosen=None if state is None else tuple(sorted(state.chosen)),
        impossible=least.enough is False,
        stated=stated,
    )


def _why(decision: Decision | None) -> str | None:
    """Reason why the verdict level is only equilibrium, as in `Verdict.why`; else None."""
    if decision is None or decision.level != "equilibrium":
        return None
    if decision.verdict == "balanced":
        return "balanced"
    return None if decision.friction is None else decision.friction.why
