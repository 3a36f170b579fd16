"""Proofs of ranges of contact forces, as a file that is recomputed without a solver.

An end of a range has two sides. The forces of an equilibrium attain its value. A motion p of the
free parts bounds it: for all forces f that balance the load w,

    c.f = (c + J p).f + w.p <= w.p + sum over rows of f_max (v_n + mu |v_t|)+,  v = c + J p

since forces in Coulomb's cones gain nothing from a v in the polar cones. The sum takes in what the
motion misses by rounding, for forces up to `MOST` weights of the free parts at each row.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kilter.analysis.analysis_tolerances import RANGE_AGREES
from kilter.analysis.decision.judge import judge
from kilter.analysis.force_ranges import MOST, ForceRange, gain_of, rows_between
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import InputError
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.certificate import check_forces
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import Evidence, make_proof
from kilter.mechanics.proof_form import (
    NUMBER,
    SIX,
    VECTOR,
    every,
    keys,
    list_of,
    named,
    nullable,
    one_of,
    require,
)
from kilter.tell.numbers import number, vector
from kilter.units import metres_per_unit

Entry = Mapping[str, Any]
UNIT = 1e-9
"""Largest error of the length of an axis [-]."""
SENSE = {"least": -1, "greatest": 1}
"""Sign of the value that each end makes as large as possible."""
ABOUT = ("parts", "along", "moment")
"""Keys of an entry that state its force or moment."""
FORM = keys(
    about=one_of(*SENSE),
    along=nullable(VECTOR),
    moment=nullable(VECTOR),
    value=NUMBER,
    bound=NUMBER,
    bounding=named(SIX),
)
"""Keys of an entry in a file of ranges; its parts depend on the assembly."""


def make_range_proofs(
    assembly: Assembly,
    contacts: ContactSet,
    ranges: Sequence[ForceRange],
    options: Mapping[str, Any],
) -> dict[str, Any]:
    """JSON data of the proofs of all ends that have two sides.

    Raises `InputError` if no end has both sides: for example if all ranges are without limits.
    """
    program = build_program(assembly, contacts)
    evidence = Evidence("open") if program.mu.any() else None
    others, proofs = judge(program).forces, []
    ends = [(one, word, getattr(one, word)) for one in ranges for word in SENSE]
    for one, word, end in ends:
        if others is None or end.evidence is None or end.value is None or end.bound is None:
            continue
        forces, friction = others.forces.copy(), others.friction.copy()
        motion = np.zeros((len(program.names), 6))
        for piece in end.evidence:
            forces[piece.rows], friction[piece.rows] = piece.forces.forces, piece.forces.friction
            motion += piece.motion
        statement = {
            "about": word,
            **{key: value for key, value in one.to_dict().items() if key in ABOUT},
            "value": end.value,
            "bounding": {
                name: motion[k].tolist() for k, name in enumerate(program.names) if program.free[k]
            },
            "change": {},
        }
        statement["bound"] = bound_of(program, statement, motion)
        proof = check_forces(program, forces, friction)
        made = make_proof(assembly, contacts, program, proof, dict(options), evidence=evidence)
        proofs.append((statement, made))
    if not proofs:
        raise InputError("no range has a limit, so there is no proof to write")
    return make_bundle("ranges", proofs)


def bound_of(program: Program, entry: Entry, motion: Array) -> float:
    """The bound of the end [N or N m] that an entry states, by a motion (N, 6) of free parts."""
    sense, (gain, unit) = SENSE[entry["about"]], _gain(program, entry)
    along = np.einsum("ki,ki->k", gain, program.normal)
    across = gain - along[:, None] * program.normal
    opens = program.velocities(motion) + sense * along
    slips = program.slips(motion, np.arange(len(gain))) + sense * across
    rubs = program.mu * np.linalg.norm(slips, axis=1)
    missed = np.where(program.two_sided, np.abs(opens), np.maximum(opens + rubs, 0.0))
    most = MOST * float(program.weight[program.free].sum())
    power = float((program.load * motion)[program.free].sum())
    return sense * unit * (power + most * float((missed * program.arm).sum()))


def _gain(program: Program, entry: Entry) -> tuple[Array, float]:
    """Vector of each row whose product with its force counts, (K, 3), and its unit [N or N m]."""
    parts = tuple(program.names.index(name) for name in entry["parts"])
    along, moment = (
        None if entry[key] is None else np.array(entry[key]) for key in ("along", "moment")
    )
    gain = gain_of(program, rows_between(program, parts), parts, along, moment)
    return gain, 1.0 if moment is None else metres_per_unit(program.units)


def require_range_form(bundle: Entry, names: Sequence[str]) -> None:
    """Reject ranges in a proof file if an entry has a wrong key or type, or an unknown part.

    Raises `MalformedProof` with the first key that is wrong.
    """

    def parts(value: Any, place: str) -> str:
        two = isinstance(value, list) and len(value) == 2
        return list_of(one_of(*names), 2 if two else 1)(value, place)

    require(keys(proofs=list_of(every(FORM, keys(parts=parts)))), bundle)


def wrong_ranges(
    assembly: Assembly, contacts: ContactSet, bundle: Entry, verdicts: Sequence[str]
) -> Iterator[str]:
    """Yield the reasons why forces and motions do not prove the stated ends of ranges."""
    program = build_program(assembly, contacts)
    weight = float(program.weight[program.free].sum())
    for entry, verdict in zip(bundle["proofs"], verdicts, strict=True):
        name, sense = f"{entry['about']} of {' - '.join(entry['parts'])}", SENSE[entry["about"]]
        gain, unit = _gain(program, entry)
        near = RANGE_AGREES * weight * unit * max(float(np.abs(gain).max(initial=0.0)), 1.0)
        axes = [entry[key] for key in ("along", "moment") if entry[key] is not None]
        if len(axes) > 1 or any(abs(np.linalg.norm(axis) - 1) > UNIT for axis in axes):
            yield f"{name}: its axis is not a single unit vector"
        if verdict == "unstable" or entry["change"]:
            yield f"{name}: its forces are not those of the assembly"
            continue
        value = _value_of_forces(program, entry, bundle["common"]["points"])
        if abs(value - entry["value"]) > near:
            yield f"{name}: its forces have the value {number(value)}, not {entry['value']:.6g}"
        motion = np.zeros((len(program.names), 6))
        for k in np.flatnonzero(program.free).tolist():
            motion[k] = entry["bounding"].get(program.names[k], 0.0)
        bound = bound_of(program, entry, motion)
        if sense * (bound - entry["bound"]) > near:
            yield f"{name}: its motion bounds the force by {number(bound)} only"


def _value_of_forces(program: Program, entry: Entry, points: Sequence[Entry]) -> float:
    """The force [N] or moment [N m] that the contact forces of an entry add up to."""
    parts, total = entry["parts"], 0.0
    centre = program.center[program.names.index(parts[-1])]
    for point, force in zip(points, np.asarray(entry["proof"]["forces"]), strict=True):
        if not set(parts) <= set(point["parts"]):
            continue
        on_last = 1.0 if point["parts"][1] == parts[-1] else -1.0
        if entry["moment"] is not None:
            turned = np.cross(np.asarray(point["x"]) - centre, force)
            total += on_last * float(turned @ entry["moment"]) * metres_per_unit(program.units)
        elif entry["along"] is not None:
            total += on_last * float(force @ entry["along"])
        else:
            total += float(force @ point["normal"])
    return total


def range_notes(assembly: Assembly, contacts: ContactSet, bundle: Entry) -> Iterator[str]:
    """Yield each end in words: the value that forces attain, and the bound of its motion."""
    for entry in bundle["proofs"]:
        unit = "N" if entry["moment"] is None else "N m"
        value, bound = (f"{number(entry[side], 8)} {unit}" for side in ("value", "bound"))
        words = {"along": "along", "moment": "about"}
        axis = [f" {word} {vector(entry[key], 3)}" for key, word in words.items() if entry[key]]
        name = f"{entry['about']} of {' - '.join(entry['parts'])}{''.join(axis)}"
        yield f"{name}: {value}, and no forces up to {MOST:g} weights at a point pass {bound}"
