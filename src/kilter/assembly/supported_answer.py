"""Base class of answers about an assembly, which state the support and the unit they assume."""

from __future__ import annotations

from kilter.assembly.assembly import Assembly
from kilter.tell.record import Answer, InPython, key


class SupportedAnswer(Answer):
    """Base class of answers about an assembly that may have an assumed support."""

    assembly: InPython[Assembly]
    """The assembly."""

    @property
    @key
    def assumed(self) -> tuple[str, ...]:
        """Options that are assumed: "floor" or "ground" if the file holds no part, "units"."""
        return tuple(self.assembly.assumed)
