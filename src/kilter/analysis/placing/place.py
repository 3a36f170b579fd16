"""`kilter.place`: the places at which the next part stands on an assembly.

The part is lowered straight down onto the assembly. The map has, for each height, the places at
which forces prove that the assembly and the part stand, and the places that motions exclude
(`kilter.analysis.placing.place_map`). At a given place `kilter.check` decides, with its levels, and
the heaviest mass there follows from a limit of load.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar

import numpy as np
import shapely
from numpy.typing import ArrayLike

from kilter.analysis.placing.place_at import AtPlace, decide_at, mass_limits, part_cases
from kilter.analysis.placing.place_map import LevelMap, map_warnings
from kilter.analysis.placing.place_proofs import (
    MapQuestion,
    at_proof,
    case_prism,
    combined_levels,
    map_cases,
    map_domain,
    map_proof,
)
from kilter.analysis.placing.polygon_sets import NOTHING, rings_of
from kilter.analysis.placing.upright_prisms import PlacedPrism, Top, find_tops, placed_prism
from kilter.assembly import Assembly, Part
from kilter.assembly.mesh_surface import reweighed
from kilter.assembly.question import Question, question
from kilter.assembly.supported_answer import SupportedAnswer
from kilter.contact import ContactSet, detect
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.shape.primitives import Box
from kilter.tell.levels import holds, require_level
from kilter.tell.place_words import place_sentence
from kilter.tell.record import InPython, Record, Shape, UnitWord, key
from kilter.validate import finite, number
from kilter.values.guesses import guarded
from kilter.work import stop_after

__all__ = ["AtPlace", "Places", "box_to_place", "place"]

ACCURACY = 2e-3
"""Default width of the open strip between places that stand and places that fall [extents]."""
Polygons = Annotated[shapely.Geometry, Shape(None, None, None, 2)]


class LevelPlaces(Record):
    """Places of the centre of the part at one height; the open places are neither."""

    height: float
    """Height of the centre of the part [length unit]."""
    stands: Polygons
    """Places that forces prove; as data polygons, each a list of rings (outline, holes) of points
    [length unit]."""
    falls: Polygons
    """Places that motions exclude."""
    open: Polygons
    """The other places."""

    @property
    @key
    def open_strip(self) -> float:
        """Area of the open places [length unit^2]."""
        return float(self.open.area)

    @property
    @key
    def area(self) -> float:
        """Area of the places that stand [length unit^2]."""
        return float(self.stands.area)

    def to_dict(self) -> dict[str, Any]:
        """The JSON data, with polygons as lists of rings."""
        rings = {name: rings_of(getattr(self, name)) for name in ("stands", "falls", "open")}
        return super().to_dict() | rings


class BestPlace(Record):
    """The place farthest from the boundary of the places that stand."""

    x: float
    """Centre of the part, world frame [length unit]."""
    y: float
    """Centre of the part, world frame [length unit]."""
    height: float
    """Height of the centre of the part [length unit]."""
    margin: float
    """Distance from the boundary [length unit]."""


class Places(SupportedAnswer):
    """Answer of `kilter.place`: where a part stands on an assembly."""

    answer: ClassVar[str] = "place"

    units: UnitWord
    """Length unit."""
    levels: tuple[LevelPlaces, ...] = ()
    """Places by height, the lowest first; empty if a place was given."""
    best: BestPlace | None = None
    """The best place of the map; null at a given place, or if no place stands."""
    at: AtPlace | None = None
    """The decision at the given place."""
    mass: tuple[float, float]
    """Least and largest mass of the part [kg]."""
    center_within: float
    """Largest shift of the centre of mass along each axis [sizes of the part]."""
    require: str
    """Level from which a given place counts as standing."""
    accuracy: float = 0.0
    """Largest width of the open strip [length unit]."""
    programs: int = 0
    """Number of solved programs."""
    warnings: tuple[str, ...]
    """Warnings about the map, the geometry and the contacts."""
    seconds: float
    """Duration [s]."""
    assembly: InPython[Assembly]
    """The assembly without the part."""
    part: InPython[Part]
    """The part that is put down."""
    prism: InPython[PlacedPrism | None]
    """The part as a prism; None if it is no upright convex prism."""
    question: InPython[MapQuestion | None] = None
    """Contacts, domain and maps of the cases, for the proof; None at a given place."""

    @property
    @key
    def sentence(self) -> str:
        """The answer in a sentence."""
        return place_sentence(self.data_without("sentence"))

    @property
    @key
    def heaviest(self) -> float | None:
        """Largest mass that is carried at the given place [kg]; null: not known, or no limit."""
        return None if self.at is None else self.at.heaviest

    @property
    @key
    def stands(self) -> bool:
        """True if the part stands at the given place at the required level, or at some place."""
        if self.at is not None:
            return holds(self.at.level, self.require)
        return self.best is not None

    @property
    @key
    def undecided(self) -> bool:
        """True if it is not decided whether the part stands at the given place, or at any place."""
        if self.at is not None:
            return self.at.verdict == "undecided"
        open_area = sum(level.open.area for level in self.levels)
        falls = sum(level.falls.area for level in self.levels)
        return not self.stands and bool(open_area > NOTHING * falls)

    @property
    @key
    def level(self) -> str | None:
        """Level at the given place; of a map "equilibrium", None without a place."""
        if self.at is not None:
            return self.at.level
        return None if self.best is None else "equilibrium"

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Forces and motions of the map, or of the given place, as JSON data for `kilter.verify`.

        `options` are those with which the file is read.

        Raises
        ------
        InputError
            If the place is undecided, or the assembly without the part is.
        """
        if self.at is not None:
            return at_proof(self.at, self.mass, self.center_within, options or {})
        assert self.question is not None
        return map_proof(
            self.assembly, self.part, self.question, self.mass, self.center_within, options or {}
        )

    def __repr__(self) -> str:
        if self.at is not None:
            return f"Places({self.at.verdict} at {self.at.x:g}, {self.at.y:g})"
        area = sum(level.stands.area for level in self.levels)
        return f"Places({len(self.levels)} heights, {area:g} {self.assembly.units}^2 stand)"


@guarded
def box_to_place(
    size: ArrayLike, mass: float, *, turn: float = 0.0, name: str = "new part"
) -> Part:
    """A box to put down, with its centre at the origin.

    Parameters
    ----------
    size : array_like, shape (3,)
        Length, width and height [length unit].
    mass : float
        [kg]
    turn : float
        Angle about the vertical [deg].
    name : str

    Raises
    ------
    InputError
        If a value is invalid.

    See Also
    --------
    kilter.place : the places where the part stands.
    kilter.Box : the shape alone.
    """
    lengths = finite(size, (3,), "size of the box")
    half = np.radians(number(turn, "turn")) / 2
    pose = Pose([0, 0, 0], [float(np.cos(half)), 0, 0, float(np.sin(half))])
    return Part(name, Box(lengths), pose, mass=number(mass, "mass", lowest=0))


@question()
def place(
    asked: Question,
    part: Part,
    *,
    at: ArrayLike | None = None,
    mass: float | Sequence[float] | None = None,
    center_within: float = 0.0,
    clear: float = 0.0,
    accuracy: float | None = None,
) -> Places:
    """Find where the next part stands on an assembly, or decide whether it stands at a place.

    Parameters
    ----------
    assembly : Assembly, or path
        Gravity acts along -z.
    part : Part
        The part to put down, in its orientation; its position does not matter. `box_to_place` makes
        a box. A map needs a box or another upright convex prism.
    at : array_like, shape (2,), optional
        Centre of the part in x and y [length unit]. Without it, all places are mapped.
    mass : float or (float, float), optional
        Mass of the part, or its least and largest mass [kg]; by default the mass of `part`.
    center_within : float
        Largest horizontal shift of the centre of mass along each axis of the part [sizes of the
        part]. The answer then holds for each mass and each centre within these limits.
    clear : float
        Distance that the part keeps from parts beside it in a map [length unit].
    accuracy : float, optional
        Largest width of the strip between places that stand and places that fall; by default a
        500th of the extent of the map [length unit].
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which a given place counts as standing. A map has the level equilibrium.

    Returns
    -------
    Places

    Raises
    ------
    TimeLimitReached
        At the time limit.
    InputError
        If gravity does not act along -z, no part is held, or an argument is invalid.

    See Also
    --------
    kilter.settle : moves drawn parts until they rest.
    kilter.check_plan : decides a given sequence of places.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> answer = place(scene("tower"), box_to_place([1, 1, 1], 1.0))
    >>> answer.stands, [level.height for level in answer.levels]
    (True, [5.5])

    With a centre of mass that is known to a tenth of the size, the margin is smaller by this tenth:

    >>> unsure = place(scene("tower"), box_to_place([1, 1, 1], 1.0), center_within=0.1)
    >>> round(answer.best.margin, 6), round(unsure.best.margin, 6)
    (0.5, 0.4)
    """
    assembly, require = asked.assembly, require_level(asked.require, strict=True)
    assembly.require_grounded()
    if assembly.planar or not np.allclose(assembly.down, [0, 0, -1]):
        raise InputError(
            "place needs gravity along -z in space", hint="turn the file with up or down"
        )
    part, limits = _free_part(part, assembly, mass)
    clear = number(clear, "clear", lowest=0)
    if at is not None and clear > 0:
        raise InputError(
            "clear is a distance in a map of places, but a place is given",
            hint="leave out clear or at",
            option="leave out --clear or --at",
        )
    with stop_after(asked.seconds_left):
        return _places(asked.but(require=require), part, limits, at, center_within, clear, accuracy)


def _places(
    asked: Question,
    part: Part,
    limits: tuple[float, float],
    at: ArrayLike | None,
    center_within: float,
    clear: float,
    accuracy: float | None,
) -> Places:
    """The answer of `place` about a part with given limits of its mass [kg]."""
    assembly = asked.assembly
    tops = find_tops(assembly)
    asked.tell("contacts")
    found: dict[str, Any]
    if at is not None:
        decision = decide_at(asked, part, limits, center_within, tops, at)
        prism = placed_prism(Assembly([part], units=assembly.units))
        found = {"at": decision, "warnings": decision.remarks(assembly), "prism": prism}
    else:
        contacts = detect.touching(asked.but(progress=None))
        asked.tell("places")
        found = _map(assembly, part, contacts, tops, limits, center_within, clear, accuracy)
    return Places(
        **found,
        units=assembly.units,
        mass=limits,
        center_within=float(center_within),
        require=asked.require,
        seconds=time.perf_counter() - asked.begun,
        assembly=assembly,
        part=part,
    )


def _map(
    assembly: Assembly,
    part: Part,
    contacts: ContactSet,
    tops: list[Top],
    mass: tuple[float, float],
    center_within: float,
    clear: float,
    accuracy: float | None,
) -> dict[str, Any]:
    """The map of all places as fields of `Places`."""
    prism, _ = case_prism(part, assembly.units)
    domain = map_domain(assembly, tops, prism)
    bounds = np.array(domain.bounds)
    extent = float((bounds[2:] - bounds[:2]).max())
    width = ACCURACY * extent if accuracy is None else number(accuracy, "accuracy", lowest=0)
    cases = part_cases(part, mass, center_within)
    maps = map_cases(assembly, contacts, tops, part, cases, domain, width, clear)
    levels = combined_levels(maps)
    warnings = map_warnings(assembly, tops, contacts, levels, width)
    return {
        "levels": tuple(
            LevelPlaces(
                height=level.height + prism.below,
                stands=level.stands,
                falls=level.falls,
                open=level.open,
            )
            for level in levels
        ),
        "best": _best(levels, prism),
        "accuracy": width,
        "programs": sum(case.programs for case in maps),
        "warnings": (*warnings, *contacts.warnings),
        "prism": prism,
        "question": MapQuestion(contacts, domain, clear, levels, tuple(maps)),
    }


def _free_part(
    part: Part, assembly: Assembly, mass: float | Sequence[float] | None
) -> tuple[Part, tuple[float, float]]:
    """The part with a free name and its largest mass, and the least and the largest mass [kg]."""
    if not isinstance(part, Part):
        raise InputError(
            f"place needs a part, got {type(part).__name__}",
            hint="give kilter.Part(name, shape, mass=...)",
        )
    name, count = part.name, 1
    while name in assembly.index:
        count += 1
        name = f"{part.name} {count}"
    part = replace(part, name=name, grounded=False)
    limits = mass_limits(mass, part)
    return reweighed(part, given_mass=limits[1], density=None), limits


def _best(levels: Sequence[LevelMap], part: PlacedPrism) -> BestPlace | None:
    """The place farthest from the boundary of the places that stand, of all heights."""
    best = None
    for level in levels:
        for piece in shapely.get_parts(level.stands):
            if not piece.area > 0:
                continue
            radius = shapely.maximum_inscribed_circle(piece)
            margin = float(radius.length)
            if best is None or margin > best.margin:
                x, y = shapely.get_coordinates(radius)[0].tolist()
                best = BestPlace(x=x, y=y, height=level.height + part.below, margin=margin)
    return best
