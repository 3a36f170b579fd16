"""Several proofs about an assembly in a single file: region, margin, transport, plan, fixture.

The data that all proofs share (parts, points, units, options) are stored once, in `common`. Each
entry of `proofs` has the other data of its proof (in a plan, the changes of its rows from the
entry before: `kilter.mechanics.bundle_changes`), preceded by

    about, value     the subject: a ray or facet; a tilt and the angle at which it is proved
    vector           the ray, line or normal
    change           differences from the file: `down`, `gravity` [m/s^2], `mu` of every contact,
                     a factor `mu_share` on every mu, `loads`, the share `strength` of every bond's
                     and strap's strength, parts that are left out (`without`), parts that are
                     `held`, external `supports`, a further `part` (an assembly file with it)

A plan also has the `rules` that its order obeys, and a fixture the candidates. `digest` is the hash
of the whole file.

The forces of a ray are proved for the direction of that ray. The motion of a facet has its power
exactly beyond that facet: the sum of mass times displacement is its outward normal. Both are
checked for each proof.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from kilter.assembly import Assembly, Load, Strap
from kilter.contact import detect
from kilter.contact.contact_set import ContactSet
from kilter.contact.kept_contacts import contacts_among
from kilter.contact.supports import Support, with_supports
from kilter.errors import InputError
from kilter.files.own.kilter_json import from_dict
from kilter.mechanics.bundle_changes import ROWS, with_changes
from kilter.mechanics.mechanics_tolerances import FOLLOWS
from kilter.mechanics.proof import digest_of
from kilter.mechanics.proof_form import FORMAT, require_bundle_form, require_form

COMMON = ("kilter_proof", "units", "planar", "options", "tolerance", "parts", "points")
"""Keys whose values are equal in all proofs of a file."""


FOLLOWING = ("plan",)
"""Kinds of files whose proofs are those of states that follow one another."""
LOAD = ("part", "force", "torque", "point")
"""Keys of a load."""


def make_bundle(
    kind: str, proofs: Sequence[tuple[Mapping[str, Any], Mapping[str, Any]]], **more: Any
) -> dict[str, Any]:
    """Combine proofs about an assembly, each with its subject, as the JSON data of a file.

    Arguments: `kind`: kind of the file: "region", "margin", "transport", "plan", "hold" or "place".
    Raises `InputError` if `proofs` is empty.
    """
    if not proofs:
        raise InputError(f"this {kind} has no proof to write")
    first = proofs[0][1]
    common = {key: first[key] for key in COMMON}
    if kind in FOLLOWING:
        entries = with_changes([{**about, "proof": proof} for about, proof in proofs], common)
    else:
        entries = [
            {**about, "proof": {key: v for key, v in proof.items() if common.get(key, ...) != v}}
            for about, proof in proofs
        ]
    bundle = {"kilter_proofs": FORMAT, "kind": kind, **more, "common": common, "proofs": entries}
    return {**bundle, "digest": digest_of(bundle)}


def is_bundle(data: Any) -> bool:
    """True if JSON data are a file of several proofs."""
    return isinstance(data, dict) and "kilter_proofs" in data


def split_bundle(bundle: Any) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Iterate over the proofs in the data of a file, as pairs of subject and complete proof.

    Raises `InputError` if the data do not have the form of a file of proofs.
    """
    bundle = require_bundle_form(bundle)
    if more := set(bundle["common"]) - set(COMMON):
        raise InputError(
            f"the proof cannot be read: common.{min(more)} is no key that all proofs share",
            hint="make it anew with --proof",
        )
    known: set[tuple[str, int]] = set()
    for entry in bundle["proofs"]:
        proof = {**bundle["common"], **entry["proof"]}
        # rows that an earlier proof has, too, are the same objects
        lists = {key: proof[key] for key in ROWS if isinstance(proof.get(key), list)}
        new = {key: [r for r in rows if (key, id(r)) not in known] for key, rows in lists.items()}
        require_form({**proof, **new})
        known.update((key, id(row)) for key, rows in new.items() for row in rows)
        yield {key: value for key, value in entry.items() if key != "proof"}, proof


def apply_change(
    assembly: Assembly, contacts: ContactSet, change: Mapping[str, Any]
) -> tuple[Assembly, ContactSet]:
    """The assembly and the contacts that a proof is about: the file after the stated change.

    Raises `InputError` if the change is inconsistent with the assembly.
    """
    mu = change.get("mu")
    if change.get("down") is not None:
        assembly = assembly.with_down(change["down"])
    if change.get("gravity") is not None:
        assembly = dataclasses.replace(assembly, gravity=change["gravity"])
    if mu is not None:
        contacts = contacts.with_friction(mu)
    if change.get("mu_share") is not None:
        contacts = contacts.with_friction_share(change["mu_share"])
    if change.get("loads") is not None:
        loads = [Load(**{key: load[key] for key in LOAD}) for load in change["loads"]]
        assembly = dataclasses.replace(assembly, loads=loads)
    if change.get("strength") is not None:
        bonds = [bond.with_strength(change["strength"]) for bond in assembly.bonds]
        straps = [strap.with_strength(change["strength"]) for strap in assembly.straps]
        assembly = dataclasses.replace(assembly, bonds=bonds, straps=straps)
        contacts = contacts.of(assembly)
    if change.get("straps") is not None:
        straps = [Strap(**{**data, "path": list(map(tuple, data["path"]))})
                  for data in change["straps"]]  # fmt: skip
        assembly = dataclasses.replace(assembly, straps=[*assembly.straps, *straps])
        contacts = contacts.of(assembly)
    if change.get("without") or change.get("held"):
        if change.get("without"):
            assembly = assembly.without(change["without"])
        if change.get("held"):
            assembly = assembly.with_grips(change["held"])
        contacts = contacts_among(contacts, assembly)
    if change.get("part") is not None:
        added = from_dict(change["part"])
        if added.units != assembly.units:
            raise InputError(f"the part of the proof is in {added.units}, not {assembly.units}")
        assembly = assembly.with_parts(added.parts)
        contacts = detect.contacts(assembly, tolerance=contacts.searched)
    if change.get("supports") is not None:
        supports = [Support.from_dict(data) for data in change["supports"]]
        return with_supports(assembly, contacts, supports)
    return assembly, contacts


def subject_mismatch(about: Mapping[str, Any], proof: Mapping[str, Any]) -> str:
    """Reason why a proof is not about its stated subject `about`; empty if it is."""
    vector = about.get("vector")
    if vector is None:
        return ""
    given = np.array(vector, dtype=float)
    if "forces" in proof:
        down = np.asarray(proof["down"])
        distance = np.linalg.norm(down - given)
        if about.get("about") == "line":
            distance = min(distance, np.linalg.norm(down + given))
        return "" if distance <= FOLLOWS else "its forces are for another direction"
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
