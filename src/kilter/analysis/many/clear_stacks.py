"""Assemblies of upright prisms that are decided by compiled code, if numba is installed.

numba is loaded only for many assemblies, since its import and its first use take time. An assembly
near any limit, and every other assembly, is left to the computation without numba, whose verdicts
are the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Assembly
from kilter.assembly.assembly_arrays import AssemblyArrays
from kilter.assembly.mesh_surface import DEFAULT_DENSITY
from kilter.contact import Tolerance
from kilter.shape.primitives import BOX_CORNERS, BOX_TRIANGLES, Box
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.analysis.many.compiled_prisms import Meshes
    from kilter.analysis.many.compiled_stacks import Answers

FEWEST = 1000
"""Least number of assemblies for which numba is loaded."""


def clear_answers(
    given: Sequence[Assembly] | AssemblyArrays, tolerance: Tolerance
) -> tuple[Index, Answers] | None:
    """The assemblies that compiled code was given, shape (m,), and its answers about them.

    None for few assemblies, for a tolerance with a clearance, and without numba.
    """
    if len(given) < FEWEST or tolerance.clearance is not None or not has_numba():
        return None
    if isinstance(given, AssemblyArrays):
        if given.vertices.dtype != np.float64:
            return None
        which: Index = np.arange(len(given))
        meshes: Callable[[Any], Meshes] = _meshes_of_arrays
    else:
        which = np.array([k for k, one in enumerate(given) if _all_boxes(one)], dtype=np.int64)
        if len(which) < FEWEST:
            return None
        given, meshes = [given[k] for k in which.tolist()], _meshes_of_boxes
    # numba takes a quarter of a second to load
    from kilter.analysis.many.compiled_stacks import decide_meshes

    return which, decide_meshes(meshes(given), tolerance.relative_gap, tolerance.gap)


@cache
def has_numba() -> bool:
    """Whether numba is installed."""
    return find_spec("numba") is not None


def _meshes_of_arrays(given: Any) -> Meshes:
    """The meshes of `AssemblyArrays`."""
    from kilter.analysis.many.compiled_prisms import Meshes

    parts, count = len(given.held), len(given)
    density = np.full(parts, DEFAULT_DENSITY) if given.density is None else given.density
    return Meshes(
        given.vertices, given.faces, given.vertex_start, given.face_start, given.part_start,
        given.held, given.gravity, density, np.full(parts, np.nan),
        np.full(count, given.friction), np.full(count, metres_per_unit(given.units)),
    )  # fmt: skip


def _all_boxes(assembly: Assembly) -> bool:
    """Whether an assembly consists of boxes whose centres of mass are their own, without more."""
    given = assembly.contacts or assembly.joints or assembly.loads or assembly.bonds
    if given or assembly.straps or assembly.planar or not assembly.detect:
        return False
    if assembly.tolerance is not None:
        return False
    return all(isinstance(p.shape, Box) and p.center_of_mass is None for p in assembly.parts)


def _meshes_of_boxes(assemblies: Any) -> Meshes:
    """The boxes of assemblies as meshes."""
    from kilter.analysis.many.compiled_prisms import Meshes

    parts = [part for one in assemblies for part in one.parts]
    count, start = len(parts), np.cumsum([0, *(len(one.parts) for one in assemblies)])
    size, place, turn = (
        np.array([part.shape.size for part in parts]),
        np.array([part.pose.position for part in parts]),
        np.array([part.pose.rotation for part in parts]),
    )
    corners = BOX_CORNERS * size[:, None]
    turned = np.flatnonzero(turn[:, 1:].any(axis=1))
    if len(turned):
        matrices = np.array([parts[k].pose.matrix for k in turned.tolist()])
        corners[turned] = corners[turned] @ matrices.transpose(0, 2, 1)
    first = 8 * np.arange(count + 1)
    return Meshes(
        (corners + place[:, None]).reshape(-1, 3),
        (BOX_TRIANGLES + first[:-1, None, None]).reshape(-1, 3),
        first,
        len(BOX_TRIANGLES) * np.arange(count + 1),
        start,
        np.array([part.grounded for part in parts]),
        np.array([one.gravity for one in assemblies]),
        _numbers([part.density for part in parts], DEFAULT_DENSITY),
        _numbers([part.given_mass for part in parts], np.nan),
        np.array([largest_friction(one) for one in assemblies]),
        np.array([metres_per_unit(one.units) for one in assemblies]),
    )


def _numbers(values: list[float | None], default: float) -> Array:
    """Numbers, with a default in place of None, shape (n,)."""
    return np.array([default if value is None else value for value in values])


def largest_friction(assembly: Assembly) -> float:
    """Largest friction coefficient of any contact of an assembly [-]."""
    return max(assembly.friction, *(pair.mu for pair in assembly.friction_pairs), 0.0)
