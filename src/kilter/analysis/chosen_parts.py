"""The assembly of some parts of an assembly, in place."""

from __future__ import annotations

from dataclasses import replace

from kilter.arrays import Index
from kilter.assembly import Assembly


def chosen_parts(assembly: Assembly, chosen: Index, held: list[int]) -> Assembly:
    """The assembly of some of the parts, of which some are also held.

    Arguments: `chosen` (n,): positions of the parts, ascending.
    """
    parts = [assembly.parts[k] for k in chosen.tolist()]
    names = {part.name for part in parts}
    still = {assembly.names[k] for k in held}
    if still:
        parts = [replace(p, grounded=True) if p.name in still else p for p in parts]
    inside = {*names, "ground"}
    return replace(
        assembly,
        parts=parts,
        notes=(),
        friction_pairs=[e for e in assembly.friction_pairs if names.issuperset(e.parts)],
        contacts=[e for e in assembly.contacts if names.issuperset(e.parts)],
        joints=[e for e in assembly.joints if inside.issuperset(e.parts)],
        bonds=[e for e in assembly.bonds if names.issuperset(e.parts)],
        straps=[e for e in assembly.straps if inside.issuperset(e.parts)],
        loads=[e for e in assembly.loads if e.part in names - still],
    )
