"""Changes of an assembly that raise a limit most, each tried before it is listed.

The gradient of the limit predicts the gain of small changes: a part moved along its contacts, a
mass, a friction coefficient, a size across the contacts. The parts that drive the mechanism most
are candidates to be held. Of each kind the best few are tried: the limit of the changed assembly is
computed again, and a change counts only if the changed assembly still stands and gains.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Literal

import numpy as np

from kilter.analysis.analysis_tolerances import MOVES, NO_GAIN
from kilter.analysis.decision.cascade import decide
from kilter.analysis.gradients.gradient import Gradient
from kilter.analysis.gradients.limit_case import LimitCase
from kilter.analysis.gradients.shape_rates import size_names
from kilter.analysis.load_limit import NoLimit, find_limit, gravity_wrench, least_limit
from kilter.analysis.margins.least_friction import find_group_friction
from kilter.analysis.margins.tilt import find_least_tilt
from kilter.arrays import Array, across
from kilter.assembly import Assembly, FrictionPair, Part
from kilter.contact import ContactSet, contacts
from kilter.contact.round_edges import round_edges
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.clusters import limit_groups
from kilter.mechanics.program import build_program
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Prism, Sphere
from kilter.tell.numbers import number, vector
from kilter.tell.record import InPython, OneOf, OrNull, Record, Vector, Word
from kilter.work import Work

TRIED = 3
"""Largest number of changes of each kind that are tried."""
HELD = 4
"""Largest number of parts that are held in turn."""
LISTED = 10
"""Largest number of changes in the answer."""
MORE_FRICTION = 0.05
"""Increase of a friction coefficient that is tried [-]."""
MORE_MASS = 0.1
"""Share of a mass by which it changes [-]."""
MOVED = 0.02
"""Movement, and growth of a size, as a share of the size of the part [-]; rounded."""
ALONG = 1e-6
"""A contact normal across a direction has at most this component along it [-]."""
SIZE_AXES = {"x": (0,), "y": (1,), "z": (2,), "radius": (0, 1), "height": (2,), "depth": (1,)}
"""Own axes of a part along which a size grows."""
STANDS = ("stable", "settles", "balanced", "potentially-stable")
Kind = Literal["move", "mass", "friction", "size", "hold", "add", "remove"]


class TriedChange(Record):
    """A change of an assembly that raises a limit, and the gain that was found."""

    of: Annotated[str, OneOf(("tilt", "load factor", "friction", "strength"))]
    """The limit that improves: the least friction, or the needed share of the strength of studs,
    becomes less; other limits become more."""
    what: Kind
    """Kind of the change."""
    parts: tuple[str, ...]
    """The part, or the two parts of the contact. An added brick has its name in the changed
    assembly."""
    by: float | None
    """Distance of a movement or growth of a size [length unit], increase of a mass [kg] or of a
    friction coefficient [-]; null if a part is held, added or removed."""
    along: Vector | None
    """Unit direction of a movement, world frame; else null."""
    size: str | None
    """Name of the size that grows; else null."""
    limit: OrNull
    """The limit of the changed assembly [deg] or [-]."""
    gain: OrNull
    """Improvement of the limit [deg] or [-]; null if no strength of studs was enough."""
    verdict: Word
    """Verdict of the changed assembly, at the level "equilibrium"."""
    sentence: str
    """The change in words."""
    changed: InPython[Assembly]
    """The changed assembly."""


@dataclass(frozen=True, slots=True, eq=False)
class PossibleChange:
    """A change, the gain that the gradient predicts, and the changed assembly."""

    what: Kind
    parts: tuple[str, ...]
    predicted: float
    build: Callable[[], Assembly]
    by: float | None = None
    along: Array | None = None
    size: str | None = None


def tried_changes(
    assembly: Assembly,
    touching: ContactSet,
    gradient: Gradient,
    *,
    push: Array | None,
    held: list[int],
    work: Work,
) -> tuple[TriedChange, ...]:
    """The changes that improve a limit most, the largest gain first.

    Arguments: `push` (3,): direction of the load factor, or None; `held`: parts that may be held;
    `work`: work of each decision whether the changed assembly stands.
    """
    found = []
    for group in _candidates(assembly, touching, gradient, held):
        ranked = sorted(group, key=lambda candidate: -candidate.predicted)
        for candidate in [each for each in ranked if each.predicted > NO_GAIN][:TRIED]:
            tried = _tried(candidate, touching, gradient, push, work)
            if tried is not None:
                found.append(tried)
    return tuple(sorted(found, key=lambda change: -change.gain)[:LISTED])


def _candidates(
    assembly: Assembly, touching: ContactSet, gradient: Gradient, held: list[int]
) -> Iterator[list[PossibleChange]]:
    """Changes of each kind, with the gains that the gradient predicts."""
    sense = -1.0 if gradient.of == "friction" else 1.0
    free = np.flatnonzero(~assembly.geometry.grounded).tolist()
    yield [each for k in free for each in _moves(assembly, touching, gradient, k, sense)]
    yield [each for k in free for each in _masses(assembly, gradient, k, sense)]
    yield list(_frictions(assembly, touching, gradient, sense))
    yield [each for k in free for each in _sizes(assembly, touching, gradient, k, sense)]
    if not gradient.copied:
        yield _holds(assembly, gradient.cases[0], held)


def _normals(touching: ContactSet, part: int) -> Array:
    """Normals of all contact points of a part, shape (n, 3)."""
    mine = (touching.patch_parts == part).any(axis=1)
    normals: Array = touching.normals[mine[touching.point_patch]]
    return normals


def _rounded(length: float) -> float:
    """The nearest of 1, 2 and 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(length))
    steps = np.array([1.0, 2.0, 5.0, 10.0])
    return float(f"{power * steps[np.abs(steps - length / power).argmin()]:.1g}")


def _moves(
    assembly: Assembly, touching: ContactSet, gradient: Gradient, k: int, sense: float
) -> Iterator[PossibleChange]:
    """Movements of a part along all of its contacts."""
    part, slopes = assembly.parts[k], gradient.position[k]
    if np.isnan(slopes).any():
        return
    step = _rounded(MOVED * float(assembly.geometry.size[k]))
    for axis in moving_axes(assembly, touching, k):
        for sign in (1.0, -1.0):
            along = sign * axis
            slope = float(sum(x * slopes[j, int(x > 0)] for j, x in enumerate(along)))
            yield PossibleChange(
                "move",
                (part.name,),
                sense * step * slope,
                partial(_moved, assembly, k, step * along),
                by=step,
                along=along,
            )


def moving_axes(assembly: Assembly, touching: ContactSet, k: int) -> list[Array]:
    """Unit directions along all contacts of a part: world axes, or those of a single plane."""
    normals = _normals(touching, k)
    if not len(normals):
        return []
    axes = list(np.eye(3))
    if not any((np.abs(normals @ axis) <= ALONG).all() for axis in axes):
        axes = list(across(normals[0]))
    along = [axis for axis in axes if (np.abs(normals @ axis) <= ALONG).all()]
    return [axis for axis in along if not (assembly.planar and abs(axis[1]) > ALONG)]


def _moved(assembly: Assembly, k: int, step: Array) -> Assembly:
    """Copy of an assembly with a moved part."""
    pose = assembly.parts[k].pose
    return assembly.with_pose(k, Pose(np.asarray(pose.position) + step, pose.rotation))


def _with_part(assembly: Assembly, k: int, part: Part) -> Assembly:
    """Copy of an assembly with another part in the place of part `k`."""
    parts = list(assembly.parts)
    parts[k] = part
    return replace(assembly, parts=parts)


def weighing(part: Part, mass: float) -> Part:
    """Copy of a part with a given mass."""
    return replace(part, given_mass=mass)


def _with_pairs(assembly: Assembly, pairs: list[FrictionPair]) -> Assembly:
    """Copy of an assembly with other friction pairs."""
    return replace(assembly, friction_pairs=pairs)


def _masses(
    assembly: Assembly, gradient: Gradient, k: int, sense: float
) -> Iterator[PossibleChange]:
    """A part that is heavier, and one that is lighter."""
    part = assembly.parts[k]
    step = float(f"{MORE_MASS * float(assembly.geometry.mass[k]):.2g}")
    for sign, side in ((1.0, 1), (-1.0, 0)):
        predicted = sense * sign * step * float(gradient.mass[k, side])
        mass = float(assembly.geometry.mass[k]) + sign * step
        yield PossibleChange(
            "mass",
            (part.name,),
            predicted,
            partial(_with_part, assembly, k, weighing(part, mass)),
            by=sign * step,
        )


def _frictions(
    assembly: Assembly, touching: ContactSet, gradient: Gradient, sense: float
) -> Iterator[PossibleChange]:
    """More friction between two parts."""
    listed = {frozenset(contact.parts) for contact in assembly.contacts}
    ends = np.sort(touching.patch_parts, axis=1)
    for number_, pair in enumerate(gradient.pairs):
        a, b = (assembly.index_of(name) for name in pair)
        mu = touching.patch_mu[(ends == [min(a, b), max(a, b)]).all(axis=1)]
        if frozenset(pair) in listed or len(np.unique(mu)) != 1:
            continue
        entry = FrictionPair(pair, float(mu[0]) + MORE_FRICTION)
        others = [each for each in assembly.friction_pairs if set(each.parts) != set(pair)]
        yield PossibleChange(
            "friction",
            pair,
            sense * MORE_FRICTION * float(gradient.friction[number_, 1]),
            partial(_with_pairs, assembly, [*others, entry]),
            by=MORE_FRICTION,
        )


def growing_sizes(assembly: Assembly, touching: ContactSet, k: int) -> list[str]:
    """Names of the sizes of a part that grow along all of its contacts."""
    part, normals = assembly.parts[k], _normals(touching, k)
    if not len(normals) or isinstance(part.shape, Sphere):  # a ball grows into what it touches
        return []
    own = np.abs(normals @ part.pose.matrix).max(axis=0) > ALONG
    flat = ("y", "depth") if assembly.planar else ()
    names = [size for size in size_names(part) if size not in flat]
    return [size for size in names if not own[list(SIZE_AXES[size])].any()]


def _sizes(
    assembly: Assembly, touching: ContactSet, gradient: Gradient, k: int, sense: float
) -> Iterator[PossibleChange]:
    """A larger size of a part, along all of its contacts."""
    part = assembly.parts[k]
    names = growing_sizes(assembly, touching, k)
    step = _rounded(MOVED * float(assembly.geometry.size[k]))
    slopes = gradient.quick_sizes(part.name) if names else {}
    for size in names:
        yield PossibleChange(
            "size",
            (part.name,),
            sense * step * slopes[size],
            partial(_with_part, assembly, k, grown(part, size, step)),
            by=step,
            size=size,
        )


def grown(part: Part, size: str, step: float) -> Part:
    """Copy of a part of which a size is larger."""
    shape = part.shape
    if isinstance(shape, Box):
        return replace(part, shape=Box(shape.size + step * np.eye(3)["xyz".index(size)]))
    if isinstance(shape, Prism):
        return replace(part, shape=Prism(shape.polygon, shape.depth + step))
    assert isinstance(shape, Cylinder)
    radius = shape.radius + step * (size == "radius")
    return replace(part, shape=Cylinder(radius, shape.height + step * (size == "height")))


def _holds(assembly: Assembly, case: LimitCase, held: list[int]) -> list[PossibleChange]:
    """The parts that drive the mechanism most, held."""
    solved = case.solved
    program, motion = solved.program, solved.motion
    size = part_sizes(program, motion, per_radius=False)
    load = program.load + solved.value * solved.along
    power = np.where(program.free, (load * motion).sum(axis=1), -np.inf)
    moving = [k for k in held if program.free[k] and size[k] > MOVES * size.max()]
    driving = sorted(moving, key=lambda k: -power[k])[:HELD]
    return [
        PossibleChange(
            "hold",
            (program.names[k],),
            np.inf,
            partial(_held, assembly, k),
        )
        for k in driving
    ]


def _held(assembly: Assembly, k: int) -> Assembly:
    """Copy of an assembly with a held part, on which no load acts."""
    part = assembly.parts[k]
    loads = [load for load in assembly.loads if load.part != part.name]
    return _with_part(replace(assembly, loads=loads), k, replace(part, grounded=True))


def _tried(
    candidate: PossibleChange,
    given: ContactSet,
    gradient: Gradient,
    push: Array | None,
    work: Work,
) -> TriedChange | None:
    """A change that gains and leaves the assembly standing; else None."""
    changed = candidate.build()
    touching = contacts(changed, tolerance=given.searched)
    value = limit_of(changed, touching, gradient.of, push)
    gain = (gradient.value - value) if gradient.of == "friction" else (value - gradient.value)
    if not gain > NO_GAIN:
        return None
    verdict = decide(
        changed, touching, require="equilibrium", work=work.beside(work.allowed),
        second_order=False, question=False,
    ).verdict  # fmt: skip
    if verdict not in STANDS:
        return None
    return TriedChange(
        of=gradient.of,
        what=candidate.what,
        parts=candidate.parts,
        by=candidate.by,
        along=candidate.along,
        size=candidate.size,
        limit=value,
        gain=gain,
        verdict=verdict,
        sentence=_sentence(candidate, given.assembly.units, gradient, value, gain),
        changed=changed,
    )


def _sentence(
    candidate: PossibleChange, units: str, gradient: Gradient, value: float, gain: float
) -> str:
    """The change and its gain in words."""
    names, amount = [repr(name) for name in candidate.parts], candidate.by or 0.0
    if candidate.what == "move":
        assert candidate.along is not None
        words = f"move {names[0]} by {number(amount)} {units} towards {_side(candidate.along)}"
    elif candidate.what == "mass":
        words = f"make {names[0]} {number(abs(amount))} kg {'heavier' if amount > 0 else 'lighter'}"
    elif candidate.what == "friction":
        words = f"increase mu between {names[0]} and {names[1]} by {MORE_FRICTION:g}"
    elif candidate.what == "size":
        words = f"increase {candidate.size} of {names[0]} by {number(amount)} {units}"
    else:
        words = f"fix {names[0]} so that it cannot move at all"
    unit = " deg" if gradient.of == "tilt" else ""
    if np.isinf(value):
        return f"{words}: then it withstands every load factor"
    if gradient.of == "tilt" and value >= 90.0 - NO_GAIN:
        return f"{words}: then no tilt up to a right angle moves another part"
    name = {"tilt": "tilt", "load factor": "load factor", "friction": "least friction"}[gradient.of]
    sign = "-" if gradient.of == "friction" else "+"
    return f"{words}: {name} {gradient.value:.5g} -> {value:.5g}{unit} ({sign}{gain:.3g})"


def _side(along: Array) -> str:
    """A unit direction in words: the name of an axis, or the vector."""
    axis = int(np.abs(along).argmax())
    if abs(along[axis]) > 1 - ALONG:
        return f"{'+' if along[axis] > 0 else '-'}{'xyz'[axis]}"
    return vector(along)


def limit_of(assembly: Assembly, touching: ContactSet, of: str, push: Array | None) -> float:
    """A limit of an assembly: its tilt [deg], its load factor or its least friction [-].

    NaN if it is not known; infinite, or 90 deg, without a limit. Arguments: `push` (3,): direction
    of the load factor; None: of the given loads.
    """
    program = build_program(assembly, touching, fitted=of == "friction")
    if not program.free.any():
        return {"tilt": 90.0, "friction": 0.0}.get(of, np.inf)
    groups = limit_groups(program)
    if of == "friction":
        friction = find_group_friction(groups)
        return np.nan if isinstance(friction, NoLimit) else friction.value
    if of == "tilt":
        edges = () if program.planar else round_edges(assembly, touching)
        tilt = find_least_tilt(groups, edges, lambda _: None)
        return np.nan if isinstance(tilt, NoLimit) else float(np.degrees(tilt.angle))
    factors = []
    for group in groups:
        base, wrench = group, np.where(group.free[:, None], group.applied, 0.0)
        if push is not None:
            wrench = gravity_wrench(group, push)
        else:
            base = group.with_rows(applied=np.zeros_like(group.applied))
        factors.append(find_limit(base, wrench))
    factor = least_limit(factors, lambda limit: limit.value)
    return np.nan if isinstance(factor, NoLimit) else factor.value
