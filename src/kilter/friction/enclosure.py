"""What is known of every solution of the contact law that is asked about: bounds and modes.

All bounds hold for the solutions with |a| <= scale and w.a <= scale^2; motions are in units
of the scale, b = a / scale, and forces in those of `kilter.friction.contact_law`. A mode
narrows them: a point touches (un = 0) or is without force (fn = 0); the twist of a patch is 0
or lies in a cone. The children of a mode cover it, so that every solution is in one of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array
from kilter.friction.contact_law import ContactLaw
from kilter.friction.twist_cones import Cone

__all__ = [
    "Enclosure",
    "Reach",
    "apart",
    "first_enclosure",
    "in_cone",
    "reach",
    "rescaled",
    "touching",
]


@dataclass(frozen=True, slots=True, eq=False)
class Enclosure:
    """Bounds of all solutions; K points, G groups, m directions, n freedoms.

    Attributes
    ----------
    scale : float
        |a| <= scale [-], and w.a <= scale^2.
    un, fn : ndarray, shape (K,)
        Opening and force are at least 0 and at most these.
    ut : ndarray, shape (G, m)
        d_k.ut is at most this; in space also |ut| is.
    slip : ndarray, shape (G,)
        |ut| is at most this.
    rest : ndarray, shape (G, m)
        g_k = mu N + d_k.ft is at most this, and in space mu N is.
    least, most : ndarray, shape (G,)
        Bounds of the sum N of the normal forces.
    tangents : ndarray, shape (q, n)
        Points c where the ball of accelerations is bounded by its tangent.
    cones : tuple, one a patch
        None, or the cone in which the twist lies.
    cuts : bool
        Whether rows may rest on the bounds of forces.
    """

    scale: float
    un: Array
    fn: Array
    ut: Array
    slip: Array
    rest: Array
    least: Array
    most: Array
    tangents: Array
    cones: tuple[Cone | None, ...]
    cuts: bool


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """Largest un, shape (K,), d_k.ut (in space |ut|), (G, m), and |ut|, (G,), for |b| <= 1."""

    un: Array
    ut: Array
    slip: Array


def reach(law: ContactLaw, directions: Array) -> Reach:
    """How far unit motions reach; `directions` d_k, shape (m, T)."""
    opening = np.sqrt(np.asarray(law.normal.multiply(law.normal).sum(axis=1)).ravel())
    rows = [law.tangent[k :: law.directions] for k in range(law.directions)]
    gram = np.array([[np.asarray(a.multiply(b).sum(axis=1)).ravel() for a in rows] for b in rows])
    slip = np.sqrt(np.linalg.eigvalsh(gram.transpose(2, 0, 1)).max(axis=1, initial=0.0))
    return Reach(opening, np.tile(slip[:, None], len(directions)), slip)


def first_enclosure(law: ContactLaw, far: Reach, force: float, pool: int) -> Enclosure:
    """Before anything is known but that no force exceeds `force`; no cut rests on that yet."""
    sides = far.ut.shape[1]
    members = np.bincount(law.group[law.group >= 0], minlength=len(law.mu)).astype(np.float64)
    most = force * members
    return Enclosure(
        1.0,
        far.un,
        np.full(len(law.group), force),
        far.ut,
        far.slip,
        np.repeat(2 * law.mu * most, sides).reshape(len(most), sides),
        np.zeros(len(most)),
        most,
        np.vstack([law.load / 2, law.load, np.zeros((pool - 2, len(law.load)))]),
        (None,) * len(law.twist),
        False,
    )


def rescaled(far: Reach, bounds: Enclosure, power: float) -> Enclosure:
    """The bounds in units of the size that a greatest `power` w.b leaves: |a|^2 <= w.a."""
    scale = float(np.sqrt(bounds.scale * max(power, 0.0)))
    if not 0 < scale < bounds.scale:
        return bounds
    grown = bounds.scale / scale
    return replace(
        bounds,
        scale=scale,
        un=np.minimum(bounds.un * grown, far.un),
        ut=np.minimum(bounds.ut * grown, far.ut),
        slip=np.minimum(bounds.slip * grown, far.slip),
        tangents=bounds.tangents * grown,
    )


def touching(bounds: Enclosure, point: int) -> Enclosure:
    """The solutions where a point stays closed."""
    un = bounds.un.copy()
    un[point] = 0.0
    return replace(bounds, un=un)


def apart(bounds: Enclosure, point: int) -> Enclosure:
    """The solutions where a point bears no force."""
    fn = bounds.fn.copy()
    fn[point] = 0.0
    return replace(bounds, fn=fn)


def in_cone(law: ContactLaw, bounds: Enclosure, patch: int, cone: Cone) -> Enclosure:
    """The solutions whose twist of a patch lies in a cone, or is 0 where the cone is empty."""
    cones = tuple(cone if k == patch else old for k, old in enumerate(bounds.cones))
    ut, slip, rest = bounds.ut.copy(), bounds.slip.copy(), bounds.rest.copy()
    members = np.flatnonzero(law.patch == patch)
    if not cone.size:
        ut[members], slip[members] = 0.0, 0.0
    elif law.directions == 1:
        along = 0 if cone[0, 0] > 0 else 1  # the directions are +1 and -1
        ut[members, 1 - along] = 0.0
        slip[members] = ut[members, along]
        rest[members, along] = 0.0
    return replace(bounds, cones=cones, ut=ut, slip=slip, rest=rest)
