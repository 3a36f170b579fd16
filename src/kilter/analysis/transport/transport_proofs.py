"""Proofs of acceleration limits, as data that anyone can verify.

The assembly feels a share of a motion of its carrier as another gravity and, if the carrier turns,
as further loads. Just within a limit forces hold it, just beyond a motion starts; both are as near
to the limit as they are proved.

A collapse multiplier is the limit of the opposite acceleration. Its statement also has the
participating mass M* of the mechanism, which `kilter.verify` recomputes from the motion.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from kilter.analysis.load_limit import Limit
from kilter.analysis.margins.margin_answer import changed_proof
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.turning_tolerances import AROUND_LIMIT
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import InputError

__all__ = ["ALPHA", "CARRIER", "carried_change", "participating_mass", "transport_proofs"]

ALPHA = "alpha "
"""Start of the name of a collapse multiplier in a proof file."""
SAME_MECHANISM = 1e-6
"""Relative difference of participating masses up to which a motion is the same mechanism [-]."""
About = tuple[dict[str, Any], dict[str, Any]]


def transport_proofs(
    assembly: Assembly,
    contacts: ContactSet,
    motions: Iterable[tuple[str, CarrierMotion, Limit, float | None]],
    weaker: Mapping[str, float],
    *,
    options: dict[str, Any],
) -> list[About]:
    """Proofs just below and just beyond the limit of each carrier motion, as data.

    Unlimited motions have none.

    Arguments: `motions`: name, motion, the largest factor of the motion, and the participating mass
    of a collapse multiplier; `weaker`: further change of the file with which the limits were
    computed: a factor on every friction coefficient.
    """
    proofs = []
    for name, motion, limit, mass in motions:
        if not np.isfinite(limit.value):
            continue
        for held in (True, False):
            sides = _near_limit(assembly, contacts, motion, limit, held, weaker, options)
            nearest = next(sides, None)
            if nearest is None:
                continue
            about, data = nearest
            if mass is not None and not held:
                for side in (nearest, *sides):  # the nearest motion may be another mechanism
                    stated = participating_mass(
                        assembly, np.asarray(motion.acceleration), side[1]["motion"]
                    )
                    if abs(stated - mass) <= SAME_MECHANISM * mass:
                        about, data = side
                        about["participating_mass"] = stated
                        break
            given = {key: np.asarray(getattr(motion, key)).tolist() for key in CARRIER}
            proofs.append(({"about": name, **about, "motion": given}, data))
    return proofs


def _near_limit(
    assembly: Assembly,
    contacts: ContactSet,
    motion: CarrierMotion,
    limit: Limit,
    held: bool,
    weaker: Mapping[str, float],
    options: dict[str, Any],
) -> Iterator[About]:
    """Yield statements with proofs on one side of a limit, the nearest first."""
    mechanism = None if held else limit.motion
    for step in AROUND_LIMIT:
        share = limit.value + (-step if held else step) * max(abs(limit.value), 1.0)
        change = carried_change(assembly, motion, share)
        if change is not None:
            change |= weaker
            data = changed_proof(assembly, contacts, change, held, mechanism, options)
            if data is not None:
                yield {"value": share, "held": held, "change": change}, data


def participating_mass(
    assembly: Assembly, acceleration: Array, mechanism: Mapping[str, list[float]]
) -> float:
    """Participating mass M* [kg] of a motion in a proof, under the forces of an acceleration.

    It is 0 for a motion without displacement along the forces.
    """
    parts = zip(assembly, assembly.geometry.mass, strict=True)
    known = [(m, mechanism[part.name][:3]) for part, m in parts if part.name in mechanism]
    mass = np.array([m for m, _ in known])
    shift = np.array([velocity for _, velocity in known]).reshape(-1, 3) @ acceleration
    return float((mass @ shift) ** 2 / (mass @ shift**2)) if shift.any() else 0.0


CARRIER = ("acceleration", "angular_velocity", "angular_acceleration", "about")
"""Names of the vectors of a carrier motion."""


def carried_change(
    assembly: Assembly, motion: CarrierMotion, share: float
) -> dict[str, Any] | None:
    """Change of a file to the gravity and loads at a fraction of a carrier motion.

    None in free fall.
    """
    spin = np.sqrt(max(share, 0.0)) * np.asarray(motion.angular_velocity)
    part = CarrierMotion(
        share * np.asarray(motion.acceleration),
        spin,
        share * np.asarray(motion.angular_acceleration),
        motion.about,
    )
    try:
        felt = carried_assembly(assembly, part)
    except InputError:
        return None
    change: dict[str, Any] = {"gravity": felt.gravity.tolist()}
    if part.turns:
        change["loads"] = [
            {
                "part": load.part,
                "force": load.force.tolist(),
                "torque": load.torque.tolist(),
                "point": None if load.point is None else load.point.tolist(),
            }
            for load in felt.loads
        ]
    return change
