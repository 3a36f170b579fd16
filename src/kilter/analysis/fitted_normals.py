"""What rests on fitted normals: contacts of smooth faces that two meshes cut differently.

A normal that a fit gave is known to its doubt. Forces within mu - doubt of it are within mu of
the true one, and such a contact has that friction; without friction nothing is certain of it,
and whether a motion obeys Coulomb's law depends on the normals themselves. So equilibrium is
said of these contacts, not that nothing can move; and without friction only what holds without
them.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.judge import judge
from kilter.contact import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.work import Work

__all__ = ["rests_on_fits", "why_fits_leave_it_open"]


def rests_on_fits(program: Program, contacts: ContactSet, work: Work) -> bool:
    """Whether forces that hold a program need contacts whose normals are in doubt."""
    unsure = np.flatnonzero(contacts.patch_doubt)
    rows = (program.kind == CONTACT) & np.isin(program.source, unsure)
    return bool(rows.any()) and not judge(program.taking(~rows), work=work).stable


def why_fits_leave_it_open(contacts: ContactSet) -> str:
    """Why nothing is certain without friction."""
    worst = float(contacts.patch_doubt.max(initial=0.0))
    return (
        "forces that hold it exist with the fitted normals of curved faces, which are known to "
        f"{np.degrees(worst):.1g} degrees only; friction above {worst:.2g} would settle it"
    )
