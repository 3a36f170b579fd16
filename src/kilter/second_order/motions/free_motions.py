"""Motions that keep every gap and the energy exactly constant, each with its kind of proof.

    spin      a part turns about its centre of mass and keeps each of its touched surfaces in
              place: a ball, a top
    level     a set of parts moves as one by level translations and turns about the vertical, and
              keeps the touched surfaces of its surroundings in place; all of these are held, or
              joints of a part that other joints guide level
    slide     a part moves level and keeps its own touched surfaces in place; a set moves level over
              level planes, or over surfaces of a single other part; level edges move level over
              level edges and cylinders that they cross
    pivot     a part with a single contact turns about its normal, which is vertical and passes
              through the centre of mass
    shift     translations of all parts that open no contact of plane faces, straight edges and
              corners, and that do not move parts in other contacts relative to each other: all gaps
              are affine

The first two are symmetries: from every configuration near by they keep all gaps and the energy, so
they may be divided out. So may pivots: after a pivot the only force on the part acts at the same
point, along the same normal and through the centre of mass, so balance and neutral motions stay.
The others keep gaps and energy only along themselves, and may lead to configurations that are not
in equilibrium (a cylinder across another slides along itself, and tips). They count only if every
neutral motion is free. Then the motions that open no contact are those of the family everywhere
along it, the forces of equilibrium move with it, and the energy is least on all of it.

Shifts are added only if no part that turns freely touches a face that is not level.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, connected, cross
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE, SPHERE
from kilter.mechanics.program import Program
from kilter.rigid import skew
from kilter.second_order.gaps.features import EDGE, FACE, Features
from kilter.second_order.gaps.gap_form import formed
from kilter.second_order.gaps.joint_forms import on_joints
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.gaps.touched_surfaces import AXIS, LINE, PLANE, POINT, RAIL, Touched
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import ACROSS
from kilter.shape.primitives import Cylinder, Sphere

EXACT = 1e-9
"""Singular values below this fraction of the largest count as zero [-]."""
ALL_SETS = 6
"""Largest number of free parts for which every set of parts is tried; above, connected sets only.
"""


@dataclass(frozen=True, slots=True, eq=False)
class FreeMotions:
    """F motions of N parts that keep every gap and the energy; they may be linearly dependent.

    `motions`, shape (F, N, 6): (r, theta) of each part [length unit, rad]; `kinds`: the proof of
    each (spin, level, slide, pivot or shift).
    """

    motions: Array
    kinds: tuple[str, ...]

    @property
    def symmetries(self) -> FreeMotions:
        """The free motions that form a symmetry: spins, pivots, and horizontal motions."""
        chosen = [k for k, kind in enumerate(self.kinds) if kind in ("spin", "level", "pivot")]
        return FreeMotions(self.motions[chosen], tuple(self.kinds[k] for k in chosen))


def find_free_motions(
    program: Program, features: Features, touched: tuple[Touched, Touched]
) -> FreeMotions:
    """Motions proved to keep every gap and the energy (spin, level, slide, pivot, shift)."""
    search = _FreeSearch(program, features, touched)
    return search.planar() if program.planar else search.all()


class _FreeSearch:
    """Search for free motions, from the exact surfaces at the contacts."""

    def __init__(
        self, program: Program, features: Features, touched: tuple[Touched, Touched]
    ) -> None:
        self.program, self.features = program, features
        self.a, self.b = touched
        free = np.append(program.free, False)
        self.down = program.down
        self.crossed = self._level_edges()
        self.free_a, self.free_b = free[program.part_a], free[program.part_b]
        level_a, level_b = self.a.level(self.down), self.b.level(self.down)
        self.level = level_a | level_b
        level_on_steep = np.where(self.free_a, level_a & ~level_b, level_b & ~level_a)
        self.slides = np.asarray((self.free_a & self.free_b) | level_on_steep)
        # a level motion slides here on a free part, or on a surface that is not level
        self.parts = np.flatnonzero(program.free)
        self.joined = on_joints(program)
        self.guided = self._guided_level()
        self.origin = program.center[self.parts].mean(axis=0)
        self.length = float(program.radius[self.parts].max())
        self.keeps_a = self.a.conditions(self.origin, self.length)
        self.keeps_b = self.b.conditions(self.origin, self.length)
        self.motions: list[Array] = []
        self.kinds: list[str] = []

    def _level_edges(self) -> Mask:
        """Mask of rows at which a horizontal edge crosses a horizontal edge or cylinder, (K,)."""
        program, features = self.program, self.features
        level = np.linalg.norm(np.cross(program.normal, program.down), axis=1) < EXACT
        level &= formed(program, features) & (self.a.kind == LINE) & (self.b.kind == LINE)
        edge = (features.kind_a == EDGE) | (features.kind_b == EDGE)
        return np.asarray(level & edge)

    def all(self) -> FreeMotions:
        """Free motions of an assembly in space, of all kinds."""
        for part in self.parts:
            self._add_screws_of_part(int(part))
            self._pivot(int(part))
        for chosen in self._sets():
            self._level(chosen)
        self._shifts()
        return self._known_motions()

    def planar(self) -> FreeMotions:
        """Free motions of an assembly in the plane: translations, and spins on joints."""
        in_plane = np.eye(6)[[1, 3, 5]]
        for part in self.parts[np.isin(self.parts, self._jointed())]:
            self._add_screws_of_part(int(part), in_plane)
        self._shifts()
        return self._known_motions()

    def _known_motions(self) -> FreeMotions:
        """The free motions that the search has found so far."""
        shape = (0, len(self.program.names), 6)
        motions = np.array(self.motions) if self.motions else np.empty(shape)
        return FreeMotions(motions, tuple(self.kinds))

    def _add(self, parts: Index | list[int], screw: Array, kind: str) -> None:
        """Add a motion in which the given parts move alike, as a screw (v, L omega)."""
        motion = np.zeros((len(self.program.names), 6))
        turn = screw[3:] / self.length
        arms = self.program.center[parts] - self.origin
        motion[parts, :3] = screw[:3] + cross(np.tile(turn, (len(arms), 1)), arms)
        motion[parts, 3:] = turn
        self.motions.append(motion)
        self.kinds.append(kind)

    def _guided_level(self) -> Mask:
        """Mask of the parts that joints to held or guided parts allow to move level only, (N,).

        These are slides along level lines and hinges about verticals.
        """
        program, guided = self.program, ~self.program.free
        level = np.abs(self.a.direction @ self.down) < EXACT
        upright = np.linalg.norm(np.cross(self.a.direction, self.down), axis=1) < EXACT
        guides = ((self.a.kind == RAIL) & level) | ((self.a.kind == AXIS) & upright)
        ends = np.column_stack([program.part_a, program.part_b])[self.joined & guides]
        for _ in self.parts:
            fixed = np.append(guided, True)
            more = np.append(ends[fixed[ends[:, 1]], 0], ends[fixed[ends[:, 0]], 1])
            guided[more[more >= 0]] = True
        return guided & program.free

    def _jointed(self) -> Index:
        """Parts with joints, by index; -1 for the ground."""
        return np.concatenate([self.program.part_a[self.joined], self.program.part_b[self.joined]])

    def _add_screws_of_part(self, part: int, plane: Array | None = None) -> None:
        """Add the screws of a part that keep its touched surfaces and its height.

        `plane`, (p, 6): further conditions on the screws.

        A centre of mass keeps its height to all orders if it stays, or if the screw is level.
        """
        rows = [] if plane is None else [plane]
        for keeps, of in ((self.keeps_a, self.program.part_a), (self.keeps_b, self.program.part_b)):
            rows += [keeps[k] for k in np.flatnonzero(of == part)]
        arm = (self.program.center[part] - self.origin) / self.length
        stays = np.hstack([np.eye(3), -skew(arm[None])[0]])
        for height, kind in ((stays, "spin"), (self._upright(), "slide")):
            for screw in null_space(np.vstack([height, *rows]), EXACT).T:
                self._add([part], screw, kind)

    def _upright(self) -> Array:
        """Conditions, (3, 6), on a screw without rise and with turns about verticals only."""
        rows = np.zeros((3, 6))
        rows[0, :3] = self.down
        rows[1:, 3:] = null_space(self.down[None], EXACT).T
        return rows

    def _pivot(self, part: int) -> None:
        """Add the turn of a part about its only contact normal, if vertical through its centre."""
        program = self.program
        rows = np.flatnonzero((program.part_a == part) | (program.part_b == part))
        if len(rows) != 1:
            return
        k, down = rows[0], self.down
        arm = program.point[k] - program.center[part]
        off = np.linalg.norm(arm - (arm @ down) * down) / program.radius[part]
        smooth = self.features.kind_a[k] == FACE and self.features.kind_b[k] == FACE
        if smooth and off < EXACT and np.linalg.norm(np.cross(program.normal[k], down)) < EXACT:
            self._add([part], self._about(part, down), "pivot")

    def _about(self, part: int, axis: Array) -> Array:
        """Screw of a turn about an axis through a part's centre of mass, shape (6,)."""
        arm = self.program.center[part] - self.origin
        return np.append(-np.cross(axis, arm), axis * self.length)

    def _sets(self) -> Iterator[Index]:
        """Yield sets of free parts that may move together as a rigid body."""
        parts, count = self.parts, len(self.program.names)
        if len(parts) <= ALL_SETS:
            for size in range(1, len(parts) + 1):
                for chosen in itertools.combinations(parts, size):
                    yield np.array(chosen)
            return
        inner = self.free_a & self.free_b
        seen = set()
        for without in (-1, *parts):
            a, b = self.program.part_a[inner], self.program.part_b[inner]
            keep = (a != without) & (b != without)
            label = connected(count, a[keep], b[keep])
            for number in np.unique(label[parts]):
                chosen = parts[label[parts] == number]
                if tuple(chosen) not in seen:
                    seen.add(tuple(chosen))
                    yield chosen

    def _level(self, chosen: Index) -> None:
        """Add horizontal screws of a set of parts, relative to held parts or to another part."""
        program = self.program
        across = np.isin(program.part_a, chosen) != np.isin(program.part_b, chosen)
        crossing = np.flatnonzero(across & ~self.level)
        self._level_across(chosen, across, crossing, "")
        without = crossing[~self.crossed[crossing]]
        if len(without) < len(crossing):
            self._level_across(chosen, across, without, "slide")

    def _level_across(self, chosen: Index, across: Mask, crossing: Index, kind: str) -> None:
        """Add horizontal screws of a set of parts that keep its border surfaces in place.

        `across`, shape (K,): rows between the set and its surroundings; `crossing`: indices of the
        rows whose surfaces count.
        """
        frames = [-1, *self.parts] if len(crossing) else [-1]
        for frame in frames:
            rows = self._frame_rows(crossing, int(frame))
            guided = frame >= 0 and bool(self.guided[frame])
            of_frame = (self.program.part_a == frame) | (self.program.part_b == frame)
            slides = self.slides & ~(guided & self.joined & of_frame)
            steep = (frame >= 0 and not guided) or bool(slides[across].any())
            proof = kind or ("slide" if steep else "level")
            if rows is not None:
                for screw in null_space(np.vstack([self._upright(), *rows]), EXACT).T:
                    self._add(chosen, screw, proof)

    def _frame_rows(self, crossing: Index, frame: int) -> list[Array] | None:
        """Conditions that keep the surfaces of a reference part in place; or None.

        The frame is a part, or the held surroundings (-1).
        """
        a, b = self.program.part_a[crossing], self.program.part_b[crossing]
        if frame < 0:
            of_a, of_b = ~self.free_a[crossing], ~self.free_b[crossing]
        else:
            of_a, of_b = a == frame, b == frame
        if not (of_a | of_b).all():
            return None
        return [
            (self.keeps_b if second else self.keeps_a)[k]
            for k, second in zip(crossing, of_b, strict=True)
        ]

    def _shifts(self) -> None:
        """Add translations along which all gaps are linear and stay closed."""
        program, sharp = self.program, self._sharp()
        count = len(self.parts)
        place = np.full(len(program.names) + 1, -1)
        place[self.parts] = np.arange(count)
        rows = []
        for k in range(len(sharp)):
            block = np.zeros((3, 3 * count))
            for part, sign in ((program.part_a[k], -1.0), (program.part_b[k], 1.0)):
                if place[part] >= 0:
                    block[:, 3 * place[part] : 3 * place[part] + 3] += sign * np.eye(3)
            rows.append(program.normal[k] @ block if sharp[k] else block)
        heights = (program.load[self.parts, :3] / program.weight[self.parts].max()).reshape(-1)
        plane = np.kron(np.eye(count), [[0.0, 1.0, 0.0]] if program.planar else np.empty((0, 3)))
        matrix = np.vstack([heights[None], plane, *(np.atleast_2d(row) for row in rows)])
        if self._turns_at_walls(sharp):
            return
        for column in null_space(matrix, EXACT).T:
            motion = np.zeros((len(program.names), 6))
            motion[self.parts, :3] = column.reshape(-1, 3) * self.length
            self.motions.append(motion)
            self.kinds.append("shift")

    def _sharp(self) -> Mask:
        """Mask of rows between planes, straight edges and corners (no curvature), shape (K,)."""
        features = self.features
        straight = np.ones(len(features), dtype=bool)
        for side, curvature in ((self.a, features.curvature_a), (self.b, features.curvature_b)):
            bent = np.abs(curvature).max(axis=(1, 2), initial=0.0) > 0
            straight &= ~bent & np.isin(side.kind, (PLANE, POINT, LINE))
        return straight

    def _turns_at_walls(self, sharp: Mask) -> bool:
        """True if a part that can turn touches a face, edge or corner that is not horizontal."""
        program = self.program
        turning = np.zeros(len(program.names) + 1, dtype=bool)
        for motion in self.motions:
            turning[:-1] |= np.abs(motion[:, 3:]).max(axis=1) > EXACT
        touches = turning[program.part_a] | turning[program.part_b]
        return bool((touches & ~self.level & sharp).any())


# Free motions in scaled unknowns: their span, and the parts that they visibly move.


def free_span(program: Program, problem: Stationary, free: FreeMotions) -> Array:
    """Orthonormal basis, (n, f), of the free motions that open no contact and cost no energy."""
    columns = scaled_columns(program, problem, free.motions)
    size = np.linalg.norm(columns, axis=0)
    columns = np.asarray(columns[:, size > 0] / size[size > 0], dtype=np.float64)
    opened = np.abs(problem.rows @ columns).max(axis=0, initial=0.0)
    spent = np.abs(problem.load @ columns)
    columns = columns[:, (opened < ACROSS / 10) & (spent < ACROSS / 10)]
    if not columns.shape[1]:
        return columns
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return np.ascontiguousarray(left[:, values > ACROSS * values[0]])


def scaled_columns(program: Program, problem: Stationary, motions: Array) -> Array:
    """Convert motions of all parts, shape (F, N, 6), to scaled unknowns, shape (n, F)."""
    assert problem.scale is not None
    free = np.flatnonzero(program.free)
    moved = motions[:, free][:, :, program.freedoms].reshape(len(motions), len(problem.scale))
    return np.asarray((moved / problem.scale).T)


def moving_free(assembly: Assembly, free: FreeMotions) -> Index:
    """Indices of the parts that a free motion visibly moves; spins of round parts do not count.

    A group of tied parts counts as its first part, as in the motions.
    """
    groups, moving = RigidGroups.of(assembly), np.zeros(len(assembly.parts), dtype=bool)
    for motion in groups.spread(free.motions):
        for k in np.flatnonzero(np.abs(motion).max(axis=1) > 0):
            moving[k] |= not spins_unseen(assembly, int(k), motion[k])
    return np.unique(groups.first[moving])


def spins_unseen(assembly: Assembly, part: int, motion: Array) -> bool:
    """True if a motion, shape (6,), only spins a round part about its own axis."""
    turn, center = motion[3:], assembly.geometry.center[part]
    radius = float(assembly.geometry.radius[part])
    speed = float(np.abs(turn).max()) * radius
    still = ACROSS * max(speed, float(np.abs(motion[:3]).max()))
    if speed == 0 or abs(motion[:3] @ turn) * radius > still * speed:
        return False
    shape, pose = assembly.parts[part].shape, assembly.parts[part].pose
    if not isinstance(shape, Sphere | Cylinder):
        return _of_revolution(assembly.geometry, part, motion, center)
    if np.abs(motion[:3] + np.cross(turn, pose.position - center)).max() > still:
        return False
    across = np.abs(np.cross(turn, pose.matrix[:, 2])).max() * radius
    return isinstance(shape, Sphere) or bool(across < still)


def _of_revolution(geometry: Geometry, part: int, motion: Array, center: Array) -> bool:
    """True if a motion, shape (6,), maps every face of a part to itself."""
    surfaces, turn = geometry.surfaces, motion[3:] / np.linalg.norm(motion[3:])
    near = ACROSS * float(geometry.radius[part]) + float(geometry.accuracy[part])
    faces = np.arange(surfaces.start[part], surfaces.start[part + 1])
    if (surfaces.kind[faces] == FREE).any():
        return False
    through = center + np.cross(motion[3:], motion[:3]) / (motion[3:] @ motion[3:])
    off = np.linalg.norm(np.cross(surfaces.point[faces] - through, turn), axis=1)
    leans = np.linalg.norm(np.cross(surfaces.axis[faces], turn), axis=1)
    if (off > near).any() or (leans[surfaces.kind[faces] != SPHERE] > ACROSS).any():
        return False
    span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    corners = geometry.vertices[geometry.triangles[span][geometry.triangle_surface[span] < 0]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    aside = np.linalg.norm(np.cross(normal, turn), axis=1)
    return bool(len(faces)) and bool((aside <= ACROSS * np.linalg.norm(normal, axis=1)).all())
