"""Find the exact surface of a face of a STEP file.

Planes, cylinders, cones, spheres and tori are converted. Many files store them as B-splines, or as
surfaces of revolution and extrusion. OCCT then proposes a surface, which is accepted only if points
all over the face lie on it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.files.file_tolerances import RECOGNISED
from kilter.shape.solid import Surface, height

# Helpers for OCCT: containers, exception types, silenced output, subshapes of a shape.


# the bindings of OCCT 7 and 8 name their containers differently


def shape_map() -> Any:
    """An empty OCCT map that numbers shapes and gives equal shapes the same number."""
    try:
        from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
    except ModuleNotFoundError:
        from OCP.TopTools import TopTools_IndexedMapOfShape as ShapeMap
    return ShapeMap()


def labels() -> Any:
    """An empty OCCT sequence for labels."""
    try:
        from OCP.collections import Sequence_TDF_Label as Labels
    except ModuleNotFoundError:
        from OCP.TDF import TDF_LabelSequence as Labels
    return Labels()


def asciis() -> Any:
    """An empty OCCT sequence for ASCII strings."""
    try:
        from OCP.collections import Sequence_TCollection_AsciiString as Texts
    except ModuleNotFoundError:
        from OCP.TColStd import TColStd_SequenceOfAsciiString as Texts
    return Texts()


def failures(*more: type[Exception]) -> tuple[type[Exception], ...]:
    """Exception types that OCCT raises for an invalid shape, together with the types `more`.

    The bindings define a class for each kind of failure, without a common base. For the null
    handles and empty boxes of invalid shapes they raise TypeError, ValueError or RuntimeError.
    """
    import OCP.Standard

    name = OCP.Standard.__name__.partition(".")[0]
    kinds = [kind for kind in Exception.__subclasses__() if kind.__module__.startswith(name)]
    return (*kinds, RuntimeError, TypeError, ValueError, *more)


@contextmanager
def quiet() -> Iterator[None]:
    """Context manager that silences the output of OCCT."""
    from OCP.Message import Message

    messenger = Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    for printer in printers:
        messenger.RemovePrinter(printer)
    try:
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)


def inside(shape: Any, kind: Any, avoid: Any = None) -> Iterator[Any]:
    """Subshapes of type `kind` of a shape, except those inside a subshape of type `avoid`."""
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(shape, kind) if avoid is None else TopExp_Explorer(
        shape, kind, avoid
    )  # fmt: skip
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def face_surface(face: Any, nodes: Array, probes: Array) -> Surface | None:
    """The exact surface of a face; None if it is none of the kinds that kilter knows.

    The side of the material is not set yet.

    Arguments: `nodes` (n, 3): corners of its triangles; `probes` (m, 3): points of the face between
    the corners.
    """
    from OCP.BRepAdaptor import BRepAdaptor_Surface

    adaptor = BRepAdaptor_Surface(face)
    kind = _kind(adaptor)
    if kind in _NATIVE:
        return _NATIVE[kind](getattr(adaptor, kind)(), nodes)
    points = np.vstack([nodes, probes])
    within = RECOGNISED * float(np.ptp(points, axis=0).max())
    for surface in (_proposed_surface(face, nodes, within), _revolved_torus(adaptor, kind)):
        if surface is not None and float(np.abs(height(surface, points)).max()) <= within:
            return surface
    return None


def is_plain(face: Any) -> bool:
    """Whether the file states that a face is a plane, cylinder, cone, sphere or torus."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface

    return _kind(BRepAdaptor_Surface(face)) in _NATIVE


def _kind(adaptor: Any) -> str:
    """OCCT's name for the kind of a surface, such as "Plane"."""
    return str(adaptor.GetType().name).removeprefix("GeomAbs_")


def points_of_face(face: Any, parameters: Array) -> Array:
    """Points on the surface of a face, shape (n, 3), at surface parameters, shape (n, 2)."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface

    adaptor = BRepAdaptor_Surface(face)
    return np.array([_xyz(adaptor.Value(u, v)) for u, v in parameters.tolist()]).reshape(-1, 3)


def _proposed_surface(face: Any, nodes: Array, within: float) -> Surface | None:
    """The surface that OCCT recognises in a face within a tolerance; None without one."""
    from OCP.gp import gp_Cone, gp_Cylinder, gp_Pln, gp_Sphere
    from OCP.ShapeAnalysis import ShapeAnalysis_CanonicalRecognition

    recognition = ShapeAnalysis_CanonicalRecognition(face)
    for kind, shape in (
        ("Plane", gp_Pln()),
        ("Cylinder", gp_Cylinder()),
        ("Sphere", gp_Sphere()),
        ("Cone", gp_Cone()),
    ):
        try:
            if getattr(recognition, f"Is{kind}")(within, shape):
                return _NATIVE[kind](shape, nodes)
        except failures():  # the recognition fails on some splines
            continue
    return None


def _revolved_torus(adaptor: Any, kind: str) -> Surface | None:
    """The torus of a circle revolved about an axis in its plane; None for other surfaces."""
    from OCP.GeomAbs import GeomAbs_CurveType

    if kind != "SurfaceOfRevolution":
        return None
    curve = adaptor.BasisCurve()
    if curve.GetType() != GeomAbs_CurveType.GeomAbs_Circle:
        return None
    axis, circle = adaptor.AxeOfRevolution(), curve.Circle()
    point, direction = _xyz(axis.Location()), _xyz(axis.Direction())
    center = _xyz(circle.Location())
    along = (center - point) @ direction
    foot = point + along * direction
    radius = float(np.linalg.norm(center - foot))
    if radius <= circle.Radius():
        return None
    return Surface("torus", foot, direction, radius=radius, tube=circle.Radius())


# OCCT's surfaces ------------------------------------------------------------------------


def _plane(plane: Any, _: Array) -> Surface:
    """Convert an OCCT plane (gp_Pln) to a `Surface`."""
    return Surface("plane", _xyz(plane.Location()), _axis(plane))


def _cylinder(cylinder: Any, _: Array) -> Surface:
    """Convert an OCCT cylinder (gp_Cylinder) to a `Surface`."""
    return Surface("cylinder", _xyz(cylinder.Location()), _axis(cylinder), radius=cylinder.Radius())


def _sphere(sphere: Any, _: Array) -> Surface:
    """Convert an OCCT sphere (gp_Sphere) to a `Surface`."""
    return Surface("sphere", _xyz(sphere.Location()), radius=sphere.Radius())


def _torus(torus: Any, _: Array) -> Surface | None:
    """Convert an OCCT torus (gp_Torus) to a `Surface`; None if it intersects itself."""
    if torus.MajorRadius() <= torus.MinorRadius():
        return None  # a point may be on either of two sheets
    return Surface(
        "torus",
        _xyz(torus.Location()),
        _axis(torus),
        radius=torus.MajorRadius(),
        tube=torus.MinorRadius(),
    )


def _cone(cone: Any, nodes: Array) -> Surface | None:
    """Convert an OCCT cone (gp_Cone) to a `Surface`, its axis from the apex towards the nodes.

    None if nodes are on both sides of the apex.
    """
    apex, axis = _xyz(cone.Apex()), _axis(cone)
    along = (nodes - apex) @ axis
    if along.sum() < 0:
        axis, along = -axis, -along
    if along.min() < -RECOGNISED * float(np.abs(along).max()):
        return None
    return Surface("cone", apex, axis, half_angle=abs(cone.SemiAngle()))


_NATIVE = {
    "Plane": _plane,
    "Cylinder": _cylinder,
    "Cone": _cone,
    "Sphere": _sphere,
    "Torus": _torus,
}
"""Converter of each kind of OCCT surface that `Surface` has."""


def _axis(shape: Any) -> Array:
    """Direction of the axis of an OCCT surface, shape (3,)."""
    axis = shape.Axis()
    return _xyz(axis.Direction())


def _xyz(point: Any) -> Array:
    """Coordinates of an OCCT point or direction, shape (3,)."""
    return np.array([point.X(), point.Y(), point.Z()])
