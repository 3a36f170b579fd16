"""Rows of settled states: each state of a MuJoCo model brought to rest, the same in each process.

A worker process gets the snapshot of the model once, and for each state the places of its bodies.
It needs no MuJoCo.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from kilter.analysis.many.batch_rows import serve_tasks, words_of
from kilter.analysis.settled_pose.settle import Settled, settle
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import Tolerance
from kilter.contact.fits.fastening import fasten_as_read
from kilter.errors import TimeLimitReached
from kilter.files.file_content import FileContent
from kilter.files.objects.state_scenes import StateScene
from kilter.files.reading import Reading

StateTask = tuple[int, dict[str, Array]]
"""Index of a state, and the places of its bodies."""


@dataclass(slots=True, eq=False)
class StateQuestion:
    """The scene of all states, and the options with which each state is settled."""

    scene: StateScene
    reading: Reading
    tolerance: Tolerance | None
    options: dict[str, Any] = field(default_factory=dict)
    """Keywords of `kilter.settle`."""

    def assembly(self, places: dict[str, Array] | None = None) -> Assembly:
        """The assembly of a state, with the options of reading."""
        read = self.scene.assembly(places)
        assembly = self.reading.read_content(FileContent(read, states_gravity=True))
        if self.tolerance is not None:
            assembly = replace(assembly, tolerance=self.tolerance)
        if not self.reading.fastens:
            return assembly
        tolerance = self.tolerance or Tolerance()
        return fasten_as_read(assembly, self.reading, tolerance=tolerance)[0]


def settled_rows(tasks: Sequence[StateTask], question: StateQuestion) -> list[dict[str, Any]]:
    """Settle states, given with their indices; return a row of plain data for each."""
    return [_settled_row(index, places, question) for index, places in tasks]


def _settled_row(index: int, places: dict[str, Array], question: StateQuestion) -> dict[str, Any]:
    """The row of a state; an error in a state is a row, too."""
    begun = time.perf_counter()
    free = 0
    try:
        assembly = question.assembly(places)
        free = int((~assembly.geometry.grounded).sum())
        row = _row(settle(assembly, **question.options), question.scene)
    except TimeLimitReached:
        row = failed_row(index, "the time limit was reached", state="not-found")
    except Exception as error:
        row = failed_row(index, words_of(error))
    seconds = time.perf_counter() - begun
    return {**row, "index": index, "free": free, "seconds": seconds}


def failed_row(index: int, why: str, *, state: str = "error") -> dict[str, Any]:
    """The row of a state for which no pose at rest is known."""
    return {
        "index": index, "state": state, "level": None, "free": 0, "rests": 0,
        "leaves": [], "parts": [], "moved": 0.0,
        "farthest": None, "why": why, "seconds": 0.0, "qpos": None,
    }  # fmt: skip


def _row(answer: Settled, scene: StateScene) -> dict[str, Any]:
    """The row of a settled state, and the new positions of its joints if some parts rest.

    Parts that leave the scene, and parts without a pose, keep their drawn poses.
    """
    lost = {*answer.leaves, *answer.parts}
    kept = {p.name: p.pose for p in answer.drawn.parts if p.name in lost}
    posed = answer.assembly.with_poses(kept)
    way = np.where([name in lost for name in answer.drawn.names], 0.0, answer.distance)
    farthest = int(way.argmax()) if way.any() else None
    return {
        "state": answer.state,
        "level": answer.level,
        "rests": answer.rests,
        "leaves": list(answer.leaves),
        "parts": list(answer.parts),
        "moved": float(way.max(initial=0.0)),
        "farthest": None if farthest is None else answer.drawn.names[farthest],
        "why": answer.why or None,
        "qpos": scene.positions(answer.drawn, posed).tolist() if answer.rests else None,
    }


def serve() -> None:
    """Main function of a worker process: it settles states."""
    serve_tasks(settled_rows)
