"""Interfaces that a COMPAS file carries, as given contacts between its blocks.

    edges[u][v]:  "interfaces": [{"points", "frame": {"xaxis", "yaxis"}}],  "interface": one,
                  "interface_points", "interface_uvw" in files of 2020

The corners of an interface are the contact points, and x cross y of its frame the normal; where
it has no frame, that of its polygon, sum of p x q / 2. Which block it points away from is not
said, and writers differ: so it is asked of the blocks. The face of u nearest to the interface
looks along the normal from u to v, and that of v against it.
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

__all__ = ["contacts_of", "interfaces_of"]

_HINT = "export the assembly with its interfaces again, or take --contacts geometry"


def interfaces_of(graph: dict[str, Any]) -> list[tuple[str, str, dict[str, Any]]]:
    """(u, v, interface) of every edge of a graph that has one; an edge listed twice, once."""
    found: list[tuple[str, str, dict[str, Any]]] = []
    seen: set[frozenset[str]] = set()
    for u, row in _dict(graph.get("edge")).items():
        for v, edge in _dict(row).items():
            listed = _listed(_dict(edge))
            if listed and frozenset((u, v)) not in seen:
                seen.add(frozenset((u, v)))
                found += [(u, v, one) for one in listed]
    return found


def _listed(edge: dict[str, Any]) -> list[dict[str, Any]]:
    several = edge.get("interfaces")
    one = edge.get("interface")
    given = several if isinstance(several, list) and several else [one]
    if isinstance(edge.get("interface_points"), list):
        u, v = (*(edge.get("interface_uvw") or ()), None, None)[:2]
        given = [{"points": edge["interface_points"], "frame": {"xaxis": u, "yaxis": v}}]
    return [_inner(found) for found in given if isinstance(found, dict)]


def _dict(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


def _inner(value: Any) -> Any:
    """What is inside ``{"dtype", "data"}``, or the value itself."""
    while isinstance(value, dict) and ("dtype" in value or "datatype" in value):
        value = value.get("data", value.get("value"))
    return value


def contacts_of(
    interfaces: list[tuple[str, str, dict[str, Any]]], parts: Mapping[str, Part]
) -> list[GivenContact]:
    """The contacts that interfaces are, `parts` by the keys of their nodes.

    Raises
    ------
    InputError
        If there is none, or one names a block that is not there or has no usable corners.
    """
    if not interfaces:
        raise InputError(
            "the file carries no interfaces", hint="leave contacts='file' out",
            option="leave --contacts file out",
        )  # fmt: skip
    return [_contact(u, v, one, parts) for u, v, one in interfaces]


def _contact(u: str, v: str, interface: Any, parts: Mapping[str, Part]) -> GivenContact:
    for key in (u, v):
        if key not in parts:
            raise InputError(f"an interface names block {key!r}, which is not there", hint=_HINT)
    points, normal = _polygon(interface)
    if not len(points) or not np.linalg.norm(normal) > 0:
        raise InputError(
            f"an interface of {parts[u].name!r} and {parts[v].name!r} has no usable corners",
            hint=_HINT,
        )
    normal = normal / np.linalg.norm(normal)
    middle = points.mean(axis=0)
    away = _looks(parts[u].shape, middle, normal) - _looks(parts[v].shape, middle, normal)
    return GivenContact((parts[u].name, parts[v].name), points, -normal if away < 0 else normal)


def _polygon(interface: Any) -> tuple[Array, Array]:
    """Corners of an interface, shape (n, 3), and a direction across it; zero where it has none."""
    data = _dict(interface)
    frame = _dict(_inner(data.get("frame")))
    try:
        points = np.array([_inner(p) for p in data.get("points") or ()], dtype=np.float64)
        points = points.reshape(-1, 3)
        if frame.get("xaxis") and frame.get("yaxis"):
            axes = np.array([_inner(frame[key]) for key in ("xaxis", "yaxis")], dtype=np.float64)
            normal = np.cross(*axes.reshape(2, 3))
        else:
            around = points - points.mean(axis=0) if len(points) else points
            normal = np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0) / 2
    except (TypeError, ValueError):
        return np.empty((0, 3)), np.zeros(3)
    if not (np.isfinite(points).all() and np.isfinite(normal).all()):
        return np.empty((0, 3)), np.zeros(3)
    return points, normal


def _looks(shape: Any, point: Array, normal: Array) -> float:
    """Cosine between a direction and the outside of the face of a mesh nearest to a point.

    Of the faces that lie across the direction; 0 where there is none.
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
    away = _distances(point, p[chosen], q[chosen], r[chosen])
    return float(cosine[chosen[away.argmin()]])


def _distances(point: Array, p: Array, q: Array, r: Array) -> Array:
    """Distance of a point from triangles, shape (n,): of their planes inside, of edges outside."""
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
