"""Random scenes of rigid objects as MJCF text, and their simulation in MuJoCo.

An object is a body of one to 60 geoms: boxes, cylinders, convex hulls, bowls, mugs, and bins.
`simulated_scene` drops objects in heaps, into bins and bowls, and onto shelves. `floating_scene`
puts stacks together with gaps between 1 mm and .3 m, some of them off centre. Lengths in m.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
SOFT = '<option timestep="0.002"/>'
ROBOTS = '<option timestep="0.002" cone="elliptic" impratio="20"/>'
STIFF = (
    '<option timestep="0.0005" cone="elliptic" impratio="100" tolerance="1e-10" iterations="200" '
    'noslip_iterations="20"/><default><geom solref="0.001 1"/></default>'
)
"""Settings of the simulator: its own, those of many robot benchmarks, and contacts as stiff as two
short time steps allow: with .002 s, a stack of six hulls rocks by 1 mm before it sinks in."""


@dataclass(slots=True)
class Thing:
    """A body: its geoms and meshes as MJCF, its extent, and its pose."""

    name: str
    geoms: list[str]
    radius: float
    """Largest distance of its surface from its origin."""
    low: float = 0.0
    high: float = 0.0
    """Least and greatest z of its surface in its own frame."""
    width: float = 0.0
    """Half of the least width of its top face, on which a next object is put."""
    meshes: list[str] = field(default_factory=list)
    held: bool = False
    position: Array = field(default_factory=lambda: np.zeros(3))
    turn: Rotation = field(default_factory=Rotation.identity)

    def placed(self, position: Array, turn: Rotation) -> Thing:
        """The same object in a pose."""
        self.position, self.turn = np.asarray(position, float), turn
        return self


@dataclass(slots=True)
class Scene:
    """Objects above a plane."""

    kind: str
    things: list[Thing]
    friction: float
    option: str = SOFT

    def xml(self, poses: dict[str, Array] | None = None) -> str:
        """The scene as MJCF; `poses`: position and quaternion of each free object, shape (7,)."""
        meshes = "".join(mesh for thing in self.things for mesh in thing.meshes)
        default = f'<default><geom friction="{self.friction} .005 .0001"/></default>'
        bodies = []
        for thing in self.things:
            pose = np.concatenate([thing.position, thing.turn.as_quat(scalar_first=True)])
            if poses is not None and not thing.held:
                pose = poses[thing.name]
            joint = "" if thing.held else "<freejoint/>"
            bodies.append(
                f'<body name="{thing.name}" pos="{numbers(pose[:3])}" quat="{numbers(pose[3:])}">'
                f"{joint}{''.join(thing.geoms)}</body>"
            )
        return (
            f"<mujoco>{self.option}{default}<asset>{meshes}</asset><worldbody>"
            f'<geom name="floor" type="plane" size="3 3 .1"/>{"".join(bodies)}'
            "</worldbody></mujoco>"
        )

    def without(self, names: Collection[str]) -> Scene:
        """The scene without some objects."""
        return replace(self, things=[thing for thing in self.things if thing.name not in names])

    @property
    def pieces(self) -> int:
        """Number of geoms of the object that has most."""
        return max(len(thing.geoms) for thing in self.things)


def numbers(values: Array) -> str:
    """Numbers with all their digits, separated by spaces."""
    return " ".join(repr(float(value)) for value in values)


# objects ------------------------------------------------------------------------------------


def geom(
    kind: str, size: list[float], at: Array | list[float], turn: Rotation | None = None
) -> str:
    """A geom as MJCF."""
    quat = (Rotation.identity() if turn is None else turn).as_quat(scalar_first=True)
    place = f'pos="{numbers(np.asarray(at))}" quat="{numbers(quat)}"'
    return f'<geom type="{kind}" size="{numbers(np.asarray(size))}" {place}/>'


def hull(name: str, points: Array) -> tuple[str, str]:
    """Geom and mesh of the convex hull of points."""
    mesh = f'<mesh name="{name}" vertex="{numbers(points.ravel())}"/>'
    return f'<geom type="mesh" mesh="{name}"/>', mesh


def box(rng: np.random.Generator, name: str) -> Thing:
    """A box."""
    half = rng.uniform(0.015, 0.06, 3)
    radius = float(np.linalg.norm(half))
    return Thing(name, [geom("box", half, np.zeros(3))], radius, -half[2], half[2], half[:2].min())


def cylinder(rng: np.random.Generator, name: str) -> Thing:
    """A cylinder with its axis along z."""
    radius, half = rng.uniform(0.015, 0.05), rng.uniform(0.01, 0.06)
    made = geom("cylinder", [radius, half], np.zeros(3))
    return Thing(name, [made], float(np.hypot(radius, half)), -half, half, radius)


def polyhedron(rng: np.random.Generator, name: str) -> Thing:
    """The hull of random points of an ellipsoid."""
    points = rng.normal(size=(int(rng.integers(6, 17)), 3))
    points *= rng.uniform(0.02, 0.05, 3) / np.linalg.norm(points, axis=1)[:, None]
    made, mesh = hull(name, points)
    radius = float(np.linalg.norm(points, axis=1).max())
    return Thing(name, [made], radius, points[:, 2].min(), points[:, 2].max(), 0, [mesh])


def frustum(rng: np.random.Generator, name: str) -> Thing:
    """A frustum of a pyramid with 3 to 8 sides."""
    sides, half = int(rng.integers(3, 9)), rng.uniform(0.01, 0.05)
    low = rng.uniform(0.03, 0.06)
    high = low * rng.uniform(0.6, 1.0)
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.vstack(
        [np.column_stack([r * ring, np.full(sides, z)]) for r, z in ((low, -half), (high, half))]
    )
    made, mesh = hull(name, points)
    radius = float(np.hypot(low, half))
    return Thing(name, [made], radius, -half, half, high * np.cos(np.pi / sides), [mesh])


def bowl(rng: np.random.Generator, name: str) -> Thing:
    """A bowl of 20 to 60 pieces: a disc and two rings of boxes or of hulls."""
    around = int(rng.integers(10, 30))
    top, thick = rng.uniform(0.05, 0.1), rng.uniform(0.005, 0.008)
    base, middle = 0.5 * top, 0.85 * top
    height = rng.uniform(0.5, 0.9) * top
    profile = [(base, 0.5 * thick), (middle, 0.45 * height), (top, height)]
    geoms, meshes = [geom("cylinder", [base, thick / 2], [0, 0, thick / 2])], []
    hulls = bool(rng.integers(2))
    for ring, (low, high) in enumerate(pairwise(profile)):
        for k in range(around):
            if hulls:
                made, mesh = hull(f"{name}-{ring}-{k}", _wedge(low, high, thick, around, k))
                meshes.append(mesh)
            else:
                made = _board(low, high, thick, around, k)
            geoms.append(made)
    reach = top + thick
    return Thing(name, geoms, float(np.hypot(reach, height)), 0, height, top, meshes)


def _wedge(
    low: tuple[float, float], high: tuple[float, float], thick: float, around: int, k: int
) -> Array:
    """Corners of a piece of a ring between two points of the outline (radius, height)."""
    out = np.array([high[1] - low[1], low[0] - high[0]])
    out *= thick / np.linalg.norm(out)
    outline = np.array([low, high, np.add(high, out), np.add(low, np.maximum(out, [0, 0]))])
    angles = 2 * np.pi * (k + np.array([0, 1])) / around
    return np.array([[r * np.cos(a), r * np.sin(a), z] for r, z in outline for a in angles])


def _board(
    low: tuple[float, float], high: tuple[float, float], thick: float, around: int, k: int
) -> str:
    """A box along an outline (radius, height), at the place k of a ring of boxes."""
    along = np.subtract(high, low)
    angle = 2 * np.pi * (k + 0.5) / around
    turn = Rotation.from_euler("z", angle) * Rotation.from_euler(
        "y", np.arctan2(along[0], along[1])
    )
    (r, z), half = np.add(low, high) / 2, np.linalg.norm(along) / 2
    # the lower corner of a leaning board stays above the ground of its bowl
    z += thick / 2 * abs(along[0]) / np.linalg.norm(along)
    wide = max(low[0], high[0]) * np.tan(np.pi / around)
    at = np.array([r * np.cos(angle), r * np.sin(angle), z])
    return geom("box", [thick / 2, wide, half], at, turn)


def mug(rng: np.random.Generator, name: str) -> Thing:
    """A mug of 20 to 60 pieces: a disc, a ring of boxes, and a handle of three boxes."""
    around = int(rng.integers(16, 57))
    radius, height, thick = rng.uniform(0.03, 0.045), rng.uniform(0.07, 0.1), 0.005
    geoms = [geom("cylinder", [radius, thick / 2], [0, 0, thick / 2])]
    geoms += [
        _board((radius, 0.2 * thick), (radius, height), thick, around, k) for k in range(around)
    ]
    out, bar = radius + 0.025, thick / 2
    for z in (0.25 * height, 0.75 * height):
        geoms.append(geom("box", [0.0125 + bar, bar, bar], [radius + 0.0125, 0, z]))
    geoms.append(geom("box", [bar, bar, 0.25 * height + bar], [out, 0, 0.5 * height]))
    return Thing(name, geoms, float(np.hypot(out + bar, height)), 0, height, radius)


def tray(name: str, half: Array, tall: float, thick: float, *, held: bool) -> Thing:
    """A bin of five boxes with its ground at z = 0."""
    x, y = half
    geoms = [geom("box", [x, y, thick / 2], [0, 0, thick / 2])]
    for sign in (-1, 1):
        geoms.append(geom("box", [thick / 2, y, tall / 2], [sign * (x - thick / 2), 0, tall / 2]))
        geoms.append(geom("box", [x, thick / 2, tall / 2], [0, sign * (y - thick / 2), tall / 2]))
    return Thing(name, geoms, float(np.linalg.norm([x, y, tall])), 0, tall, 0, held=held)


def shelf(name: str, boards: int, apart: float) -> Thing:
    """A held shelf: a back, two sides and boards; its ground at z = 0."""
    wide, deep, thick = 0.6, 0.15, 0.01
    tall = boards * apart + 0.1
    geoms = [geom("box", [wide, thick, tall / 2], [0, deep, tall / 2])]
    geoms += [geom("box", [thick, deep, tall / 2], [s * wide, 0, tall / 2]) for s in (-1, 1)]
    geoms += [geom("box", [wide, deep, thick], [0, 0, thick + apart * k]) for k in range(boards)]
    return Thing(name, geoms, tall, held=True)


SMALL = (box, cylinder, polyhedron, frustum)


def small(rng: np.random.Generator, name: str) -> Thing:
    """A box, a cylinder, a polyhedron, or a frustum."""
    return SMALL[int(rng.integers(len(SMALL)))](rng, name)


def vessel(rng: np.random.Generator, name: str) -> Thing:
    """A bowl or a mug."""
    return (bowl, mug)[int(rng.integers(2))](rng, name)


# dropped scenes -----------------------------------------------------------------------------


def scattered(
    rng: np.random.Generator, things: list[Thing], half: Array, begin: float, tilt: float | None
) -> list[Thing]:
    """Objects in layers above a rectangle, apart from each other; `tilt`: greatest tilt [rad]."""
    cell = 2.02 * max(thing.radius for thing in things)
    across = np.maximum((2 * half / cell).astype(int), 1)
    per_layer = int(across.prod())
    for k, thing in enumerate(things):
        layer, place = divmod(k, per_layer)
        spot = (np.array(divmod(place, across[1])) + 0.5) / across * 2 * half - half
        free = np.maximum(half / across - thing.radius, 0)
        turn = Rotation.random(random_state=int(rng.integers(2**31)))
        if tilt is not None:
            turn = Rotation.from_euler("zxz", [*rng.uniform(-3, 3, 1), rng.uniform(0, tilt), 1.0])
        height = begin + cell * (layer + 0.5)
        thing.placed(np.append(spot + rng.uniform(-1, 1, 2) * free, height), turn)
    return things


def heap(rng: np.random.Generator) -> list[Thing]:
    """3 to 30 small objects above the plane."""
    count = int(rng.integers(3, 31))
    things = [small(rng, f"thing{k}") for k in range(count)]
    return scattered(rng, things, np.full(2, rng.uniform(0.08, 0.2)), 0.01, None)


def vessels(rng: np.random.Generator) -> list[Thing]:
    """Two to four bowls and mugs, each with up to three objects above it."""
    things = []
    for k in range(int(rng.integers(2, 5))):
        at = np.array([0.35 * (k % 2), 0.35 * (k // 2)])
        low = vessel(rng, f"vessel{k}")
        lean = Rotation.from_euler("zx", [rng.uniform(-3, 3), rng.uniform(0, 0.15)])
        things.append(low.placed(np.append(at, 0.03 + rng.uniform(0, 0.05)), lean))
        height = 0.1 + low.high
        for j in range(int(rng.integers(0, 4))):
            name = f"in{k}-{j}"
            made = vessel(rng, name) if rng.random() < 0.25 else small(rng, name)
            turn = Rotation.random(random_state=int(rng.integers(2**31)))
            height += made.radius
            spot = at + rng.uniform(-0.01, 0.01, 2)
            things.append(made.placed(np.append(spot, height), turn))
            height += made.radius + 0.005
    return things


def shelves(rng: np.random.Generator) -> list[Thing]:
    """A held shelf, with objects above its boards."""
    boards, apart = int(rng.integers(1, 4)), 0.3
    things = [shelf("shelf", boards, apart)]
    for board in range(boards):
        for k in range(int(rng.integers(1, 5))):
            name = f"thing{board}-{k}"
            made = vessel(rng, name) if rng.random() < 0.4 else small(rng, name)
            turn = Rotation.from_euler("zx", [rng.uniform(-3, 3), rng.uniform(0, 0.1)])
            height = 0.02 + apart * board - made.low + rng.uniform(0.012, 0.03)
            things.append(made.placed(np.array([-0.42 + 0.28 * k, 0, height]), turn))
    return things


def bins(rng: np.random.Generator) -> list[Thing]:
    """A held or a free bin, with objects above it."""
    half = rng.uniform(0.14, 0.21, 2)
    low = tray("bin", half, rng.uniform(0.08, 0.15), 0.02, held=bool(rng.integers(2)))
    low.position = np.array([0, 0, 0.0 if low.held else 0.01])
    things = [small(rng, f"thing{k}") for k in range(int(rng.integers(4, 21)))]
    return [low, *scattered(rng, things, half - 0.02, 0.04, None)]


SIMULATED = {"heap": heap, "vessels": vessels, "shelves": shelves, "bins": bins}


def simulated_scene(seed: int) -> Scene:
    """A scene of dropped objects; the kinds take turns."""
    rng = np.random.default_rng([67, seed])
    kind = list(SIMULATED)[seed % len(SIMULATED)]
    friction = round(float(rng.uniform(0.4, 1.0)), 3)
    option = (SOFT, ROBOTS)[seed // len(SIMULATED) % 2]
    return Scene(kind, SIMULATED[kind](rng), friction, option)


# floating scenes ----------------------------------------------------------------------------


def floating_scene(seed: int) -> Scene:
    """Stacks of up to six objects with gaps between 1 mm and .3 m; a third is off centre."""
    rng = np.random.default_rng([76, seed])
    things: list[Thing] = []
    for k in range(int(rng.integers(1, 5))):
        at = np.array([0.9 * (k % 2), 0.9 * (k // 2)])
        height = 0.0
        width = 0.2
        if rng.random() < 0.5:
            half = np.array([*rng.uniform(0.06, 0.2, 2), rng.uniform(0.03, 0.2)])
            table = Thing(f"table{k}", [geom("box", half, np.zeros(3))], 0.3, held=True)
            things.append(table.placed(np.append(at, half[2]), Rotation.identity()))
            height, width = 2 * half[2], half[:2].min()
        things += _column(rng, f"c{k}", at, height, width)
    return Scene("floating", things, round(float(rng.uniform(0.5, 1.0)), 3), STIFF)


def _column(
    rng: np.random.Generator, name: str, at: Array, height: float, width: float
) -> Iterator[Thing]:
    """A floating stack above a place, whose support has a height and half a width."""
    count = int(rng.integers(1, 7))
    off = rng.random() < 1 / 3
    for k in range(count):
        last = k == count - 1
        kinds = (box, cylinder, frustum, *((bowl, mug) if last else ()))
        made = kinds[int(rng.integers(len(kinds)))](rng, f"{name}-{k}")
        reach = rng.uniform(0.4, 1.4) if off and last else rng.uniform(0, 0.3)
        way = rng.uniform(0, 2 * np.pi)
        at = at + reach * width * np.array([np.cos(way), np.sin(way)])
        height += float(np.exp(rng.uniform(np.log(1e-3), np.log(0.3)))) - made.low
        turn = Rotation.from_euler("z", rng.uniform(-3, 3))
        yield made.placed(np.append(at, height), turn)
        height += made.high
        width = made.width


# simulation ---------------------------------------------------------------------------------


class Simulated:
    """A scene in MuJoCo: poses, movements, and sunk depths."""

    def __init__(self, scene: Scene, poses: dict[str, Array] | None = None) -> None:
        self.model = mujoco.MjModel.from_xml_string(scene.xml(poses))
        self.data = mujoco.MjData(self.model)
        self.names = [thing.name for thing in scene.things if not thing.held]
        self.body = np.array([self.model.body(name).id for name in self.names])
        mujoco.mj_forward(self.model, self.data)

    def run(self, seconds: float, damping: float = 0.0) -> None:
        """Simulate for some seconds [s]; every motion decays at the rate `damping` [1/s].

        Contacts of MuJoCo have no rolling resistance by default: cylinders would roll for ever.
        Damping leaves the poses at rest as they are.
        """
        self.model.dof_damping[:] = damping * self.model.dof_M0
        until = self.data.time + seconds
        while self.data.time < until:
            mujoco.mj_step(self.model, self.data)
        mujoco.mj_forward(self.model, self.data)

    def poses(self) -> dict[str, Array]:
        """Position and quaternion of each free body."""
        return {
            name: np.array(self.data.joint(self.model.body_jntadr[body]).qpos)
            for name, body in zip(self.names, self.body, strict=True)
        }

    def centers(self) -> Array:
        """Centres of mass of the free bodies, shape (n, 3)."""
        return np.array(self.data.xipos[self.body])

    def speed(self) -> float:
        """Largest speed of a centre of mass, or of a surface by rotation [m/s]."""
        fast = 0.0
        for body in self.body:
            six = np.zeros(6)
            mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_XBODY, body, six, 0)
            fast = max(fast, float(np.linalg.norm(six[3:])), 0.05 * float(np.linalg.norm(six[:3])))
        return fast

    def sunk(self) -> dict[tuple[int, int], float]:
        """Depth of the deepest contact of each pair of bodies that touch; held bodies are 0."""
        fixed = self.model.body_weldid
        deep: dict[tuple[int, int], float] = {}
        for contact in self.data.contact:
            a, b = sorted(int(fixed[self.model.geom_bodyid[geom]]) for geom in contact.geom)
            deep[a, b] = max(deep.get((a, b), 0.0), -float(contact.dist))
        return deep

    def chains(self) -> Array:
        """Sunk depth summed along the chain of contacts of each free body; nan without a chain.

        The level of a body is the least number of contacts between it and a held body. Its chain
        goes to the next lower level, each time along the contact with the greatest sum; the
        deepest contact with a body of the same level is added, since both share its depth.
        """
        near: dict[int, list[tuple[int, float]]] = defaultdict(list)
        for (a, b), depth in self.sunk().items():
            near[a].append((b, depth))
            near[b].append((a, depth))
        level, reached, front = {0: 0}, {0: 0.0}, [0]
        while front:
            following = sorted({b for a in front for b, _ in near[a]} - set(level))
            level |= dict.fromkeys(following, level[front[0]] + 1)
            for body in following:
                below = [
                    reached[other] + depth
                    for other, depth in near[body]
                    if level.get(other, np.inf) < level[body]
                ]
                aside = [depth for other, depth in near[body] if level.get(other) == level[body]]
                reached[body] = max(below) + max(aside, default=0.0)
            front = following
        return np.array([reached.get(int(body), np.nan) for body in self.body])
