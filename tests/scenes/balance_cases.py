"""Assemblies with known second-order answers: minima of the energy and balanced positions.

Each case is a function of a single number. Its given contacts define points and curvatures; the
shapes of the parts are placeholders, only the centre of mass matters. `CASES` are without
friction, the parts of `ROLLING` do not slip. Lengths are in m, masses in kg, z is up.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.assembly import Assembly, Feature, GivenContact, Part
from kilter.rigid import Pose, unit
from kilter.shape.primitives import Box, Sphere

State = Literal["minimum", "free", "balanced"]

BASE = "base"
X, Y, Z = np.eye(3)
PLANE, VERTEX = Feature("face"), Feature("vertex")
Build = Callable[[float], Assembly]


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A case with a known second-order answer.

    Attributes
    ----------
    number, title : str
    build : callable
        Function from the parameter to the assembly; a case without a limit ignores the parameter.
    state : {"minimum", "free", "balanced"}
        State below the limit, or of a case without a limit.
    free : int
        Dimension of the motions that keep the energy and every loaded gap, if the state is not
        balanced; some may be free in only one direction.
    limit : float, optional
        Limit of the parameter.
    above : {"minimum", "free", "balanced"}, optional
        State above the limit.
    """

    number: str
    title: str
    build: Build
    state: State
    free: int = 0
    limit: float | None = None
    above: State | None = None

    def __repr__(self) -> str:
        return f"<Case: {self.number} {self.title}>"


CASES: list[Case] = []
"""Cases without friction, in order."""
ROLLING: list[Case] = []
"""Cases of rolling without slip; "minimum" if the energy rises along every rolling motion."""


def _case(
    number: str,
    title: str,
    state: State,
    free: int = 0,
    *,
    limit: float | None = None,
    above: State | None = None,
    among: list[Case] = CASES,
) -> Callable[[Build], Build]:
    """Decorator that adds a case to a list."""

    def enter(build: Build) -> Build:
        among.append(Case(number, title, build, state, free, limit, above))
        return build

    return enter


# pieces ------------------------------------------------------------------------------------


def _ball(radius: float, hollow: bool = False) -> Feature:
    return Feature("face", curvature=-1 / radius if hollow else 1 / radius)


def _cylinder(axis: Array, radius: float) -> Feature:
    """Surface of a cylinder along `axis`; a negative radius is the inner side."""
    return Feature("face", axis, (0.0, 1 / radius))


def _touch(
    x: ArrayLike, n: ArrayLike, a: Feature, b: Feature, parts: tuple[str, str] = (BASE, "b")
) -> GivenContact:
    return GivenContact(parts, [x], n, feature=(a, b))


def _body(center: ArrayLike, name: str = "b", mass: float = 1.0) -> Part:
    """A free part with a given centre of mass."""
    return Part(name, Box([1, 1, 1]), Pose(center), mass=mass)


def _sphere(center: ArrayLike, radius: float, name: str = "b", mass: float = 1.0) -> Part:
    return Part(name, Sphere(radius), Pose(center), mass=mass)


def _on_base(parts: Sequence[Part], touches: Sequence[GivenContact], mu: float = 0.0) -> Assembly:
    base = Part(BASE, Box([1, 1, 1]), Pose([0, 0, -2]), grounded=True)
    return Assembly([base, *parts], contacts=touches, friction=mu, detect=False)


def _one(center: ArrayLike, *touches: GivenContact, mu: float = 0.0) -> Assembly:
    return _on_base([_body(center)], touches, mu)


def _ball_on(feature: Feature, radius: float) -> Assembly:
    """A ball on a surface with the normal z at the origin."""
    return _on_base([_sphere(radius * Z, radius)], [_touch(0 * Z, Z, feature, _ball(radius))])


# a ball, a body on one contact -------------------------------------------------------------


@_case("01", "a ball on a plane", "free", 5)
def _ball_plane(_: float) -> Assembly:
    return _ball_on(PLANE, 1.0)


@_case("02", "a ball on a ball", "balanced")
def _ball_ball(_: float) -> Assembly:
    return _ball_on(_ball(1.3), 0.7)


@_case("03", "a ball in a bowl", "minimum", 3)
def _ball_bowl(_: float) -> Assembly:
    return _ball_on(_ball(1.3, hollow=True), 0.7)


@_case("04", "a ball on ground of curvatures -1 and k", "minimum", 3, limit=0.0, above="balanced")
def _ball_saddle(k: float) -> Assembly:
    return _ball_on(Feature("face", X, (-1.0, k)), 0.5)


@_case("05", "a ball in a V trough", "free", 4)
def _ball_trough(_: float) -> Assembly:
    c = np.sqrt(2) * Z
    sides = [unit([s, 0, 1]) for s in (1, -1)]
    return _on_base([_sphere(c, 1.0)], [_touch(c - n, n, PLANE, _ball(1.0)) for n in sides])


def _ball_on_balls(places: Sequence[float], apart: float) -> Assembly:
    """A ball of radius 1/2 on balls of radius 1, whose centres are `apart` from its axis."""
    r, big = 0.5, 1.0
    c = np.sqrt((r + big) ** 2 - apart**2) * Z
    touches = []
    for t in places:
        p = apart * np.array([np.cos(t), np.sin(t), 0])
        n = unit(c - p)
        touches.append(_touch(p + big * n, n, _ball(big), _ball(r)))
    return _on_base([_sphere(c, r)], touches)


@_case("06", "a ball on two balls", "balanced")
def _ball_two(_: float) -> Assembly:
    return _ball_on_balls((0.0, np.pi), 0.9)


@_case("07", "a ball on three balls", "minimum", 3)
def _ball_three(_: float) -> Assembly:
    return _ball_on_balls((0.0, 2.1, 4.2), 1.16)


@_case("08", "an ellipsoid 1.2, 1, c on a plane", "free", 3, limit=1.0, above="balanced")
def _ellipsoid(c: float) -> Assembly:
    return _one(c * Z, _touch(0 * Z, Z, PLANE, Feature("face", X, (c / 1.44, c))))


@_case(
    "09", "a weeble of radius 1, centre of mass at height h", "free", 3, limit=1.0, above="balanced"
)
def _weeble(h: float) -> Assembly:
    return _one(h * Z, _touch(0 * Z, Z, PLANE, _ball(1.0)))


@_case(
    "10",
    "a half cylinder of radius 1, centre of mass at height h",
    "free",
    3,
    limit=1.0,
    above="balanced",
)
def _half_cylinder(h: float) -> Assembly:
    rim = Feature("edge", X, 1.0)
    return _one(h * Z, *(_touch(y * Y, Z, PLANE, rim) for y in (-2, 2)))


@_case("11", "a box on a cylinder", "balanced")
def _box_on_cylinder(_: float) -> Assembly:
    line = [_touch(y * Y, Z, _cylinder(Y, 1.0), Feature("edge", X)) for y in (-1, 0, 1)]
    return _one(0.2 * Z, *line)


@_case("12", "a cylinder across a cylinder", "balanced")
def _crossed(_: float) -> Assembly:
    return _one(0.5 * Z, _touch(0 * Z, Z, _cylinder(Y, 1.0), _cylinder(X, 0.5)))


def _parallel(radius: float) -> Assembly:
    """A cylinder of radius 1/2 on a parallel cylinder; inside it for a negative radius."""
    rim = Feature("edge", X, 2.0, 0.5 * Z, Y)
    line = [_touch(y * Y, Z, _cylinder(Y, radius), rim) for y in np.linspace(-2, 2, 5)]
    return _one(0.5 * Z, *line)


@_case("13", "a cylinder on a parallel cylinder", "balanced")
def _parallel_on(_: float) -> Assembly:
    return _parallel(1.0)


@_case("14", "a cylinder in a round trough", "free", 2)
def _parallel_in(_: float) -> Assembly:
    return _parallel(-1.0)


# two balls ---------------------------------------------------------------------------------


@_case("15", "two balls in zigzag in a tube", "free", 7)
def _zigzag(_: float) -> Assembly:
    r, tube = 0.5, 0.8
    off = tube - r
    c1 = np.array([-off, 0, r])
    c2 = np.array([off, 0, r + np.sqrt(4 * r * r - 4 * off * off)])
    n, ball = unit(c2 - c1), _ball(r)
    wall = _cylinder(Z, -tube)
    touches = [
        _touch([-off, 0, 0], Z, PLANE, ball, (BASE, "1")),
        _touch([-tube, 0, c1[2]], X, wall, ball, (BASE, "1")),
        _touch(c1 + r * n, n, ball, ball, ("1", "2")),
        _touch([tube, 0, c2[2]], -X, wall, ball, (BASE, "2")),
    ]
    return _on_base([_sphere(c1, r, "1"), _sphere(c2, r, "2")], touches)


def _upright(walls: Sequence[Array]) -> Assembly:
    """Two balls, the second vertically above the first, between planes with given normals."""
    r = 0.5
    ball, centers = _ball(r), {"1": r * Z, "2": 3 * r * Z}
    touches = [
        _touch(0 * Z, Z, PLANE, ball, (BASE, "1")), _touch(2 * r * Z, Z, ball, ball, ("1", "2")),
    ]  # fmt: skip
    for n in walls:
        touches += [_touch(c - r * n, n, PLANE, ball, (BASE, k)) for k, c in centers.items()]
    return _on_base([_sphere(c, r, k) for k, c in centers.items()], touches)


@_case("16", "two balls upright in a tight tube", "minimum", 6)
def _tight_tube(_: float) -> Assembly:
    return _upright([np.cos(t) * X + np.sin(t) * Y for t in np.arange(6) * np.pi / 3])


@_case("17", "two balls upright between two plates", "balanced")
def _two_plates(_: float) -> Assembly:
    return _upright([X, -X])


@_case("18", "a ball upright on a ball", "balanced")
def _no_walls(_: float) -> Assembly:
    return _upright([])


# feet and edges ----------------------------------------------------------------------------


def _plank(h: float, slope: float) -> Assembly:
    """A body with four corners on two slopes [rad], its centre of mass h above them."""
    touches = []
    for s in (1, -1):
        n = np.array([-s * np.sin(slope), 0, np.cos(slope)])
        touches += [_touch([s, y, 0], n, PLANE, VERTEX) for y in (0.5, -0.5)]
    return _one(h * Z, *touches)


@_case("19", "a plank in a V, centre of mass at height h", "free", 1, limit=-1.0, above="balanced")
def _plank_in_v(h: float) -> Assembly:
    return _plank(h, np.pi / 4)


@_case("20", "a plank in a V of slope 0.3", "free", 1, limit=-float(np.tan(0.3)), above="balanced")
def _plank_in_flat_v(h: float) -> Assembly:
    return _plank(h, 0.3)


PEG, RING, WIRE = 0.3, 1.0, 0.1


def _hook(h: float, mu: float = 0.0) -> Assembly:
    """A ring of inner radius 1 on a peg along y."""
    wire = Feature("face", X, (-1 / RING, 1 / WIRE), -RING * Z, Y)
    return _one(h * Z, _touch(0 * Z, Z, _cylinder(Y, PEG), wire), mu=mu)


@_case("21", "a ring on a peg", "free", 3)
def _ring_on_peg(_: float) -> Assembly:
    return _hook(-RING)


@_case(
    "22", "a hook on a peg, centre of mass at height h", "free", 2, limit=-RING, above="balanced"
)
def _hook_on_peg(h: float) -> Assembly:
    return _hook(h)


@_case("23", "a ring standing on a peg", "balanced")
def _ring_standing(_: float) -> Assembly:
    wire = Feature("face", X, (1 / (RING + WIRE), 1 / WIRE), (RING + WIRE) * Z, Y)
    return _one((RING + WIRE) * Z, _touch(0 * Z, Z, _cylinder(Y, PEG), wire))


def _over_edge(h: float) -> list[GivenContact]:
    """Contacts of a box that extends half over the edge of a table."""
    touches = []
    for y in (0.5, -0.5):
        touches.append(_touch(y * Y, Z, Feature("edge", Y), Feature("edge", X)))
        touches.append(_touch([-1, y, 0], Z, PLANE, VERTEX))
    return touches


@_case("24", "a box over the edge of a table, centre below it", "balanced")
def _table_edge(_: float) -> Assembly:
    return _one(-0.3 * Z, *_over_edge(-0.3))


@_case("24b", "the same, stopped from sliding out", "free", 3, limit=0.0, above="balanced")
def _table_edge_stopped(h: float) -> Assembly:
    stops = [_touch([1, y, 0], -X, PLANE, VERTEX) for y in (0.5, -0.5)]
    return _one(h * Z, *_over_edge(h), *stops)


@_case("25", "a pivot, centre of mass at height h", "free", 3, limit=0.0, above="balanced")
def _pivot(h: float) -> Assembly:
    return _one(h * Z, _touch(0 * Z, Z, PLANE, VERTEX))


def _dumbbell(drop: float) -> Assembly:
    """Two connected balls in a bowl, with the centre of mass `drop` below their axis."""
    r, bowl, half = 0.3, 1.5, 0.7
    height = -np.sqrt((bowl - r) ** 2 - half**2)
    touches = []
    for s in (1, -1):
        p = np.array([s * half, 0, height])
        n = -unit(p)
        touches.append(_touch(p - r * n, n, _ball(bowl, hollow=True), _ball(r)))
    return _one((height - drop) * Z, *touches)


@_case("26", "a dumbbell in a bowl", "free", 2)
def _dumbbell_level(_: float) -> Assembly:
    return _dumbbell(0.0)


@_case("27", "a dumbbell, its centre above its axis", "free", 1, limit=0.0, above="balanced")
def _dumbbell_high(rise: float) -> Assembly:
    return _dumbbell(-rise)


@_case("28", "a ball in a conical cup", "minimum", 3)
def _cone_cup(_: float) -> Assembly:
    half = 0.6
    r = np.tan(half)
    touches = []
    for t in np.arange(8) * np.pi / 4:
        away = np.cos(t) * X + np.sin(t) * Y
        n = np.sin(half) * Z - np.cos(half) * away
        touches.append(_touch(np.sin(half) * away + np.cos(half) * Z, n, PLANE, _ball(r)))
    return _on_base([_sphere(Z / np.cos(half), r)], touches)


@_case("29", "a ball on a lying cylinder", "balanced")
def _ball_on_cylinder(_: float) -> Assembly:
    return _ball_on(_cylinder(Y, 1.3), 0.7)


@_case("30", "a ball in a lying pipe", "free", 4)
def _ball_in_pipe(_: float) -> Assembly:
    return _ball_on(_cylinder(Y, -1.3), 0.7)


@_case("31", "a ball within a standing ring", "balanced")
def _ball_in_ring(_: float) -> Assembly:
    return _ball_on(Feature("face", X, (-1.0, 5.0)), 0.3)


@_case("32", "a coin on its rim", "balanced")
def _coin(_: float) -> Assembly:
    return _one(Z, _touch(0 * Z, Z, PLANE, Feature("edge", X, 1.0)))


FEET = [np.array([x, y, 0.0]) for x in (1, -1) for y in (0.6, -0.6)]


@_case("33", "a box on a table", "free", 3)
def _box(_: float) -> Assembly:
    return _one([0.1, 0.2, 0.5], *(_touch(p, Z, PLANE, VERTEX) for p in FEET))


@_case("34", "a box on three balls", "free", 18)
def _box_on_balls(_: float) -> Assembly:
    r = 0.5
    parts, touches = [_body([0.05, 0, 2 * r + 0.3])], []
    for name, t in zip("123", (0.0, 2.1, 4.2), strict=True):
        p = np.array([np.cos(t), np.sin(t), 0])
        parts.append(_sphere(p + r * Z, r, name, 0.2))
        touches.append(_touch(p, Z, PLANE, _ball(r), (BASE, name)))
        touches.append(_touch(p + 2 * r * Z, Z, _ball(r), PLANE, (name, "b")))
    return _on_base(parts, touches)


@_case("35", "a box on a box", "free", 6)
def _two_boxes(_: float) -> Assembly:
    touches = [_touch(p, Z, PLANE, VERTEX, (BASE, "1")) for p in FEET]
    touches += [_touch(0.7 * p + Z, Z, PLANE, VERTEX, ("1", "2")) for p in FEET]
    return _on_base([_body(0.5 * Z, "1"), _body(1.5 * Z, "2")], touches)


@_case("36", "a plank on two balls", "balanced")
def _plank_on_balls(_: float) -> Assembly:
    return _one(0.2 * Z, *(_touch(s * X, Z, _ball(0.5), PLANE) for s in (1, -1)))


@_case(
    "37",
    "two round feet of radius 1, centre of mass at height h",
    "free",
    3,
    limit=1.0,
    above="balanced",
)
def _round_feet(h: float) -> Assembly:
    return _one(h * Z, *(_touch(s * X, Z, PLANE, _ball(1.0)) for s in (1, -1)))


@_case("38", "two round feet in two bowls", "minimum", 0)
def _two_bowls(_: float) -> Assembly:
    bowl = _ball(1.0, hollow=True)
    touches = [_touch([s, 0, -0.25], Z, bowl, _ball(0.25)) for s in (1, -1)]
    return _one(-0.3 * Z, *touches)


@_case("39", "six feet sunk by d into saddles", "minimum", 0, limit=0.5, above="balanced")
def _six_feet(sink: float) -> Assembly:
    touches = []
    for j in range(3):
        turn = np.pi * j / 3
        along = np.cos(turn) * X + np.sin(turn) * Y
        ground = Feature("face", along, (sink - 1, sink + 1))
        touches += [_touch(s * 2 * np.cross(along, Z), Z, ground, VERTEX) for s in (1, -1)]
    return _one(0 * Z, *touches)


# rolling without slip ----------------------------------------------------------------------

GRIP = 10.0
"""Friction coefficient at which no part of these cases slips [-]."""


def _rolls(on: Feature, body: Feature, h: float, normal: Array = Z) -> Assembly:
    return _one(h * Z, _touch(0 * Z, normal, on, body), mu=GRIP)


@_case("R1", "a board on a cylinder, centre of mass at height h", "minimum", limit=1.0,
       above="balanced", among=ROLLING)  # fmt: skip
def _board(h: float) -> Assembly:
    line = [_touch(y * Y, Z, _cylinder(Y, 1.0), Feature("edge", X)) for y in (-1, 1)]
    return _one(h * Z, *line, mu=GRIP)


@_case("R2", "a board on a ball, centre of mass at height h", "minimum", limit=1.0,
       above="balanced", among=ROLLING)  # fmt: skip
def _board_on_ball(h: float) -> Assembly:
    return _rolls(_ball(1.0), PLANE, h)


ROCKS = 1 / (1 / 1.0 + 1 / 2.0)


@_case("R3", "a rocking stone of radius 2 on a hill of radius 1", "minimum", limit=ROCKS,
       above="balanced", among=ROLLING)  # fmt: skip
def _rocking_stone(h: float) -> Assembly:
    return _rolls(_ball(1.0), _ball(2.0), h)


@_case("R4", "a ball on a ball", "balanced", among=ROLLING)
def _ball_rolls_off(_: float) -> Assembly:
    return _rolls(_ball(5.0), _ball(0.5), 0.5)


@_case("R5", "a ball in a bowl", "minimum", 1, among=ROLLING)
def _ball_rolls_back(_: float) -> Assembly:
    return _rolls(_ball(5.0, hollow=True), _ball(0.5), 0.5)


@_case("R6", "a cylinder of radius r across a cylinder", "minimum", limit=1.0, above="balanced",
       among=ROLLING)  # fmt: skip
def _crossed_rolls(r: float) -> Assembly:
    return _rolls(_cylinder(Y, 1.0), _cylinder(X, r), r)


SLOPE = 0.4


@_case("R7", "a weeble of radius 1 on a slope of 0.4, centre of mass at height h", "minimum",
       limit=float(np.cos(SLOPE)), above="balanced", among=ROLLING)  # fmt: skip
def _weeble_on_slope(h: float) -> Assembly:
    return _rolls(PLANE, _ball(1.0), h, np.array([np.sin(SLOPE), 0, np.cos(SLOPE)]))


@_case("R8", "a hook on a peg in its plane, centre of mass at height h", "minimum",
       limit=PEG * RING / (RING - PEG), above="balanced", among=ROLLING)  # fmt: skip
def _hook_rolls(h: float) -> Assembly:
    return _hook(h, GRIP)


@_case("R9", "a board on two cylinders", "minimum", among=ROLLING)
def _board_on_two(_: float) -> Assembly:
    touches = [
        _touch([s, y, 0], Z, _cylinder(Y, 0.5), Feature("edge", X))
        for s in (1, -1)
        for y in (1, -1)
    ]
    return _one(0.2 * Z, *touches, mu=GRIP)
