"""`kilter.Pile`: boxes on a base as arrays, for packing loops.

A packing program asks thousands of times whether the pile still stands with the next box. A pile
answers for all places of a grid at once, with the equilibrium of the whole pile as `kilter.check`
decides it (level: equilibrium), and keeps what it learns for the next question.

Without friction the steps are those of `pile_places`. With friction, a place that stands without
friction stands, a box without a neighbour beside it tips off alone, and the other places are
programs in Coulomb's cones (`pile_friction`). Places that are still open are left to
`kilter.check` itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.check import check, check_equilibrium
from kilter.analysis.placing.piles.pile_contacts import BoxRows, Touching
from kilter.analysis.placing.piles.pile_open_places import decide_places
from kilter.analysis.placing.piles.pile_question import (
    FALLS,
    OPEN,
    STANDS,
    PlaceDecision,
    decide_rough,
    rough_program,
)
from kilter.analysis.placing.piles.pile_state import PileState, corner_shares
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly, Part
from kilter.contact import detect
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.shape.primitives import Box
from kilter.threads import on_one_thread
from kilter.units import metres_per_unit
from kilter.validate import finite, in_range, number

BASE = "base"
"""Name of the held part under the pile."""
THICK = 0.1
"""Thickness of the base, over its longer side [-]."""
GRAVITY = 9.81
"""[m/s^2]"""
GRID = 1e-9
"""A box beyond the last place of a grid by less than this fraction of a step is on the grid [-]."""
MOST_PLACES = 1_000_000
"""Largest number of places of one question; more would need gigabytes."""


@dataclass(frozen=True, slots=True, eq=False)
class PileFit:
    """Answer of `Pile.fits`: where a box stands. It unpacks as ``mask, heights``.

    Attributes
    ----------
    mask : ndarray of bool, shape (nx, ny)
        True: forces prove that the pile stands with the box there.
    heights : ndarray, shape (nx, ny)
        Height of the underside of the box [length unit]; NaN where it would not lie on the base.
    undecided : ndarray of bool, shape (nx, ny)
        Places without a proof of either answer, for instance because of an open pair. `mask` is
        False there.
    x, y : ndarray, shape (nx,) and (ny,)
        Places of the corner with the least coordinates [length unit].
    programs : int
        Number of programs that were solved.
    steps : dict
        Number of places that each step decided.
    decision : PlaceDecision or None
        States of the places on the base with their forces and motions; None without such places.
    rows : ndarray of int
        Index of each place of `decision` in the flattened `mask`.
    """

    mask: Mask
    heights: Array
    undecided: Mask
    x: Array
    y: Array
    programs: int
    steps: dict[str, int] = field(repr=False)
    decision: PlaceDecision | None = field(repr=False)
    rows: Index = field(repr=False)

    def __iter__(self) -> Iterator[Array | Mask]:
        yield self.mask
        yield self.heights

    @property
    def share(self) -> float:
        """Share of the decided places, of those on the base [-]."""
        on_base = int(np.isfinite(self.heights).sum())
        return 1.0 - float(self.undecided.sum()) / max(on_base, 1)


class Pile:
    """Axis-parallel boxes on a level base, under gravity along -z.

    Parameters
    ----------
    base : array_like, shape (2,)
        Length along x and width along y [length unit]. The base lies from the origin on, its top at
        the height 0; every box lies above it.
    mu : float
        Friction coefficient of all contacts [-].
    units : {"m", "cm", "mm", "in"}
        Length unit.
    gravity : float
        [m/s^2]

    Raises
    ------
    InputError
        If an argument is invalid.

    Examples
    --------
    >>> pile = Pile(base=(1.2, 0.8))
    >>> pile.add((0.4, 0.4, 0.2), 5.0, (0.2, 0.2))
    0.0
    >>> mask, heights = pile.fits((0.6, 0.4, 0.1), 2.0, 0.2)
    >>> mask.shape, int(mask.sum())
    ((6, 4), 9)
    >>> mask[:4, :3].all(axis=1).tolist()  # the third row tips over the edge of the first box
    [True, True, False, True]
    >>> heights[:4, 0].tolist()
    [0.2, 0.2, 0.2, 0.0]
    >>> pile.add((0.6, 0.4, 0.1), 2.0, (0.2, 0.2))
    0.2
    >>> pile.verdict().verdict
    'stable'
    """

    def __init__(
        self,
        base: ArrayLike,
        mu: float = 0.0,
        *,
        units: str = "m",
        gravity: float = GRAVITY,
    ) -> None:
        lengths = finite(base, (2,), "base of the pile")
        if not (lengths > 0).all():
            raise InputError(f"base of the pile is {lengths.tolist()}", hint="give lengths above 0")
        in_range(lengths, "base of the pile")
        metres_per_unit(units)
        self.base: Array = lengths
        self.mu = number(mu, "mu", lowest=0)
        self.units = units
        self.gravity = number(gravity, "gravity", lowest=0, above=True)
        low = np.array([[0.0, 0.0, -THICK * lengths.max()]])
        high = np.array([[*lengths, 0.0]])
        self._state = PileState.of_base(BoxRows(low, high, np.ones(1)))

    def __len__(self) -> int:
        return len(self._state.statics.boxes) - 1

    def __repr__(self) -> str:
        return f"Pile({len(self)} boxes, mu {self.mu:g}, {self.units})"

    @property
    def boxes(self) -> Array:
        """Corners with the least coordinates and sizes of the boxes, shape (n, 6)."""
        boxes = self._state.statics.boxes
        return np.concatenate([boxes.low, boxes.high - boxes.low], axis=1)[1:]

    @property
    def masses(self) -> Array:
        """Masses of the boxes, shape (n,) [kg]."""
        return self._state.statics.boxes.mass[1:].copy()

    def copy(self) -> Pile:
        """A pile with the same boxes, to which others may be added. It takes microseconds."""
        new = Pile.__new__(Pile)
        new.__dict__.update(self.__dict__)
        return new

    @on_one_thread
    def fits(self, size: ArrayLike, mass: float, step: float) -> PileFit:
        """Decide at all places of a grid whether the pile would stand with a further box there.

        The box is lowered straight down and stays where it lands: on the highest top below it. It
        passes beside boxes that it would overlap by less than the gap tolerance.

        Parameters
        ----------
        size : array_like, shape (3,)
            Along x, y, z as the box would lie [length unit].
        mass : float
            [kg]
        step : float
            Distance of the places [length unit]. Place (i, j) has the corner of the box with the
            least coordinates at (i step, j step). The grid has length / step by width / step
            places; at the last ones the box would not lie on the base, so it does not fit there.

        Returns
        -------
        PileFit
            It unpacks as ``mask, heights``.

        Raises
        ------
        InputError
            If an argument is invalid.
        """
        lengths, kilograms = self._box(size, mass)
        step = number(step, "step", lowest=0, above=True)
        counts = np.floor(self.base / step + GRID).astype(np.int64)
        if (counts < 1).any() or counts.prod() > MOST_PLACES:
            raise InputError(
                f"step is {step:g}, so the grid has {counts[0]} x {counts[1]} places",
                hint=f"give a step for 1 to {MOST_PLACES:,} places",
            )
        x, y = (np.arange(count) * step for count in counts.tolist())
        inside = [
            np.flatnonzero(places + length <= whole + GRID * step)
            for places, length, whole in zip((x, y), lengths, self.base, strict=False)
        ]
        shape = (len(x), len(y))
        mask, undecided = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
        heights = np.full(shape, np.nan)
        i, j = (index.ravel() for index in np.meshgrid(*inside, indexing="ij"))
        if not len(i):
            return PileFit(mask, heights, undecided, x, y, 0, {}, None, i)
        corner = np.stack([x[i], y[j]], axis=1)
        touch, decision = self._decide(lengths, kilograms, corner)
        heights[i, j] = touch.height
        mask[i, j] = decision.state == STANDS
        undecided[i, j] = decision.state == OPEN
        return PileFit(
            mask, heights, undecided, x, y, decision.programs, decision.steps, decision,
            np.ravel_multi_index((i, j), shape),
        )  # fmt: skip

    @on_one_thread
    def add(self, size: ArrayLike, mass: float, at: ArrayLike) -> float:
        """Put a box down, and return the height of its underside [length unit].

        The box is added whether the pile stands or not; `fits` and `stands` answer that.

        Parameters
        ----------
        size : array_like, shape (3,)
            Along x, y, z as the box lies [length unit].
        mass : float
            [kg]
        at : array_like, shape (2,)
            Corner of the box with the least coordinates, in x and y [length unit]. The box is
            lowered straight down there, so it lands on what is below it and never inside.

        Raises
        ------
        InputError
            If an argument is invalid, or the box would not lie on the base.
        """
        lengths, kilograms = self._box(size, mass)
        corner = finite(at, (2,), "place of the box")
        slack = GRID * float(lengths[:2].min())
        if (corner < -slack).any() or (corner + lengths[:2] > self.base + slack).any():
            raise InputError(
                f"the box at {corner.tolist()} with the size {lengths[:2].tolist()} does not lie "
                f"on the base of {self.base.tolist()} {self.units}",
                hint="give the corner with the least coordinates",
            )
        weight = kilograms * self.gravity
        touch = self._state.touching(lengths, corner[None])
        low = np.append(corner, touch.height[0])
        box = BoxRows(low[None], (low + lengths)[None], np.array([kilograms]))
        forces = None
        decision = decide_places(self._state, lengths, weight, touch)
        if decision.state[0] == STANDS:
            forces = _with_pushes(touch, *decision.forces[0])
        self._state = self._state.with_box(box, touch, weight, forces)
        if decision.state[0] == FALLS:
            motion, plane = decision.motions[0]
            if motion is None:
                motion = np.zeros((len(self._state.statics.boxes) - 1, 3))
            self._state.add_motion(np.concatenate([motion, plane[None]]))
        return float(touch.height[0])

    @property
    def stands(self) -> bool | None:
        """Whether the pile stands, at the level equilibrium; None if open pairs leave it open."""
        state = self._state
        if state.forces is not None:
            return True
        if self.mu == 0 and state.falls:
            return False
        if state.checked is None:
            state.checked = (_stands_by_check(self.assembly()),)
        return state.checked[0]

    def verdict(self) -> Verdict:
        """The verdict of `kilter.check` on the pile, with the level equilibrium."""
        return check(self.assembly(), require="equilibrium")

    def assembly(self) -> Assembly:
        """The pile as an assembly: a held base, and the boxes "box 1", "box 2" in their order."""
        boxes = self._state.statics.boxes
        parts = [
            Part(
                BASE if k == 0 else f"box {k}",
                Box(boxes.high[k] - boxes.low[k]),
                Pose(boxes.center[k]),
                mass=None if k == 0 else float(boxes.mass[k]),
                grounded=k == 0,
            )
            for k in range(len(boxes))
        ]
        return Assembly(
            parts, units=self.units, friction=self.mu, gravity=[0.0, 0.0, -self.gravity]
        )

    def _box(self, size: ArrayLike, mass: float) -> tuple[Array, float]:
        """Valid size and mass of a box."""
        lengths = finite(size, (3,), "size of the box")
        if not (lengths > 0).all():
            raise InputError(f"size of the box is {lengths.tolist()}", hint="give lengths above 0")
        in_range(lengths, "size of the box")
        kilograms = number(mass, "mass of the box", lowest=0, above=True)
        in_range(kilograms, "mass of the box")
        return lengths, kilograms

    def _decide(self, size: Array, mass: float, corner: Array) -> tuple[Touching, PlaceDecision]:
        """Contacts and states of places."""
        touch = self._state.touching(size, corner)
        weight = mass * self.gravity
        rough = self.mu > 0
        decision = decide_places(self._state, size, weight, touch, programs=not rough)
        if rough:
            if self._state.rough is None:
                self._state.rough = rough_program(self.assembly())
            new = BoxRows(np.zeros((1, 3)), size[None], np.array([mass]))
            decide_rough(
                self._state.rough, self._state.statics.boxes, self.mu, new, touch, decision
            )
        self._decide_by_check(size, mass, touch, decision)
        return touch, decision

    def _decide_by_check(
        self, size: Array, mass: float, touch: Touching, decision: PlaceDecision
    ) -> None:
        """Decide the places that are still open by `kilter.check`: open pairs, close limits."""
        rows = np.flatnonzero(decision.state == OPEN)
        if not len(rows):
            return
        pile = self.assembly()
        for row in rows.tolist():
            low = np.append(touch.corner[row], touch.height[row])
            part = Part(f"box {len(self) + 1}", Box(size), Pose(low + size / 2), mass=mass)
            stands = _stands_by_check(pile.with_parts([part]))
            decision.programs += 1
            if stands is not None:
                decision.state[row] = STANDS if stands else FALLS
        decision.count("check", int((decision.state[rows] != OPEN).sum()))


def _stands_by_check(assembly: Assembly) -> bool | None:
    """Whether forces of equilibrium exist, by `kilter.check`; None if this is undecided."""
    verdict = check_equilibrium(assembly, detect.contacts(assembly))
    return None if verdict.verdict == "undecided" else verdict.level is not None


def _with_pushes(touch: Touching, forces: Array, box: Index, points: Array, pushes: Array) -> Array:
    """Forces at the contacts of the pile and of a new box; `pushes` act at points on boxes."""
    below = np.flatnonzero(touch.may_carry[0])
    new = np.zeros((len(below), 4))
    slot = np.searchsorted(below, box)
    share = corner_shares(points, touch.low[0, box], touch.high[0, box])
    np.add.at(new, slot, pushes[:, None] * share)
    return np.concatenate([np.maximum(forces, 0.0), new.ravel()])
