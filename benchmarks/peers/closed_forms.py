"""Cases of the comparison: assemblies with known answers from closed forms.

`walls` have increasing sizes. The other cases are slightly inside or outside a limit: by two
percent of a load or a length, or by a hundredth of a degree; masses and sizes differ by many
powers of ten. The cases contain only parts, gravity and friction, which every tool accepts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import atan, degrees

import numpy as np

from kilter.assembly import Assembly
from kilter.scenes.friction import a_block, v_block
from kilter.scenes.pieces import block
from kilter.scenes.stacks import block_on_slope, harmonic_stack, overhang, staircase, tower
from kilter.scenes.walls import tilted_wall

__all__ = ["CASES", "SIZES", "Case"]

SIZES = (10, 30, 100, 300, 1000, 10_000)
"""Approximate numbers of bricks of the walls."""
SHARES = (0.98, 1.02)
"""Shares of a limit; stable below 1, unstable above."""
NEAR = 0.01
"""Distance of angles from their limit [deg]."""
POWERS = (2, 4, 6, 8)
"""Exponents k of the ratio 10^-k of two masses."""
SMALL = (2, 4, 6)
"""Exponents k of the ratio 10^-k of two sides."""


@dataclass(frozen=True, slots=True)
class Case:
    """An assembly with its known answer.

    Attributes
    ----------
    family : str
    name : str
    holds : bool
        Whether the parts hold, by the closed form.
    build : callable
        Function that builds the assembly.
    limit : str
        Closed form in words.
    """

    family: str
    name: str
    holds: bool
    build: Callable[[], Assembly]
    limit: str


def leaning_wall(courses: int, per_course: int, share: float, friction: float = 0.6) -> Assembly:
    """A wall of 200 x 100 x 60 mm bricks, tilted by a share of its limit.

    The wall overturns as a whole about its lower edge at tan = 0.1 / (0.06 courses), or slides on
    the base at tan = friction, whichever is less.
    """
    limit = min(0.1 / (0.06 * courses), friction)
    angle = degrees(atan(share * limit))
    return tilted_wall(angle, friction=friction, courses=courses, per_course=per_course)


def sliding(angle: float, azimuth: float) -> Assembly:
    """A cube on a held cube with friction 1/2; gravity leans toward an azimuth [deg].

    The cube slides if tan(angle) exceeds the friction, for every azimuth.
    """
    lean, around = np.radians(angle), np.radians(azimuth)
    aside = np.sin(lean) * np.array([np.cos(around), np.sin(around)])
    return replace(tower(1, friction=0.5), gravity=9.81 * np.array([*aside, -np.cos(lean)]))


def loaded(mass: tuple[float, float], side: float, share: float) -> Assembly:
    """A cube on a unit cube on a held cube, with `share` of its side beyond the edge.

    The upper cube tips if its middle is beyond the edge, share > 1/2, for every mass and size.
    """
    lower, upper = mass
    start = 0.5 - side + share * side
    return Assembly(
        [
            block("base", [-0.5, -0.5, -1], [0.5, 0.5, 0], grounded=True),
            block("lower", [-0.5, -0.5, 0], [0.5, 0.5, 1], density=lower),
            block(
                "upper",
                [start, -side / 2, 1],
                [start + side, side / 2, 1 + side],
                density=upper / side**3,
            ),
        ]
    )


def _walls() -> Iterator[Case]:
    for count in SIZES:
        courses = round(count**0.5)
        build = partial(leaning_wall, courses, round(count / courses), 0.5)
        yield Case("walls", f"wall-{count}", True, build, "half of what overturns or moves it")


def _limits() -> Iterator[Case]:
    def slope(share: float, azimuth: float) -> Assembly:
        return sliding(degrees(atan(share * 0.5)), azimuth)

    def tipping(share: float) -> Assembly:
        return block_on_slope(degrees(atan(share * 0.5)), height=2.0, friction=1.0)

    def leaning_tower(share: float) -> Assembly:
        return tower(5, tilt=degrees(atan(share / 5)), friction=0.5)

    asked: list[tuple[str, Callable[[float], Assembly], str]] = [
        *(
            (f"slides toward {a:g}", partial(slope, azimuth=a), "tan = friction")
            for a in (0.0, 22.5, 45.0)
        ),
        ("tips on a slope", tipping, "tan = width / height"),
        ("hangs over an edge", lambda s: overhang(s / 2), "half its length"),
        ("staircase of 4", lambda s: staircase(4, offset=s / 5), "1 / 5 a step"),
        ("harmonic stack of 10", lambda s: harmonic_stack(10, scale=s), "1 / (2 k) a block"),
        ("tower of 5 leans", leaning_tower, "tan = 1 / 5"),
        ("wall of 14 leans", partial(leaning_wall, 4, 3, friction=1.0), "tan = depth / height"),
        ("wall of 14 slides", partial(leaning_wall, 4, 3, friction=0.15), "tan = friction"),
    ]
    for name, build, limit in asked:
        for share in SHARES:
            yield Case("limits", f"{name}, {share:g}", share < 1, partial(build, share), limit)


def _angles() -> Iterator[Case]:
    yield Case(
        "angles", f"wedge, wider above by {NEAR:g}", True, partial(v_block, NEAR),
        "no friction: it rests if it narrows downward",
    )  # fmt: skip
    yield Case(
        "angles", f"wedge, wider below by {NEAR:g}", False, partial(a_block, NEAR, friction=0.0),
        "no friction: it falls if it widens downward",
    )  # fmt: skip
    for turn in (-NEAR, NEAR):
        for azimuth in (0.0, 22.5):
            angle = degrees(atan(0.5)) + turn
            build = partial(sliding, angle, azimuth)
            name = f"slides toward {azimuth:g}, {turn:+g}"
            yield Case("angles", name, turn < 0, build, "tan = friction")
        lean = partial(tower, 5, tilt=degrees(atan(0.2)) + turn, friction=0.5)
        yield Case("angles", f"tower of 5 leans, {turn:+g}", turn < 0, lean, "tan = 1 / 5")


def _contrasts() -> Iterator[Case]:
    for share in SHARES:
        past, holds = share / 2, share < 1
        for k in POWERS:
            light = 10.0**-k
            for word, mass in (("light on heavy", (1.0, light)), ("heavy on light", (light, 1.0))):
                build = partial(loaded, mass, 1.0, past)
                yield Case("masses", f"{word}, 1e-{k}, {share:g}", holds, build, "half its length")
        for k in SMALL:
            side = 10.0**-k
            build = partial(loaded, (1.0, side**3), side, past)
            yield Case("sizes", f"side 1e-{k}, {share:g}", holds, build, "half its length")


CASES = {case.name: case for family in (_walls, _limits, _angles, _contrasts) for case in family()}
"""All cases by name."""
