"""Pieces of the answer of `kilter.check`: counts, densities, the proof and tolerances."""

from __future__ import annotations

from typing import Literal

from kilter.assembly import Assembly
from kilter.assembly.mesh_surface import DEFAULT_DENSITY
from kilter.contact.contact_set import AppliedTolerance
from kilter.tell.record import Record


class Tries(Record):
    """Number of tries (parts put down loosely) that came to rest, and number of all tries."""

    passed: int
    """Number of tries that came to rest."""
    of: int
    """Number of all tries."""


class Density(Record):
    """Densities from which masses of free parts are computed."""

    given: tuple[float, float] | None
    """Range of the stated densities [kg/m^3]; null if no part uses them."""
    default: float | None
    """Density of the parts without mass and density [kg/m^3]; null if there are none."""


def density_of(assembly: Assembly) -> Density:
    """Densities from which the masses of the free parts of an assembly are computed."""
    free = [
        part.density for part in assembly.parts if not part.grounded and part.given_mass is None
    ]
    given = [density for density in free if density is not None]
    return Density(
        given=(min(given), max(given)) if given else None,
        default=DEFAULT_DENSITY if len(given) < len(free) else None,
    )


class ContactCounts(Record):
    """Numbers of touching pairs, contact patches and contact points."""

    pairs: int
    """Number of touching pairs of parts."""
    patches: int
    """Number of contact patches."""
    points: int
    """Number of contact points."""


class BondsNeeded(Record):
    """Least share of bond strength that suffices, and the pairs that fail first below it."""

    share: float
    """Least share of the strength [-]."""
    fail: tuple[tuple[str, str], ...]
    """Pairs of parts whose bonds fail first."""


class ProofErrors(Record):
    """Kind of the proof, and the numerical errors of the best forces and the best motion."""

    kind: Literal["forces", "motion"] | None
    """Kind of the proof; null without a proof."""
    residual: float | None
    """Largest imbalance of a part under the forces, over its weight [-]."""
    power: float | None
    """Power of the motion if its fastest part moves at 1 m/s [W]."""
    violation: float | None
    """Largest violation of the contacts by the motion [-]."""


class VerdictTolerance(AppliedTolerance):
    """Tolerances of contact detection and of the verdict."""

    verdict: float
    """Limit of the residual and of the power of a proof [-]: the largest of all parts."""
    moves: float
    """Smallest relative size of a motion that counts [-]."""
