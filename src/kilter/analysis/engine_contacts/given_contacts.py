"""`kilter.check_contacts`: the verdict on bodies with given contacts, from arrays alone.

Physics engines report their contacts as points with normals. These arrays, with the masses and the
centres of mass, are all data that equilibrium needs, so the shapes of the bodies are not read. A
body has a box in place of its shape: a cube about its centre of mass, whose circumscribed sphere
passes through the farthest contact point. Nothing is detected on it; it gives the body a size.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kilter.analysis.check import check, check_equilibrium
from kilter.analysis.verdict.remarks import loose_parts, remarks
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index, Mask, read_only
from kilter.assembly import Assembly, Feature, Part
from kilter.assembly.interactions import GivenContact, Load
from kilter.assembly.question import Question, question
from kilter.contact.detect import contacts
from kilter.errors import InputError
from kilter.shape.primitives import Box, Shape, Sphere
from kilter.tell.levels import VerdictWord
from kilter.validate import finite, number

WORLD = "world"
"""Name of the held part that stands for all bodies with the index -1."""
STANDARD = 9.80665
"""Acceleration that relates the assumed masses of bodies to their wrenches [m/s^2]."""
ONLY_FORCES = (
    "Potentially stable: forces that hold it exist. Small pushes and other motions were not "
    "examined at the level equilibrium."
)
"""Sentence of a verdict at the level equilibrium."""
NO_SIZE = 1e-9
"""Bodies smaller than this share of the largest one have no size of their own [-]."""


@question(lacks="friction down ground floor contacts tolerance progress assume")
def check_contacts(
    points: Any,
    normals: Any,
    mu: Any,
    bodies: Any,
    center_of_mass: Any,
    *,
    asked: Question,
    mass: Any = None,
    wrenches: Any = None,
    gravity: Any = (0.0, 0.0, -9.81),
    curved: Any = None,
) -> Verdict:
    """Decide whether given contacts hold bodies at rest: arrays in, a verdict with proof out.

    The arrays are those of any physics engine. Only these contacts exist, and shapes are not read.
    All vectors are in the world frame; lengths are metres. Contact k acts between the bodies
    ``bodies[k]``, and its Coulomb cone has the axis ``normals[k]``.

    Parameters
    ----------
    points : array_like, shape (K, 3)
        Contact points [m].
    normals : array_like, shape (K, 3)
        Normals from the first body to the second, of any length [-].
    mu : array_like, shape (K,), or float
        Friction coefficients [-].
    bodies : array_like of int, shape (K, 2)
        First and second body of each contact, from 0 to B - 1; -1 is the world, which is held.
    center_of_mass : array_like, shape (B, 3)
        Centres of mass [m].
    mass : array_like, shape (B,), optional
        Masses [kg]. Without masses `wrenches` are all loads; accelerations then belong to assumed
        masses in proportion to the wrenches.
    wrenches : array_like, shape (B, 6), optional
        Force [N] and torque about the centre of mass [N m] on each body, in addition to the weight.
    gravity : array_like, shape (3,)
        Acceleration of gravity [m/s^2].
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. "equilibrium" is the quickest: it decides only whether
        forces at the contacts balance every body, in about 10 ms for 20 bodies.
    curved : array_like of bool, shape (B,), optional
        Whether the surface of each body may be curved at its contacts. By default none is: every
        body touches with corners, edges and flat faces. For a curved body the level is at most
        "equilibrium" unless friction or further contacts prevent that it rolls.

    Returns
    -------
    Verdict
        Its parts are named "0", "1", ... and "world". The contact points of ``forces`` have the
        order of the given points.

    Raises
    ------
    InputError
        If an array has another shape, a number is not finite, a normal is zero, a coefficient is
        negative, a contact is of a body with itself, or there are neither masses nor wrenches.

    See Also
    --------
    kilter.judge : the same for a state of MuJoCo, with motors and joints.
    kilter.check : the verdict on an assembly with shapes.

    Examples
    --------
    A block on a plane of friction 0.5, whose slope is below and above atan 0.5:

    >>> corners = [[x, y, -1.0] for x in (-1, 1) for y in (-1, 1)]
    >>> for slope in (0.49, 0.51):
    ...     verdict = check_contacts(corners, [[0, 0, 1]] * 4, 0.5, [[-1, 0]] * 4, [[0, 0, 0]],
    ...                              mass=[2.0], gravity=[9.81 * slope, 0, -9.81])
    ...     print(verdict.verdict)
    stable
    unstable
    """
    given = ContactArrays.of(points, normals, mu, bodies)
    center = _array(center_of_mass, (None, 3), "center_of_mass")
    count = len(center)
    if not count:
        raise InputError("there are no bodies", hint="give at least one centre of mass")
    given.require_bodies(count)
    down = finite(gravity, (3,), "gravity")
    loads = np.zeros((count, 6))
    if wrenches is not None:
        loads = _array(wrenches, (count, 6), "wrenches")
    elif mass is None:
        raise InputError("there are neither masses nor wrenches", hint="give mass, or wrenches")
    sizes = given.sizes(center)
    if mass is None:  # weights that the wrenches replace, so that all loads are the wrenches
        down = np.array([0.0, 0.0, -STANDARD])
        force = np.linalg.norm(loads[:, :3], axis=1)
        force = np.maximum(force, np.linalg.norm(loads[:, 3:], axis=1) / sizes)
        masses = np.where(force > 0, force, max(force.max(initial=0.0), 1.0)) / STANDARD
        loads = loads.copy()
        loads[:, :3] -= masses[:, None] * down
    else:
        masses = _array(mass, (count,), "mass")
    round_bodies = np.zeros(count, dtype=bool)
    if curved is not None:
        round_bodies = np.asarray(curved, dtype=bool)
        if round_bodies.shape != (count,):
            raise InputError(
                f"curved has shape {round_bodies.shape}", hint=f"give a flag for each of {count}"
            )
    parts = [
        Part(str(k), stand_in(size, curved=odd), at, mass=own)
        for k, (size, odd, at, own) in enumerate(
            zip(sizes, round_bodies.tolist(), center, masses.tolist(), strict=True)
        )
    ]
    pushes = [
        Load(str(k), force=loads[k, :3], torque=loads[k, 3:])
        for k in np.flatnonzero(loads.any(axis=1)).tolist()
    ]
    assembly = given.with_world(count).assembly(parts, [WORLD], gravity=down, loads=pushes)
    return verdict_on(assembly, asked)


def verdict_on(assembly: Assembly, asked: Question) -> Verdict:
    """The verdict on bodies with stand-in shapes, without warnings about these shapes.

    At the level equilibrium, only forces are sought: small pushes and other motions, which take ten
    times longer, are not examined, and the verdict does not claim more.
    """
    if asked.require == "equilibrium":
        verdict = check_equilibrium(assembly, contacts(assembly))
        verdict = replace(verdict, require=asked.require)
        if verdict.level not in (None, asked.require):
            verdict = replace(
                verdict, verdict=VerdictWord.POTENTIALLY_STABLE, own_sentence=ONLY_FORCES
            )
    else:
        verdict = check(
            assembly, require=asked.require, effort=asked.effort, time_limit=asked.seconds_left
        )
    shapes = {*remarks(assembly, verdict.contact_set), *loose_parts(assembly, verdict.contact_set)}
    return replace(verdict, notes=tuple(note for note in verdict.notes if note not in shapes))


def stand_in(size: float, *, curved: bool) -> Shape:
    """The shape in place of that of a body: a cube or a ball with a circumscribed radius [m]."""
    return Sphere(size) if curved else Box(np.full(3, 2 * size / np.sqrt(3.0)))


@dataclass(frozen=True, slots=True, eq=False)
class ContactArrays:
    """Contacts of an engine, K points; the world frame, metres."""

    points: Array
    """Contact points, shape (K, 3)."""
    normals: Array
    """Normals from the first to the second body, shape (K, 3)."""
    mu: Array
    """Friction coefficients, shape (K,)."""
    bodies: Index
    """First and second body, shape (K, 2); from the number of moving bodies on, held bodies."""
    features: Sequence[tuple[Feature, Feature] | None] | None = None
    """Features of both bodies at each contact, if they are known."""

    def __post_init__(self) -> None:
        read_only(self)

    @staticmethod
    def of(points: Any, normals: Any, mu: Any, bodies: Any) -> ContactArrays:
        """Copies of arrays that a user gives.

        Raises `InputError` if a shape or a number is invalid.
        """
        at = _array(points, (None, 3), "points")
        count = len(at)
        across = _array(normals, (count, 3), "normals")
        if not across.any(axis=1).all():
            k = int(np.argmin(across.any(axis=1)))
            raise InputError(f"the normal of contact {k} is zero", hint="give its direction")
        if np.ndim(mu) == 0:
            mu = np.full(count, number(mu, "mu", lowest=0))
        friction = _array(mu, (count,), "mu")
        if (friction < 0).any():
            k = int(np.argmax(friction < 0))
            raise InputError(f"mu of contact {k} is {friction[k]:g}", hint="give 0 or more")
        ends = np.array(bodies)
        if not ends.size:
            ends = np.empty((0, 2), dtype=np.int64)
        if ends.dtype.kind not in "iu" or ends.shape != (count, 2):
            raise InputError(
                f"bodies is an array of {ends.dtype} of shape {ends.shape}",
                hint=f"give the indices of two bodies for each of {count} contacts",
            )
        return ContactArrays(at, across, friction, ends.astype(np.int64))

    def with_world(self, count: int) -> ContactArrays:
        """The contacts with the world, -1, as the body after `count` bodies."""
        return replace(self, bodies=np.where(self.bodies < 0, count, self.bodies))

    def require_bodies(self, count: int) -> None:
        """Raise an InputError if a contact names a body that does not exist, or one body twice."""
        wrong = ((self.bodies < -1) | (self.bodies >= count)).any(axis=1)
        wrong |= self.bodies[:, 0] == self.bodies[:, 1]
        if wrong.any():
            k = int(np.argmax(wrong))
            raise InputError(
                f"contact {k} is of the bodies {self.bodies[k].tolist()}",
                hint=f"give two different numbers from -1, the world, to {count - 1}",
            )

    def sizes(self, center: Array) -> Array:
        """Distance of the farthest contact from the centre of mass of each body, shape (B,) [m].

        Bodies without such a distance have that of the largest body, or 1 m.
        """
        sizes = np.zeros(len(center))
        for side in (0, 1):
            ends = self.bodies[:, side]
            rows = np.flatnonzero((ends >= 0) & (ends < len(center)))
            body = self.bodies[rows, side]
            np.maximum.at(sizes, body, np.linalg.norm(self.points[rows] - center[body], axis=1))
        largest = float(sizes.max(initial=0.0)) or 1.0
        return np.where(sizes > NO_SIZE * largest, sizes, largest)

    @property
    def runs(self) -> Index:
        """First contact of each run of contacts with the same bodies, normal and friction."""
        same = (np.diff(self.bodies, axis=0) == 0).all(axis=1) & (np.diff(self.mu) == 0)
        same &= (np.diff(self.normals, axis=0) == 0).all(axis=1)
        if self.features is not None:
            pairs = zip(self.features[1:], self.features, strict=False)
            same &= np.array([after is before for after, before in pairs], dtype=bool)
        first: Mask = np.append(np.ones(min(len(self.mu), 1), dtype=bool), ~same[: len(self.mu)])
        return np.flatnonzero(first)

    def given(self, names: Sequence[str]) -> list[GivenContact]:
        """The contacts in their order, those of a run as one, between bodies with these names."""
        start = self.runs.tolist()
        ends = [*start[1:], len(self.mu)][: len(start)]
        features = self.features or [None] * len(self.mu)
        return [
            GivenContact(
                (names[self.bodies[k, 0]], names[self.bodies[k, 1]]),
                self.points[k:end],
                self.normals[k],
                mu=float(self.mu[k]),
                feature=features[k],
            )
            for k, end in zip(start, ends, strict=True)
        ]

    def assembly(
        self, parts: Sequence[Part], held: Sequence[str], more: Sequence[Part] = (), **entries: Any
    ) -> Assembly:
        """The assembly of parts that touch in these contacts only.

        Arguments: `parts`: in the order of the bodies; `held`: names of the held bodies after them;
        `more`: parts without contacts.
        """
        centers = np.array([part.pose.position for part in parts]).reshape(-1, 3)
        every = np.vstack([self.points, centers])
        middle = (every.min(axis=0) + every.max(axis=0)) / 2
        size = float(np.ptp(every, axis=0).max()) or 1.0
        box = Box(np.full(3, size))
        names = [*(part.name for part in parts), *held]
        fixed = [Part(name, box, middle, grounded=True) for name in held]
        return Assembly(
            [*parts, *more, *fixed], contacts=self.given(names), detect=False, **entries
        )


def _array(values: Any, shape: tuple[int | None, ...], what: str) -> Array:
    """A float array of the given shape (None: any length).

    Raises `InputError` for another shape, or for numbers that are not finite.
    """
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{what} is {values!r:.60}", hint="give an array of numbers") from None
    if not array.size and shape[0] in (None, 0):
        array = array.reshape(0, *(size or 0 for size in shape[1:]))
    fits = array.ndim == len(shape)
    if not fits or any(n is not None and n != m for n, m in zip(shape, array.shape, strict=True)):
        wanted = ", ".join("n" if size is None else str(size) for size in shape)
        raise InputError(f"{what} has shape {array.shape}", hint=f"give ({wanted})")
    if not np.isfinite(array).all():
        raise InputError(f"{what} has a number that is not finite", hint="give finite numbers")
    return array
