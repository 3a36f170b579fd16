"""`kilter.place`: the places at which the next part stands on an assembly.

The part is lowered straight down onto the assembly. The map has, for each height, the places at
which forces prove that the assembly and the part stand, and the places that motions exclude
(`kilter.analysis.placing.place_map`). At a given place `kilter.check` decides, with its levels, and
the heaviest mass there follows from a limit of load.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import shapely
from numpy.typing import ArrayLike

from kilter.analysis.placing.case_maps import (
    case_prism,
    combined_levels,
    map_cases,
    map_domain,
)
from kilter.analysis.placing.map_warnings import map_warnings
from kilter.analysis.placing.place_at import AtPlace, decide_at
from kilter.analysis.placing.place_map import LevelMap
from kilter.analysis.placing.place_proofs import MapQuestion, at_proof, map_proof
from kilter.analysis.placing.polygon_sets import NOTHING, rings_of
from kilter.analysis.placing.uncertain_part import mass_limits, part_cases
from kilter.analysis.placing.upright_prisms import PlacedPrism, find_tops, placed_prism
from kilter.assembly import Assembly, Part
from kilter.assembly.masses import reweighed
from kilter.assembly.question import Question, question
from kilter.contact import detect
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.shape.primitives import Box
from kilter.tell.json_answer import AnswerInWords
from kilter.tell.levels import holds, require_level
from kilter.tell.place_words import place_sentence
from kilter.validate import finite, number
from kilter.values.guesses import guarded
from kilter.work import stop_after

if TYPE_CHECKING:
    from kilter.tell.answer_data.place_data import LevelPlacesData, PlaceData

__all__ = ["AtPlace", "Places", "box_to_place", "place"]

ACCURACY = 2e-3
"""Default width of the open strip between places that stand and places that fall [extents]."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Places(AnswerInWords):
    """Answer of `kilter.place`: where a part stands on an assembly.

    Attributes
    ----------
    assembly : Assembly
    part : Part
    levels : tuple of LevelMap
        Places by height, the lowest first; empty if a place was given. The coordinates are those of
        the centre of the part.
    prism : PlacedPrism or None
        The part as a prism; None if it is no upright convex prism.
    best : (float, float, float, float) or None
        x, y and height of the centre at the place farthest from the boundary, and its distance from
        the boundary [length unit].
    at : AtPlace or None
        The decision at the given place.
    mass : (float, float)
        Least and largest mass of the part [kg].
    center_within : float
        Largest shift of its centre of mass along each of its axes [sizes of the part].
    question : MapQuestion or None
        Contacts, domain and maps of the cases, for the proof; None at a given place.
    require : str
    accuracy : float
        Largest width of the open strip [length unit].
    programs : int
    warnings : tuple of str
    seconds : float
    """

    answer: ClassVar[str] = "place"

    assembly: Assembly
    part: Part
    levels: tuple[LevelMap, ...]
    prism: PlacedPrism | None
    best: tuple[float, float, float, float] | None
    at: AtPlace | None
    mass: tuple[float, float]
    center_within: float
    question: MapQuestion | None
    require: str
    accuracy: float
    programs: int
    warnings: tuple[str, ...]
    seconds: float

    @property
    def stands(self) -> bool:
        """True if the part stands at the given place at the required level, or at some place."""
        if self.at is not None:
            return holds(self.at.level, self.require)
        return self.best is not None

    @property
    def undecided(self) -> bool:
        """True if it is not decided whether the part stands at the given place, or at any place."""
        if self.at is not None:
            return self.at.verdict.verdict == "undecided"
        open_area = sum(level.open.area for level in self.levels)
        falls = sum(level.falls.area for level in self.levels)
        return not self.stands and bool(open_area > NOTHING * falls)

    @property
    def level(self) -> str | None:
        """Level at the given place; of a map "equilibrium", None without a place."""
        if self.at is not None:
            return self.at.level
        return None if self.best is None else "equilibrium"

    def to_dict(self) -> PlaceData:
        """The places as JSON data, as ``kilter place --json`` prints them."""
        below = 0.0 if self.prism is None else self.prism.below
        data: PlaceData = {
            "sentence": "",  # made below from the other data
            "units": self.assembly.units,
            "levels": [_level_data(level, below) for level in self.levels],
            "best": None
            if self.best is None
            else dict(zip(("x", "y", "height", "margin"), self.best, strict=True)),
            "at": None if self.at is None else self.at.to_dict(),
            "heaviest": None if self.at is None else self.at.to_dict()["heaviest"],
            "mass": list(self.mass),
            "center_within": self.center_within,
            "stands": self.stands,
            "undecided": self.undecided,
            "level": self.level,
            "require": self.require,
            "accuracy": self.accuracy,
            "programs": self.programs,
            "warnings": list(self.warnings),
            "seconds": self.seconds,
        }
        data["sentence"] = place_sentence(data)
        return data

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Forces and motions of the map, or of the given place, as JSON data for `kilter.verify`.

        Parameters
        ----------
        options : dict, optional
            Options with which the file is read.

        Raises
        ------
        InputError
            If the place is undecided, or the assembly without the part is.
        """
        if self.at is not None:
            return at_proof(self.at, self.mass, self.center_within, options or {})
        assert self.question is not None
        return map_proof(
            self.assembly,
            self.part,
            self.levels,
            self.question,
            self.mass,
            self.center_within,
            options or {},
        )

    def __repr__(self) -> str:
        if self.at is not None:
            return f"Places({self.at.verdict.verdict} at {self.at.x:g}, {self.at.y:g})"
        area = sum(level.stands.area for level in self.levels)
        return f"Places({len(self.levels)} heights, {area:g} {self.assembly.units}^2 stand)"


def _level_data(level: LevelMap, below: float) -> LevelPlacesData:
    """JSON data of the places at one height; the height is that of the centre of the part."""
    return {
        "height": level.height + below,
        "stands": rings_of(level.stands),
        "falls": rings_of(level.falls),
        "open": rings_of(level.open),
        "open_strip": float(level.open.area),
        "area": float(level.stands.area),
    }


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
    (True, [5.0])

    With a centre of mass that is known to a tenth of the size, the margin is smaller by this tenth:

    >>> unsure = place(scene("tower"), box_to_place([1, 1, 1], 1.0), center_within=0.1)
    >>> round(answer.best[3], 6), round(unsure.best[3], 6)
    (0.5, 0.4)
    """
    assembly, require = asked.assembly, require_level(asked.require, strict=True)
    assembly.require_grounded()
    if assembly.planar or not np.allclose(assembly.down, [0, 0, -1]):
        raise InputError(
            "place needs gravity along -z in space", hint="turn the file with up or down"
        )
    if not isinstance(part, Part):
        raise InputError(
            f"place needs a part, got {type(part).__name__}",
            hint="give kilter.Part(name, shape, mass=...)",
        )
    if part.name in assembly.index:
        part = replace(part, name=_free_name(part.name, assembly))
    part = replace(part, grounded=False)
    limits = mass_limits(mass, part)
    part = reweighed(part, given_mass=limits[1], density=None)
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
    levels: tuple[LevelMap, ...] = ()
    best = decision = question = None
    programs, width = 0, 0.0
    if at is not None:
        prism = placed_prism(Assembly([part], units=assembly.units))
        decision = decide_at(asked, part, limits, center_within, tops, at)
        remarks = decision.remarks(assembly)
    else:
        prism, _ = case_prism(part, assembly.units)
        domain = map_domain(assembly, tops, prism)
        bounds = np.array(domain.bounds)
        extent = float((bounds[2:] - bounds[:2]).max())
        width = ACCURACY * extent if accuracy is None else number(accuracy, "accuracy", lowest=0)
        contacts = detect.touching(asked.but(progress=None))
        asked.tell("places")
        cases = part_cases(part, limits, center_within)
        maps = map_cases(assembly, contacts, tops, part, cases, domain, width, clear)
        question = MapQuestion(contacts, domain, clear, tuple(maps))
        levels = combined_levels(maps)
        programs = sum(case.programs for case in maps)
        best = _best(levels, prism)
        remarks = [
            *map_warnings(assembly, tops, contacts, levels, width),
            *contacts.remarks(),
        ]
    return Places(
        assembly,
        part,
        levels,
        prism,
        best,
        decision,
        limits,
        float(center_within),
        question,
        asked.require,
        width,
        programs,
        tuple(remarks),
        time.perf_counter() - asked.begun,
    )


def _free_name(name: str, assembly: Assembly) -> str:
    number_ = 2
    while f"{name} {number_}" in assembly.index:
        number_ += 1
    return f"{name} {number_}"


def _best(
    levels: Sequence[LevelMap], part: PlacedPrism
) -> tuple[float, float, float, float] | None:
    """The place farthest from the boundary of the places that stand, of all heights."""
    best = None
    for level in levels:
        for piece in shapely.get_parts(level.stands):
            if not piece.area > 0:
                continue
            radius = shapely.maximum_inscribed_circle(piece)
            margin = float(radius.length)
            center = shapely.get_coordinates(radius)[0]
            if best is None or margin > best[3]:
                best = (float(center[0]), float(center[1]), level.height + part.below, margin)
    return best
