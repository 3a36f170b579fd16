"""Census of two random bodies that touch in a single point, against the nearest points by OCCT.

    python benchmarks/tangent_census.py            300 scenes
    python benchmarks/tangent_census.py 1000 300   1,000 scenes, from seed 300 on

Two bodies with curved faces, edges and corners stand at random places and angles, apart or one in a
hollow of the other. OCCT gives their nearest points. The second body is then moved along the line
between these points until a gap of 0.3 or 3 gap tolerances, or a wide gap, is left. kilter must
find this contact point with this normal and no other contact (0.3), no contact but an open pair
(3), or neither (wide). A body that presses along the normal through the point is stable, and with
its centre of mass beside that line it is not. The command prints the counts by the kind of bodies
and the contradictions; the exit code is 1 if there are any.
"""

from __future__ import annotations

import argparse
import collections
import sys
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from round_census import TAU, Body, _ball, _cut, _fused, _pose, _step
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Part, Tolerance, check

Array = NDArray[np.float64]
WIDE = 0.03
"""Wide gap of a scene, in which the bodies do not touch [mm]."""
ASIDE = 1e-3
"""Largest distance of the contact point from that of OCCT [mm]."""
TURNED = 2e-4
"""Largest difference in a component of the contact normal from that of OCCT [-]."""
TRIES = 60
"""Number of random places that are tried for a scene."""


@dataclass(frozen=True)
class Solid:
    """A random solid of OCCT, and the largest distance of its points from its origin."""

    kind: str
    made: Any
    reach: float
    hollow: bool = False


def _box(rng: np.random.Generator) -> Solid:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    a, b, c = rng.uniform(0.5, 3, size=3).tolist()
    made = BRepPrimAPI_MakeBox(gp_Pnt(-a, -b, -c), gp_Pnt(a, b, c)).Solid()
    return Solid("box", made, float(np.hypot(np.hypot(a, b), c)))


def _rounded(rng: np.random.Generator, chamfer: bool) -> Solid:
    """A box or a rod whose edges all have a fillet or a chamfer."""
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    r, h = rng.uniform(1, 3, size=2)
    body = Solid("rod", Body("cylinder", (r, h)).made(), float(np.hypot(r, h)))
    body = body if rng.random() < 0.5 else _box(rng)
    tool = (BRepFilletAPI_MakeChamfer if chamfer else BRepFilletAPI_MakeFillet)(body.made)
    explorer, seen = TopExp_Explorer(body.made, TopAbs_EDGE), []
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        is_seam = body.kind == "rod" and _is_straight(edge)
        if not is_seam and not any(edge.IsSame(other) for other in seen):
            tool.Add(0.2, edge)
            seen.append(edge)
        explorer.Next()
    name = f"{body.kind} with {'chamfers' if chamfer else 'fillets'}"
    return Solid(name, tool.Shape(), body.reach)


def _is_straight(edge: Any) -> bool:
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_Line

    return bool(BRepAdaptor_Curve(edge).GetType() == GeomAbs_Line)


def _slanted_rod(rng: np.random.Generator) -> Solid:
    """A rod that a slanted plane cuts: its end is an ellipse."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    r, h, lean = rng.uniform(0.5, 2), rng.uniform(2, 5), rng.uniform(0.1, 0.9)
    frame = gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(np.sin(lean), 0, np.cos(lean)))
    half = BRepPrimAPI_MakeBox(frame, 40, 40, 40).Shape()
    half = half.Moved(_moved(Rotation.identity(), -20 * _in_frame(frame)))
    return Solid("slanted rod", _cut(Body("cylinder", (r, h)).made(), half), r + h)


def _in_frame(frame: Any) -> Array:
    """Sum of the first two axes of a frame."""
    x, y = frame.XDirection(), frame.YDirection()
    return np.array([x.X() + y.X(), x.Y() + y.Y(), x.Z() + y.Z()])


def _groove(rng: np.random.Generator) -> Solid:
    """A wheel with a round groove about its rim."""
    r, q = rng.uniform(2, 4), rng.uniform(0.4, 1)
    wheel = Body("cylinder", (r, 4 * q)).made()
    ring = Body("torus", (r + rng.uniform(0, 0.5) * q, q)).made()
    return Solid("grooved wheel", _cut(wheel, ring), r + 2 * q)


def _race(rng: np.random.Generator) -> Solid:
    """A tube with a round groove inside."""
    r, q = rng.uniform(2, 4), rng.uniform(0.6, 1.2)
    tube = Body("tube", (r + 2 * q, 4 * q, r)).made()
    ring = Body("torus", (r - rng.uniform(0, 0.4) * q, q)).made()
    return Solid("grooved tube", _cut(tube, ring), r + 4 * q, hollow=True)


def _crossed_holes(rng: np.random.Generator) -> Solid:
    """A rod with a bore through its side."""
    r = rng.uniform(1, 2)
    bore = Body("cylinder", (rng.uniform(0.3, 0.8) * r, 10.0)).made()
    bore = bore.Moved(_moved(Rotation.from_euler("x", 90, degrees=True), np.zeros(3)))
    return Solid("drilled rod", _cut(Body("cylinder", (r, 4.0)).made(), bore), r + 2)


def _domed(rng: np.random.Generator) -> Solid:
    """A rod that ends in a sphere that is smaller than a half."""
    r = rng.uniform(0.5, 2)
    ball = _ball(1.3 * r, 0.0)
    return Solid("domed rod", _fused(Body("cylinder", (r, 4.0)).made(), ball), r + 2)


def _body(rng: np.random.Generator, kind: str) -> Solid:
    r, h = rng.uniform(0.8, 3, size=2).tolist()
    sizes = {
        "ball": (r,), "cone": (r, 0.0, h), "frustum": (r, 0.5 * r, h), "torus": (r, 0.4 * r),
        "tube": (r, h, 0.7 * r), "socket": (r + 1, 2 * r + 1, r), "taper": (r + 1, h, r),
    }  # fmt: skip
    size = sizes.get(kind, (r, h))
    reach = float(np.linalg.norm(size)) + 1
    return Solid(kind, Body(kind, size).made(), reach, kind in ("tube", "socket", "taper"))


def random_solid(rng: np.random.Generator) -> Solid:
    """A random solid."""
    makers = {
        "box": _box, "fillets": lambda g: _rounded(g, False),
        "chamfers": lambda g: _rounded(g, True),
        "slanted rod": _slanted_rod, "grooved wheel": _groove, "grooved tube": _race,
        "drilled rod": _crossed_holes, "domed rod": _domed,
    }  # fmt: skip
    kinds = ["ball", "cylinder", "cone", "frustum", "torus", "torus", "tube", "taper", "socket"]
    kind = str(rng.choice([*kinds, *makers]))
    return makers[kind](rng) if kind in makers else _body(rng, kind)


def _moved(turn: Rotation, at: Array) -> Any:
    """A location of OCCT."""
    from OCP.gp import gp_Quaternion, gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    move = gp_Trsf()
    move.SetRotation(gp_Quaternion(*turn.as_quat().tolist()))
    move.SetTranslationPart(gp_Vec(*at.tolist()))
    return TopLoc_Location(move)


@dataclass(frozen=True)
class Nearest:
    """Distance of two solids, a nearest point of each, and whether other pairs are as near.

    `degenerate`: a corner meets a corner or an edge, and their contact has no single normal.
    """

    distance: float
    ends: Array
    single: bool
    degenerate: bool


def _contains(solid: Any, point: Array) -> bool:
    """Whether a point lies inside a solid of OCCT."""
    from OCP.BRepClass3d import BRepClass3d_SolidClassifier
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_IN

    classifier = BRepClass3d_SolidClassifier(solid, gp_Pnt(*point.tolist()), TAU / 100)
    return bool(classifier.State() == TopAbs_IN)


def nearest(first: Any, second: Any) -> Nearest:
    """Nearest points of two solids by OCCT."""
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape, BRepExtrema_SupportType

    found = BRepExtrema_DistShapeShape(first, second)
    p, q = found.PointOnShape1(1), found.PointOnShape2(1)
    ends = np.array([[p.X(), p.Y(), p.Z()], [q.X(), q.Y(), q.Z()]])
    pairs = []
    for k in range(1, found.NbSolution() + 1):
        p = found.PointOnShape1(k)
        pairs.append([p.X(), p.Y(), p.Z()])
    spread = np.ptp(np.array(pairs), axis=0).max()
    kinds = found.SupportTypeShape1(1), found.SupportTypeShape2(1)
    corner = BRepExtrema_SupportType.BRepExtrema_IsVertex in kinds
    degenerate = corner and BRepExtrema_SupportType.BRepExtrema_IsInFace not in kinds
    return Nearest(float(found.Value()), ends, bool(spread < ASIDE / 10), degenerate)


@dataclass(frozen=True)
class Scene:
    """Two solids, the place of the second, and their only contact: point, normal and gap."""

    solids: tuple[Solid, Solid]
    turn: Rotation
    at: Array
    point: Array
    normal: Array
    gap: float
    degenerate: bool

    @property
    def kind(self) -> str:
        """Names of the bodies."""
        return " / ".join(sorted(solid.kind for solid in self.solids))


def random_scene(rng: np.random.Generator) -> Scene | None:
    """A random scene; None if no place was found at which a single pair of points is nearest."""
    first, second = random_solid(rng), random_solid(rng)
    inside = first.hollow and rng.random() < 0.7
    gap = float(rng.choice([0.3 * TAU, 0.3 * TAU, 3 * TAU, WIDE]))
    for _ in range(TRIES):
        turn, way = Rotation.random(rng=rng), rng.normal(size=3)
        way /= np.linalg.norm(way)
        at = way * (rng.uniform(0, 3) if inside else 0.8 * (first.reach + second.reach))
        placed = second.made.Moved(_moved(turn, at))
        apart = nearest(first.made, placed)
        if apart.distance < 0.02 or not apart.single:
            continue
        if _contains(first.made, apart.ends[1]) or _contains(placed, apart.ends[0]):
            continue
        normal = (apart.ends[1] - apart.ends[0]) / apart.distance
        at = at - (apart.distance - gap) * normal
        near = nearest(first.made, second.made.Moved(_moved(turn, at)))
        if abs(near.distance - gap) > 1e-7 or not near.single:
            continue
        point = near.ends.mean(axis=0)
        return Scene((first, second), turn, at, point, normal, gap, apart.degenerate)
    return None


def assembly_of(scene: Scene, normal: Array, center: Array) -> Assembly:
    """The scene as an assembly, with gravity against a normal and a given centre of mass."""
    first, second = scene.solids
    local = scene.turn.inv().apply(center - scene.at)
    parts = [
        Part("held", _step(first.made), grounded=True),
        Part("free", _step(second.made), _pose(scene.turn, scene.at), mass=1.0,
             center_of_mass=local),
    ]  # fmt: skip
    return Assembly(parts, units="mm", gravity=-9.81 * normal)


def judged(scene: Scene) -> list[str]:
    """Contradictions between kilter and the known contact of a scene."""
    tolerance = Tolerance(gap=TAU)
    assembly = assembly_of(scene, scene.normal, scene.point + scene.normal)
    contacts = kilter.contacts(assembly, tolerance=tolerance)
    if scene.gap == WIDE:
        wrong = ["a contact of bodies that are apart"] * min(len(contacts.points), 1)
        return wrong + ["an open pair of bodies that are apart"] * len(contacts.open_pairs)
    if scene.gap > TAU:
        wrong = ["a contact beyond the tolerance"] * min(len(contacts.points), 1)
        return wrong + ["no open pair beyond the tolerance"] * (not contacts.open_pairs)
    if scene.degenerate:
        wrong = ["a contact without a single normal"] * min(len(contacts.points), 1)
        return wrong + ["no open pair"] * (not contacts.open_pairs)
    wrong = [f"not modelled: {contact.kind}" for contact in contacts.unsupported]
    # other faces may lie just beyond the tolerance
    near = [pair.kind for pair in contacts.open_pairs if pair.kind == "near" and pair.gap > TAU]
    wrong += [f"open pair: {pair.kind}" for pair in contacts.open_pairs if not (wrong or near)]
    if not len(contacts.points):
        return [*wrong, "the contact is missing"]
    off = np.linalg.norm(contacts.points - scene.point, axis=1)
    k = int(off.argmin())
    lean = float(np.abs(contacts.normals[k] - scene.normal).max())
    if off[k] > ASIDE:
        wrong.append(f"the nearest contact is {off[k]:.2g} mm aside")
    elif lean > TURNED:
        wrong.append(f"the normal is off by {lean:.2g}")
    if off.max() > 100 * ASIDE:
        wrong.append(f"a further contact {off.max():.2g} mm aside")
    return (
        wrong if wrong or near else _judged_verdicts(scene, contacts.points[k], contacts.normals[k])
    )


def _judged_verdicts(scene: Scene, point: Array, normal: Array) -> list[str]:
    """Contradictions of the verdicts of a body above and beside its only contact point."""
    tolerance, wrong = Tolerance(gap=TAU), []
    above = check(assembly_of(scene, normal, point + normal), tolerance=tolerance).first_order
    wrong += [f"{above} above its contact"] * (above != "stable")
    aside = np.cross(normal, [0.3, 0.5, 0.7])
    beside = check(assembly_of(scene, normal, point + normal + aside), tolerance=tolerance).verdict
    return wrong + [f"{beside} beside its contact"] * (beside != "unstable")


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=300)
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("--seed", type=int, action="append", help="only this scene")
    options = parser.parse_args()
    kinds: collections.Counter[str] = collections.Counter()
    wrong: list[str] = []
    skipped, started = 0, time.process_time()
    for seed in options.seed or range(options.first, options.first + options.count):
        scene = random_scene(np.random.default_rng(seed))
        if scene is None:
            skipped += 1
            continue
        gap = "wide" if scene.gap == WIDE else f"{scene.gap / TAU:g} tolerances"
        kinds[f"gap {gap}{', no single normal' if scene.degenerate else ''}"] += 1
        for word in judged(scene):
            wrong.append(f"seed {seed} ({scene.kind}; {gap}): {word}")
            print(wrong[-1], flush=True)
    for kind, count in sorted(kinds.items()):
        print(f"{count:5d}  {kind}")
    seconds = time.process_time() - started
    print(f"{skipped} scenes without a single nearest pair, {seconds:.0f} s of CPU")
    print(f"{len(wrong)} disagree" if wrong else "nothing disagrees")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
