"""Assemblies that are drawn with play, and the poses in which their parts come to rest.

Each builder returns a `KnownRest`: the assembly, and in closed form the shift of every part that
comes to rest and the names of the parts that fall out. Gravity is along -z; `turned` rotates a
scene. d, D: diameters; c: play on each side; h: height above the seat; all in length units.

    pin_in_hole          a horizontal pin, coaxial with its hole: down by (D - d) / 2
    pin_in_through_hole  a vertical pin in a through hole: falls out
    pin_in_blind_hole    a vertical pin, h above the ground of its hole: down by h
    button               a stem with a flange, h above the seat of the flange: down by h;
                         without a flange: falls out
    drawer               between two sides, h above its rails: down by h; without rails, H above a
                         panel: down by H
    lid                  a rim with side play, h above the edge of a box: down by h
    stack_with_gaps      n boxes, gaps g_1 to g_n from below: box k down by g_1 + ... + g_k
    sunk_stack           n boxes, each contact sunk by e: box k up by k e
    side_by_side         two boxes, apart by a hair, on the floor: no movement
    ball_in_groove       a ball over a V groove, h above its rest: down by h
    cylinder_in_channel  a lying cylinder between two walls, h above the ground: down by h
    key_in_slot          length L, breadth b, c on each side, turned by a torque about its middle:
                         turns by asin((b + 2 c) / sqrt(L^2 + b^2)) - atan(b / L)
    ring_on_bar          a ring around a bar, drawn concentric: down by (D - d) / 2
    cabinet              six boards that touch, without glue; the shelf touches one side and the
                         back, which press it against nothing: it slides down to the bottom board,
                         the others stay
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kilter import Assembly, Cylinder, Joint, Load, Part, Pose, Sphere
from kilter.scenes.pieces import block, cells, compose, floor, moved, prism, tube, turn
from kilter.shape.solid import Solid, Surface

Array = NDArray[np.float64]
Shift = tuple[float, float, float]
STILL = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class KnownRest:
    """An assembly, and where its free parts come to rest."""

    name: str
    assembly: Assembly
    shift: dict[str, Shift]
    """Shift of the centre of mass of each free part that comes to rest [length unit]."""
    leaves: tuple[str, ...] = ()
    """Names of the parts that fall out."""
    angle: dict[str, float] = field(default_factory=dict)
    """Angle of the rotation of parts that turn [rad]; other parts do not turn."""


def turned(known: KnownRest, rotation: Sequence[float]) -> KnownRest:
    """The same scene and gravity, rotated by a quaternion (w, x, y, z)."""
    matrix = Pose(rotation=rotation).matrix
    shift = {name: tuple((matrix @ np.array(by)).tolist()) for name, by in known.shift.items()}
    assembly = moved(known.assembly, rotation)
    return KnownRest(known.name, assembly, shift, known.leaves, known.angle)


# parts ----------------------------------------------------------------------------------------


def revolved(
    name: str,
    profile: Sequence[tuple[float, float]],
    at: Sequence[float] = STILL,
    *,
    sides: int = 48,
    **properties: object,
) -> Part:
    """A solid of revolution about z with exact cylinders and planes.

    `profile`: corners (radius, z), counterclockwise with the radius to the right; its sides are
    parallel or perpendicular to the axis.
    """
    corners = np.array(profile, dtype=np.float64)
    angle = np.arange(sides) * (2 * np.pi / sides)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    rings = [np.column_stack([r * circle, np.full(sides, z)]) for r, z in corners]
    k, j = np.arange(sides), (np.arange(sides) + 1) % sides
    triangles, owner, surfaces = [], [], []
    for n, (r, z) in enumerate(corners):
        m = (n + 1) % len(corners)
        end, top = corners[m]
        if r == end == 0.0:
            continue
        if z == top:
            surfaces.append(Surface("plane", [0, 0, z], [0, 0, np.sign(r - end)]))
        else:
            assert r == end, "the sides of the profile run along or across the axis"
            surfaces.append(Surface("cylinder", STILL, [0, 0, 1], radius=r, hollow=top < z))
        for three in ((k + n * sides, j + n * sides, j + m * sides),
                      (k + n * sides, j + m * sides, k + m * sides)):  # fmt: skip
            triangles.append(np.column_stack(three))
            owner.append(np.full(sides, len(surfaces) - 1))
    vertices, faces = _welded(np.concatenate(rings), np.concatenate(triangles))
    sound = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    volume, middle, across, along = _moments(corners)
    second = np.diag([across, across, along - volume * middle**2])
    sagitta = float(corners[:, 0].max()) * (1 - np.cos(np.pi / sides))
    solid = Solid(
        vertices, faces[sound], tuple(surfaces), np.concatenate(owner)[sound], volume,
        [0, 0, middle], second, sagitta=sagitta,
    )  # fmt: skip
    return Part(name, solid, Pose(at), **properties)


def _welded(vertices: Array, triangles: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """Vertices without repetitions on the axis, and the triangles with new indices."""
    distinct, index = np.unique(vertices.round(12) + 0.0, axis=0, return_inverse=True)
    exact = np.empty_like(distinct)
    exact[index.ravel()] = vertices
    return exact, index.ravel()[triangles]


def _moments(corners: Array) -> tuple[float, float, float, float]:
    """Integrals over the solid of a profile: volume, mean z, x^2 and z^2 (about the origin)."""
    ends = np.roll(corners, -1, axis=0)
    place, weight = np.polynomial.legendre.leggauss(4)
    share = (place[:, None, None] + 1) / 2
    r, z = np.moveaxis(corners + share * (ends - corners), 2, 0)
    rise = (ends - corners)[:, 1] * weight[:, None] / 2
    volume, first, second = (np.pi * float((rise * r**2 * z**n).sum()) for n in (0, 1, 2))
    return volume, first / volume, np.pi / 4 * float((rise * r**4).sum()), second


def lying(part: Part, at: Sequence[float] = STILL) -> Part:
    """A part about z, with its axis along y and its origin at a point."""
    return Part(part.name, part.shape, Pose(at, turn([1, 0, 0], 90)), grounded=part.grounded)


def tray(
    name: str, size: Sequence[float], wall: float, low: Sequence[float], **properties: object
) -> Part:
    """A box that is open above, of outer extents `size`, with its lowest corner at `low`."""
    lines = [[a, a + wall, a + b - wall, a + b] for a, b in zip(low, size, strict=True)]
    solid = np.ones((3, 3, 2), dtype=bool)
    solid[1, 1, 1] = False
    shape = cells(lines[0], lines[1], [low[2], low[2] + wall, low[2] + size[2]], solid)
    return Part(name, shape, **properties)


# scenes ---------------------------------------------------------------------------------------


def pin_in_hole(d: float = 0.02, D: float = 0.0206, length: float = 0.05) -> KnownRest:
    """A pin of diameter d that is coaxial with a horizontal hole of diameter D in a held tube."""
    hole = lying(tube("plate", D / 2, D, length / 2, grounded=True))
    pin = lying(Part("pin", Cylinder(d / 2, length)))
    down = {"pin": (0.0, 0.0, -(D - d) / 2)}
    return KnownRest("pin in a hole", Assembly([hole, pin], friction=0.3), down)


def pin_in_through_hole(d: float = 0.02, D: float = 0.0206, length: float = 0.05) -> KnownRest:
    """A vertical pin in a through hole of a held tube."""
    hole = tube("plate", D / 2, D, length / 2, grounded=True)
    drawn = Assembly([hole, Part("pin", Cylinder(d / 2, length))], friction=0.3)
    return KnownRest("pin in a through hole", drawn, {}, ("pin",))


def pin_in_blind_hole(
    d: float = 0.02, D: float = 0.0206, length: float = 0.05, h: float = 0.003
) -> KnownRest:
    """A vertical pin in a blind hole of a held cup, h above the ground of the hole."""
    profile = [(0, -d), (D, -d), (D, length / 2), (D / 2, length / 2), (D / 2, 0), (0, 0)]
    pin = Part("pin", Cylinder(d / 2, length), [0, 0, length / 2 + h])
    drawn = Assembly([revolved("cup", profile, grounded=True), pin], friction=0.3)
    return KnownRest("pin in a blind hole", drawn, {"pin": (0, 0, -h)})


def button(
    d: float = 0.008, flange: float = 0.012, c: float = 0.0001, h: float = 0.0002,
    *, flanged: bool = True, square: bool = False,
) -> KnownRest:  # fmt: skip
    """A button in a held case whose chamber, `d` high, has a hole in its lower and its upper wall.

    d and `flange` are the diameters, or widths, of the stem and its flange, which is a quarter of d
    thick and lies in the chamber, h above the lower wall.
    """
    r, f, wall, thick = d / 2, flange / 2, d / 4, d / 4
    top, foot = d + 2 * wall, -2 * wall
    if square:
        across = [-2 * f, -f - c, -r - c, r + c, f + c, 2 * f]
        solid = np.ones((5, 5, 3), dtype=bool)
        solid[2, 2, :] = False
        solid[1:4, 1:4, 1] = False
        case = Part("case", cells(across, across, [-wall, 0, d, d + wall], solid), grounded=True)
        stem = np.zeros((3, 3, 3), dtype=bool)
        stem[1, 1, :] = True
        stem[:, :, 1] = True
        lines = [-f, -r, r, f]
        shape = cells(lines, lines, [foot + h, h, h + thick, top + h], stem)
        inner = Part("button", shape)
        if not flanged:
            inner = block("button", [-r, -r, foot + h], [r, r, top + h])
    else:
        case = revolved("case", [
            (r + c, -wall), (2 * f, -wall), (2 * f, d + wall), (r + c, d + wall), (r + c, d),
            (f + c, d), (f + c, 0), (r + c, 0),
        ], grounded=True)  # fmt: skip
        profile = [(0, foot), (r, foot), (r, 0), (f, 0), (f, thick), (r, thick), (r, top), (0, top)]
        inner = revolved("button", profile, [0, 0, h])
        if not flanged:
            inner = Part("button", Cylinder(r, top - foot), [0, 0, (top + foot) / 2 + h])
    drawn = Assembly([case, inner], friction=0.3)
    if not flanged:
        return KnownRest("button without a flange", drawn, {}, ("button",))
    return KnownRest("button with a flange", drawn, {"button": (0, 0, -h)})


def drawer(
    size: Sequence[float] = (0.3, 0.4, 0.15), c: float = 0.001, h: float = 0.0005,
    *, rails: bool = True, below: float = 0.05, hollow: bool = True,
) -> KnownRest:  # fmt: skip
    """A drawer, hollow or solid, between two held sides; on two rails or above a panel."""
    x, y, z = size
    t = x / 20
    drop = h if rails else below
    body = tray("drawer", size, t, [-x / 2, -y / 2, drop])
    if not hollow:
        body = block("drawer", [-x / 2, -y / 2, drop], [x / 2, y / 2, drop + z])
    parts = [
        block("left", [-x / 2 - c - t, -y / 2, -2 * t], [-x / 2 - c, y / 2, z + t], grounded=True),
        block("right", [x / 2 + c, -y / 2, -2 * t], [x / 2 + c + t, y / 2, z + t], grounded=True),
    ]
    if rails:
        ends = (("left-rail", -x / 2 - c, -x / 2 + t), ("right-rail", x / 2 - t, x / 2 + c))
        parts += [block(name, [a, -y / 2, -t], [b, y / 2, 0], grounded=True) for name, a, b in ends]
    else:
        edge = x / 2 + c
        parts.append(block("panel", [-edge, -y / 2, -2 * t], [edge, y / 2, 0], grounded=True))
    name = "drawer on rails" if rails else "drawer without rails"
    return KnownRest(name, Assembly([*parts, body], friction=0.3), {"drawer": (0, 0, -drop)})


def lid(
    size: Sequence[float] = (0.1, 0.08, 0.05), c: float = 0.0005, h: float = 0.001,
    *, inside: bool = True, circular: bool = False,
) -> KnownRest:  # fmt: skip
    """A lid over a held box, h above its edge; its rim is inside the box or around it."""
    x, y, z = size
    t = min(size) / 10
    if circular:
        r = x / 2
        cup = [(0, 0), (r, 0), (r, z), (r - t, z), (r - t, t), (0, t)]
        box = revolved("box", cup, grounded=True)
        if inside:
            outline = [(r - 2 * t - c, -2 * t), (r - t - c, -2 * t), (r - t - c, 0), (r, 0)]
            profile = [*outline, (r, t), (0, t), (0, 0), (r - 2 * t - c, 0)]
        else:
            outline = [(r + c, -2 * t), (r + c + t, -2 * t), (r + c + t, t), (0, t)]
            profile = [*outline, (0, 0), (r + c, 0)]
        cover = revolved("lid", profile, [0, 0, z + h])
    else:
        box = tray("box", size, t, [-x / 2, -y / 2, 0], grounded=True)
        low, high = (-2 * t - c, -t - c) if inside else (c, c + t)
        lines = []
        for half in (x / 2, y / 2):
            ends = sorted({half + low, half + high, half} if inside else {half + low, half + high})
            lines.append([-a for a in ends[::-1]] + ends)
        solid = np.ones((len(lines[0]) - 1, len(lines[1]) - 1, 2), dtype=bool)
        edge = 2 if inside else 1
        solid[edge:-edge, edge:-edge, 0] = False
        if inside:
            solid[[0, -1], :, 0] = False
            solid[:, [0, -1], 0] = False
        cover = Part("lid", cells(*lines, [z + h - 2 * t, z + h, z + h + t], solid))
    drawn = Assembly([box, cover], friction=0.3)
    return KnownRest("lid with a rim", drawn, {"lid": (0, 0, -h)})


def stack_with_gaps(
    gaps: Sequence[float] = (0.01, 0.01, 0.01), size: float = 0.1, *, order: Sequence[int] = ()
) -> KnownRest:
    """Boxes above a floor, each with a gap below it; `order`: numbers of the boxes in the file."""
    boxes, shift, low, sunk = [], {}, 0.0, 0.0
    for k, gap in enumerate(gaps):
        low, sunk = low + gap, sunk + gap
        boxes.append(
            block(f"box-{k}", [-size / 2, -size / 2, low], [size / 2, size / 2, low + size])
        )
        shift[f"box-{k}"] = (0.0, 0.0, -sunk)
        low += size
    ordered = [boxes[k] for k in (order or range(len(boxes)))]
    ground = floor([-2 * size, -2 * size], [2 * size, 2 * size])
    name = "stack with gaps" if min(gaps) > 0 else "sunk stack"
    return KnownRest(name, Assembly([ground, *ordered], friction=0.5), shift)


def sunk_stack(count: int = 3, e: float = 1e-4, size: float = 0.1) -> KnownRest:
    """Boxes on a floor, each sunk by e into the body below it."""
    return stack_with_gaps([-e] * count, size)


def side_by_side(apart: float = 1e-5, size: float = 0.1) -> KnownRest:
    """Two boxes on a floor with a narrow gap between them."""
    parts = [
        floor([-2 * size, -2 * size], [4 * size, 2 * size]),
        block("left", [-size, 0, 0], [0, size, size]),
        block("right", [apart, 0, 0], [apart + size, size, size]),
    ]
    return KnownRest("side by side", Assembly(parts, friction=0.3), {"left": STILL, "right": STILL})


def ball_in_groove(radius: float = 0.02, slope: float = 45.0, h: float = 0.003) -> KnownRest:
    """A ball over a held V groove along y whose sides slope by an angle [deg]."""
    rise = float(np.tan(np.radians(slope)))
    wide = 3 * radius
    outline = [(0, 0), (wide, rise * wide), (wide, -radius), (-wide, -radius), (-wide, rise * wide)]
    groove = prism("groove", outline, 6 * radius, grounded=True)
    rest = radius / float(np.cos(np.radians(slope)))  # height of the centre over the line
    ball = Part("ball", Sphere(radius), [0, 0, rest + h])
    drawn = Assembly([groove, ball], friction=0.5)
    return KnownRest("ball in a groove", drawn, {"ball": (0, 0, -h)})


def cylinder_in_channel(radius: float = 0.02, play: float = 0.1, h: float = 0.003) -> KnownRest:
    """A lying cylinder midway between two held walls, which are wider apart by 2 `play`."""
    edge, length = radius + play, 4 * radius
    parts = [
        block("bed", [-2 * edge, -length, -radius], [2 * edge, length, 0], grounded=True),
        block("left", [-2 * edge, -length, 0], [-edge, length, 2 * radius], grounded=True),
        block("right", [edge, -length, 0], [2 * edge, length, 2 * radius], grounded=True),
        lying(Part("cylinder", Cylinder(radius, length)), [0, 0, radius + h]),
    ]
    drawn = Assembly(parts, friction=0.3)
    return KnownRest("cylinder in a channel", drawn, {"cylinder": (0, 0, -h)})


def key_in_slot(
    length: float = 0.02, breadth: float = 0.006, c: float = 0.0002, torque: float = 0.01
) -> KnownRest:
    """A key between two held walls, on a vertical pivot through its middle, under a torque."""
    half, deep = breadth / 2 + c, breadth
    parts = [
        block("left", [-length, half, 0], [length, half + deep, deep], grounded=True),
        block("right", [-length, -half - deep, 0], [length, -half, deep], grounded=True),
        block("key", [-length / 2, -breadth / 2, 0], [length / 2, breadth / 2, deep]),
    ]
    pivot = Joint(("ground", "key"), "revolute", point=[0, 0, deep / 2], axis=[0, 0, 1])
    drawn = Assembly(
        parts, friction=0.3, joints=[pivot], loads=[Load("key", [0, 0, 0], [0, 0, torque])]
    )
    angle = float(np.arcsin(2 * half / np.hypot(length, breadth)) - np.arctan2(breadth, length))
    return KnownRest("key in a slot", drawn, {"key": STILL}, (), {"key": angle})


def ring_on_bar(d: float = 0.01, D: float = 0.03, width: float = 0.005) -> KnownRest:
    """A ring of bore D around a held horizontal bar of diameter d, drawn concentric."""
    bar = lying(Part("bar", Cylinder(d / 2, 6 * width), grounded=True))
    ring = lying(tube("ring", D / 2, 0.7 * D, width))
    down = {"ring": (0.0, 0.0, -(D - d) / 2)}
    return KnownRest("ring on a bar", Assembly([bar, ring], friction=0.3), down)


def cabinet(
    size: Sequence[float] = (0.6, 0.3, 0.8), t: float = 0.02, shelf: float = 0.4
) -> KnownRest:
    """Six boards that touch; the bottom of the shelf is at the height `shelf`.

    The shelf is narrower than the space between the sides by a hundredth of a board.
    """
    x, y, z = size
    low, high = [-x / 2, 0.0], [x / 2, y]
    parts = [
        floor([-2 * x, -2 * x], [2 * x, 2 * x]),
        block("bottom", [*low, 0], [*high, t]),
        block("left", [low[0], 0, t], [low[0] + t, y, z - t]),
        block("right", [high[0] - t, 0, t], [high[0], y, z - t]),
        block("top", [*low, z - t], [*high, z]),
        block("back", [low[0], y, 0], [high[0], y + 3 * t, z]),
        block("shelf", [low[0] + t, 0, shelf], [high[0] - 1.01 * t, y, shelf + t]),
    ]
    shift = dict.fromkeys(("bottom", "left", "right", "top", "back"), STILL)
    drawn = Assembly(parts, friction=0.4)
    return KnownRest("cabinet", drawn, {**shift, "shelf": (0.0, 0.0, t - shelf)})


# random scenes --------------------------------------------------------------------------------


def _random_pin(rng: np.random.Generator, s: float) -> KnownRest:
    builder = (pin_in_hole, pin_in_through_hole, pin_in_blind_hole)[int(rng.integers(3))]
    d = s * rng.uniform(0.1, 0.3)
    more = {"h": s * rng.uniform(0.001, 0.1)} if builder is pin_in_blind_hole else {}
    return builder(d, d * (1 + 10 ** rng.uniform(-3, -1)), s * rng.uniform(0.3, 1), **more)


def _random_button(rng: np.random.Generator, s: float) -> KnownRest:
    d = s * rng.uniform(0.2, 0.5)
    c = d * 10 ** rng.uniform(-3, -1.3)
    flanged, square = bool(rng.random() < 0.7), bool(rng.random() < 0.5)
    flange, h = d * rng.uniform(1.4, 2), d * 10 ** rng.uniform(-3, -0.7)
    return button(d, flange, c, h, flanged=flanged, square=square)


def _random_drawer(rng: np.random.Generator, s: float) -> KnownRest:
    size = s * rng.uniform(0.4, 1, 3)
    c, h, below = size.min() * np.array([10 ** rng.uniform(-3, -1.5), 10 ** rng.uniform(-3, -1.5),
                                         rng.uniform(0.02, 0.4)])  # fmt: skip
    rails, hollow = bool(rng.random() < 0.6), bool(rng.random() < 0.6)
    return drawer(size, c, h, rails=rails, below=below, hollow=hollow)


def _random_lid(rng: np.random.Generator, s: float) -> KnownRest:
    size = s * rng.uniform(0.4, 1, 3)
    c, h = size.min() * 10 ** rng.uniform([-3, -3], [-1.5, -1.3])
    inside, circular = bool(rng.random() < 0.5), bool(rng.random() < 0.5)
    return lid(size, c, h, inside=inside, circular=circular)


def _random_stack(rng: np.random.Generator, s: float) -> KnownRest:
    count = int(rng.integers(2, 7))
    if rng.random() < 0.4:
        return sunk_stack(count, 0.2 * s * 10 ** rng.uniform(-6, -3), 0.2 * s)
    gaps = 0.2 * s * 10 ** rng.uniform(-3, -0.3, count)
    return stack_with_gaps(gaps, 0.2 * s, order=rng.permutation(count).tolist())


def _random_round(rng: np.random.Generator, s: float) -> KnownRest:
    radius = s * rng.uniform(0.1, 0.4)
    h = radius * 10 ** rng.uniform(-3, -0.3)
    if rng.random() < 0.5:
        return ball_in_groove(radius, rng.uniform(20, 60), h)
    return cylinder_in_channel(radius, radius * 10 ** rng.uniform(-2, 0), h)


def _random_key(rng: np.random.Generator, s: float) -> KnownRest:
    breadth = s * rng.uniform(0.1, 0.4)
    return key_in_slot(s, breadth, breadth * 10 ** rng.uniform(-3, -1), s**4 * 1e4)


def _random_ring(rng: np.random.Generator, s: float) -> KnownRest:
    d = s * rng.uniform(0.1, 0.5)
    return ring_on_bar(d, d * (1 + 10 ** rng.uniform(-2, 0.5)), s * rng.uniform(0.05, 0.3))


def _random_boxes(rng: np.random.Generator, s: float) -> KnownRest:
    if rng.random() < 0.5:
        return side_by_side(s * 10 ** rng.uniform(-5, -2), s / 3)
    size = s * rng.uniform(0.5, 1, 3)
    return cabinet(size, size.min() / 20, size[2] * rng.uniform(0.2, 0.7))


RANDOM: tuple[Callable[[np.random.Generator, float], KnownRest], ...] = (
    _random_pin, _random_button, _random_drawer, _random_lid, _random_stack, _random_round,
    _random_key, _random_ring, _random_boxes,
)  # fmt: skip


def random_scene(rng: np.random.Generator) -> KnownRest:
    """A scene of a random kind, with a size of 10 mm to 1 m, in a random direction."""
    scene = RANDOM[int(rng.integers(len(RANDOM)))](rng, 10 ** rng.uniform(-2, 0))
    quaternion = rng.normal(size=4)
    return turned(scene, compose((quaternion / np.linalg.norm(quaternion)).tolist(), (1, 0, 0, 0)))


EXACT: tuple[Callable[[], KnownRest], ...] = (
    pin_in_hole, pin_in_through_hole, pin_in_blind_hole, button,
    lambda: button(flanged=False), lambda: button(square=True),
    lambda: button(square=True, flanged=False), drawer, lambda: drawer(rails=False),
    lambda: drawer(hollow=False), lid, lambda: lid(inside=False), lambda: lid(circular=True),
    lambda: lid(circular=True, inside=False), stack_with_gaps,
    lambda: stack_with_gaps(order=(2, 0, 1)), lambda: stack_with_gaps((0.02, 0.05, 0.1)),
    sunk_stack, side_by_side, ball_in_groove, cylinder_in_channel, key_in_slot, ring_on_bar,
    cabinet,
)  # fmt: skip
"""Every scene once, with its default sizes."""
