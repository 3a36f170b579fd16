"""Convert the interfaces of a COMPAS file to given contacts between its blocks.

    edges[u][v]:  "interfaces": [{"points", "frame": {"xaxis", "yaxis"}}],
                  "contacts": the same in a model of compas_model,
                  "interface": a single interface,
                  "interface_points", "interface_uvw" in files of 2020

The corners of an interface are the contact points. Its normal is x cross y of its frame, or
without a frame the area vector of its polygon, the sum of p x q / 2. The files do not define the
sense of the normal, and writers differ. Therefore the faces of the blocks determine the sense: the
normal from u to v points out of the face of u nearest to the interface, and into the face of v.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from kilter.arrays import Array, cross
from kilter.assembly import GivenContact, Part
from kilter.errors import InputError
from kilter.files.file_tolerances import ALONG
from kilter.shape.primitives import Mesh

_HINT = "export the assembly with its interfaces again, or use --contacts geometry"


def as_dict(value: Any) -> dict[str, Any]:
    """The value if it is a dict, else an empty dict."""
    return value if isinstance(value, dict) else {}


def kind(data: dict[str, Any]) -> Any:
    """The type name of a serialised COMPAS object; an empty text for other dicts."""
    return data.get("dtype", data.get("datatype", ""))


def inner(value: Any) -> Any:
    """The content under the key "data" of a serialised object, or the value itself."""
    while isinstance(value, dict) and kind(value):
        value = value.get("data", value.get("value"))
    return value


def interfaces_of(graph: dict[str, Any]) -> list[tuple[str, str, dict[str, Any]]]:
    """All contact interfaces of a COMPAS graph as (u, v, interface), each once."""
    result: list[tuple[str, str, dict[str, Any]]] = []
    seen: set[frozenset[str]] = set()
    for u, row in as_dict(graph.get("edge")).items():
        for v, edge in as_dict(row).items():
            interfaces = _edge_interfaces(as_dict(edge))
            if interfaces and frozenset((u, v)) not in seen:
                seen.add(frozenset((u, v)))
                result += [(u, v, interface) for interface in interfaces]
    return result


def _edge_interfaces(edge: dict[str, Any]) -> list[dict[str, Any]]:
    """Contact interfaces of a graph edge, from any of the three forms in which files store them."""
    several = edge.get("interfaces") or edge.get("contacts")
    single = edge.get("interface")
    stored = several if isinstance(several, list) and several else [single]
    if isinstance(edge.get("interface_points"), list):
        axes = edge.get("interface_uvw")
        u, v = (*(axes if isinstance(axes, list) else ()), None, None)[:2]
        stored = [{"points": edge["interface_points"], "frame": {"xaxis": u, "yaxis": v}}]
    return [inner(interface) for interface in stored if isinstance(interface, dict)]


def contacts_of(
    interfaces: list[tuple[str, str, dict[str, Any]]], parts: Mapping[str, Part]
) -> list[GivenContact]:
    """Convert COMPAS interfaces to contacts of parts.

    Arguments: `interfaces`: keys of the two nodes, and the interface, as `interfaces_of` returns
    them. Raises `InputError` if there is no interface, or an interface has an unknown block or no
    valid corners.
    """
    if not interfaces:
        raise InputError(
            "the file has no interfaces", hint="leave contacts='file' out",
            option="leave --contacts file out",
        )  # fmt: skip
    return [_contact(u, v, interface, parts) for u, v, interface in interfaces]


def _contact(u: str, v: str, interface: Any, parts: Mapping[str, Part]) -> GivenContact:
    """Convert an interface to a contact, with the normal from block u to block v."""
    for key in (u, v):
        if key not in parts:
            raise InputError(f"an interface names the unknown block {key!r:.80}", hint=_HINT)
    points, normal = _polygon(interface)
    if not len(points) or not np.linalg.norm(normal) > 0:
        raise InputError(
            f"an interface of {parts[u].name!r} and {parts[v].name!r} has no valid corners",
            hint=_HINT,
        )
    normal = normal / np.linalg.norm(normal)
    middle = points.mean(axis=0)
    facing_u = _facing_cosine(parts[u].shape, middle, normal)
    sense = facing_u - _facing_cosine(parts[v].shape, middle, normal)
    return GivenContact((parts[u].name, parts[v].name), points, -normal if sense < 0 else normal)


def _polygon(interface: Any) -> tuple[Array, Array]:
    """Corners of an interface, shape (n, 3), and its normal, shape (3,), not yet of length 1.

    Without valid corners: no corners, and a zero normal.
    """
    data = as_dict(interface)
    frame = as_dict(inner(data.get("frame")))
    try:
        points = np.array([inner(p) for p in data.get("points") or ()], dtype=np.float64)
        points = points.reshape(-1, 3)
        if frame.get("xaxis") and frame.get("yaxis"):
            axes = np.array([inner(frame[key]) for key in ("xaxis", "yaxis")], dtype=np.float64)
            normal = np.cross(*axes.reshape(2, 3))
        else:
            around = points - points.mean(axis=0) if len(points) else points
            normal = np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0) / 2
    except (TypeError, ValueError, OverflowError):
        return np.empty((0, 3)), np.zeros(3)
    if not (np.isfinite(points).all() and np.isfinite(normal).all()):
        return np.empty((0, 3)), np.zeros(3)
    return points, normal


def _facing_cosine(shape: Any, point: Array, normal: Array) -> float:
    """Cosine of the angle between a direction and the outward normal of the nearest mesh face.

    Only faces across the direction are considered (cosine above `ALONG` in magnitude); without
    any, the result is 0.
    """
    assert isinstance(shape, Mesh)
    p, q, r = (shape.vertices[shape.triangles[:, k]] for k in range(3))
    outside = cross(q - p, r - p)
    outward = 1.0 if float(np.einsum("ij,ij->", p - p[0], cross(q - p[0], r - p[0]))) >= 0 else -1.0
    length = np.linalg.norm(outside, axis=1)
    cosine = outward * (outside @ normal) / np.where(length > 0, length, 1.0)
    chosen = np.flatnonzero(np.abs(cosine) > ALONG)
    if not len(chosen):
        return 0.0
    distance = _distances(point, p[chosen], q[chosen], r[chosen])
    return float(cosine[chosen[distance.argmin()]])


def _distances(point: Array, p: Array, q: Array, r: Array) -> Array:
    """Distance of a point from each of n triangles (p, q, r), shape (n,).

    It is the distance from the plane if the point projects into the triangle, else the distance
    from the nearest edge.
    """
    normal = cross(q - p, r - p)
    length = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(length > 0, length, 1.0)[:, None]
    inside = length > 0
    nearest = np.full(len(p), np.inf)
    for a, b in ((p, q), (q, r), (r, p)):
        along = b - a
        inside &= np.einsum("ij,ij->i", cross(along, point - a), unit) >= 0
        squared = np.maximum(np.einsum("ij,ij->i", along, along), np.finfo(float).tiny)
        t = np.clip(np.einsum("ij,ij->i", point - a, along) / squared, 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(point - a - t[:, None] * along, axis=1))
    across = np.abs(np.einsum("ij,ij->i", point - p, unit))
    return np.asarray(np.where(inside, across, nearest))
