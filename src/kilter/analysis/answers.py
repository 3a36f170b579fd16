"""Answers as JSON data: the shapes that scripts rely on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.mechanics.certificate import ForceProof

if TYPE_CHECKING:
    from kilter.analysis.check import Verdict
    from kilter.analysis.contact_forces import ContactForces
    from kilter.assembly import Assembly
    from kilter.contact import ContactSet

__all__ = ["check_answer", "contacts_answer", "joints_answer"]


def check_answer(verdict: Verdict) -> dict[str, Any]:
    """The answer of `kilter check --json`."""
    assembly, contacts = verdict.assembly, verdict.contacts
    neutral, found = verdict.neutral, verdict.displacement
    proof = verdict.certificate
    kind = None if proof is None else "forces" if isinstance(proof, ForceProof) else "motion"
    forces, motion = verdict.judgement.forces, verdict.judgement.motion
    return {
        "verdict": verdict.verdict,
        "guarantee": verdict.guarantee,
        "seated": verdict.seated,
        "sentence": verdict.sentence,
        "neutral": None
        if neutral is None
        else {"two_sided": neutral.two_sided, "one_sided": neutral.one_sided},
        "down": assembly.down.tolist(),
        "gravity": assembly.gravity.tolist(),
        "units": assembly.units,
        "instability": verdict.instability,
        "z": found.z,
        "parts": [_part(verdict, k) for k in range(len(assembly.parts))],
        "contacts": {
            "pairs": contacts.pairs,
            "patches": len(contacts),
            "points": len(contacts.points),
        },
        "unsupported": [
            {"parts": [assembly.names[k] for k in u.parts], "kind": u.kind, "point": list(u.point)}
            for u in contacts.unsupported
        ],
        "joints": joints_answer(assembly),
        "certificate": {
            "kind": kind,
            "residual": None if forces is None else forces.residual,
            "power": None if motion is None else motion.power,
        },
        "friction": _friction(verdict),
        "forces": None if verdict.forces is None else _forces(verdict, verdict.forces),
        "tolerance": {
            "gap": contacts.gap,
            "angle_deg": float(np.degrees(contacts.tolerance.angle)),
            "clearance": contacts.tolerance.clearance,
            "verdict": verdict.tolerance,
        },
        "warnings": [*verdict.warnings, *([verdict.barely] if verdict.barely else [])],
        "seconds": verdict.seconds,
    }


def joints_answer(assembly: Assembly) -> list[dict[str, Any]]:
    """Joints of an assembly, those that were fastened among them."""
    return [{"parts": list(joint.parts), "kind": joint.kind} for joint in assembly.joints]


def _part(verdict: Verdict, k: int) -> dict[str, Any]:
    part = verdict.assembly.parts[k]
    shift = verdict.displacement.displacement
    return {
        "name": part.name,
        "grounded": part.grounded,
        "mass": float(verdict.program.mass[k]),
        "displacement": None if shift is None else (shift[k] + 0.0).tolist(),
        "acceleration": (verdict.motion.acceleration[k] + 0.0).tolist(),
        "moves": bool(verdict.motion.moves[k]),
        "motion": verdict.words(k),
    }


def _friction(verdict: Verdict) -> dict[str, Any] | None:
    """How the guarantee came about, where the verdict rests on friction."""
    answer = verdict.friction
    if answer is None:
        return None
    witness, seating, exclusion = answer.witness, answer.seating, answer.exclusion
    return {
        "witness": None
        if witness is None
        else {"power": witness.law.power, "residual": witness.law.residual, "found": witness.found},
        "seating": {"seated": answer.seated, "residual": seating.residual},
        "exclusion": None
        if exclusion is None
        else {
            "proved": exclusion.proved,
            "kind": exclusion.kind,
            "programs": exclusion.programs,
            "bound": exclusion.bound,
            "assumes": exclusion.assumes,
        },
        "budget": verdict.budget,
        "seconds": answer.seconds,
    }


def _forces(verdict: Verdict, found: ContactForces) -> dict[str, Any]:
    """Forces of equilibrium, on the second part of each patch."""
    contacts, names = verdict.contacts, verdict.assembly.names
    rows = np.argsort(found.patch_of, kind="stable")
    ends = np.cumsum(np.bincount(found.patch_of, minlength=len(found.patch)))
    points = verdict.program.point[found.rows]
    patches = []
    for k, own in enumerate(np.split(rows, ends[:-1]) if len(ends) else []):
        patch = found.patch[k]
        presses, rubs = np.isfinite(found.center[k]).all(), np.isfinite(found.utilisation[k])
        patches.append(
            {
                "parts": [names[i] for i in contacts.patch_parts[patch]],
                "kind": str(contacts.patch_kind[patch]),
                "resultant": found.resultant[k].tolist(),
                "normal_force": float(found.normal_force[k]),
                "center": found.center[k].tolist() if presses else None,
                "utilisation": float(found.utilisation[k]) if rubs else None,
                "points": points[own].tolist(),
                "forces": (found.force[own] + 0.0).tolist(),
            }
        )
    return {"least": found.least, "residual": found.residual, "patches": patches}


def contacts_answer(assembly: Assembly, contacts: ContactSet) -> dict[str, Any]:
    """The answer of `kilter contacts --json`."""
    names = assembly.names
    edges = [None if np.isinf(e) else float(e) for e in contacts.gap_edges]
    return {
        "units": assembly.units,
        "patches": [
            {
                "parts": [names[i] for i in contacts.patch_parts[k]],
                "kind": str(contacts.patch_kind[k]),
                "area": float(contacts.patch_area[k]),
                "gap": float(contacts.patch_gap[k, np.abs(contacts.patch_gap[k]).argmax()]),
                "gap_range": contacts.patch_gap[k].tolist(),
                "normal": contacts.patch_normal[k].tolist(),
                "mu": float(contacts.patch_mu[k]),
                "points": contacts.points[
                    contacts.patch_start[k] : contacts.patch_start[k + 1]
                ].tolist(),
            }
            for k in range(len(contacts))
        ],
        "unsupported": [
            {"parts": [names[i] for i in u.parts], "kind": u.kind, "point": list(u.point)}
            for u in contacts.unsupported
        ],
        "rejected": [
            {
                "parts": [names[i] for i in r.parts],
                "gap": r.gap,
                "angle_deg": float(np.degrees(r.angle)),
                "why": r.why,
            }
            for r in contacts.rejected
        ],
        "overlaps": [
            {
                "parts": [names[i] for i in o.parts],
                "volume": o.volume,
                "depth": o.depth,
                "why": o.why,
            }
            for o in contacts.overlaps
        ],
        "joints": joints_answer(assembly),
        "histogram": {"edges": edges, "counts": contacts.gap_counts.tolist()},
        "tolerance": {
            "gap": contacts.gap,
            "angle_deg": float(np.degrees(contacts.tolerance.angle)),
            "clearance": contacts.tolerance.clearance,
        },
        "warnings": [*assembly.notes, *assembly.geometry.warnings, *contacts.warnings],
    }
