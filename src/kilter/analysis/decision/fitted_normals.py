"""Fitted normals: contacts of smooth faces that two meshes cut differently.

A fitted normal has an error, its doubt. Forces within mu - doubt of it are within mu of
the true normal, and such a contact has that friction; without friction nothing is certain of it,
and whether a motion obeys Coulomb's law depends on the normals themselves. So equilibrium is
certain of these contacts, not that no motion exists. Without friction the verdict counts only on
the other contacts: `kilter.mechanics.program.build_program` leaves these out.
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
    """Whether contacts of a program that may open or slide have normals in doubt."""
    return len(_fitted(program, assembly)) > 0


def _fitted(program: Program, assembly: Assembly) -> Index:
    """Patches in doubt between parts that are not the same body, each once."""
    group = rigid_groups(assembly)
    rows = np.flatnonzero(program.doubt)
    rows = rows[group[program.part_a[rows]] != group[program.part_b[rows]]]
    return np.unique(program.source[rows])


def why_fits_leave_it_open(
    assembly: Assembly, contacts: ContactSet, certain: Program, work: Work
) -> tuple[str, ...]:
    """Why an assembly is undecided that only its fitted contacts would hold."""
    program = build_program(assembly, contacts, fitted=True)
    if len(program.kind) == len(certain.kind) or not judge(program, work=work).stable:
        return ()
    worst = float(contacts.patch_doubt.max(initial=0.0))
    return (
        "forces that hold it exist, but they use fitted normals of curved faces, which are "
        f"accurate only to {np.degrees(worst):.1g} deg; friction above {worst:.2g} would decide it",
    )


def fits_left_out(assembly: Assembly, contacts: ContactSet, certain: Program) -> list[str]:
    """A warning that names the pairs whose fitted contacts are not in the certain program.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    certain : Program
        As `build_program` gives it, or without friction.
    """
    every = build_program(assembly, contacts, fitted=True)
    out = np.setdiff1d(_fitted(every, assembly), _fitted(certain, assembly))
    if not len(out):
        return []
    names, worst = assembly.names, float(contacts.patch_doubt[out].max())
    pairs = np.unique(contacts.patch_parts[out], axis=0).tolist()
    return [
        "left out: contacts of curved faces whose fitted normals are accurate only to "
        f"{np.degrees(worst):.1g} deg; with friction above {worst:.2g} they would count: "
        f"{some([f'{names[a]!r} and {names[b]!r}' for a, b in pairs])}"
    ]
