"""What there is to show: an assembly and the answers that were found for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array, Index

if TYPE_CHECKING:
    from kilter.assembly import Assembly
    from kilter.contact import ContactSet

__all__ = ["Answers", "Balance", "MapAnswer", "Orientation"]


@dataclass(frozen=True, slots=True, eq=False)
class Balance:
    """Contact forces that balance every part for one direction of gravity.

    Attributes
    ----------
    down : ndarray, shape (3,)
    points : ndarray, shape (K, 3)
        Where they act [length unit].
    parts : ndarray of int, shape (K, 2)
    forces : ndarray, shape (K, 3)
        On the second part [N].
    """

    down: Array
    points: Array
    parts: Index
    forces: Array

    @classmethod
    def of_proof(cls, proof: dict[str, Any], index: dict[str, int]) -> Balance | None:
        """The forces of a proof (`kilter.mechanics.proof`); None where it holds a motion."""
        if "forces" not in proof:
            return None
        points = proof["points"]
        return cls(
            np.array(proof["down"], dtype=np.float64),
            np.array([p["x"] for p in points], dtype=np.float64).reshape(-1, 3),
            np.array([[index[n] for n in p["parts"]] for p in points], np.int64).reshape(-1, 2),
            np.array(proof["forces"], dtype=np.float64).reshape(-1, 3),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Orientation:
    """One direction of gravity, answered in full.

    Attributes
    ----------
    down : ndarray, shape (3,)
    check : dict
        The answer of `kilter check --json`.
    balance : Balance or None
    sentence : str
        What is special about this direction.
    """

    down: Array
    check: dict[str, Any]
    balance: Balance | None
    sentence: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class MapAnswer:
    """The stability map with a motion a vertex; world frame.

    Attributes
    ----------
    vertices : ndarray, shape (V, 3)
        z(g) = -max over vertices of q.g [kg x length unit].
    mass : float
        Of the free parts [kg].
    motions : ndarray, shape (V, N, 6)
        The displacement of LP (9) of least 2-norm where that vertex is the farthest.
    """

    vertices: Array
    mass: float
    motions: Array


@dataclass(frozen=True, slots=True, eq=False)
class Answers:
    """All that a page shows.

    Attributes
    ----------
    assembly : Assembly
    contacts : ContactSet
    given : Orientation
        Gravity as in the file or as asked for.
    recommended : Orientation or None
    region : dict or None
        The answer of `kilter region --json`.
    none : bool
        It is proved that no direction is stable, whatever further forces there may be.
    rays : sequence of Balance
        Forces for each ray, and both signs of each line, of the region.
    map : MapAnswer or None
    notes : sequence of str
        What is not shown, and why.
    command : str
        How to make the page again.
    versions : dict
        Of kilter and of what it computes with.
    """

    assembly: Assembly
    contacts: ContactSet
    given: Orientation
    recommended: Orientation | None = None
    region: dict[str, Any] | None = None
    none: bool = False
    rays: Sequence[Balance] = ()
    map: MapAnswer | None = None
    notes: Sequence[str] = ()
    command: str = ""
    versions: dict[str, str] = field(default_factory=dict)
