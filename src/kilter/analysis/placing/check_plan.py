"""`kilter.check_plan`: does each item of a packing plan stand when it is put down?

After item k the pile of the items 1 to k is decided as `kilter.check` decides it, on the contacts
that all items have together. The first item after which the pile does not stand is reported with a
reason: its centre of mass lies beside the area on which it rests, or it tips items below it. An
item with a limit is overloaded if all forces that balance the pile load its top beyond the limit.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import shapely
from numpy.typing import ArrayLike

from kilter.analysis.placing.plan_states import PlanState, plan_states
from kilter.analysis.transport.transport import transport
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index
from kilter.assembly import Assembly, Part
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet, detect
from kilter.errors import InputError
from kilter.files.packing.packing_lists import PackedBox, PackingPlan, load_plan
from kilter.mechanics.coulomb_cones import pyramid
from kilter.mechanics.forms import equilibrium, scaled_problem
from kilter.mechanics.program import Program
from kilter.rigid import Pose
from kilter.shape.primitives import Box
from kilter.solvers.highs import solve_linear
from kilter.tell.levels import holds, level_rank, require_level
from kilter.tell.place_words import packing_sentence
from kilter.tell.record import Answer, InPython, Record, UnitWord, key
from kilter.validate import finite
from kilter.work import stop_after

# The support of an item of a packing plan, and the reason why the pile falls under the item.


def item_support(contacts: ContactSet, box: PackedBox, later: Index) -> SupportShares:
    """Parts below an item, and the share of its underside on each."""
    patches, below = _patches_under(contacts, box.name)
    before = ~np.isin(below, later)
    patches, below = patches[before], below[before]
    names = contacts.assembly.names
    area = np.bincount(below, contacts.patch_area[patches], minlength=len(names))
    share = area / (box.size[0] * box.size[1])
    parts = np.unique(below)
    order = parts[np.argsort(-share[parts], kind="stable")]
    return tuple((names[k], float(share[k])) for k in order.tolist())


SupportShares = tuple[tuple[str, float], ...]
"""Names of the parts below an item, and the share of its underside on each [-]."""


def _patches_under(contacts: ContactSet, name: str) -> tuple[Index, Index]:
    """Contact patches under a part, and the part below at each; both of shape (n,)."""
    k = contacts.assembly.index_of(name)
    upward = contacts.patch_normal[:, 2]
    is_above = (contacts.patch_parts[:, 1] == k) & (upward > FLAT)
    is_above_reversed = (contacts.patch_parts[:, 0] == k) & (-upward > FLAT)
    patches = np.flatnonzero(is_above | is_above_reversed)
    return patches, contacts.patch_parts[patches, np.where(is_above[patches], 0, 1)]


FLAT = 0.999
"""Least upward component of the normal of a contact under a box [-]."""


def fall_reason(plan: PackingPlan, first: int, verdict: Verdict) -> str:
    """The reason why the pile falls when an item is put down, as a clause."""
    box = plan.boxes[first]
    patches, _ = _patches_under(verdict.contact_set, box.name)
    points = verdict.contact_set.points[np.isin(verdict.contact_set.point_patch, patches), :2]
    center = np.array(box.corner[:2]) + np.array(box.size[:2]) / 2
    if not len(points):
        return f"nothing is under {box.name!r}"
    area = shapely.convex_hull(shapely.multipoints(points))
    beside = float(shapely.distance(area, shapely.points(center)))
    if beside > 0:
        return (
            f"the centre of {box.name!r} lies {beside:.3g} {plan.units} beside the area on which "
            "it rests"
        )
    tipped = _moving_below(box, verdict)
    if tipped:
        named = " and ".join(repr(name) for name in tipped[:2])
        return f"{box.name!r} tips {named}, on which it rests"
    return f"the pile falls under {box.name!r}"


def _moving_below(box: PackedBox, verdict: Verdict) -> list[str]:
    """Parts that lie under an item and move, the fastest first."""
    low, high = verdict.assembly.geometry.part_boxes
    k = verdict.assembly.index_of(box.name)
    overlap = np.minimum(high[:, :2], high[k, :2]) - np.maximum(low[:, :2], low[k, :2])
    top = box.corner[2] + ABOVE * box.size[2]
    under = (high[:, 2] <= top) & (overlap > 0).all(axis=1)
    names = {verdict.assembly.names[j] for j in np.flatnonzero(under).tolist()}
    return [name for name in verdict.moving if name in names]


ABOVE = 1e-3
"""Height above the underside of a box up to which the top of a box below it lies [heights]."""


# Held walls around the pile of a packing plan, such as those of a roll container.


WALL = "wall"
"""Beginning of the names of assumed walls."""
THICK = 0.1
"""Thickness of the base and of assumed walls [widths of the pile]."""


def walls_around(low: Array, high: Array, top: float) -> list[Part]:
    """Four held walls around the space between two corners, up to a height."""
    low, high = np.array(low), np.array([high[0], high[1], top])
    thick = THICK * float((high - low).max())
    walls = []
    for axis in (0, 1):
        for end, side in ((low, -1), (high, 1)):
            size = high - low + 2 * thick
            middle = (low + high) / 2
            size[axis] = thick
            middle[axis] = end[axis] + side * thick / 2
            name = f"{WALL} {'xy'[axis]}{'-+'[side > 0]}"
            walls.append(Part(name, Box(size), Pose(middle), grounded=True, density=1000.0))
    return walls


def given_walls(plan: PackingPlan, size: ArrayLike) -> list[Part]:
    """Held walls of a given inner size; an error if a box lies beyond them."""
    size = finite(size, (2,), "the walls")
    if not size.min() > 0:
        raise InputError(
            f"the walls are {size.tolist()}", hint="give an inner length and width above 0"
        )
    slack = BEYOND * float(size.max())
    for box in plan.boxes:
        if any(
            box.corner[k] < -slack or box.corner[k] + box.size[k] > size[k] + slack for k in (0, 1)
        ):
            word = "item" if plan.order else "line"
            raise InputError(
                f"{word} {box.line}: {box.name!r:.60} lies beyond the walls, which are "
                f"{size[0]:g} x {size[1]:g} {plan.units} inside",
                file=plan.source or None,
                hint="correct its place, or the size of the walls",
            )
    low, high = np.array([0.0, 0.0, plan.low[2]]), np.array([*size, plan.high[2]])
    return walls_around(low, high, float(plan.high[2]))


BEYOND = 1e-6
"""A box may lie beyond a wall by this fraction of the size of the walls [-]."""


# The least load that the top of an item must carry, in all forces that balance a pile.


SIDES = 16
"""Sides of the pyramid around each friction cone."""


def least_top_load(program: Program, name: str) -> float | None:
    """Compute the least sum of normal forces on the top of a part [N]; None if it is not proved.

    Examples
    --------
    >>> from kilter import Assembly, Box, Part, Pose, contacts
    >>> from kilter.mechanics.program import build_program
    >>> base = Part("base", Box([1, 1, 1]), grounded=True)
    >>> boxes = [Part(f"b{k}", Box([1, 1, 1]), Pose([0, 0, k]), mass=k) for k in (1, 2)]
    >>> pile = Assembly([base, *boxes])
    >>> program = build_program(pile, contacts(pile))
    >>> round(least_top_load(program, "b1") / program.g, 9)
    2.0
    >>> least_top_load(program, "b2")
    0.0
    """
    top = _downward_on(program, program.names.index(name))
    if not top.any():
        return 0.0
    rays = pyramid(program, SIDES, outer=True)
    problem = scaled_problem(rays)
    normal_force = _of_rays(program, rays, top) * problem.forces(np.ones(len(rays.part_a)))
    answer = solve_linear(replace(equilibrium(problem), cost=normal_force / problem.unit))
    if not answer.holds:
        return None
    return max(answer.objective * problem.unit, 0.0)


def _downward_on(program: Program, k: int) -> Array:
    """1 for each contact row that presses on the top of a part, else 0; shape (K,)."""
    upward = program.normal[:, 2]
    top = ((program.part_a == k) & (upward > FLAT)) | ((program.part_b == k) & (upward < -FLAT))
    chosen: Array = (top & ~program.angular).astype(float)
    return chosen


def _of_rays(program: Program, rays: Program, top: Array) -> Array:
    """Normal component of a unit force along each row of the pyramids, on the chosen rows."""
    if rays is program:
        return top
    smooth, rough = np.flatnonzero(program.mu <= 0), program.rough
    sides = (len(rays.part_a) - len(smooth)) // len(rough)
    rows = np.concatenate([smooth, np.repeat(rough, sides)])
    along: Array = top[rows] * np.einsum("ij,ij->i", rays.normal, program.normal[rows])
    return along


BASE = "base"
"""Name of the held part under the pile."""
OVER = 1e-7
"""A load beyond a limit by less than this fraction of the limit is within it [-]."""


class SupportShare(Record):
    """A part on which an item rests."""

    part: str
    """Name of the part."""
    share: float
    """Share of the underside of the item [-]."""


class CheckedItem(Record):
    """An item, and the verdict on the pile after it was put down."""

    name: str
    """Name of the item."""
    line: int
    """Line of the table, or number in the order."""
    mass: float
    """[kg]"""
    verdict: str
    """Verdict on the pile of this item and all items before it."""
    level: str | None
    """Level of this verdict."""
    support: tuple[SupportShare, ...]
    """Parts on which it rests."""
    max_load: float | None
    """Largest mass that its top may carry [kg]."""
    top_load: float | None = None
    """Least mass that its top must carry in the finished pile [kg]; null: not known, or without
    a limit."""


class Overload(Record):
    """The first item whose top must carry more than its limit."""

    item: str
    """Name of the item."""
    after: int
    """The item that overloads it, counted from 1."""
    load: float
    """Least mass that its top must carry [kg]."""
    max_load: float
    """[kg]"""


class Walls(Record):
    """Assumed smooth walls around the pile."""

    inner_size: tuple[float, float]
    """Along x and y [length unit]."""
    stands: bool
    """Whether each item stands between the walls."""
    first: int | None
    """The first item that falls nevertheless."""


class CarriedAcceleration(Record):
    """Largest acceleration of the finished pile along a direction."""

    direction: str
    """Axis with its sign."""
    g: float | None
    """[g]; null: no limit up to 100 g."""


class CheckedPlan(Answer):
    """Answer of `kilter.check_plan`: the items of a packing plan, each with its verdict."""

    answer: ClassVar[str] = "check-plan"

    order: str | None
    """Name of the order of the file."""
    units: UnitWord
    """Length unit."""
    friction: float
    """Friction coefficient of all contacts [-]."""
    require: str
    """Level from which an item stands."""
    items: tuple[CheckedItem, ...]
    """Items in their order."""
    first: int | None = None
    """The first item, counted from 1, after which the pile does not stand."""
    why: str | None = None
    """Reason why the first item falls."""
    overload: Overload | None = None
    """The first item whose top must carry more than its limit."""
    walls: Walls | None = None
    """Assumed walls around the pile; null unless an item falls."""
    carried: tuple[CarriedAcceleration, ...] = ()
    """Largest accelerations of the finished pile, if requested."""
    warnings: tuple[str, ...]
    """Warnings about file, geometry and contacts."""
    seconds: float
    """Duration [s]."""
    plan: InPython[PackingPlan]
    """The checked plan."""
    assembly: InPython[Assembly]
    """The finished pile with its base and held parts."""

    @property
    @key
    def sentence(self) -> str:
        """The answer in a sentence."""
        return packing_sentence(self.data_without("sentence"))

    @property
    @key
    def stands(self) -> bool:
        """True if the pile stands after each item, at the required level."""
        return all(holds(item.level, self.require) for item in self.items)

    @property
    @key
    def level(self) -> str | None:
        """Lowest level after an item; None if the pile falls or is undecided after an item."""
        return min((item.level for item in self.items), key=level_rank)

    @property
    def undecided(self) -> bool:
        """True if open pairs leave the pile undecided after an item."""
        return any(item.verdict == "undecided" for item in self.items)

    def __repr__(self) -> str:
        words = "stands" if self.first is None else f"falls at item {self.first}"
        return f"CheckedPlan({len(self.items)} items, {words})"


@question(lacks="down ground floor contacts assume", friction=0.0)
def check_plan(
    plan: PackingPlan | str | Path,
    *,
    asked: Question,
    order: str | None = None,
    units: str | None = None,
    pallet: tuple[float, float] | None = None,
    held: Assembly | None = None,
    walls: tuple[float, float] | None = None,
    carried: bool = False,
) -> CheckedPlan:
    """Decide for each item of a packing plan whether the pile stands when the item is put down.

    Parameters
    ----------
    plan : PackingPlan or path
        A plan, or its file (CSV, or JSON of BED-BPP).
    order : str, optional
        Name of the order, for a file with several orders.
    units : {"m", "cm", "mm", "in"}, optional
        Length unit of a table that states none.
    pallet : (float, float), optional
        Length and width of the base, from the origin of x and y [length unit]. By default the base
        extends beyond the pile.
    held : Assembly, optional
        Held parts around the pile, such as the walls of a roll container.
    walls : (float, float), optional
        Inner length and width of four held walls from the origin of x and y, as tall as the pile
        [length unit].
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which an item stands.
    carried : bool
        Whether to compute the accelerations that the finished pile carries.

    Returns
    -------
    CheckedPlan

    Raises
    ------
    TimeLimitReached
        At the time limit.
    InputError
        If the plan is invalid, two boxes are in the same place, or a box lies beyond the walls.

    See Also
    --------
    kilter.place : the places where a next part stands.
    kilter.plan : a search for an order.

    Examples
    --------
    >>> from kilter.files.packing.packing_lists import PackedBox, PackingPlan
    >>> lower = PackedBox("a", (1, 1, 1), 1, (0, 0, 0), 1)
    >>> upper = PackedBox("b", (1, 1, 1), 1, (0.6, 0, 1), 2)
    >>> check_plan(PackingPlan((lower, upper), "m")).why
    "the centre of 'b' lies 0.1 m beside the area on which it rests"
    """
    asked = asked.but(require=require_level(asked.require, strict=True))
    if not isinstance(plan, PackingPlan):
        plan = load_plan(plan, order=order, units=units)
    friction = asked.friction or 0.0
    pile = plan.assembly().with_friction(friction)
    _require_no_box_inside(plan)
    whole = _with_base(pile, plan, pallet)
    if held is not None:
        whole = whole.merged(held.with_friction(friction), prefix="")
    if walls is not None:
        whole = whole.with_parts(given_walls(plan, walls))
    asked = asked.but(assembly=whole)
    with stop_after(asked.seconds_left):
        free = held is None and walls is None
        return _checked(plan, asked, (pile, pallet) if free else None, carried=carried)


def _checked(
    plan: PackingPlan,
    asked: Question,
    unwalled: tuple[Assembly, tuple[float, float] | None] | None,
    *,
    carried: bool,
) -> CheckedPlan:
    """The answer of `check_plan` about a pile; walls are tried around the pile `unwalled`."""
    whole, tell = asked.assembly, asked.tell
    tell("contacts")
    contacts = detect.contacts(asked)
    found = _items(plan, asked.but(contacts=contacts), tell)
    tell("reason")
    first = found["first"]
    assume = first is not None and unwalled is not None
    return CheckedPlan(
        **found,
        order=plan.order or None,
        units=plan.units,
        friction=whole.friction,
        require=asked.require,
        walls=_walled(asked, plan, *unwalled) if assume and unwalled is not None else None,
        carried=_carried(whole, contacts) if carried and first is None else (),
        warnings=contacts.warnings,
        seconds=time.perf_counter() - asked.begun,
        plan=plan,
        assembly=whole,
    )


def _items(plan: PackingPlan, asked: Question, tell: Callable[[str], None]) -> dict[str, Any]:
    """The items with their verdicts, the first that falls and the first overload, as fields."""
    items: list[CheckedItem] = []
    overload: Overload | None = None
    loads: dict[str, float | None] = {}
    first, why = None, None
    count = len(plan.boxes)
    states = plan_states(asked, count)
    for k, (box, state) in enumerate(zip(plan.boxes, states, strict=True), 1):
        tell(f"item {k} of {count}")
        if first is None and state.verdict is not None and state.word == "unstable":
            # only this verdict is kept: a verdict holds the contacts of its whole pile
            first, why = k, fall_reason(plan, k - 1, state.verdict)
        support = item_support(asked.contacts, box, np.arange(k, count))
        items.append(
            CheckedItem(
                name=box.name,
                line=box.line,
                mass=box.mass,
                verdict=state.word,
                level=state.level,
                support=tuple(SupportShare(part=part, share=share) for part, share in support),
                max_load=box.max_load,
            )
        )
        loads = _top_loads(plan.boxes[:k], state)
        overload = overload or _overload(plan.boxes[:k], loads)
    checked = tuple(replace(item, top_load=loads.get(item.name)) for item in items)
    return {"items": checked, "first": first, "why": why, "overload": overload}


def _top_loads(boxes: Sequence[PackedBox], state: PlanState) -> dict[str, float | None]:
    """Least mass on the top of each item with a limit [kg]; None if it is not known."""
    limited = [box.name for box in boxes if box.max_load is not None]
    if not limited or state.level is None:
        return dict.fromkeys(limited)
    program = state.program()
    forces = {name: least_top_load(program, name) for name in limited}
    return {name: None if force is None else force / program.g for name, force in forces.items()}


def _overload(boxes: Sequence[PackedBox], loads: dict[str, float | None]) -> Overload | None:
    """The first of the items whose top must carry more than its limit."""
    for box in boxes:
        load, most = loads.get(box.name), box.max_load
        if load is not None and most is not None and load > most * (1 + OVER):
            return Overload(item=box.name, after=len(boxes), load=load, max_load=most)
    return None


def _require_no_box_inside(plan: PackingPlan) -> None:
    """Raise an error if two boxes share more than half of the volume of the smaller box."""
    corner = np.array([box.corner for box in plan.boxes])
    size = np.array([box.size for box in plan.boxes])
    volume = np.prod(size, axis=1)
    for k in range(1, len(plan.boxes)):  # in turn: all pairs together would need N^2 numbers
        edges = np.minimum(corner[:k] + size[:k], corner[k] + size[k]) - np.maximum(
            corner[:k], corner[k]
        )
        shared = np.prod(np.maximum(edges, 0.0), axis=1) / np.minimum(volume[:k], volume[k])
        other = int(shared.argmax())
        if shared[other] > INSIDE:
            one, two = plan.boxes[k], plan.boxes[other]
            word = "item" if plan.order else "line"
            where = f"{two.name!r:.60} ({word} {two.line})"
            raise InputError(
                f"{word} {one.line}: {one.name!r:.60} lies inside {where}",
                file=plan.source or None,
                hint="correct the place of one of them",
            )


INSIDE = 0.5
"""Shared volume above which a box counts as inside another [volumes of the smaller box]."""


def _with_base(pile: Assembly, plan: PackingPlan, pallet: Sequence[float] | None) -> Assembly:
    """The pile with a held base under its lowest point."""
    if pallet is None:
        return pile.with_floor()
    thick = THICK * max(pallet)
    middle = [pallet[0] / 2, pallet[1] / 2, float(plan.low[2]) - thick / 2]
    base = Part(BASE, Box([*pallet, thick]), Pose(middle), grounded=True, density=1000.0)
    return pile.with_parts([base])


def _walled(
    asked: Question, plan: PackingPlan, pile: Assembly, pallet: tuple[float, float] | None
) -> Walls:
    """Whether each item stands if smooth walls stand around the pile, and their inner size."""
    low, high = plan.low, plan.high
    walls = walls_around(low, high, high[2])
    whole = _with_base(pile, plan, pallet).with_parts(walls)
    asked = asked.but(assembly=whole, contacts=detect.contacts(whole))
    first = None
    states = plan_states(asked, len(plan.boxes))
    for k, state in enumerate(states, 1):
        if not holds(state.level, asked.require):
            first = k
            break
    size = (high - low).tolist()
    return Walls(inner_size=tuple(size[:2]), stands=first is None, first=first)


def _carried(whole: Assembly, contacts: ContactSet) -> tuple[CarriedAcceleration, ...]:
    """Largest accelerations of the finished pile by direction."""
    data = transport(whole, contacts=contacts, polar=False).to_dict()
    found = [limit for limit in data["limits"] if limit["name"][1:] != "z"]
    return tuple(CarriedAcceleration(direction=limit["name"], g=limit["g"]) for limit in found)
