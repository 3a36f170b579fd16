"""Exit codes of all commands."""

from __future__ import annotations

__all__ = [
    "DOCTOR",
    "FAULT",
    "HOLD",
    "HOLDS",
    "IMPROVE",
    "INTERRUPTED",
    "LOWER",
    "ORIENT",
    "PLAN",
    "SOME_ERRORS",
    "USAGE",
    "VERDICT",
    "VERIFY",
    "WRITTEN",
]

WRITTEN = 0
"""The answer is printed or written, whatever its verdict."""
HOLDS, LOWER = 0, 3
"""`check` and `plan`: it holds at the required level, or only at a lower level."""
VERDICT = {"unstable": 1, "undecided": 4}
"""`check`: it holds at no level."""
ORIENT = {"found": 0, "none": 1, "undecided": 4}
"""`orient`, by its verdict."""
PLAN = {"impossible": 1, "fails": 1, "none-found": 4, "undecided": 4}
"""`plan` without an order, or with a given order that fails."""
VERIFY = {True: 0, False: 1}
"""`verify`, by whether the proof holds."""
HOLD = {"impossible": 1, "undecided": 4}
"""`hold` without sufficient supports."""
IMPROVE = {True: 0, False: 1}
"""`improve`, by whether the model stands as it is or with the named change."""
DOCTOR = {True: 0, False: 1}
"""`doctor`, by whether all installed parts work."""
SOME_ERRORS = 1
"""`batch`: all rows are written, and some rows have an error instead of a verdict."""
USAGE = 2
"""Wrong usage or input."""
FAULT = 70
"""Fault of kilter itself."""
INTERRUPTED = 130
"""Ctrl-C, or a request of the system to end."""
