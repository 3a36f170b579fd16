"""Random assemblies at a stated distance from a limit, whose verdict follows from a formula."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from transformations import as_single, scaled

from kilter import Assembly, Bond, Joint, Strap
from kilter.arrays import Array
from kilter.mechanics.mechanics_tolerances import EXCESS, EXCUSED, RULED_OUT, TOLERANCE
from kilter.rigid import Pose
from kilter.scenes.pieces import block, moved, prism

G = 9.81
MARGIN = 10.0
"""Distance from the limit above which the verdict is certain, over the tolerances of a proof: the
levers of the forces are a few sizes of a part [-]."""
ROUNDINGS = 1e4
"""The same, over the rounding of the coordinates [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class LimitCase:
    """An assembly near a limit.

    Attributes
    ----------
    family : str
    beyond : float
        Distance beyond the limit, as a share of the weight; the assembly stays if it is not
        positive [-].
    certain : bool
        Whether the distance is larger than the tolerance and the rounding of the coordinates.
    assembly : Assembly
    """

    family: str
    beyond: float
    certain: bool
    assembly: Assembly

    @property
    def stays(self) -> bool:
        """Whether the assembly stays."""
        return self.beyond <= 0.0

    def __repr__(self) -> str:
        return f"<LimitCase: {self.family}, {self.beyond:.3g} beyond its limit>"


def limit_case(seed: int, *, exact: bool = True) -> LimitCase:
    """A random case; equal seeds give equal cases.

    Parameters
    ----------
    seed : int
    exact : bool
        False: turned in space, and rounded to the coordinates of a binary STL file.
    """
    rng = np.random.default_rng([seed, 20])
    names = sorted(FAMILIES if exact else set(FAMILIES) - NEEDS_EXACT)
    family = names[seed % len(names)]
    beyond = float(10 ** rng.uniform(-12 if exact else -8, -1) * rng.choice([-1.0, 1.0]))
    made = FAMILIES[family](rng, beyond)
    if not made.straps:  # the path of a strap has its own coordinates
        made = scaled(made, 10 ** rng.uniform(-3, 2))
    if not exact:
        turned = moved(made, Pose(rotation=rng.normal(size=4)).rotation)
        return LimitCase(family, beyond, False, as_single(turned))
    size = float(made.geometry.radius.max())
    # a strap has its own coordinates; far coordinates are coarse, and excuse more of a light part
    near = bool(made.straps) or family == "dust" or rng.random() < 0.6
    far = 1.0 if near else 10 ** rng.uniform(3, 6)
    if far > 1.0:
        made = moved(made, shift=size * far * rng.uniform(-1, 1, size=3))
    least = max(ROUNDINGS * far * 2.0**-52, MARGIN * TOLERANCE)
    mass = made.geometry.mass[~made.geometry.grounded]
    excused = min(EXCESS * float(mass.sum() / mass.min()), EXCUSED)
    least = max(least, MARGIN * excused)
    if family == "wedge" and beyond < 0:  # forces of more weights are no proof
        least = max(least, 1 / RULED_OUT)
    return LimitCase(family, beyond, abs(beyond) > least, made)


def _leaning(angle: float, along: float = 0.0) -> Array:
    """Gravity that leans by an angle [rad] toward the horizontal direction `along` [rad]."""
    level = np.sin(angle) * np.array([np.cos(along), np.sin(along), 0.0])
    return G * (level - np.cos(angle) * np.array([0.0, 0, 1]))


def _masses(rng: np.random.Generator, count: int, span: float = 6.0) -> list[float]:
    return [float(m) for m in 10 ** rng.uniform(-span, 0, size=count)]


def _slope(rng: np.random.Generator, beyond: float) -> Assembly:
    """A box without friction between two walls on a floor, which slopes along the walls."""
    parts = [
        block("floor", [-5, -5, -1], [5, 5, 0], grounded=True),
        block("left", [-1.5, -1, 0], [-0.5, 1, 1], grounded=True),
        block("right", [0.5, -1, 0], [1.5, 1, 1], grounded=True),
        block("box", [-0.5, -0.5, 0], [0.5, 0.5, float(rng.uniform(0.1, 1))], mass=1.0),
    ]
    level = 0.0 if beyond > 0 else np.pi / 2  # it leans on a wall, or along the walls
    return Assembly(parts, gravity=_leaning(abs(beyond), np.pi / 2 - level))


def _dust(rng: np.random.Generator, beyond: float) -> Assembly:
    """A box of down to 1e-12 of its neighbours' mass, between two free boxes on a slope."""
    light = float(10 ** rng.uniform(-12, -2))
    parts = [
        block("floor", [-5, -5, -1], [5, 5, 0], grounded=True),
        block("left-wall", [-2.5, -1, 0], [-1.5, 1, 1], grounded=True),
        block("right-wall", [1.5, -1, 0], [2.5, 1, 1], grounded=True),
        block("stop", [-5, -2, 0], [5, -1, 1], grounded=True),
        block("end", [-5, 1, 0], [5, 2, 1], grounded=True),
        block("left", [-1.5, -1, 0], [-0.5, 1, 1], mass=1.0),
        block("right", [0.5, -1, 0], [1.5, 1, 1], mass=1.0),
        block("box", [-0.5, -0.5, 0], [0.5, 0.5, 1], mass=light),
    ]
    level = 0.0 if beyond > 0 else np.pi / 2
    return Assembly(parts, gravity=_leaning(abs(beyond), np.pi / 2 - level))


def _rough_slope(rng: np.random.Generator, beyond: float) -> Assembly:
    """A flat box on a slope at its angle of friction."""
    mu = float(10 ** rng.uniform(-4, 0))
    parts = [
        block("floor", [-5, -5, -1], [5, 5, 0], grounded=True),
        block("box", [-1, -1, 0], [1, 1, 0.01], mass=1.0),
    ]
    lean = np.arctan(mu) + max(beyond, -mu)
    return Assembly(parts, gravity=_leaning(lean, rng.uniform(0, 2 * np.pi)), friction=mu)


def _overhang(rng: np.random.Generator, beyond: float) -> Assembly:
    """A thin slab whose centre of mass lies at an edge, under or over a stack of blocks."""
    thick = float(10 ** rng.uniform(-2, 0))
    parts = [
        block("base", [-3, -2, -1], [0, 2, 0], grounded=True),
        block("slab", [beyond - 1, -1, 0], [beyond + 1, 1, thick], mass=1.0),
    ]
    if rng.random() < 0.5:
        top = float(10 ** rng.uniform(-6, 6))
        parts.append(block("top", [beyond - 0.2, -0.2, thick], [beyond + 0.2, 0.2, 1], mass=top))
    return Assembly(parts)


def _leaning_wall(rng: np.random.Generator, beyond: float) -> Assembly:
    """A rough wall of blocks on a floor that leans until the wall tips over its edge."""
    count, thin = int(rng.integers(1, 5)), float(10 ** rng.uniform(-1, 0))
    mass = 1.0
    parts = [block("floor", [-50, -5, -1], [50, 5, 0], grounded=True)]
    parts += [
        block(f"b{k}", [-thin / 2, -1, k], [thin / 2, 1, k + 1], mass=mass) for k in range(count)
    ]
    return Assembly(parts, gravity=_leaning(np.arctan(thin / count) + beyond), friction=10.0)


def _wedge(rng: np.random.Generator, beyond: float) -> Assembly:
    """A block that widens downward between two rough walls, at its angle of friction."""
    half = float(10 ** rng.uniform(-9, -3)) if rng.random() < 0.5 else float(rng.uniform(0.01, 0.3))
    mu = float(np.tan(max(half - beyond, 0.0)))
    low, high = 0.5 + np.tan(half), 0.5
    shape = [[-low, -1], [low, -1], [high, 0], [-high, 0]]
    left = [[-3, -1], [-low, -1], [-high, 0], [-3, 0]]
    right = [[low, -1], [3, -1], [3, 0], [high, 0]]
    parts = [
        prism("left", left, 1.0, grounded=True),
        prism("right", right, 1.0, grounded=True),
        prism("block", shape, 1.0, mass=1.0),
    ]
    return Assembly(parts, friction=mu)


def _bonded(rng: np.random.Generator, beyond: float) -> Assembly:
    """A stack of blocks that hangs from a ceiling by bonds at the limit of the highest bond."""
    masses = _masses(rng, int(rng.integers(1, 4)))
    parts = [block("ceiling", [-2, -2, 0], [2, 2, 1], grounded=True)]
    bonds, above = [], "ceiling"
    for k, mass in enumerate(masses):
        parts.append(block(f"b{k}", [-1, -1, -k - 1], [1, 1, -k], mass=mass))
        strong = 1.0 if k == 0 else 1 / (1 - abs(beyond))
        pull = G * sum(masses[k:]) / 4 * strong * (1 - beyond if k == 0 else 1)
        bonds.append(Bond((above, f"b{k}"), pull=pull))
        above = f"b{k}"
    return Assembly(parts, bonds=bonds)


def _strapped(rng: np.random.Generator, beyond: float) -> Assembly:
    """A box on a slope without friction, which a strap of limited capacity keeps from sliding."""
    lean = float(rng.uniform(0.2, 1.0))
    parts = [
        block("floor", [-9, -5, -1], [9, 5, 0], grounded=True),
        block("box", [-1, -1, 0], [1, 1, 1], mass=1.0),
    ]
    capacity = G * (np.sin(lean) - beyond)
    strap = Strap([("ground", [-5.0, 0, 0.5]), ("box", [-1.0, 0, 0.5])], capacity=capacity)
    return Assembly(parts, gravity=_leaning(lean), straps=[strap])


def _sliding_joint(rng: np.random.Generator, beyond: float) -> Assembly:
    """A block on a prismatic joint that is level, or slopes along its axis."""
    parts = [
        block("rail", [-5, -1, -1], [5, 1, 0], grounded=True),
        block("carriage", [-1, -1, 1], [1, 1, float(rng.uniform(2, 3))], mass=1.0),
    ]
    joint = Joint(("rail", "carriage"), "prismatic", point=[0, 0, 1], axis=[1, 0, 0])
    along = 0.0 if beyond > 0 else np.pi / 2
    return Assembly(parts, joints=[joint], gravity=_leaning(abs(beyond), along))


def _rubbing_joint(rng: np.random.Generator, beyond: float) -> Assembly:
    """A carriage on a sloping rail that friction and a spring keep from sliding."""
    parts = [
        block("rail", [-5, -1, -1], [5, 1, 0], grounded=True),
        block("carriage", [-1, -1, 1], [1, 1, float(rng.uniform(2, 3))], mass=1.0),
    ]
    lean, share = float(rng.uniform(0.2, 1.0)), float(rng.uniform(0.1, 1.0))
    needed = G * (np.sin(lean) - beyond)
    joint = Joint(
        ("rail", "carriage"), "prismatic", axis=[1, 0, 0], friction=share * needed,
        stiffness=needed, rest=1 - share,
    )  # fmt: skip
    return Assembly(parts, joints=[joint], gravity=_leaning(lean))


def _stopped_joint(rng: np.random.Generator, beyond: float) -> Assembly:
    """A carriage on a rail that slopes away from its stop, or towards it."""
    made = _sliding_joint(rng, 1.0)
    joint = Joint(("rail", "carriage"), "prismatic", axis=[1, 0, 0], limits=(-1.0, 0.0))
    gravity = _leaning(abs(beyond), 0.0) * [np.sign(beyond), 1, 1]
    return replace(made, joints=[joint], gravity=gravity)


FAMILIES: dict[str, Callable[[np.random.Generator, float], Assembly]] = {
    "bonded": _bonded,
    "dust": _dust,
    "leaning-wall": _leaning_wall,
    "overhang": _overhang,
    "rough-slope": _rough_slope,
    "rubbing-joint": _rubbing_joint,
    "sliding-joint": _sliding_joint,
    "slope": _slope,
    "stopped-joint": _stopped_joint,
    "strapped": _strapped,
    "wedge": _wedge,
}
"""Functions that build an assembly at a distance beyond its limit."""
NEEDS_EXACT = {"rubbing-joint", "sliding-joint", "stopped-joint", "strapped"}
"""Families that rounding of the coordinates would not change."""
