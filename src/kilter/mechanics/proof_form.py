"""The form of a proof file, of one proof or several: which keys it has, and of what kind each is.

What has this form can be recomputed without further questions: every key that is read is
there, and every number is one, and so are its square and its product with another.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from typing import Any

from kilter.errors import InputError
from kilter.validate import LARGEST

__all__ = ["FORMAT", "require_bundle_form", "require_form"]

FORMAT = 1

Form = Callable[[Any, str], str]
"""From a value and its place to what is wrong with it; empty where nothing is."""


def _is(*kinds: type) -> Form:
    def fault(value: Any, place: str) -> str:
        # true and false are whole numbers to Python
        fits = isinstance(value, kinds) and (not isinstance(value, bool) or bool in kinds)
        return "" if fits else f"{place} is {value!r:.40}"

    return fault


def _number(value: Any, place: str) -> str:
    fits = isinstance(value, float | int) and not isinstance(value, bool)
    return "" if fits and abs(value) <= LARGEST else f"{place} is {value!r:.40}"


def _list(form: Form, length: int | None = None) -> Form:
    def fault(value: Any, place: str) -> str:
        if not isinstance(value, list) or length not in (None, len(value)):
            return f"{place} is {value!r:.40}"
        return _first(form(entry, f"{place}[{k}]") for k, entry in enumerate(value))

    return fault


def _named(form: Form) -> Form:
    def fault(value: Any, place: str) -> str:
        if not isinstance(value, dict):
            return f"{place} is {value!r:.40}"
        return _first(form(entry, f"{place}.{name}") for name, entry in value.items())

    return fault


def _keys(**forms: Form) -> Form:
    def fault(value: Any, place: str) -> str:
        if not isinstance(value, dict):
            return f"{place} is {value!r:.40}"
        places = {key: f"{place}.{key}".lstrip(".") for key in forms}
        return _first(
            form(value[key], places[key]) if key in value else f"{places[key]} is missing"
            for key, form in forms.items()
        )

    return fault


def _maybe(form: Form) -> Form:
    return lambda value, place: "" if value is None else form(value, place)


def _each(*forms: Form) -> Form:
    return lambda value, place: _first(form(value, place) for form in forms)


def _if_there(**forms: Form) -> Form:
    """Keys that may be missing, or null."""

    def fault(value: Any, place: str) -> str:
        known = value if isinstance(value, dict) else {}
        there = {key: form for key, form in forms.items() if known.get(key) is not None}
        return _keys(**there)(value, place)

    return fault


def _one_of(*words: str) -> Form:
    return lambda value, place: "" if value in words else f"{place} is {value!r:.40}"


def _first(faults: Iterable[str]) -> str:
    return next(filter(None, faults), "")


NUMBER, WORD, FLAG, COUNT = _number, _is(str), _is(bool), _is(int)
VECTOR, SIX, PAIR = _list(NUMBER, 3), _list(NUMBER, 6), _list(WORD, 2)
LOADS = _list(_keys(part=WORD, point=_maybe(VECTOR), force=VECTOR, torque=VECTOR))

PROOF = _keys(
    verdict=WORD,
    units=WORD,
    planar=FLAG,
    gravity=VECTOR,
    down=VECTOR,
    digest=WORD,
    options=_keys(),
    tolerance=_each(
        _keys(gap=_maybe(NUMBER), relative_gap=NUMBER, angle=NUMBER), _if_there(clearance=NUMBER)
    ),
    parts=_list(_keys(name=WORD, grounded=FLAG, mass=NUMBER, center=VECTOR)),
    points=_list(
        _each(
            _keys(parts=PAIR, x=VECTOR, normal=VECTOR, mu=NUMBER),
            _if_there(pull=NUMBER, tied=FLAG, shear=NUMBER),
        )
    ),
    loads=LOADS,
    joints=_list(_keys(parts=PAIR, kind=WORD, point=VECTOR, axis=_maybe(VECTOR))),
)
"""What every proof has."""
FORCES = _keys(
    forces=_list(VECTOR),
    joints=_list(_keys(wrench=SIX)),
    certificate=_keys(residual=NUMBER),
)
"""What a proof by forces has besides."""
MOTION = _keys(
    motion=_named(SIX),
    certificate=_keys(power=NUMBER, violation=NUMBER),
    open_pairs=_list(_keys(parts=PAIR, kind=WORD)),
)
"""What a proof by a motion has besides."""
BALANCED = _keys(forces=_list(VECTOR), joints=_list(NUMBER), residual=NUMBER)
"""Forces that balance every part."""
FRICTION = _keys(
    guarantee=WORD,
    exclusion=_maybe(
        _keys(
            kind=WORD,
            programs=COUNT,
            assumes=WORD,
            opening=_maybe(_list(NUMBER)),
            steps=_list(_keys()),
        )
    ),
    seated=_maybe(BALANCED),
    tries=_keys(passed=COUNT, of=COUNT, forces=_list(BALANCED)),
    witness=_maybe(
        _keys(
            acceleration=_named(SIX),
            forces=_list(VECTOR),
            joints=_list(VECTOR),
            power=NUMBER,
            residual=NUMBER,
        )
    ),
)
"""What `friction` is, where the verdict rests on it."""
CHANGE = _if_there(
    down=VECTOR,
    mu=NUMBER,
    strength=NUMBER,
    loads=LOADS,
    without=_list(WORD),
    held=_list(WORD),
    supports=_list(_keys(kind=WORD, part=WORD)),
)
"""What of the file is another for one proof of several."""
BUNDLE = _keys(
    kind=_one_of("region", "margin", "plan", "hold"),
    common=_keys(),
    proofs=_list(
        _each(
            _keys(about=WORD, change=CHANGE, proof=_keys()),
            _if_there(vector=VECTOR),
        )
    ),
)
"""What a file of several proofs has beside them."""


def require_form(proof: Any) -> None:
    """Refuse what is no proof of this format.

    Raises
    ------
    InputError
        Naming the first key that is missing or of another kind.

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


def require_bundle_form(bundle: Any) -> None:
    """Refuse what is no file of several proofs, whatever each of them is.

    Raises
    ------
    InputError
        Naming the first key that is missing or of another kind.

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
    fault = BUNDLE(bundle, "") or ("" if bundle["proofs"] else "it has no proofs")
    if fault:
        raise _unreadable(fault)


def _require_json(proof: Any) -> None:
    """Refuse what has no digest: numbers that are not finite, values that JSON does not know."""
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
