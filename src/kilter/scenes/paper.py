"""Figures of the paper and cases derived from them.

The paper gives angles but no coordinates: the angles here are those of the paper, the dimensions
are chosen. All scenes are in the x-z plane, extruded along y; `planar` restricts the motions to
that plane, with the same answer. C1 is a held L with a floor z = 0 along +x and a wall x = 0 along
+z. Masses are given, by default 1 kg, so that the dimensions affect only the lines of action.

Two blocks in an L have the contact normal n = (-sin c, cos c) in (x, z) from block A on the floor
to block B on the wall. Their forces balance only if gravity is along

    -(sin c / m_A, cos c / m_B)

References
----------
Mattikalli, Khosla, Repetto and Baraff (1993), Stability of Assemblies, Figures 1-12.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, GivenContact, Part
from kilter.errors import InputError
from kilter.rigid import Pose, rotation_between, unit
from kilter.scenes.pieces import block, moved, prism, ring
from kilter.scenes.registry import listed
from kilter.shape.primitives import Mesh, Prism

G = 9.81
"""Gravity [m/s^2]."""
DEPTH = 1.0
"""Extent of the parts along y [m]."""


def _ell(width: float, height: float, thick: float = 0.5) -> Part:
    """A held part in the shape of an L: a floor up to x = width, and a wall at x = 0."""
    t = thick
    polygon = [[-t, -t], [width, -t], [width, 0], [0, 0], [0, height], [-t, height]]
    return prism("C1", polygon, DEPTH, grounded=True)


def stable_direction(angle: float, mass_a: float, mass_b: float) -> Array:
    """Unit direction of gravity for which two blocks in an L are stable, shape (3,).

    `angle`: angle c of the chamfer [deg].
    """
    c = np.radians(angle)
    return unit([-np.sin(c) / mass_a, 0.0, -np.cos(c) / mass_b])


def upright(assembly: Assembly) -> Assembly:
    """Rotate an assembly about the y axis so that its gravity points to -z."""
    turned = moved(assembly, rotation_between(assembly.down, [0, 0, -1]))
    size = float(np.linalg.norm(assembly.gravity))
    return dataclasses.replace(turned, gravity=(0.0, 0.0, -size))


def two_blocks_in_an_l(
    angle: float = 45.0,
    *,
    mass_a: float = 1.0,
    mass_b: float = 1.0,
    stable: bool = False,
    planar: bool = False,
) -> Assembly:
    """Case F11': a block on the floor and a block on the wall of an L, touching at a chamfer.

    With gravity along -z, B sinks and pushes A away. The assembly is stable for a single
    direction, `stable_direction`. For equal masses its angle from -z is 45 deg (angle 45) and
    60 deg (angle 60), for mass_b = 2 mass_a it is 63.435 and 73.898 deg.

    Arguments: `angle`: angle c of the chamfer to the floor [deg], 30 to 60; `mass_a`, `mass_b`:
    masses [kg], in a ratio of 1/2 to 2.

    Notes
    -----
    The chamfer extends from (1, tan c) to (2, 2 tan c). At 45 deg the blocks are mirror images
    in the line x = z. The faces on floor and wall are long enough for the three lines of action of
    each block to meet.
    """
    low = np.array([1.0, np.tan(np.radians(angle))])
    high = 2 * low
    reach, rise = high[0] + 1.0, high[1] + 1.0
    a = [[low[0], 0], [reach, 0], [reach, high[1]], high, low]
    b = [[0, low[1]], low, high, [high[0], rise], [0, rise]]
    parts = [
        _ell(reach + 1.0, rise + 1.0),
        prism("C2", b, DEPTH, mass=mass_b),
        prism("C3", a, DEPTH, mass=mass_a),
    ]
    if not stable:
        return Assembly(parts, planar=planar)
    down = stable_direction(angle, mass_a, mass_b) * G
    return upright(Assembly(parts, gravity=down, planar=planar))


@listed(
    "paper-figure-1-in-space",
    "the same L turned by 45 degrees in space: the slightest push makes it fall",
    source="F1(b)",
    answer="balanced",
    orientation="b",
)
@listed(
    "paper-figure-1-turned",
    "the same L turned by 45 degrees: stable",
    source="F1(b)",
    answer="stable",
    orientation="b",
    planar=True,
)
@listed(
    "paper-figure-1",
    "a sinking block pushes another block out of an L",
    source="F1(a)",
    answer="unstable",
    planar=True,
)
def figure_1(orientation: str = "a", *, planar: bool = False) -> Assembly:
    """Figure 1 of the paper: two identical blocks with chamfers of 45 degrees in an L.

    (a) is unstable: C2 sinks and C3 moves to the right. (b) is turned by 45 degrees and stable.
    """
    return two_blocks_in_an_l(45.0, stable=_is_b(orientation), planar=planar)


@listed(
    "paper-figure-4",
    "two blocks in an L, second of three directions of gravity: z = -2.5",
    source="F4",
    answer="unstable",
    orientation=2,
)
def figure_4(orientation: int = 1, *, planar: bool = False) -> Assembly:
    """Figure 4 of the paper: two blocks in an L for three directions of gravity.

    The optimum z of the displacement program is -5, -2.5 and 0 (gravity of length 1, m kg).

    The scene has the two blocks of Figure 1 with 2.5 kg each. Gravity is along +z (1: both blocks
    fall out), -x (2: a block pushes the other out) or the stable diagonal (3). Orientation 4, the
    figure's d, is 3 with the assembly turned.
    """
    directions = {1: [0, 0, 1], 2: [-1, 0, 0], 3: [-1, 0, -1], 4: [-1, 0, -1]}
    if orientation not in directions:
        raise InputError(f"Figure 4 has no orientation {orientation!r}", hint="give 1 to 4")
    assembly = two_blocks_in_an_l(45.0, mass_a=2.5, mass_b=2.5, planar=planar)
    assembly = assembly.with_down(directions[orientation])
    return upright(assembly) if orientation == 4 else assembly


@listed(
    "paper-figure-8",
    "block C2 sinks by 1 and pushes C3 aside by 1 / tan 60",
    source="F8",
    answer="unstable",
)
def figure_8(angle: float = 60.0, *, planar: bool = False) -> Assembly:
    """Figure 8 of the paper: a block C2 between a wall and a block C3, which lies on the floor.

    The assembly is unstable. In the unit box of the displacement program, z = -m_2. The smallest
    optimum moves C2 down by 1 and C3 sideways by 1 / tan(angle) = 0.577 without rotation, because
    the normal of the chamfer meets the vertical through the centre of mass of C2 at the height of
    its contact with the wall.

    Arguments: `angle`: angle of the chamfer to the floor [deg], 45 to 75.
    """
    slope = float(np.tan(np.radians(angle)))

    def on_chamfer(z: float) -> list[float]:
        return [0.5 + z / slope, z]

    low, high = on_chamfer(0.5), on_chamfer(2.0)
    c2 = [[0, 0.5], low, high, [high[0], 3], [0, 3]]
    c3 = [[0.5, 0], [3, 0], [3, 2], high]
    return Assembly(
        [_ell(5, 4), prism("C2", c2, DEPTH, mass=1.0), prism("C3", c3, DEPTH, mass=1.0)],
        planar=planar,
    )


@listed(
    "paper-figure-9",
    "four blocks in a frame: stable, but free to circulate",
    source="F9",
    answer="stable",
    planar=True,
)
def figure_9(*, planar: bool = False) -> Assembly:
    """Figure 9 of the paper: four identical blocks, two edges chamfered by 45 degrees, in a frame.

    Each block lies along a side of the square frame and touches its two neighbours along the
    chamfers, so that the contacts form a loop. The assembly is stable, z = 0. All four blocks can
    circulate along their sides at no cost; in the plane, no other motion keeps every contact.
    """
    block = np.array([[-2, -3], [2, -3], [2, -2], [1, -1], [-1, -1], [-2, -2]], dtype=float)
    turn = np.array([[0, 1], [-1, 0]], dtype=float)  # rows @ turn: a quarter turn to the left
    parts = [Part("frame", ring(3, 4, DEPTH), grounded=True)]
    for name in ("bottom", "right", "top", "left"):
        parts.append(prism(name, block, DEPTH, mass=1.0))
        block = block @ turn + 0.0
    return Assembly(parts, planar=planar)


@listed(
    "paper-figure-10",
    "two blocks in an L, tilted out of a range of stable directions",
    source="F10(a)",
    answer="unstable",
)
def figure_10(orientation: str = "a", *, planar: bool = False) -> Assembly:
    """Figure 10 of the paper: two blocks without chamfer in an L, stable for some directions.

    C2 is in the corner, C3 lies on C2 and against the wall. In (a), gravity leans 30 degrees away
    from the wall: unstable. In (b), gravity is in the middle of the stable range, which is every
    direction between -x and -z.
    """
    parts = [
        _ell(3.0, 3.0),
        prism("C2", [[0, 0], [2, 0], [2, 1], [0, 1]], DEPTH, mass=1.0),
        prism("C3", [[0, 1], [1, 1], [1, 2], [0, 2]], DEPTH, mass=1.0),
    ]
    if _is_b(orientation):
        return upright(Assembly(parts, gravity=unit([-1, 0, -1]) * G, planar=planar))
    lean = np.radians(30)
    down = [G * np.sin(lean), 0.0, -G * np.cos(lean)]
    return Assembly(parts, gravity=down, planar=planar)


@listed(
    "paper-figure-11-in-space",
    "the same L at 45 degrees in space: the slightest push makes it fall",
    source="F11(b)",
    answer="balanced",
    orientation="b",
)
@listed(
    "paper-figure-11-turned",
    "the same L at 45 degrees, its only stable orientation",
    source="F11(b)",
    answer="stable",
    orientation="b",
    planar=True,
)
@listed(
    "paper-figure-11",
    "two blocks chamfered 45 degrees in an L: a single stable direction",
    source="F11(a)",
    answer="unstable",
    planar=True,
)
def figure_11(orientation: str = "a", *, planar: bool = False) -> Assembly:
    """Figure 11 of the paper: the blocks of Figure 1, whose only stable orientation is (b).

    (a) is unstable. In (b) the L is at 45 degrees.
    """
    return two_blocks_in_an_l(45.0, stable=_is_b(orientation), planar=planar)


@listed(
    "paper-figure-12-in-space",
    "the same L at 60 degrees in space: the slightest push makes it fall",
    source="F12(b)",
    answer="balanced",
    orientation="b",
)
@listed(
    "paper-figure-12-turned",
    "the same L at 60 degrees, its only stable orientation",
    source="F12(b)",
    answer="stable",
    orientation="b",
    planar=True,
)
@listed(
    "paper-figure-12",
    "two blocks chamfered 60 degrees in an L: a single stable direction",
    source="F12(a)",
    answer="unstable",
    planar=True,
)
def figure_12(orientation: str = "a", *, planar: bool = False) -> Assembly:
    """Figure 12 of the paper: two blocks in an L with chamfers of 60 degrees; "b": L leans."""
    return two_blocks_in_an_l(60.0, stable=_is_b(orientation), planar=planar)


@listed(
    "trapped-wedge",
    "a block under an overhang, gravity 10 degrees toward the wall",
    source="TR",
    answer="stable",
)
def trapped_wedge(
    tilt: float = 10.0, *, mass_a: float = 1.0, mass_b: float = 1.0, planar: bool = True
) -> Assembly:
    """Case TR: a wedge B on the floor under the 45-degree overhang of A, which fills the corner.

    Gravity is turned from -z toward the wall (-x) by `tilt`. The assembly is stable for
    0 <= tilt <= atan(mass_a / mass_b). At 0 degrees B can slide away at no cost, at 10 degrees
    no part can move, at -0.01 degrees the assembly is unstable.

    Arguments: `tilt`: angle of gravity [deg]; `mass_a`, `mass_b`: masses [kg], in a ratio of 1/2 to
    2.
    """
    a = [[0, 0], [2, 0], [3.5, 1.5], [3.5, 2], [0, 6]]
    b = [[2.5, 0], [6, 0], [6, 1], [3.25, 1.25], [2.5, 0.5]]
    angle = np.radians(tilt)
    return Assembly(
        [
            _ell(8.0, 8.0),
            prism("A", a, DEPTH, mass=mass_a),
            prism("B", b, DEPTH, mass=mass_b),
        ],
        gravity=[-G * np.sin(angle), 0.0, -G * np.cos(angle)],
        planar=planar,
    )


def _is_b(orientation: str) -> bool:
    """Whether an orientation is "b", the stable one; False for "a"; raises for other words."""
    if orientation not in ("a", "b"):
        raise InputError(f"there is no orientation {orientation!r}", hint="give 'a' or 'b'")
    return orientation == "b"


# Figures 2 and 3 of the paper: kinds of contact, each as the smallest assembly that has it.


QUARTER = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]
"""Quaternion of a quarter turn about z."""


@listed(
    "paper-figure-2",
    "a body on a held body, in contact along a segment ab",
    source="F2",
    answer="stable",
)
def figure_2() -> Assembly:
    """Figure 2 of the paper: bodies m and n touch over a segment, here from x = -1 to x = 1.

    Two constraint inequalities, at a and at b, keep m out of n in the plane.
    """
    n = block("n", [-2, -0.5, -1], [2, 0.5, 0])
    m = block("m", [-1, -0.5, 0], [1, 0.5, 1])
    return Assembly([Part("n", n.shape, n.pose, grounded=True), m], planar=True)


@listed(
    "paper-figure-3-plane",
    "two vertices that meet, with a plane assumed for their contact",
    source="F3(d)",
    answer="potentially-stable",
    kind="d",
)
@listed(
    "paper-figure-3-vertices",
    "two vertices that meet have no normal: the upper body slides off",
    source="F3(c)",
    answer="unstable",
    kind="c",
)
@listed(
    "paper-figure-3-edges",
    "an edge across a held edge: the slightest push makes it fall",
    source="F3(b)",
    answer="balanced",
    kind="b",
)
@listed(
    "paper-figure-3",
    "a polygonal contact, with a constraint at each of its five corners",
    source="F3(a)",
    answer="stable",
)
def figure_3(kind: str = "a") -> Assembly:
    """Figure 3 of the paper: contact over a polygon "a", of crossing edges "b", of vertices "c".

    (a) has five corners, as in the paper; a regular pentagon is assumed. In (b) the edges are
    perpendicular. The contact (c) has no normal of its own: m may slide off along any plane between
    the vertices, so that the assembly is unstable. The paper assumes a plane for it in "d"; here
    the plane is horizontal.
    """
    if kind == "a":
        angles = np.pi / 2 + 2 * np.pi * np.arange(5) / 5
        pentagon = np.column_stack([np.cos(angles), np.sin(angles)])
        lying = [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]  # the prism along y stands up
        m = Part("m", Prism(pentagon, 1.0), Pose([0, 0, 0.5], lying))
        n = block("n", [-2, -2, -1], [2, 2, 0])
        return Assembly([Part("n", n.shape, n.pose, grounded=True), m])
    if kind == "b":
        ridge = prism("n", [[-1, -1], [1, -1], [0, 0]], 3.0, grounded=True)
        wedge = Prism([[0, 0], [1, 1], [-1, 1]], 3.0)
        return Assembly([ridge, Part("m", wedge, Pose(rotation=QUARTER))])
    if kind in ("c", "d"):
        angles = 2 * np.pi * np.arange(3) / 3
        base = np.column_stack([np.cos(angles), np.sin(angles), -np.ones(3)])
        corners = np.vstack([base, np.zeros(3)])
        faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
        m = Part("m", Mesh(corners * [1, -1, -1], faces))
        plane = [GivenContact(("n", "m"), [[0, 0, 0]], [0, 0, 1])] if kind == "d" else []
        return Assembly([Part("n", Mesh(corners, faces), grounded=True), m], contacts=plane)
    raise InputError(f"Figure 3 has no contact {kind!r:.20}", hint="give 'a', 'b', 'c' or 'd'")
