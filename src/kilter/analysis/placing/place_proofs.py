"""Proofs of places as data that anyone can verify.

A map has, for each corner of the masses and centres of the part (case) and each height, findings:

    top          the part whose top carries the part alone, or null for several tops
    low, high    the rectangle of centres of mass
    places       centres with forces that hold everything; the hull of the places stands, since the
                 balance is linear in the place
    motions      each excludes the centres of a half plane
    shares       on several tops without friction: forces and motions move with the part. Forces
                 keep to the contact about these shares of its weight
                 (`kilter.analysis.placing.moving_load`), and motions exclude polygons
                 (`kilter.analysis.placing.moving_contact`)

Areas of contact, heights and the touched tops follow from the assembly, so the file has none. A
part on a held top changes nothing in the assembly, so its proof without the part decides.

At a given place the proof is that of `kilter.check` for the assembly with the part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kilter.analysis.margins.margin_answer import changed_proof
from kilter.analysis.placing.case_maps import CaseMap
from kilter.analysis.placing.place_at import AtPlace
from kilter.analysis.placing.place_map import Finding, LevelMap
from kilter.analysis.placing.polygon_sets import rings_of
from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.contact import ContactSet
from kilter.errors import InputError
from kilter.files import kilter_json
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.certificate import ForceProof

__all__ = ["MapQuestion", "at_proof", "map_proof", "part_data"]

ALONE, PLACE = "assembly without the part", "place"
"""Subjects of the proofs of a map, and of a given place."""


@dataclass(frozen=True, slots=True, eq=False)
class MapQuestion:
    """Data of a map that its proof needs."""

    contacts: ContactSet
    domain: shapely.Geometry
    """Rectangle of the centres."""
    clear: float
    """Distance to parts beside the part [length unit]."""
    levels: tuple[LevelMap, ...]
    """Maps of all cases together."""
    maps: tuple[CaseMap, ...]


def at_proof(
    at: AtPlace, mass: tuple[float, float], center_within: float, options: dict[str, Any]
) -> dict[str, Any]:
    """The proof of the verdict at a place: of a case that falls, or of all cases of the part.

    Raises `InputError` if a verdict is undecided.
    """
    falling = [verdict for verdict in at.verdicts if verdict.verdict == "unstable"]
    proofs = []
    for verdict in falling[:1] or at.verdicts:
        part = verdict.assembly.parts[-1]
        change = {"part": part_data(part, verdict.assembly.units)}
        proofs.append(({"about": PLACE, "change": change}, verdict.proof(options=options)))
    data = {
        "part": part_data(at.part, at.worst.assembly.units),
        "mass": list(mass),
        "center_within": center_within,
    }
    return make_bundle("place", proofs, place=data)


def map_proof(
    assembly: Assembly,
    part: Part,
    question: MapQuestion,
    mass: tuple[float, float],
    center_within: float,
    options: dict[str, Any],
) -> dict[str, Any]:
    """The proof of a map of places.

    Raises `InputError` if the assembly without the part is undecided.
    """
    contacts = question.contacts
    alone = None
    for held in (True, False):
        alone = alone or changed_proof(assembly, contacts, {}, held, None, options)
    if alone is None:
        raise InputError("the assembly without the part is undecided, so the map has no proof")
    data = {
        "part": part_data(part, assembly.units),
        "mass": list(mass),
        "center_within": center_within,
        "clear": question.clear,
        "domain": [float(x) for x in question.domain.bounds],
        "levels": [
            {
                "height": level.height,
                "stands": rings_of(level.stands),
                "falls": rings_of(level.falls),
            }
            for level in question.levels
        ],
        "cases": [
            [
                {
                    "height": level.height,
                    "findings": [_finding_data(finding, assembly) for finding in level.findings],
                }
                for level in case.levels
            ]
            for case in question.maps
        ],
    }
    return make_bundle("place", [({"about": ALONE, "change": {}}, alone)], map=data)


def part_data(part: Part, units: str) -> dict[str, Any]:
    """An assembly file with a part alone."""
    return kilter_json.to_dict(Assembly([part], units=units))


def _finding_data(finding: Finding, assembly: Assembly) -> dict[str, Any]:
    carried = finding.carried
    moving = {}
    if finding.shares is not None:
        moving["shares"] = {assembly.names[k]: share for k, share in finding.shares.items()}
    return {
        "top": None if finding.top < 0 else assembly.names[finding.top],
        "low": finding.low.tolist(),
        "high": finding.high.tolist(),
        "places": [_place_data(place, proof) for place, proof in carried.points],
        "motions": [_over_largest(motion).tolist() for motion in carried.motions],
        **moving,
    }


def _place_data(place: Array, proof: ForceProof) -> dict[str, Any]:
    data: dict[str, Any] = {"at": place.tolist(), "forces": proof.forces.tolist()}
    if proof.friction.any():
        data["friction"] = proof.friction.tolist()
    return data


def _over_largest(motion: Array) -> Array:
    return motion / max(float(np.abs(motion).max(initial=0.0)), 1e-300)
