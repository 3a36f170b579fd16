"""Validators of proof files: the required keys, and the form of each value.

Data of this form can be recomputed without further checks: every key that is read exists, and every
number is finite, and so are its square and its product with another number.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any

from kilter.errors import InputError
from kilter.mechanics.bundle_changes import restored
from kilter.validate import LARGEST

FORMAT = 1


class MalformedProof(ValueError):
    """Error: the data of a proof do not have the form of its kind."""


Form = Callable[[Any, str], str]
"""Function from a value and its place in a file to a fault in words; empty if it is valid."""


def instance_of(*kinds: type) -> Form:
    """Validator for a value of one of these types; True and False are not accepted as int."""

    def fault(value: Any, place: str) -> str:
        # true and false are whole numbers to Python
        fits = isinstance(value, kinds) and (not isinstance(value, bool) or bool in kinds)
        return "" if fits else f"{place} is {value!r:.40}"

    return fault


def _number(value: Any, place: str) -> str:
    fits = isinstance(value, float | int) and not isinstance(value, bool)
    return "" if fits and abs(value) <= LARGEST else f"{place} is {value!r:.40}"


def list_of(form: Form, length: int | None = None) -> Form:
    """Validator for a list whose entries all fit `form`, of the given length unless None."""

    def fault(value: Any, place: str) -> str:
        if not isinstance(value, list) or length not in (None, len(value)):
            return f"{place} is {value!r:.40}"
        return _first(form(entry, f"{place}[{k}]") for k, entry in enumerate(value))

    return fault


def named(form: Form) -> Form:
    """Validator for a dictionary with any keys, whose values all fit `form`."""

    def fault(value: Any, place: str) -> str:
        if not isinstance(value, dict):
            return f"{place} is {value!r:.40}"
        return _first(form(entry, f"{place}.{name}") for name, entry in value.items())

    return fault


def keys(**forms: Form) -> Form:
    """Validator for a dictionary with at least these keys, each value of its form."""

    def fault(value: Any, place: str) -> str:
        if not isinstance(value, dict):
            return f"{place} is {value!r:.40}"
        places = {key: f"{place}.{key}".lstrip(".") for key in forms}
        return _first(
            form(value[key], places[key]) if key in value else f"{places[key]} is missing"
            for key, form in forms.items()
        )

    return fault


def nullable(form: Form) -> Form:
    """Validator for null or a value that fits `form`."""
    return lambda value, place: "" if value is None else form(value, place)


def every(*forms: Form) -> Form:
    """Validator for a value that must fit all of `forms`."""
    return lambda value, place: _first(form(value, place) for form in forms)


def optional_keys(**forms: Form) -> Form:
    """Validator for a dictionary in which these keys may be missing or null, else fit."""

    def fault(value: Any, place: str) -> str:
        known = value if isinstance(value, dict) else {}
        present = {key: form for key, form in forms.items() if known.get(key) is not None}
        return keys(**present)(value, place)

    return fault


def row_of(*forms: Form) -> Form:
    """Validator for a list with exactly one entry for each form, in this order."""

    def fault(value: Any, place: str) -> str:
        if not isinstance(value, list) or len(value) != len(forms):
            return f"{place} is {value!r:.40}"
        entries = zip(forms, value, strict=True)
        return _first(form(entry, f"{place}[{k}]") for k, (form, entry) in enumerate(entries))

    return fault


def count_up_to(most: int, *, least: int = 1) -> Form:
    """Validator for an int from `least` to `most`."""

    def fault(value: Any, place: str) -> str:
        wrong = COUNT(value, place)
        return wrong or ("" if least <= value <= most else f"{place} is {value!r:.40}")

    return fault


def one_of(*words: str) -> Form:
    """Validator for a value that is one of these words."""
    return lambda value, place: "" if value in words else f"{place} is {value!r:.40}"


def _first(faults: Iterable[str]) -> str:
    return next(filter(None, faults), "")


NUMBER, WORD, FLAG, COUNT = _number, instance_of(str), instance_of(bool), instance_of(int)
VECTOR, SIX, PAIR = list_of(NUMBER, 3), list_of(NUMBER, 6), list_of(WORD, 2)
LOADS = list_of(keys(part=WORD, point=nullable(VECTOR), force=VECTOR, torque=VECTOR))

PROOF = keys(
    verdict=WORD,
    units=WORD,
    planar=FLAG,
    gravity=VECTOR,
    down=VECTOR,
    digest=WORD,
    options=keys(),
    tolerance=every(
        keys(gap=nullable(NUMBER), relative_gap=NUMBER, angle=NUMBER),
        optional_keys(clearance=NUMBER),
    ),
    parts=list_of(keys(name=WORD, grounded=FLAG, mass=NUMBER, center=VECTOR)),
    points=list_of(
        every(
            keys(parts=PAIR, x=VECTOR, normal=VECTOR, mu=NUMBER),
            optional_keys(pull=NUMBER, tied=FLAG, shear=NUMBER),
        )
    ),
    loads=LOADS,
    joints=list_of(
        every(
            keys(parts=PAIR, kind=WORD, point=VECTOR, axis=nullable(VECTOR)),
            optional_keys(
                limits=list_of(NUMBER, 2), friction=NUMBER, stiffness=NUMBER, rest=NUMBER
            ),
        )
    ),
)
"""Keys of every proof."""
FORCES = every(
    keys(
        forces=list_of(VECTOR),
        joints=list_of(keys(wrench=SIX)),
        certificate=keys(residual=NUMBER),
    ),
    optional_keys(pulls=list_of(NUMBER)),
)
"""Further keys of a proof by forces."""
MOTION = keys(
    motion=named(SIX),
    certificate=keys(power=NUMBER, violation=NUMBER),
    open_pairs=list_of(keys(parts=PAIR, kind=WORD)),
)
"""Further keys of a proof by a motion."""
STRAPS = list_of(
    every(
        keys(path=list_of(instance_of(list))),
        optional_keys(tension=NUMBER, capacity=NUMBER, mu=NUMBER, tensioned=WORD),
    )
)
"""Straps, as in an assembly file."""
FRICTION = keys(
    guarantee=WORD,
    exclusion=nullable(
        keys(
            kind=WORD,
            programs=COUNT,
            assumes=WORD,
            opening=nullable(list_of(NUMBER)),
            steps=list_of(keys()),
        )
    ),
    witness=nullable(
        keys(
            acceleration=named(SIX),
            forces=list_of(VECTOR),
            joints=list_of(VECTOR),
            bonds=list_of(VECTOR),
            power=NUMBER,
            residual=NUMBER,
        )
    ),
)
"""Keys of `friction`, for a verdict that depends on it."""
CHANGE = optional_keys(
    down=VECTOR,
    gravity=VECTOR,
    mu=NUMBER,
    mu_share=NUMBER,
    strength=NUMBER,
    loads=LOADS,
    without=list_of(WORD),
    held=list_of(WORD),
    supports=list_of(keys(kind=WORD, part=WORD)),
    straps=STRAPS,
    part=keys(parts=list_of(keys(name=WORD))),
)
"""Differences from the file for a proof among several."""
BUNDLE = keys(
    kind=one_of("region", "margin", "transport", "plan", "hold", "lashing", "place", "ranges"),
    common=keys(),
    proofs=list_of(
        every(
            keys(about=WORD, change=CHANGE, proof=keys()),
            optional_keys(vector=VECTOR),
        )
    ),
)
"""Keys of a file of several proofs."""


def require(form: Form, data: Any) -> None:
    """Raise `MalformedProof` with the first fault of the data of a proof, if there is one."""
    if fault := form(data, ""):
        raise MalformedProof(fault)


def require_form(proof: Any) -> None:
    """Raise an error if JSON data do not have the form of a proof.

    Raises `InputError` naming the first key that is missing or of another kind.

    Examples
    --------
    >>> require_form({"kilter_proof": 1, "verdict": 3})
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the proof cannot be read: verdict is 3; make it anew with ...
    """
    if not isinstance(proof, dict) or proof.get("kilter_proof") != FORMAT:
        raise InputError(
            f"this is no kilter proof of format {FORMAT}",
            hint="give what verdict.proof() returns",
            option="give a file of kilter check --proof",
        )
    _require_json(proof)
    evidence = FORCES if "forces" in proof else MOTION
    fault = PROOF(proof, "") or evidence(proof, "")
    if not fault and proof.get("friction") is not None:
        fault = FRICTION(proof["friction"], "friction")
    if fault:
        raise _unreadable(fault)


def require_bundle_form(bundle: Any) -> dict[str, Any]:
    """The data of a file of several proofs with all rows of each (`bundle_changes.restored`).

    Raises `InputError` if they have another form, naming the first key that is missing or of
    another kind.

    Examples
    --------
    >>> require_bundle_form({"kilter_proofs": 1, "kind": ["plan"]})
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the proof cannot be read: kind is ['plan']; make it anew with ...
    """
    if not isinstance(bundle, dict) or bundle.get("kilter_proofs") != FORMAT:
        raise InputError(
            f"this is no file of kilter proofs of format {FORMAT}",
            hint="make it anew with --proof",
        )
    _require_json(bundle)
    whole: dict[str, Any] = restored(bundle)
    fault = BUNDLE(whole, "") or ("" if whole["proofs"] else "it has no proofs")
    if fault:
        raise _unreadable(fault)
    return whole


def _require_json(proof: Any) -> None:
    """Raise an error if data are not JSON with finite numbers, since they then have no digest."""
    try:
        json.dumps(proof, allow_nan=False)
    except (TypeError, ValueError, RecursionError) as error:
        raise _unreadable(f"it is no JSON ({error})") from None


def _unreadable(why: str) -> InputError:
    return InputError(
        f"the proof cannot be read: {why}",
        hint="make it anew with verdict.proof()",
        option="make it anew with kilter check --proof",
    )
