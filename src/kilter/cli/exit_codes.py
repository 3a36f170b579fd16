"""Exit codes of all commands, and their order from harmless to worst."""

from __future__ import annotations

from kilter.errors import FAULT

__all__ = [
    "DOCTOR",
    "FAULT",
    "HOLD",
    "HOLDS",
    "INTERRUPTED",
    "INVALID",
    "LOWER",
    "ORIENT",
    "PACKING",
    "PLACE",
    "PLAN",
    "SCENE",
    "SETTLE",
    "SOME_ERRORS",
    "USAGE",
    "VERDICT",
    "WHY",
    "WRITTEN",
]

WRITTEN = 0
"""Exit code if the answer was printed or written, whatever its verdict."""
HOLDS, LOWER = 0, 3
"""Codes of `check` and `plan`: it holds at the required level, or at a lower level."""
VERDICT = {"unstable": 1, "undecided": 4}
"""Codes of `check` if the assembly holds at no level."""
ORIENT = {"found": 0, "none": 1, "undecided": 4}
"""Codes of `orient` by its verdict."""
PLAN = {"impossible": 1, "fails": 1, "none-found": 4, "undecided": 4}
"""Codes of `plan` if no order was found, or if the given order fails."""
INVALID = 1
"""Code of `verify` if the proof does not hold; `HOLDS` and `LOWER` as for `check`."""
HOLD = {"impossible": 1, "undecided": 4}
"""Codes of `hold` if no sufficient supports were found."""
PLACE = {"none": 1, "undecided": 4}
"""Codes of `place` if the part stands nowhere or not at the given place, or it is undecided."""
PACKING = {"falls": 1, "undecided": 4}
"""Codes of `check-plan` if the pile does not stand, or an item is overloaded, after an item."""
SCENE = {"faults": 1, "open": 4}
"""Codes of `scene` if some objects float, overlap or fall, or if some states are open."""
SETTLE = {"falls": 1, "does-not-fit": 1, "not-found": 4}
"""Codes of `settle` if no part comes to rest; if some rest: 1 if others leave or do not fit, or 4.
"""
WHY = {"falls": 1, "pushed-out": 1, "floats": 1, None: 4}
"""Codes of `why` if a body moves, or the state is undecided."""
DOCTOR = {True: 0, False: 1}
"""Codes of `doctor`: do all installed parts work?"""
SOME_ERRORS = 1
"""Code of `batch` if some of the written rows have an error instead of a verdict."""
USAGE = 2
"""Wrong usage or input."""
INTERRUPTED = 130
"""Ctrl-C, or a request of the system to end."""
