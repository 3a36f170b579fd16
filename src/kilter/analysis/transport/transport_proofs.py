"""Proofs of acceleration limits, as data that anyone can verify.

The assembly feels a share of a motion of its carrier as another gravity and, if the carrier turns,
as further loads. Just within a limit forces hold it, just beyond a motion starts; both are as near
to the limit as they are proved.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from kilter.analysis.margins.load_limit import Limit
from kilter.analysis.margins.margin_proofs import changed_proof
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.turning_tolerances import AROUND_LIMIT
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import InputError

__all__ = ["CARRIER", "carried_change", "transport_proofs"]

About = tuple[dict[str, Any], dict[str, Any]]


def transport_proofs(
    assembly: Assembly,
    contacts: ContactSet,
    motions: Iterable[tuple[str, CarrierMotion, Limit]],
    weaker: Mapping[str, float],
    *,
    options: dict[str, Any],
) -> list[About]:
    """Proofs just below and just beyond the limit of each carrier motion, as data.

    Unlimited motions have none.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    motions : iterable of (str, CarrierMotion, Limit)
        Name, motion, and the largest factor of the motion.
    weaker : mapping
        Further change of the file with which the limits were computed: a factor on every friction
        coefficient.
    options : dict
        Options with which the file was read.
    """
    proofs = []
    for name, motion, limit in motions:
        if not np.isfinite(limit.value):
            continue
        for held in (True, False):
            sign = -1.0 if held else 1.0
            mechanism = None if held else limit.mechanism
            for step in AROUND_LIMIT:
                share = limit.value + sign * step * max(abs(limit.value), 1.0)
                change = carried_change(assembly, motion, share)
                data = None
                if change is not None:
                    change |= weaker
                    data = changed_proof(assembly, contacts, change, held, mechanism, options)
                if data is not None:
                    about = {"about": name, "value": share, "held": held, "change": change}
                    about["motion"] = {
                        key: np.asarray(getattr(motion, key)).tolist() for key in CARRIER
                    }
                    proofs.append((about, data))
                    break
    return proofs


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
