"""Statements about contacts with fitted normals, at smooth faces that are meshed differently.

A fit gives the normal with a doubt, which is an angle. Forces within the friction mu - doubt of
the fitted normal are within mu of the true normal, so the contact keeps this reduced friction.
These contacts prove equilibrium, but they do not exclude motions: whether a motion obeys
Coulomb's law depends on the true normals. Without friction no force at such a contact is certain,
and `kilter.mechanics.program.build_program` leaves the contact out.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.arrays import Index
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.open_pairs import rigid_groups
from kilter.errors import some
from kilter.mechanics.program import Program, build_program
from kilter.work import Work

__all__ = ["fits_left_out", "rests_on_fits", "why_fits_leave_it_open"]


def rests_on_fits(program: Program, assembly: Assembly) -> bool:
    """Whether any contact between separate rigid bodies has a fitted, uncertain normal."""
    return len(_fitted_patches(program, assembly)) > 0


def _fitted_patches(program: Program, assembly: Assembly) -> Index:
    """Indices, without repeats, of patches with fitted normals between separate rigid bodies."""
    group = rigid_groups(assembly)
    rows = np.flatnonzero(program.doubt)
    rows = rows[group[program.part_a[rows]] != group[program.part_b[rows]]]
    return np.unique(program.source[rows])


def why_fits_leave_it_open(
    assembly: Assembly, contacts: ContactSet, certain: Program, work: Work
) -> tuple[str, ...]:
    """Explain why contacts with fitted normals leave an assembly undecided; empty if they do not.

    The certain contacts alone do not hold it.

    Returns one sentence if forces of equilibrium exist with the fitted contacts; otherwise empty.
    """
    program = build_program(assembly, contacts, fitted=True)
    if len(program.kind) == len(certain.kind) or not judge(program, work=work).stable:
        return ()
    worst = float(contacts.patch_doubt.max(initial=0.0))
    return (
        "forces that hold it exist, but they use fitted normals of curved faces, which are "
        f"accurate only to {np.degrees(worst):.1g} deg; friction above {worst:.2g} would decide it",
    )


def fits_left_out(assembly: Assembly, contacts: ContactSet, certain: Program) -> list[str]:
    """Warnings that name the pairs whose contacts were left out because their normals are fitted.

    Arguments: `certain`: program of the certain contacts, by `build_program`, with or without
    friction. Returns the warning, or an empty list if no contact is left out.
    """
    every = build_program(assembly, contacts, fitted=True)
    out = np.setdiff1d(_fitted_patches(every, assembly), _fitted_patches(certain, assembly))
    if not len(out):
        return []
    names, worst = assembly.names, float(contacts.patch_doubt[out].max())
    pairs = np.unique(contacts.patch_parts[out], axis=0).tolist()
    return [
        "left out: contacts of curved faces whose fitted normals are accurate only to "
        f"{np.degrees(worst):.1g} deg; with friction above {worst:.2g} they would count: "
        f"{some([f'{names[a]!r} and {names[b]!r}' for a, b in pairs])}"
    ]
