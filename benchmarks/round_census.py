"""Census of random round bodies on tables and on each other: verdicts against closed forms.

    python benchmarks/round_census.py            300 scenes
    python benchmarks/round_census.py 1000 300   1,000 scenes, from seed 300 on

Half of the scenes are a body on the table of `with_floor`, tilted or at rest, with a random centre
of mass. The body is stable if the centre is over the foot, which is known in closed form. The
other scenes are two bodies, touching or displaced by 0.3 or 3 gap tolerances in or out. Their
contact points and normals are known, and non-negative least squares gives the answer. Bodies are
kilter shapes, STEP files made by OCCT, or fine meshes. The command prints the counts of all
kinds, the slowest case and the contradictions; the exit code is 1 if there are any.
"""

from __future__ import annotations

import collections
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose, Sphere, Tolerance, check, load

Array = NDArray[np.float64]
Shape = object
X, Y, Z = np.eye(3)
G = 9.81
FINE = 0.06
"""Angle between facets of the fine meshes [rad]."""


@dataclass(frozen=True)
class Body:
    """A body of revolution about z, as a solid of OCCT and as a shape of kilter."""

    kind: str
    size: tuple[float, ...]

    def made(self) -> object:
        """Solid of OCCT."""
        from OCP.BRepPrimAPI import (
            BRepPrimAPI_MakeCone,
            BRepPrimAPI_MakeCylinder,
            BRepPrimAPI_MakeSphere,
            BRepPrimAPI_MakeTorus,
        )
        from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

        def axes(z: float) -> gp_Ax2:
            return gp_Ax2(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1))

        a, b, c = (*self.size, 0.0, 0.0)[:3]
        if self.kind == "ball":
            return BRepPrimAPI_MakeSphere(a).Shape()
        if self.kind == "torus":
            return BRepPrimAPI_MakeTorus(axes(0), a, b).Shape()
        if self.kind in ("cone", "frustum"):
            return BRepPrimAPI_MakeCone(axes(0), a, b, c).Shape()
        below = float(self.kind == "taper")
        body = BRepPrimAPI_MakeCylinder(axes(-b / 2 - below), a, b + below).Shape()
        if self.kind == "capsule":
            return _fused(_fused(body, _ball(a, b / 2)), _ball(a, -b / 2))
        if self.kind == "tube":
            return _cut(body, BRepPrimAPI_MakeCylinder(axes(-b), c, 2 * b).Shape())
        if self.kind == "socket":
            return _cut(body, _ball(c, b / 2))
        if self.kind == "taper":  # a conical hole that opens upwards, 1 above the bottom
            return _cut(body, BRepPrimAPI_MakeCone(axes(-b / 2), 0.0, c, b).Shape())
        return body

    def shape(self, way: str) -> Shape:
        """Shape of kilter for `way`: "own", "step" (from a STEP file) or "mesh" (a fine mesh)."""
        if way == "own" and self.kind == "ball":
            return Sphere(self.size[0])
        if way == "own" and self.kind == "cylinder":
            return Cylinder(*self.size)
        return _mesh(self.made()) if way == "mesh" else _step(self.made())

    def foot(self, down: Array) -> tuple[Array, Array]:
        """Foot of the body on a plane perpendicular to `down`: its corners, and a point of its rim.

        A foot that is a point or a line is given by the corners. Otherwise the foot is a disc about
        a single corner, with the point on its rim.
        """
        along = float(down @ Z)
        aside = down - along * Z
        sine = float(np.linalg.norm(aside))
        u = aside / sine if sine > 1e-9 else 0 * aside
        rings = self._rings()
        if sine <= 1e-9:
            r, z, t = max(rings, key=lambda ring: (ring[1] * np.sign(along) + ring[2], ring[0]))
            center = (z + t * np.sign(along)) * Z
            return center[None], center + r * X
        heights = [r * sine + z * along + t for r, z, t in rings]
        touching = [k for k, h in enumerate(heights) if h > max(heights) - 1e-9]
        points = [rings[k][0] * u + rings[k][1] * Z + rings[k][2] * down for k in touching]
        return np.array(points), points[0]

    def _rings(self) -> list[tuple[float, float, float]]:
        """Circles (radius, height, thickness) whose thickened hull is the hull of the body."""
        a, b, c = (*self.size, 0.0, 0.0)[:3]
        return {
            "ball": [(0.0, 0.0, a)],
            "torus": [(a, 0.0, b)],
            "cone": [(a, 0.0, 0.0), (b, c, 0.0)],
            "frustum": [(a, 0.0, 0.0), (b, c, 0.0)],
            "capsule": [(0.0, b / 2, a), (0.0, -b / 2, a)],
        }.get(self.kind, [(a, -b / 2, 0.0), (a, b / 2, 0.0)])


def _ball(radius: float, z: float) -> object:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.gp import gp_Pnt

    return BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, z), radius).Shape()


def _cut(body: object, tool: object) -> object:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    return BRepAlgoAPI_Cut(body, tool).Shape()


def _fused(body: object, other: object) -> object:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse

    return BRepAlgoAPI_Fuse(body, other).Shape()


def _step(made: object) -> Shape:
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    from kilter.files.cad.step_surfaces import quiet

    with tempfile.TemporaryDirectory() as folder, quiet():
        path = Path(folder) / "body.step"
        writer = STEPControl_Writer()
        writer.Transfer(made, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(str(path))
        return load(path).parts[0].shape


def _mesh(made: object) -> Shape:
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.StlAPI import StlAPI_Writer

    BRepMesh_IncrementalMesh(made, 1.0, False, FINE, False)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "body.stl"
        writer = StlAPI_Writer()
        writer.ASCIIMode = True
        writer.Write(made, str(path))
        shape = load(path, units="mm").parts[0].shape
    assert isinstance(shape, Mesh)
    return shape


def _pose(turn: Rotation, at: Array) -> Pose:
    return Pose(at, turn.as_quat()[[3, 0, 1, 2]])


# on a table ---------------------------------------------------------------------------------


def _random_body(rng: np.random.Generator) -> Body:
    r, h = rng.uniform(0.5, 5, size=2)
    kind = str(rng.choice(["ball", "cylinder", "cone", "frustum", "torus", "capsule", "tube"]))
    sizes = {
        "ball": (r,), "cone": (r, 0.0, h), "frustum": (r, rng.uniform(0.2, 0.9) * r, h),
        "torus": (r, rng.uniform(0.1, 0.9) * r), "tube": (r, h, rng.uniform(0.2, 0.9) * r),
    }  # fmt: skip
    return Body(kind, sizes.get(kind, (r, h)))


def _at_rest(body: Body, rng: np.random.Generator) -> Array:
    """A direction of gravity in which the body rests on a plane, or a random direction."""
    ways = [Z, -Z, rng.normal(size=3)]
    if body.kind in ("cylinder", "capsule", "tube", "torus"):
        ways.append(np.array([*rng.normal(size=2), 0.0]))
    if body.kind in ("cone", "frustum"):
        a, b, h = body.size
        ways.append(np.array([h, 0.0, a - b]))
    if body.kind == "cone":
        ways.remove(ways[0])  # on its tip, every tilt is unstable
    down = ways[rng.integers(len(ways))]
    return np.asarray(down / np.linalg.norm(down))


def on_table(rng: np.random.Generator, way: str) -> tuple[str, Assembly, str]:
    """Kind, assembly and the expected verdict of a body on a table."""
    body = _random_body(rng)
    if body.kind == "torus" and way == "mesh":
        way = "step"  # tori are not recognised in meshes; their contacts would be open
    down = _at_rest(body, rng)
    corners, rim = body.foot(down)
    share = float(rng.choice([0.0, 0.6, 0.95, 1.05, 2.0]))
    middle = corners.mean(axis=0)
    reach = rim - middle
    if len(corners) == 1 and np.allclose(rim, corners[0]):  # the foot is a point
        reach = np.cross(down, rng.normal(size=3))
        share = float(rng.choice([0.0, 2.0]))
    center = middle + share * reach - rng.uniform(0.1, 2) * down
    turn, shift = Rotation.random(rng=rng), rng.normal(size=3) * 10
    part = Part(
        "body", body.shape(way), _pose(turn, shift), mass=rng.uniform(0.1, 9), center_of_mass=center
    )
    assembly = Assembly([part], units="mm").with_down(turn.apply(down)).with_floor()
    return f"{body.kind} on table", assembly, "stable" if share < 1 else "unstable"


# on each other ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Touching:
    """Two bodies: shapes, place of the second, contact points, normals, opening direction."""

    shapes: tuple[Shape, Shape]
    place: Array
    turn: Rotation
    points: Array
    normals: Array
    opening: Array
    rate: float
    fit: bool = False
    """Whether the gap is in the sizes; else the second body is moved along `opening`."""


def _ball_on_ball(rng: np.random.Generator, way: str, gap: float) -> Touching:
    a, b = rng.uniform(0.5, 3, size=2)
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    shapes = Body("ball", (a,)).shape(way), Body("ball", (b,)).shape(way)
    turn = Rotation.random(rng=rng)
    return Touching(shapes, (a + b) * n, turn, a * n[None], n[None], n, 1.0)


def _ball_on_cylinder(rng: np.random.Generator, way: str, gap: float) -> Touching:
    a, b = rng.uniform(0.5, 3, size=2)
    shapes = Body("cylinder", (a, 8.0)).shape(way), Body("ball", (b,)).shape(way)
    place = (a + b) * X + rng.uniform(-3, 3) * Z
    point = (place - b * X)[None]
    return Touching(shapes, place, Rotation.random(rng=rng), point, X[None], X, 1.0)


def _cylinders_crossed(rng: np.random.Generator, way: str, gap: float) -> Touching:
    a, b = rng.uniform(0.5, 3, size=2)
    shapes = Body("cylinder", (a, 12.0)).shape(way), Body("cylinder", (b, 12.0)).shape(way)
    turn = Rotation.from_rotvec(rng.uniform(0.1, np.pi - 0.1) * X)
    place = (a + b) * X + rng.uniform(-4, 4) * Z + rng.uniform(-4, 4) * turn.apply(Z)
    t = float(np.linalg.lstsq(np.column_stack([Z, turn.apply(Z)]), place, rcond=None)[0][0])
    return Touching(shapes, place, turn, (a * X + t * Z)[None], X[None], X, 1.0)


def _cylinders_along(rng: np.random.Generator, way: str, gap: float) -> Touching:
    a, b = rng.uniform(0.5, 3, size=2)
    shapes = Body("cylinder", (a, 4.0)).shape(way), Body("cylinder", (b, 4.0)).shape(way)
    shift = rng.uniform(-2, 2)
    ends = np.array([max(-2, shift - 2), min(2, shift + 2)])
    points = a * X + ends[:, None] * Z
    place = (a + b) * X + shift * Z
    turn = Rotation.from_rotvec(rng.uniform(0, 6) * Z)
    return Touching(shapes, place, turn, points, np.tile(X, (2, 1)), X, 1.0)


def _ball_in_taper(rng: np.random.Generator, way: str, gap: float) -> Touching:
    h, r = rng.uniform(2, 6), rng.uniform(1, 3)
    alpha = np.arctan2(r, h)
    b = rng.uniform(0.2, 0.6) * h * np.sin(alpha)
    up = b / np.sin(alpha)
    shapes = Body("taper", (r + 1, h, r)).shape(way), Body("ball", (b,)).shape(way)
    angle = np.arange(720) * 2 * np.pi / 720
    away = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    normals = -np.cos(alpha) * away + np.sin(alpha) * Z
    place = (up - h / 2) * Z
    rate = float(np.sin(alpha))
    return Touching(shapes, place, Rotation.random(rng=rng), place - b * normals, normals, Z, rate)


def _plug_in_taper(rng: np.random.Generator, way: str, gap: float) -> Touching:
    h, r = rng.uniform(2, 6), rng.uniform(1, 3)
    alpha = np.arctan2(r, h)
    low, high = 0.2 * h, rng.uniform(0.5, 1.5) * h
    t = r / h
    plug = Body("frustum", (low * t, high * t, high - low))
    shapes = Body("taper", (r + 1, h, r)).shape(way), plug.shape(way)
    angle = np.arange(360) * 2 * np.pi / 360
    away = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    normals = np.tile(-np.cos(alpha) * away + np.sin(alpha) * Z, (2, 1))
    heights = np.repeat([low, min(high, h)], 360)[:, None]
    points = heights * (np.tile(away, (2, 1)) * t + Z) - h / 2 * Z
    place, rate = (low - h / 2) * Z, float(np.sin(alpha))
    turn = Rotation.from_rotvec(rng.uniform(0, 6) * Z)
    return Touching(shapes, place, turn, points, normals, Z, rate)


def _peg_in_hole(rng: np.random.Generator, way: str, gap: float) -> Touching:
    r, h = rng.uniform(0.5, 3), rng.uniform(1, 4)
    long = rng.uniform(1, 6)
    shapes = Body("tube", (r + 2, h, r)).shape(way), Body("cylinder", (r - gap, long)).shape(way)
    reach = (min(h, long)) / 2
    angle = np.arange(360) * 2 * np.pi / 360
    away = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([r * away + reach * Z, r * away - reach * Z])
    turn = Rotation.from_rotvec(rng.uniform(0, 6) * Z)
    return Touching(shapes, 0 * Z, turn, points, np.tile(-away, (2, 1)), X, 1.0, fit=True)


def _ball_in_socket(rng: np.random.Generator, way: str, gap: float) -> Touching:
    r = rng.uniform(0.5, 3)
    shapes = Body("socket", (r + 1, 2 * r + 1, r)).shape(way), Body("ball", (r - gap,)).shape(way)
    place = (r + 0.5) * Z
    grid = np.meshgrid(np.linspace(0, np.pi / 2, 30), np.arange(0, 6.28, 0.1))
    theta, phi = (x.ravel() for x in grid)
    sine = np.sin(theta)
    away = np.column_stack([sine * np.cos(phi), sine * np.sin(phi), -np.cos(theta)])
    turn = Rotation.random(rng=rng)
    return Touching(shapes, place, turn, place + r * away, -away, Z, 1.0, fit=True)


def _cylinder_on_slab(rng: np.random.Generator, way: str, gap: float) -> Touching:
    r, h = rng.uniform(0.5, 3), rng.uniform(1, 6)
    shapes = Box([20, 20, 2]), Body("cylinder", (r, h)).shape(way)
    turn = Rotation.from_euler("xz", [90, rng.uniform(0, 360)], degrees=True)
    along = turn.apply(Z)
    points = Z + np.array([[-h / 2], [h / 2]]) * along
    return Touching(shapes, (1 + r) * Z, turn, points, np.tile(Z, (2, 1)), Z, 1.0)


FAMILIES: dict[str, Callable[[np.random.Generator, str, float], Touching]] = {
    "ball on ball": _ball_on_ball,
    "ball on cylinder": _ball_on_cylinder,
    "crossed cylinders": _cylinders_crossed,
    "cylinders side by side": _cylinders_along,
    "ball in taper": _ball_in_taper,
    "plug in taper": _plug_in_taper,
    "peg in hole": _peg_in_hole,
    "ball in socket": _ball_in_socket,
    "cylinder on slab": _cylinder_on_slab,
}


TAU = 1e-4
"""Gap tolerance of the scenes of two bodies [mm]."""
OFF = (0.0, 0.0, 0.3, -0.3, 3.0, -3.0)
"""Displacements of the second body [gap tolerance]."""
UNSURE = 3e-3
"""A residual between rounding and this value is too close to a limit to decide [weight]."""


@dataclass(frozen=True)
class Scene:
    """An assembly, the displacement `off` [gap tolerance], and the verdict without it."""

    family: str
    assembly: Assembly
    off: float
    expected: str


def on_each_other(rng: np.random.Generator, way: str) -> Scene:
    """A random scene of a held and a free body."""
    family = str(rng.choice(list(FAMILIES)))
    off = 0.0 if way == "mesh" else float(rng.choice(OFF))
    made = FAMILIES[family](rng, way, off * TAU)
    normal = made.normals.mean(axis=0)
    upwards = normal / max(float(np.linalg.norm(normal)), 0.1)
    middle = made.points.mean(axis=0)
    aligned = rng.random() < 0.5
    spread = 0.0 if aligned and len(made.points) == 1 else rng.uniform(0, 1.5)
    down = -upwards + spread * rng.normal(size=3) * 0.6
    down /= np.linalg.norm(down)
    center = middle + (rng.uniform(0.1, 1) * upwards if aligned else rng.normal(size=3))
    if "ball" in family and len(made.points) > 2:
        center = made.place if rng.random() < 0.8 else center
    whole, shift = Rotation.random(rng=rng), rng.normal(size=3) * 5
    place = made.place + (0 if made.fit else off * TAU / made.rate * made.opening)
    local = made.turn.inv().apply(center - made.place)
    parts = [
        Part("held", made.shapes[0], _pose(whole, shift), grounded=True),
        Part("free", made.shapes[1], _pose(whole * made.turn, shift + whole.apply(place)), mass=1.0,
             center_of_mass=local),
    ]  # fmt: skip
    parts = parts if rng.random() < 0.5 else parts[::-1]
    assembly = Assembly(parts, units="mm", gravity=G * whole.apply(down))
    return Scene(family, assembly, off, _held(made, center, down))


def _held(made: Touching, center: Array, down: Array) -> str:
    """Whether forces at the contact points hold a body of weight 1: stable, unstable, unsure."""
    arms = (made.points - center) / max(1.0, float(np.ptp(made.points, axis=0).max()))
    rows = np.hstack([made.normals, np.cross(arms, made.normals)])
    left = nnls(rows.T, np.array([*-down, 0, 0, 0]), maxiter=20000)[1]
    return "stable" if left < 1e-9 else "unsure" if left < UNSURE else "unstable"


# comparison with kilter ---------------------------------------------------------------------


def judged(scene: Scene) -> list[str]:
    """Contradictions between kilter and the expected answer of a scene."""
    wrong = []
    tolerance = Tolerance(gap=TAU)
    verdict = check(scene.assembly, tolerance=tolerance)
    contacts = verdict.contact_set
    if abs(scene.off) < 1:
        wrong += _differs(verdict.first_order, scene.expected)
        wrong += ["overlap"] * len(contacts.overlaps) + ["not modelled"] * len(contacts.unsupported)
        return wrong
    if len(contacts):
        wrong.append("a contact beyond the tolerance")
    kinds = {pair.kind for pair in contacts.open_pairs}
    want = {"overlap"} if scene.off < 0 else {"near", "clearance"}
    if not kinds or not kinds <= want:
        wrong.append(f"open pairs are {kinds or 'none'}")
    if verdict.verdict != "undecided" and scene.expected == "stable":
        wrong.append(f"{verdict.verdict}, but would be held if it touched")
    if scene.off > 0:
        closing = Tolerance(gap=TAU, clearance=1.01 * scene.off * TAU)
        closed = check(scene.assembly, tolerance=closing)
        wrong += [f"closed: {word}" for word in _differs(closed.first_order, scene.expected)]
    return wrong


def _differs(verdict: str, expected: str) -> list[str]:
    """Contradiction between a verdict and the existence of forces, to first order."""
    first_order = "stable" if verdict == "balanced" else verdict
    return [] if expected in (first_order, "unsure") else [f"{verdict}, not {expected}"]


def asked(seed: int) -> tuple[str, str, list[str]]:
    """Family, expected answer and contradictions of a random scene."""
    rng = np.random.default_rng(seed)
    way = str(rng.choice(["own", "step", "step", "mesh"]))
    if seed % 2:
        scene = on_each_other(rng, way)
        return f"{scene.family}, {way}", f"off {scene.off:+g}: {scene.expected}", judged(scene)
    family, assembly, expected = on_table(rng, way)
    verdict = check(assembly)
    return f"{family}, {way}", expected, _differs(verdict.first_order, expected)


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    words = [int(word) for word in sys.argv[1:]]
    count = words[0] if words else 300
    first = words[1] if len(words) > 1 else 0
    answers: collections.Counter[str] = collections.Counter()
    wrong, slowest = [], (0.0, "")
    for seed in range(first, first + count):
        begun = time.process_time()
        family, answer, words_of = asked(seed)
        slowest = max(slowest, (time.process_time() - begun, f"seed {seed} ({family})"))
        answers[answer] += 1
        for word in words_of:
            wrong.append(f"seed {seed} ({family}; {answer}): {word}")
            print(wrong[-1], flush=True)
    for answer, number in sorted(answers.items()):
        print(f"{number:5d}  {answer}")
    print(f"slowest: {slowest[0]:.2f} s of CPU, {slowest[1]}")
    print(f"{len(wrong)} disagree" if wrong else "nothing disagrees")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
