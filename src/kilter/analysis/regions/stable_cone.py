"""Every stable direction of gravity of an assembly without friction, exactly, with proofs.

    C = {g : exists f, f >= 0 on one-sided rows:  J^T f + W g = 0},   W g = (m_i g, 0)_i

the projection of a polyhedral cone, found through its support (`kilter.analysis.regions.growth`):

    max c.g :  A f + B g = 0,  f >= 0,  |g| <= 1          A = S J^T,  B = S W    (scaled)

If it is 0, the multipliers z of its rows are a motion, J dp >= 0 with sum m_i dr_i = c: the
power of a gravity g is c.g, so c.g > 0 is unstable. Otherwise f holds g.

Rounded data (float32) hold no knife-edge assembly exactly: C would shrink to nothing. There
an imbalance s is allowed at a price, A f + B g = s with cost P |s|, which is to say that
motions longer than P for their power do not count. Every point found still proves itself by
forces within the program's tolerance, every facet by a motion that is exactly admissible. The
price goes up from low to high until all proofs hold; so the answer is the cone of the
exact scene within the accuracy of its data, and directions nearer to its boundary than
`BLUR_OVER_TOLERANCE` times the tolerance of the program count as on it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from kilter.analysis.analysis_tolerances import (
    BEYOND_CONE,
    BLUR_OVER_TOLERANCE,
    NO_DIRECTION,
    SAME_POINT,
)
from kilter.analysis.decision.judge import judge
from kilter.analysis.regions.cone_oracle import ConeOracle
from kilter.analysis.regions.growth import Grown, Reach, grow
from kilter.analysis.regions.polyhedral_cone import Cone, make_cone
from kilter.arrays import Array, Index, across
from kilter.errors import InputError
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program

FEW_PARTS = 30
"""Number of free parts up to which the cone of the outer parts is not tried first."""
ABOVE = 0.1
"""Downward component above which the unit force of a row presses a part down [-]."""
PRICES = (1e2, 1e3, 1e4, 1e5)
"""Prices of an imbalance of one weight, for rounded data; a higher price gives less imbalance."""


@dataclass(frozen=True, slots=True, eq=False)
class DirectionProof:
    """A direction of gravity, unit, shape (3,), and the proof that a program holds or falls there.

    `about` is "ray", "line", "facet" or "equation", `vector` the ray, line or normal.
    """

    about: str
    vector: Array
    down: Array
    certificate: ForceProof | MotionProof


@dataclass(frozen=True, slots=True, eq=False)
class StableCone:
    """The cone of stable directions of gravity, or an inner and an outer bound; world frame."""

    cone: Cone
    """Every direction in it is held, by sums of the forces of its rays."""
    facets: Array
    """Unit inward normals, shape (f, 3): beyond any of them no forces hold it. Those of `cone`
    if `exact`."""
    proofs: tuple[DirectionProof, ...]
    """Forces for every ray and both signs of every line; a motion for a direction just outside
    of every facet and for both sides of every equation (but that of the plane of a planar
    program)."""
    programs: int
    """How many programs were solved."""
    exact: bool = True
    """Whether rays and facets are of the same cone."""
    gap: float = 0.0
    """No direction within the facets is farther from the cone [rad]; 0 if exact."""
    slack: float = 0.0
    """How far beyond its facet, at most, the direction of a motion lies [rad]; part of `gap`."""
    is_cut: bool = False
    """Whether a time limit ended the search, so that the gap may be larger than required."""

    @property
    def proved(self) -> bool:
        """Whether every proof of the stable cone holds."""
        return all(proof.certificate.holds for proof in self.proofs)


def stable_cone(program: Program, *, progress: Callable[[str], None] | None = None) -> StableCone:
    """Compute every stable direction of gravity of a program without friction.

    Arguments: `program`: its own gravity gives the size of the forces and the first direction to
    ask. Raises `InputError` if loads are given: the set is then no cone.

    Notes
    -----
    Directions nearer to the boundary than 10 times the largest tolerance of the program
    (1e-8 rad for exact data) count as on it: the kind is that of the exact scene within
    the accuracy of the coordinates.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("tower")
    >>> found = stable_cone(build_program(assembly, contacts(assembly)))
    >>> found.cone.kind, found.cone.rays, found.proved
    ('ray', array([[ 0.,  0., -1.]]), True)
    """
    if program.applied[program.free].any():
        raise InputError(
            "loads are given: their effect depends on the size of gravity, so the stable directions"
            " are not a cone",
            hint="leave the loads out, or check a single direction",
        )
    beside = np.array([[0.0, 1.0, 0.0]]) if program.planar else np.empty((0, 3))
    blur = BLUR_OVER_TOLERANCE * float(program.tolerance[program.free].max(initial=TOLERANCE))
    if not program.free.any():
        cone = make_cone(beside, np.empty((0, 3)), np.empty((0, 3)), blur)
        return StableCone(cone, cone.facets, (), 0)
    known = _by_outer_parts(program, blur) if int(program.free.sum()) > FEW_PARTS else None
    if known is not None:
        return known
    problem = scaled_problem(program)
    coarse = blur > BLUR_OVER_TOLERANCE * TOLERANCE
    best: StableCone | None = None
    programs = 0
    for price in (*PRICES, None) if coarse else (None, *PRICES[::-1]):
        stable = _at_price(problem, price, blur, progress)
        programs += stable.programs
        if best is None or _proved_fraction(stable) > _proved_fraction(best):
            best = stable
        if best.proved:
            break
    assert best is not None
    return replace(best, programs=programs)


def _by_outer_parts(program: Program, blur: float) -> StableCone | None:
    """The cone of the outer parts while all others are held, if the whole program has the same.

    A motion of some parts is a motion of the whole, so the cone of these parts contains that of the
    whole. Both are equal if forces of the whole hold its rays and lines. The result is None if they
    do not.
    """
    outer = _outer_parts(program)
    if not 0 < len(outer) <= FEW_PARTS:
        return None
    ends = np.stack([program.part_a, program.part_b])
    rows = np.flatnonzero(np.isin(ends, outer).any(axis=0))
    parts = np.unique(np.append(ends[:, rows][ends[:, rows] >= 0], outer))
    alone = stable_cone(program.excerpt(parts, rows).with_rows(free=np.isin(parts, outer)))
    cone = alone.cone
    if not alone.proved or cone.blur != blur:
        return None
    proofs = []
    for about, vector, down in _generators(cone):
        forces = judge(program.turned(down)).forces
        if forces is None or not forces.holds:
            return None
        proofs.append(DirectionProof(about, vector, down, forces))
    points = np.array([down for _, _, down in _generators(cone)]).reshape(-1, 3)
    for proof in alone.proofs:
        if isinstance(proof.certificate, MotionProof):
            motion = np.zeros((len(program.names), 6))
            motion[parts] = proof.certificate.motion
            side = float(np.sign(proof.down @ proof.vector)) or 1.0
            is_facet = proof.about == "facet"
            on = points[np.abs(points @ proof.vector) <= blur] if is_facet else points
            outward = -proof.vector if is_facet else side * proof.vector
            proofs.append(_motion(program, proof.about, proof.vector, outward, on, motion))
    programs = alone.programs + len(points)
    found = StableCone(cone, alone.facets, tuple(proofs), programs)
    return found if found.proved else None


def _outer_parts(program: Program) -> Index:
    """The highest free part, and of those that nothing presses down the farthest on four sides."""
    presses = program.normal @ program.down
    covered = np.zeros(len(program.names) + 1, dtype=bool)  # the ground is the last
    covered[program.part_b[presses > ABOVE]] = True
    covered[program.part_a[presses < -ABOVE]] = True
    bare = np.flatnonzero(program.free & ~covered[:-1])
    if not len(bare):
        return bare
    aside = program.center[bare] @ np.transpose(across(program.down))
    highest = bare[np.argmin(program.center[bare] @ program.down)]
    return np.unique([highest, *bare[aside.argmax(axis=0)], *bare[aside.argmin(axis=0)]])


def _generators(cone: Cone) -> list[tuple[str, Array, Array]]:
    """Each ray, and both directions of each line, of a cone: kind, vector and direction."""
    rays = [("ray", ray, ray) for ray in cone.rays]
    return rays + [("line", line, sign * line) for line in cone.lines for sign in (1.0, -1.0)]


def _proved_fraction(cone: StableCone) -> float:
    """Fraction of the proofs of a stable cone that hold [-]."""
    holds = [float(proof.certificate.holds) for proof in cone.proofs]
    return float(np.mean(holds or [1.0]))


def _at_price(
    problem: ScaledProblem, price: float | None, blur: float, progress: Callable[[str], None] | None
) -> StableCone:
    """Compute the stable cone with proofs, if a unit of imbalance costs `price` in the program."""
    program = problem.program
    loads, axes = _loads(problem)
    mass = program.mass[program.free]
    spread = float(mass.max() / mass.min())
    oracle = ConeOracle(
        problem.matrix, loads, program.two_sided, price, blur / BLUR_OVER_TOLERANCE, spread
    )

    def tell() -> None:
        if progress is not None:
            progress(f"region: directions decided {oracle.programs}")

    first = axes @ program.gravity
    grown = grow(oracle, first / np.linalg.norm(first), blur, tell)
    beside = [np.array([0.0, 1.0, 0.0])] if program.planar else []
    cone = make_cone(
        np.array([*beside, *(e @ axes for e, _, _ in grown.equations)]).reshape(-1, 3),
        np.array([q @ axes for q, _ in grown.facets]).reshape(-1, 3),
        np.array([reach.point @ axes for reach in grown.points]).reshape(-1, 3),
        blur,
    )
    proofs = (*_stable(problem, cone, grown, oracle), *_unstable(problem, cone, grown))
    return StableCone(cone, cone.facets, proofs, oracle.programs)


def _loads(problem: ScaledProblem) -> tuple[csc_array, Array]:
    """Matrix from unit gravity to the load of each row, (rows, d), and the axes of gravity, (d, 3).

    Gravity in the world is g @ axes.

    Unit gravity is as long as the program's; the scaled load of a part is then g itself.
    """
    per = len(problem.program.freedoms)
    free = int(problem.program.free.sum())
    d = 2 if problem.program.planar else 3
    rows = (np.arange(free)[:, None] * per + np.arange(d)).reshape(-1)
    columns = np.tile(np.arange(d), free)
    loads = csc_array((np.ones(len(rows)), (rows, columns)), shape=(free * per, d))
    return loads, problem.frame[[0, 2]] if problem.program.planar else problem.frame


def _stable(
    problem: ScaledProblem, cone: Cone, grown: Grown, oracle: ConeOracle
) -> list[DirectionProof]:
    """Proofs by forces for every ray and for both directions of every line of the cone."""
    _, axes = _loads(problem)
    return [
        DirectionProof(about, vector, down, _forces(problem, axes, down, grown, oracle))
        for about, vector, down in _generators(cone)
    ]


def _forces(
    problem: ScaledProblem, axes: Array, down: Array, grown: Grown, oracle: ConeOracle
) -> ForceProof:
    """Forces for a direction of gravity: the known forces of that direction, or new ones."""
    program = problem.program.turned(down)
    for reach in grown.points:
        if np.linalg.norm(reach.point @ axes - down) <= SAME_POINT:
            proof = check_forces(program, problem.forces(reach.forces))
            if proof.holds:
                return proof
    proof = check_forces(program, problem.forces(oracle.forces(axes @ down)))
    if not proof.holds:
        other = judge(program).forces
        return proof if other is None or proof.residual < other.residual else other
    return proof


def _unstable(problem: ScaledProblem, cone: Cone, grown: Grown) -> list[DirectionProof]:
    """Prove that directions just outside each facet, and beside each equation, are unstable."""
    _, axes = _loads(problem)
    proofs = []
    for normal, reach in grown.facets:
        q = normal @ axes
        on = [p.point @ axes for p in grown.points if abs(p.point @ normal) <= cone.blur]
        motion = _witness(problem, reach)
        proofs.append(_motion(problem.program, "facet", q, -q, np.array(on), motion))
    points = [p.point @ axes for p in grown.points]
    for normal, *sides in grown.equations:
        e = normal @ axes
        for sign, reach in zip((1.0, -1.0), sides, strict=True):
            motion = _witness(problem, reach)
            outward, on_all = sign * e, np.array(points)
            proofs.append(_motion(problem.program, "equation", e, outward, on_all, motion))
    return proofs


def _witness(problem: ScaledProblem, reach: Reach) -> Array:
    """The motion that shows that the cone reaches no farther, shape (N, 6)."""
    motion: Array = problem.motion(problem.over_weight(reach.witness))
    return motion


def _motion(
    program: Program, about: str, vector: Array, outward: Array, on: Array, motion: Array
) -> DirectionProof:
    """The direction nearest beyond a facet for which a motion proves that the assembly falls.

    The power of gravity along a direction grows with its angle to the boundary; the proof
    needs a power above the tolerance and above 1e6 times the violation.
    """
    base = on.mean(axis=0) if len(on) else np.zeros(3)
    if np.linalg.norm(base) < NO_DIRECTION:
        base = on[0] if len(on) else np.zeros(3)
    last = None
    for angle in BEYOND_CONE:
        down = base + angle * outward
        down = down / np.linalg.norm(down)
        proof = check_motion(program.turned(down), motion)
        last = DirectionProof(about, vector, down, proof)
        if proof.holds:
            break
    assert last is not None
    if last.certificate.holds:
        return last

    other = judge(program.turned(last.down)).motion
    return (
        last
        if other is None or not other.holds
        else DirectionProof(about, vector, last.down, other)
    )
