"""Exit codes: how every command ends."""

from __future__ import annotations

__all__ = ["FAULT", "INTERRUPTED", "ORIENT", "USAGE", "VERDICT", "VERIFY", "WRITTEN"]

WRITTEN = 0
"""The answer is given or written, whatever it says."""
VERDICT = {"stable": 0, "unstable": 1, "potentially-stable": 3, "undecided": 4}
"""Of `check`."""
ORIENT = {"found": 0, "none": 1, "undecided": 4}
VERIFY = {True: 0, False: 1}
"""Of whether a proof holds."""
USAGE = 2
"""Wrong usage or input."""
FAULT = 70
"""Of kilter itself."""
INTERRUPTED = 130
