"""Proofs recomputed: the file read anew, its contacts found anew, and no solver.

Both are held against the proof number by number, and its forces and motions are judged
again (`kilter.mechanics.recheck`); the steps that exclude every motion are repeated
(`kilter.friction.exclusion_file`).
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kilter.analysis.planning.hold.hold_check import wrong_hold
from kilter.analysis.planning.order.order_check import wrong_order
from kilter.analysis.planning.plan_proof_form import require_hold_form, require_plan_form
from kilter.assembly import Assembly, require_assembly
from kilter.contact import ContactSet, Tolerance, contacts
from kilter.contact.fits.fastening import fasten_as_read
from kilter.errors import InputError
from kilter.files.reading import Reading, read_json
from kilter.friction.exclusion_file import recheck_exclusion
from kilter.mechanics.bundle import apply_change, is_bundle, split_bundle, subject_mismatch
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.mechanics.proof_form import MalformedProof, require_form
from kilter.mechanics.recheck import recheck
from kilter.second_order.proofs.second_order_recheck import recheck_second_order

__all__ = ["Verification", "proof_tolerance", "verify", "verify_proof"]


@dataclass(frozen=True, slots=True, eq=False)
class Verification:
    """Whether a proof holds, its statement, and the reasons if it does not hold.

    Attributes
    ----------
    holds : bool
    verdict : str
        Statement of the proof.
    reasons : tuple of str
        Why it does not hold.
    residual : float or None
        Worst imbalance of a part over its weight [-], of a proof by forces.
    power : float or None
        Power of the motion, whose fastest part moves by 1 [W].
    notes : tuple of str
        Further results, and facts that a proof file cannot contain.
    held : tuple of str
        Parts that are held.
    gravity : tuple of float
        [m/s^2]
    units : str
    options, tolerance : dict
        How the file was read for the proof, and when faces counted as touching.
    """

    holds: bool
    verdict: str
    reasons: tuple[str, ...]
    residual: float | None
    power: float | None
    notes: tuple[str, ...]
    held: tuple[str, ...]
    gravity: tuple[float, ...]
    units: str
    options: Mapping[str, Any]
    tolerance: Mapping[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The answer of `kilter verify --json`."""
        return {
            "holds": self.holds,
            "verdict": self.verdict,
            "residual": self.residual,
            "power": self.power,
            "reasons": list(self.reasons),
            "notes": list(self.notes),
            "held": list(self.held),
            "gravity": list(self.gravity),
            "units": self.units,
            "options": dict(self.options),
            "tolerance": dict(self.tolerance),
        }

    def __repr__(self) -> str:
        return f"<Verification: {self.verdict}, {'holds' if self.holds else 'does not hold'}>"

    def __bool__(self) -> bool:
        raise TypeError("a verification is neither true nor false: use .holds")


def verify(
    assembly: Assembly | str | Path,
    proof: dict[str, Any] | str | Path,
    *,
    progress: Callable[[str], None] | None = None,
) -> Verification:
    """Does a proof hold? Recomputed from the file, without any solver.

    Parameters
    ----------
    assembly : Assembly or path
        A file is read as it was for the proof: parts held, left out, direction of gravity.
        An assembly is taken as it is.
    proof : dict or path
        Data from `Verdict.proof`, `Region.proof`, `Margin.proof`, `Order.proof` or
        `Fixture.proof` returned, or the file that ``--proof`` of their commands wrote.
    progress : callable, optional
        Called with a word at each stage.

    Raises
    ------
    InputError
        If a file cannot be read, or has no proof.

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
    data, file = proof, None
    if isinstance(proof, str | os.PathLike):
        file = os.fspath(proof)
        data = read_json(Path(proof))
    try:
        several = isinstance(data, dict) and is_bundle(data)
        first = next(split_bundle(data))[1] if several else data
        require_form(first)
        assert isinstance(first, dict)
        assert isinstance(data, dict)
        tolerance = proof_tolerance(first)
        known = None
        if isinstance(assembly, str | os.PathLike):
            tell("reading")
            reading = Reading.from_options(first["options"])
            assembly = reading.read(assembly)
            assembly, known = fasten_as_read(
                assembly, reading, tolerance=tolerance, progress=progress
            )
        require_assembly(assembly, "verify")
        found = known or contacts(assembly, tolerance=tolerance, progress=progress)
        recompute = verify_bundle if several else verify_proof
        return recompute(assembly, found, data)
    except InputError as error:
        raise error.located(file=file) from None


def proof_tolerance(proof: dict[str, Any]) -> Tolerance:
    """The contact tolerance that a proof was made with.

    Raises
    ------
    InputError
        If it has not the form of a proof.
    """
    require_form(proof)
    values = proof["tolerance"]
    return Tolerance(
        gap=values["gap"],
        relative_gap=values["relative_gap"],
        angle=values["angle"],
        clearance=values.get("clearance"),
    )


def verify_bundle(assembly: Assembly, contacts: ContactSet, bundle: dict[str, Any]) -> Verification:
    """Recompute every proof of a region, a margin, a plan or a fixture.

    Raises
    ------
    InputError
        If a file has no proof.
    """
    reasons, residual, power, counts = [], [], [], Counter[str]()
    if bundle.get("digest") != digest_of(bundle):
        reasons.append(
            "the proof file was changed after kilter wrote it (its digest does not match)"
        )
    proof: dict[str, Any] = {}
    verdicts = []
    for about, proof in split_bundle(bundle):
        what = about["about"]
        other, touching = apply_change(assembly, contacts, about["change"])
        found = verify_proof(other, touching, proof)
        wrong = [*found.reasons, *filter(None, [subject_mismatch(about, proof)])]
        of = next((about[key] for key in ("part", "parts", "vector", "value") if key in about), "")
        reasons += [f"{what} {of}: {one}" for one in wrong]
        counts[f"{what}: {'held by forces' if 'forces' in proof else 'a motion starts'}"] += 1
        residual += [] if found.residual is None else [found.residual]
        power += [] if found.power is None else [found.power]
        verdicts.append(proof["verdict"])
    reasons += _wrong_together(assembly, contacts, bundle, verdicts)
    return Verification(
        not reasons,
        bundle["kind"],
        tuple(reasons),
        max(residual, default=None),
        min(power, default=None),
        tuple(f"{count} x {what}" for what, count in counts.items()),
        held=tuple(part.name for part in assembly if part.grounded),
        gravity=tuple(assembly.gravity.tolist()),
        units=assembly.units,
        options=proof["options"],
        tolerance=proof["tolerance"],
    )


JUDGES = {
    "plan": (require_plan_form, wrong_order),
    "hold": (require_hold_form, wrong_hold),
}
"""For files of several proofs: the form of their statements, and the judge of all together."""


def _wrong_together(
    assembly: Assembly, contacts: ContactSet, bundle: Mapping[str, Any], verdicts: Sequence[str]
) -> list[str]:
    """Reasons why valid proofs together are no plan, or no fixture.

    Raises
    ------
    InputError
        If the statements of the proofs do not have their form.
    """
    if bundle["kind"] not in JUDGES:
        return []
    require_statements, judge = JUDGES[bundle["kind"]]
    try:
        require_statements(bundle, assembly.names)
    except MalformedProof as error:
        raise InputError(
            f"the proof of a {bundle['kind']} does not have the required form ({error})",
            hint="write it again with --proof",
        ) from None
    return list(judge(assembly, contacts, bundle, verdicts))


def verify_proof(assembly: Assembly, contacts: ContactSet, proof: dict[str, Any]) -> Verification:
    """Recompute a proof from an assembly and the contacts found in it.

    Raises
    ------
    InputError
        If it is no proof: keys are missing, or of the wrong kind.
    """
    require_form(proof)
    found = recheck(assembly, contacts, proof)
    reasons, notes = list(found.reasons), list(found.notes)
    friction = proof.get("friction")
    if not reasons and friction is not None and friction["guarantee"] == "proved":
        program = build_program(assembly, contacts)
        more, also = recheck_exclusion(program, friction["exclusion"])
        reasons, notes = reasons + more, notes + also
    second = proof.get("second_order")
    if not reasons and second is not None and ("forces" not in proof or friction is not None):
        reasons = ["its second order needs a proof by forces without friction"]
    elif not reasons and second is not None:
        program = build_program(assembly, contacts)
        reasons = recheck_second_order(assembly, contacts, program.frictionless, second)
        notes += [] if reasons else [f"second order: {second['state']}"]
    if not reasons and friction is None and "forces" in proof:
        reasons = _wrong_word(proof["verdict"], second, rubs=bool((contacts.patch_mu > 0).any()))
    return Verification(
        not reasons,
        proof["verdict"],
        tuple(reasons),
        found.residual,
        found.power,
        tuple(notes),
        held=tuple(part.name for part in assembly if part.grounded),
        gravity=tuple(assembly.gravity.tolist()),
        units=assembly.units,
        options=proof["options"],
        tolerance=proof["tolerance"],
    )


def _wrong_word(verdict: str, second: Mapping[str, Any] | None, *, rubs: bool) -> list[str]:
    """Compare a verdict without friction with the word that its second order gives.

    `rubs`: a contact has friction. Then a fall counts only if rolling falls, too.
    """
    state = None if second is None else second["state"]
    falls = second is not None and second.get("rolling", None if rubs else "falls") == "falls"
    fits = "balanced" if state == "balanced" and falls else "stable"
    if verdict == fits:
        return []
    return [f"it states {verdict!r}, but its evidence proves {fits!r}"]
