"""Decision about the energy of an equilibrium, with its proof."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from kilter.arrays import Array
    from kilter.second_order.proofs.level_rest import Held, LevelRest
    from kilter.second_order.proofs.minimum_proof import LockedTurns, MinimumProof
    from kilter.second_order.proofs.paths import Path
    from kilter.second_order.proofs.stopped import Stopped


@dataclass(frozen=True, slots=True, eq=False)
class EnergyDecision:
    """Decision about an equilibrium (minimum, balanced or open), with its proof."""

    state: Literal["minimum", "balanced", "open"]
    """One of "minimum", "balanced", "open". A minimum is a minimum across the free motions."""
    neutral: int
    free: int
    blocked: int
    undecided: int
    """Dimension of the span of the critical motions, and of its parts: motions proved free,
    motions that cost or gain energy, and motions for which neither is known."""
    proof: MinimumProof | Path | LevelRest | LockedTurns | Stopped | Held | None = None
    why: str = ""
    """Reason for an open decision."""
    others: tuple[Path, ...] = ()
    """Further paths that lead down, less steeply."""
    opening: Array | None = None
    """Free motion that opens the contacts that were left out, in scaled unknowns, shape (n,)."""
