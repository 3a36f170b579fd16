"""Straps with friction at their corners that name no tensioned end: both ends are possible."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Mapping, Sequence
from typing import Any, get_args

from kilter.assembly.assembly import Assembly
from kilter.assembly.straps import StrapEnd, some
from kilter.errors import InputError

__all__ = ["end_words", "with_ends_of", "with_named_ends"]

MOST_OPEN = 6
"""Largest number of straps without a named end; all 2^n combinations are decided."""


def with_named_ends(assembly: Assembly) -> list[Assembly]:
    """Copies of an assembly with every combination of tensioned ends; itself if all are named.

    Raises `InputError` if more than `MOST_OPEN` straps name no tensioned end.
    """
    unnamed = [k for k, strap in enumerate(assembly.straps) if strap.open_end]
    if not unnamed:
        return [assembly]
    if len(unnamed) > MOST_OPEN:
        raise InputError(
            f"{len(unnamed)} straps have friction and name no tensioned end",
            hint=f'give "tensioned" so that at most {MOST_OPEN} straps are left',
        )
    copies = []
    for ends in itertools.product(get_args(StrapEnd), repeat=len(unnamed)):
        straps = list(assembly.straps)
        for k, end in zip(unnamed, ends, strict=True):
            straps[k] = dataclasses.replace(straps[k], tensioned=end)
        copies.append(dataclasses.replace(assembly, straps=straps))
    return copies


def with_ends_of(assembly: Assembly, given: Sequence[Mapping[str, Any]]) -> Assembly:
    """Copy of an assembly whose open ends are those that the straps of a proof name."""
    if len(given) != len(assembly.straps) or not any(s.open_end for s in assembly.straps):
        return assembly
    straps = [
        dataclasses.replace(strap, tensioned=data.get("tensioned"))
        if strap.open_end and data.get("tensioned") in get_args(StrapEnd)
        else strap
        for strap, data in zip(assembly.straps, given, strict=True)
    ]
    return dataclasses.replace(assembly, straps=straps)


def end_words(assembly: Assembly, named: Assembly) -> list[str]:
    """For each strap without a named end, the tensioned end that a copy of the assembly names."""
    return [
        f"the strap over {some(strap)} is tensioned at its {other.tensioned} end"
        for strap, other in zip(assembly.straps, named.straps, strict=True)
        if strap.open_end and not other.open_end
    ]
