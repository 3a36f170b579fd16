"""Exit codes: how every command ends."""

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
"""The answer is given or written, whatever it says."""
HOLDS, LOWER = 0, 3
"""Of `check`: it holds at the level that is asked for, or only at a lower one."""
VERDICT = {"unstable": 1, "undecided": 4}
"""Of `check` where it holds at no level."""
ORIENT = {"found": 0, "none": 1, "undecided": 4}
PLAN = {"impossible": 1, "fails": 1, "none-found": 4, "undecided": 4}
"""Of `plan` where there is no order, or the given one is none."""
VERIFY = {True: 0, False: 1}
"""Of whether a proof holds."""
HOLD = {"impossible": 1, "undecided": 4}
"""Exit codes of `hold` if no supports were found."""
IMPROVE = {True: 0, False: 1}
"""Of whether it stands as it is, or with the one brick that is named."""
DOCTOR = {True: 0, False: 1}
"""Of whether all that is installed works."""
SOME_ERRORS = 1
"""Of `batch`: all rows are written, and some say why there is no verdict."""
USAGE = 2
"""Wrong usage or input."""
FAULT = 70
"""Of kilter itself."""
INTERRUPTED = 130
