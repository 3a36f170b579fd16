"""A verdict with only its word computed; access to any other field runs `check`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

from kilter.analysis.check import check
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly
from kilter.assembly.assembly_arrays import AssemblyArrays

__all__ = ["DeferredVerdict"]

FIELDS = frozenset(field.name for field in fields(Verdict))


class DeferredVerdict(Verdict):
    """A `Verdict` whose unknown fields are computed at the first access to any of them."""

    @classmethod
    def of(
        cls,
        assemblies: Sequence[Assembly] | AssemblyArrays,
        k: int,
        known: Mapping[str, Any],
        options: Mapping[str, Any],
    ) -> DeferredVerdict:
        """Create the verdict of assembly k from known fields; `options` serve to compute the rest.

        Parameters
        ----------
        assemblies : sequence of Assembly, or AssemblyArrays
        k : int
            Index of the assembly.
        known : mapping
            Values of the known fields, equal to those of `check`.
        options : mapping
            Arguments of `check`.
        """
        verdict: DeferredVerdict = object.__new__(cls)
        verdict.__dict__.update(known)
        verdict.__dict__["_deferred"] = (assemblies, k, options)
        return verdict

    def __getattribute__(self, name: str) -> Any:
        """Return a field of the verdict; an unknown field is computed first, with all others."""
        if name in FIELDS:
            values = object.__getattribute__(self, "__dict__")
            if name not in values and "_deferred" in values:
                assemblies, k, options = values["_deferred"]
                if name == "assembly":
                    values[name] = assemblies[k]
                    return values[name]
                whole = check(self.assembly, **options)
                values.update({field: getattr(whole, field) for field in FIELDS})
                del values["_deferred"]
        return object.__getattribute__(self, name)
