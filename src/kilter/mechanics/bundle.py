"""Several proofs about one assembly in one file: those of a region, or of a margin.

What all of them say (parts, points, units, how the file is read) is there once, in `common`;
each of `proofs` has the rest, and before it

    about, value     what it is about: a ray, a facet; a tilt, and the angle at which it is proved
    vector           the ray, line or normal
    change           what of the file is another: `down`, `mu` of every contact, `loads`, the
                     share of its `strength` that each bond has; parts
                     that it is `without`, parts `held`, `supports` from outside

A plan has besides the `rules` that its order keeps to, a fixture the candidates.
`digest` is the hash of all of it.

A ray is proved along itself, and the motion of a facet gains power beyond exactly that facet:
the sum of mass times step is its outward normal. Both are checked beside each proof.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kilter.assembly import Assembly, Load
from kilter.contact.contact_set import ContactSet
from kilter.contact.sub_contacts import contacts_among
from kilter.contact.supports import Support, with_supports
from kilter.errors import InputError
from kilter.mechanics.mechanics_tolerances import FOLLOWS
from kilter.mechanics.proof import digest_of
from kilter.mechanics.proof_form import FORMAT, require_bundle_form, require_form

__all__ = ["apply_change", "is_bundle", "make_bundle", "split_bundle", "subject_mismatch"]

COMMON = ("kilter_proof", "units", "planar", "options", "tolerance", "parts", "points")
"""What all proofs of a file say alike."""


LOAD = ("part", "force", "torque", "point")
"""What a load is made of."""


def make_bundle(
    kind: str, proofs: Sequence[tuple[Mapping[str, Any], Mapping[str, Any]]], **more: Any
) -> dict[str, Any]:
    """One file of proofs, each with what it is about.

    Parameters
    ----------
    kind : str
    proofs : sequence of pairs
        What a proof is about, and the proof.
    **more
        What the file says besides.

    Raises
    ------
    InputError
        If there is no proof.
    """
    if not proofs:
        raise InputError(f"there is no proof of this {kind} to write")
    first = proofs[0][1]
    common = {key: first[key] for key in COMMON}
    rest = []
    for about, proof in proofs:
        own = {key: value for key, value in proof.items() if common.get(key, ...) != value}
        rest.append({**about, "proof": own})
    bundle = {"kilter_proofs": FORMAT, "kind": kind, **more, "common": common, "proofs": rest}
    return {**bundle, "digest": digest_of(bundle)}


def is_bundle(data: Any) -> bool:
    """Whether it is a file of several proofs."""
    return isinstance(data, dict) and "kilter_proofs" in data


def split_bundle(bundle: Any) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """What each proof is about, and the proof.

    Raises
    ------
    InputError
        If it has not the form of one.
    """
    require_bundle_form(bundle)
    for entry in bundle["proofs"]:
        proof = {**bundle["common"], **entry["proof"]}
        require_form(proof)
        yield {key: value for key, value in entry.items() if key != "proof"}, proof


def apply_change(
    assembly: Assembly, contacts: ContactSet, change: Mapping[str, Any]
) -> tuple[Assembly, ContactSet]:
    """The assembly and its contacts as a proof speaks of them.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    change : mapping
        Of the form that `split_bundle` asks for.

    Raises
    ------
    InputError
        If the change makes no sense.
    """
    mu = change.get("mu")
    if change.get("down") is not None:
        assembly = assembly.with_down(change["down"])
    if mu is not None:
        contacts = contacts.with_friction(mu)
    if change.get("loads") is not None:
        loads = [Load(**{key: load[key] for key in LOAD}) for load in change["loads"]]
        assembly = dataclasses.replace(assembly, loads=loads)
    if change.get("strength") is not None:
        bonds = [bond.with_strength(change["strength"]) for bond in assembly.bonds]
        assembly = dataclasses.replace(assembly, bonds=bonds)
        contacts = contacts.of(assembly)
    if change.get("without") or change.get("held"):
        if change.get("without"):
            assembly = assembly.without(change["without"])
        if change.get("held"):
            assembly = assembly.with_grounded(change["held"])
        contacts = contacts_among(contacts, assembly)
    if change.get("supports") is not None:
        supports = [Support.from_dict(one) for one in change["supports"]]
        return with_supports(assembly, contacts, supports)
    return assembly, contacts


def subject_mismatch(about: Mapping[str, Any], proof: Mapping[str, Any]) -> str:
    """Why a proof is not of what it is said to be about; empty where it is."""
    vector = about.get("vector")
    if vector is None:
        return ""
    given = np.array(vector, dtype=float)
    if "forces" in proof:
        down = np.asarray(proof["down"])
        near = min(np.linalg.norm(down - given), np.linalg.norm(down + given))
        return "" if near <= FOLLOWS else "its forces are for another direction"
    total = np.zeros(3)
    for part in proof["parts"]:
        if not part["grounded"]:
            if part["name"] not in proof["motion"]:
                return f"its motion leaves {part['name']!r} out"
            total += part["mass"] * np.asarray(proof["motion"][part["name"]][:3])
    size = float(np.linalg.norm(total))
    along = total / size if size > 0 else total
    if about.get("about") == "facet" and np.linalg.norm(along + given) > FOLLOWS:
        return "its motion gains power beyond another facet"
    return ""
