"""The parts of an opened file, as far as the actions of a user need them."""

from __future__ import annotations

import fnmatch
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["OpenedParts"]


@dataclass(frozen=True, slots=True)
class OpenedParts:
    """Names of the parts of a file, and properties of each part."""

    names: tuple[str, ...] = ()
    """Parts of the file, also those that the choices leave out; without a floor."""
    held: frozenset[str] = frozenset()
    """Parts that the file itself holds; no choice releases them."""
    volume: tuple[float, ...] = ()
    """Volume of each part [m^3]."""

    def matching(self, patterns: Sequence[str]) -> list[str]:
        """Parts that any of the patterns names or matches, in the order of the file."""
        exact = set(patterns)
        globs = [pattern for pattern in patterns if pattern not in self.names]
        return [
            name
            for name in self.names
            if name in exact or any(fnmatch.fnmatchcase(name, glob) for glob in globs)
        ]

    def volume_of(self, name: str) -> float:
        """Volume of a part [m^3]; 0 for a part that the file does not have."""
        return self.volume[self.names.index(name)] if name in self.names else 0.0
