"""Recheck of a proof of rest without a solver: gaps and normals of its points from the geometry.

The proof lists closed points with their forces. Each point must lie on the surfaces of both parts
to within the stated gap, with a normal that fits their faces and at most the friction of its pair;
no two parts may overlap deeper than the gap. The gap may be at most that of `closed_gap`. The
forces are then verified as in every other proof. A motion proves nothing about these points alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from kilter.analysis.settled_pose.rest_proof import closed_gap, closed_points, deepest_overlap
from kilter.assembly import Assembly, GivenContact
from kilter.contact.friction_coefficients import friction_coefficients
from kilter.errors import some_names
from kilter.mechanics.mechanics_tolerances import AGREES
from kilter.mechanics.proof_form import NUMBER

__all__ = ["at_closed_points", "is_proof_of_rest", "open_point_objections"]


def is_proof_of_rest(proof: Mapping[str, Any]) -> bool:
    """Whether a proof states that a pose is at rest on closed points."""
    rest = proof.get("rest")
    return isinstance(rest, Mapping) and not NUMBER(rest.get("gap"), "rest.gap")


def at_closed_points(assembly: Assembly, proof: Mapping[str, Any]) -> Assembly:
    """The assembly with the points of the proof as its only contacts."""
    given = [
        GivenContact(tuple(point["parts"]), [point["x"]], point["normal"], mu=point["mu"])
        for point in proof["points"]
    ]
    return replace(assembly, contacts=given, detect=False)


def open_point_objections(assembly: Assembly, proof: Mapping[str, Any]) -> list[str]:
    """Reasons why the points of a proof are not closed in this pose; empty if all are."""
    gap, most = float(proof["rest"]["gap"]), closed_gap(assembly)
    if "forces" not in proof:
        return ["a motion does not prove that a pose is at rest"]
    if not gap <= (1 + AGREES) * most:
        return [f"its gap is {gap:.3g} {assembly.units}; a point is closed up to {most:.3g}"]
    entries = proof["points"]
    names = [entry["parts"] for entry in entries]
    parts = np.array([[assembly.index_of(name) for name in pair] for pair in names], dtype=np.int64)
    points = np.array([entry["x"] for entry in entries], dtype=np.float64).reshape(-1, 3)
    normals = np.array([entry["normal"] for entry in entries], dtype=np.float64).reshape(-1, 3)
    apart, sound = closed_points(assembly.geometry, parts.reshape(-1, 2), points, normals, gap)
    objections = []
    if (apart > gap).any():
        k = int(apart.argmax())
        objections.append(
            f"a point of {some_names(names[k])} is {apart[k]:.3g} {assembly.units} from their "
            f"surfaces, more than {gap:.3g}"
        )
    if not sound.all():
        k = int(np.argmin(sound))
        objections.append(f"the normal at a point of {some_names(names[k])} fits no face there")
    mu = np.array([entry["mu"] for entry in entries], dtype=np.float64)
    rougher = mu > friction_coefficients(assembly, parts.reshape(-1, 2)) + AGREES
    if rougher.any():
        k = int(rougher.argmax())
        objections.append(f"a point of {some_names(names[k])} has more friction than its pair")
    _, fault = deepest_overlap(assembly, gap)
    return objections + ([fault] if fault else [])
