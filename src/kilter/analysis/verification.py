"""Verify proof files against the assembly: which level do their numbers prove?

The assembly is read and its contacts are detected anew, and both are compared with the proof number
by number. Forces and motions of the proof are tested again (`kilter.mechanics.recheck`), and the
steps that exclude every motion with friction are repeated (`kilter.friction.exclusion_file`), all
without any solver. The level settles has no proof, since it is the result of a search: its tries
and its search for a motion are repeated. A statement that is not recomputed is not part of the
result; `docs/explanation/proofs.md` lists them.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

from kilter.analysis.assumptions.proved_poses import at_poses
from kilter.analysis.limit_check import LIMITS, limit_notes, wrong_limits
from kilter.analysis.placing.place_check import require_place_form, wrong_places
from kilter.analysis.planning.hold.hold_check import wrong_hold, wrong_lashing
from kilter.analysis.planning.order.order_check import wrong_order
from kilter.analysis.planning.plan_proof_form import (
    require_hold_form,
    require_lashing_form,
    require_plan_form,
)
from kilter.analysis.range_proofs import range_notes, require_range_form, wrong_ranges
from kilter.analysis.regions.region_check import REGION, region_notes, wrong_region
from kilter.analysis.settled_pose.rest_proof import (
    at_closed_points,
    is_proof_of_rest,
    open_point_objections,
)
from kilter.assembly import Assembly, require_assembly
from kilter.assembly.assembly import end_words, with_ends_of
from kilter.assembly.assumption import DRAWN
from kilter.assembly.question import plain_joints
from kilter.contact import ContactSet, Tolerance, contacts
from kilter.contact.fits.fastening import fasten_as_read, with_decided_pairs
from kilter.errors import InputError
from kilter.files.file_content import read_json
from kilter.files.own.choices import digest, find_choices
from kilter.files.own.saved_entries import valid_entries, with_interactions
from kilter.files.reading import Reading
from kilter.friction.exclusion_file import recheck_exclusion
from kilter.mechanics.bundle import apply_change, is_bundle, split_bundle, subject_mismatch
from kilter.mechanics.bundle_changes import restored
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import digest_of
from kilter.mechanics.proof_form import Form, MalformedProof, require, require_form
from kilter.mechanics.recheck import proof_forces, recheck
from kilter.second_order.proofs.push_recheck import rests_without_friction, wrong_about_push
from kilter.second_order.proofs.second_order_recheck import recheck_second_order
from kilter.tell.levels import holds as holds_at
from kilter.tell.levels import level_of, level_rank, require_level
from kilter.tell.record import AnswerInWords, UnitWord
from kilter.values.guesses import guarded

NEEDS_FORCES = "its second order needs a proof by forces without friction"
"""Objection to second-order proofs of clusters that only friction holds."""


class Verification(AnswerInWords, kw_only=False):
    """Result of the verification of a proof: the level that it proves, and its errors."""

    answer: ClassVar[str] = "verify"

    holds: bool
    """Whether the proof holds at the required level."""
    verdict: str
    """The statement of the proof: a verdict, or the kind of a bundle of proofs."""
    level: str | None
    """Level that was recomputed, of a bundle the lowest of its states that stay.

    It is null for a motion, and without a valid proof.
    """
    claimed: str | None
    """Level that the file claims; null if it claims that the assembly falls."""
    require: str | None
    """The required level; null: the claimed level."""
    reasons: tuple[str, ...]
    """Reasons why the proof does not hold; empty if it holds."""
    residual: float | None
    """Largest imbalance of a part over its weight [-]; null without forces."""
    power: float | None
    """Power of the motion if its fastest part moves at 1 m/s [W]; null without a motion."""
    notes: tuple[str, ...]
    """Further verified statements, and statements that a proof file cannot prove."""
    held: tuple[str, ...]
    """Names of the held parts."""
    gravity: tuple[float, float, float]
    """Gravity [m/s^2]."""
    units: UnitWord
    """Length unit of the assembly."""
    options: Mapping[str, Any]
    """Options with which the file was read for the proof."""
    tolerance: Mapping[str, float | None]
    """Tolerances of contact detection."""

    def __repr__(self) -> str:
        lower = f"only {self.level} is proved" if self.level and not self.reasons else ""
        return (
            f"<Verification: {self.verdict}, {'holds' if self.holds else lower or 'does not hold'}>"
        )

    def __bool__(self) -> bool:
        raise TypeError("a verification is neither true nor false: use .holds")


@guarded
def verify(
    assembly: Assembly | str | Path,
    proof: dict[str, Any] | str | Path,
    *,
    require: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> Verification:
    """Verify a proof against the assembly: recompute the level that it proves.

    `kilter.check` computes a verdict and its proof; this function needs no solver, except that it
    repeats the search of a claim that the assembly settles.

    Parameters
    ----------
    assembly : Assembly or path
        A file is read with the options of the proof: held parts, omitted parts, gravity. An
        assembly is used unchanged.
    proof : dict or path
        The result of `Verdict.proof`, `Region.proof`, `Margin.proof`, `Order.proof` or
        `Fixture.proof`, or a file that the option ``--proof`` of their commands wrote.
    require : {"equilibrium", "settles", "proved", "strict"}, optional
        Level that the proof must reach to hold; by default the level that it claims.
    progress : callable, optional
        Function that is called with the name of each stage.

    Returns
    -------
    Verification

    Raises
    ------
    InputError
        If a file cannot be read, if the data do not have the form of a proof, or if the level does
        not exist.

    See Also
    --------
    kilter.load_answer : reads an answer, without a proof.
    kilter.check : the verdict that gives the proof.

    Examples
    --------
    >>> from kilter.analysis.check import check
    >>> from kilter.scenes import example
    >>> verdict = check(example("tower"))
    >>> verify(example("tower"), verdict.proof())
    <Verification: stable, holds>
    >>> verify(example("staircase"), verdict.proof()).holds
    False
    """
    tell = progress or (lambda stage: None)
    if require is not None:
        require_level(require, strict=True)
    data, file = proof, None
    if isinstance(proof, str | os.PathLike):
        file = os.fspath(proof)
        data = read_json(Path(proof))
    try:
        several = isinstance(data, dict) and is_bundle(data)
        # all proofs of a bundle share options and tolerances, so the first supplies them
        first = next(split_bundle(data))[1] if several else data
        require_form(first)
        assert isinstance(first, dict)
        assert isinstance(data, dict)
        tolerance = proof_tolerance(first)
        known = None
        if isinstance(assembly, str | os.PathLike):
            tell("reading")
            reading = Reading.from_options(first["options"])
            choices = find_choices(assembly)
            path = Path(assembly) if choices is None else choices.path
            if reading.entries.get("sha256") not in (None, _digest(path)):
                return _of_another_file(first, path, require)
            assembly = reading.read(assembly if choices is None else path)
            assembly, known = fasten_as_read(
                assembly, reading, tolerance=tolerance, progress=progress
            )
        else:
            require_assembly(assembly, "verify")
            assembly = _as_assumed(assembly, first["options"])
        require_assembly(assembly, "verify")
        if not several and is_proof_of_rest(first):
            return _verify_rest(assembly, first, require, progress)
        touching = known or contacts(assembly, tolerance=tolerance, progress=progress)
        recompute = verify_bundle if several else verify_proof
        result = recompute(assembly, touching, data, require=require)
        if tolerance == (assembly.tolerance or Tolerance()):
            return result
        return replace(result, notes=(OTHER_TOLERANCE, *result.notes))
    except InputError as error:
        raise error.located(file=file) from None


def _verify_rest(
    assembly: Assembly,
    proof: dict[str, Any],
    require: str | None,
    progress: Callable[[str], None] | None,
) -> Verification:
    """Verify a proof that a pose is at rest: its points are closed, and its forces balance."""
    if progress is not None:
        progress("gaps at the points of the proof")
    listed = at_closed_points(assembly, proof)
    result = verify_proof(listed, contacts(listed), proof, require=require)
    objections = open_point_objections(assembly, proof)
    gap = f"{proof['rest']['gap']:.3g} {assembly.units}"
    note = f"at rest: {len(proof['points'])} points closed to {gap}, no deeper overlap"
    return replace(
        result,
        holds=result.holds and not objections,
        level=None if objections else result.level,
        reasons=(*objections, *result.reasons),
        notes=result.notes if objections else (note, *result.notes),
    )


def _as_assumed(assembly: Assembly, options: Mapping[str, Any]) -> Assembly:
    """An assembly with the poses, joints and decided pairs of the rung of a proof."""
    if options.get("assume") != DRAWN:
        return assembly
    entries = valid_entries(options.get("entries", {}))
    moved = at_poses(assembly, entries.get("poses", {}))
    joined = {frozenset(joint.parts) for joint in moved.joints}
    new = [entry for entry in entries.get("joints", ()) if frozenset(entry["parts"]) not in joined]
    return with_decided_pairs(
        with_interactions(moved, {"joints": new} if new else {}), entries.get("open_pairs", ())
    )


def _digest(path: Path) -> str | None:
    """Digest of a file; None if it does not exist, so that reading it reports the error."""
    return digest(path) if path.exists() else None


def _of_another_file(proof: Mapping[str, Any], path: Path, require: str | None) -> Verification:
    """Failed verification of a proof that was made for an older version of the file."""
    reason = f"the proof is about another version of {path.name} (its sha256 differs)"
    return Verification(
        False,
        proof["verdict"],
        None,
        level_of(proof["verdict"]),
        require,
        (reason,),
        None,
        None,
        (),
        held=tuple(part["name"] for part in proof["parts"] if part["grounded"]),
        gravity=tuple(proof["gravity"]),
        units=str(proof.get("units", "")),
        options=proof["options"],
        tolerance=proof["tolerance"],
    )


def proof_tolerance(proof: dict[str, Any]) -> Tolerance:
    """The contact tolerance with which a proof was made, from the proof's data.

    Raises `InputError` if the data do not have the form of a proof.
    """
    require_form(proof)
    values = proof["tolerance"]
    return Tolerance(
        gap=values["gap"],
        relative_gap=values["relative_gap"],
        angle=values["angle"],
        clearance=values.get("clearance"),
    )


def verify_bundle(
    assembly: Assembly,
    contacts: ContactSet,
    bundle: dict[str, Any],
    *,
    require: str | None = None,
) -> Verification:
    """Recompute every proof in the file of a region, a margin, a plan or a fixture.

    The residual is the largest of all proofs, the power is the least.

    Raises `InputError` if an entry does not have the form of a proof.
    """
    reasons, residual, power, counts = [], [], [], Counter[str]()
    if bundle.get("digest") != digest_of(bundle):
        reasons.append(
            "the proof file was changed after kilter wrote it (its digest does not match)"
        )
    proof: dict[str, Any] = {}
    verdicts, levels = [], []
    assembly = plain_joints(assembly, str(bundle.get("kind")))
    for about, proof in split_bundle(bundle):
        subject = about["about"]
        other, touching = apply_change(assembly, contacts, about["change"])
        result = _verify_proof(other, touching, proof, require="equilibrium")
        wrong = [*result.reasons, *filter(None, [subject_mismatch(about, proof)])]
        of = next((about[key] for key in ("part", "parts", "vector", "value") if key in about), "")
        reasons += [f"{subject} {of}: {reason}" for reason in wrong]
        counts[f"{subject}: {'held by forces' if 'forces' in proof else 'a motion starts'}"] += 1
        residual += [] if result.residual is None else [result.residual]
        power += [] if result.power is None else [result.power]
        verdicts.append(proof["verdict"])
        if "forces" in proof:
            levels.append(result.level)
    together, notes = _judged_together(assembly, contacts, restored(bundle), verdicts)
    reasons += together
    level = min(levels, key=level_rank, default=None)
    return Verification(
        not reasons and (require is None or holds_at(level, require)),
        bundle["kind"],
        None if reasons else level,
        level,
        require,
        tuple(reasons),
        max(residual, default=None),
        min(power, default=None),
        (*notes, *(f"{count} x {statement}" for statement, count in counts.items())),
        **_circumstances(assembly, proof),
    )


def _of_form(form: Form) -> Callable[[Mapping[str, Any], Sequence[str]], None]:
    """Function that rejects statements of another form, whatever the names of the parts are."""
    return lambda bundle, names: require(form, bundle)


JUDGES: dict[str, tuple[Callable[..., None], Callable[..., Iterable[str]]]] = {
    "region": (_of_form(REGION), wrong_region),
    "margin": (_of_form(LIMITS), wrong_limits),
    "transport": (_of_form(LIMITS), wrong_limits),
    "plan": (require_plan_form, wrong_order),
    "hold": (require_hold_form, wrong_hold),
    "lashing": (require_lashing_form, wrong_lashing),
    "place": (require_place_form, wrong_places),
    "ranges": (require_range_form, wrong_ranges),
}
"""For each kind of bundle: the form of its statements, and the reasons why valid proofs do not
support the statement of the file: a region, limits, a plan, a fixture, a lashing, a map."""
NOTES: dict[str, Callable[..., Iterable[str]]] = {
    "region": region_notes,
    "margin": limit_notes,
    "transport": limit_notes,
    "ranges": range_notes,
}
"""For some kinds of bundle: the statement that was recomputed, in words."""


def _judged_together(
    assembly: Assembly, contacts: ContactSet, bundle: Mapping[str, Any], verdicts: Sequence[str]
) -> tuple[list[str], list[str]]:
    """Reasons why proofs that are valid one by one do not prove the statement of the file; notes.

    Raises `InputError` if the data of the statement do not have the required form.
    """
    require_statements, judge = JUDGES[bundle["kind"]]
    try:
        require_statements(bundle, assembly.names)
    except MalformedProof as error:
        raise InputError(
            f"the proof of a {bundle['kind']} does not have the required form ({error})",
            hint="write it again with --proof",
        ) from None
    reasons = list(judge(assembly, contacts, bundle, verdicts))
    notes = NOTES.get(bundle["kind"])
    return reasons, [] if notes is None or reasons else list(notes(assembly, contacts, bundle))


def verify_proof(
    assembly: Assembly,
    contacts: ContactSet,
    proof: dict[str, Any],
    *,
    require: str | None = None,
) -> Verification:
    """Recompute a single proof from an assembly and its contacts.

    Raises `InputError` if keys of the proof are missing or have the wrong type.
    """
    require_form(proof)
    return _verify_proof(assembly, contacts, proof, require=require)


def _verify_proof(
    assembly: Assembly, contacts: ContactSet, proof: dict[str, Any], *, require: str | None
) -> Verification:
    """Recompute a single proof of the right form, as `verify_proof`."""
    named = with_ends_of(assembly, proof.get("straps", []))
    ends = end_words(assembly, named)
    assembly, contacts = named, contacts.of(named)
    result = recheck(assembly, contacts, proof)
    reasons, notes = list(result.reasons), [*result.notes, *ends]
    friction = proof.get("friction")
    program = build_program(assembly, contacts)
    if not reasons and friction is not None and friction["guarantee"] == "proved":
        more, also = recheck_exclusion(program, friction["exclusion"])
        reasons, notes = reasons + more, notes + also
    second = proof.get("second_order")
    if not reasons and second is not None:
        reasons = _wrong_second_order(assembly, contacts, program, proof)
        notes += [] if reasons else [f"second order: {second['state']}"]
    claimed = level_of(proof["verdict"])
    level = None if reasons else claimed
    if not reasons and "forces" in proof:
        rough = program if friction is not None else program.frictionless
        forces, _, _ = proof_forces(rough, proof)
        question = (assembly, contacts, rough, forces, proof["verdict"], second)
        beyond = wrong_about_push(*question, curves=friction is None)
        if beyond and claimed == "equilibrium":
            reasons, level = beyond, None
        elif beyond:
            level, notes = "equilibrium", [*notes, *beyond]
    if level == "proved" and second is not None and second["state"] in STRICT:
        level = "strict"
    if level == "settles":
        level, note = "equilibrium", CLAIMED
        if require in (None, "settles"):
            level, note = _settles_again(program)
        notes.append(note)
    needed = claimed if require is None else require
    return Verification(
        not reasons and (needed is None or holds_at(level, needed)),
        proof["verdict"],
        level,
        claimed,
        require,
        tuple(reasons),
        result.residual,
        result.power,
        tuple(notes),
        **_circumstances(assembly, proof),
    )


def _wrong_second_order(
    assembly: Assembly, contacts: ContactSet, program: Program, proof: dict[str, Any]
) -> list[str]:
    """Reasons why the statement of second order does not hold."""
    second = proof["second_order"]
    if "forces" not in proof:
        return [NEEDS_FORCES]
    reasons = recheck_second_order(assembly, contacts, program.frictionless, second)
    if reasons or proof.get("friction") is None:
        return reasons
    forces, _, _ = proof_forces(program, proof)
    rest = rests_without_friction(assembly, contacts, program, forces, second)
    return [] if rest else [NEEDS_FORCES]


def _circumstances(assembly: Assembly, proof: Mapping[str, Any]) -> dict[str, Any]:
    """Fields of an answer: the held parts, gravity, units, options and tolerances."""
    return {
        "held": tuple(part.name for part in assembly if part.grounded),
        "gravity": tuple(assembly.gravity.tolist()),
        "units": assembly.units,
        "options": proof["options"],
        "tolerance": proof["tolerance"],
    }


STRICT = ("minimum", "free")
"""States of second order with which a stable assembly reaches the level strict."""
OTHER_TOLERANCE = "the tolerance of contacts is that of the file of the proof, not the default"
"""Note about a premise that whoever made the proof chose."""
CLAIMED = "settles is claimed by the file: its tries are not repeated at the required level"
"""Note about a claim that is not recomputed."""


def _settles_again(program: Program) -> tuple[str, str]:
    """Repeat the tries and the search of the level settles; return the level and a note."""
    # imported late: only the search needs a solver
    from kilter.friction.answer import ask_friction

    answer = ask_friction(program, enough="settles")
    tries = f"{len(answer.tries)} of {answer.settling.of} tries come to rest when repeated"
    if answer.guarantee == "refuted":
        return "equilibrium", f"{tries}; a motion obeys Coulomb's law too"
    if answer.settles:
        return "settles", f"{tries}, and the search finds no motion; there is no proof of either"
    return "equilibrium", f"settles is claimed by the file: {tries}"
