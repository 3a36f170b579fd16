"""Values of recent contact searches of one geometry, for its next search.

A check searches the same bodies again when it tries an option. With another tolerance the facets,
boxes, solids, smooth faces and curves of the bodies stay the same. With other friction all findings
stay the same. So these values are kept, until bodies of another geometry are searched.
"""

from __future__ import annotations

import atexit
from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Any

from kilter.assembly.geometry import Geometry

__all__ = ["RecentSearches", "recent_searches"]


MOST_TRIANGLES = 300_000
"""Largest number of triangles of a geometry whose searches are kept; more need more memory."""
MOST_FINDINGS = 4
"""Largest number of searches whose findings are kept."""


@dataclass(slots=True, eq=False)
class RecentSearches:
    """Values of searches of a geometry.

    Attributes
    ----------
    geometry : Geometry or None
    search : ContactSearch or None
        A search of this geometry, for the values that do not depend on its tolerance.
    findings : dict
        Complete findings (search, `PairFindings`) by the conditions of their search.
    """

    geometry: Geometry | None = None
    search: Any = None
    findings: dict[Hashable, tuple[Any, Any]] = field(default_factory=dict)

    def keep(self, conditions: Hashable, findings: tuple[Any, Any]) -> None:
        """Keep complete findings, in place of the oldest ones."""
        if len(self.findings) >= MOST_FINDINGS:
            del self.findings[next(iter(self.findings))]
        self.findings[conditions] = findings


def recent_searches(geometry: Geometry) -> RecentSearches:
    """The recent searches of a geometry; empty if another geometry was searched last."""
    global _recent
    if len(geometry.triangles) > MOST_TRIANGLES:
        return RecentSearches(geometry)
    recent = _recent
    if recent.geometry is not geometry:
        recent = _recent = RecentSearches(geometry)
    return recent


@atexit.register
def forget() -> None:
    """Release the values before the interpreter ends.

    Solids that live longer than their library make it print a list of leaks.
    """
    global _recent
    _recent = RecentSearches()


_recent = RecentSearches()
