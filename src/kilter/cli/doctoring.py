"""The command about kilter itself: doctor."""

from __future__ import annotations

from kilter.cli.exit_codes import DOCTOR
from kilter.cli.options import Json, Output
from kilter.cli.output import as_json, emit

__all__ = ["doctor"]


def doctor(json: Json = False, output: Output = None) -> int:
    """Does kilter work here? Versions, solvers, extras, STEP, page, terminal.

    Each is asked for something whose answer is known. Put what it prints into a bug report. It
    asks nothing of a network.

    Exit 0 all that is installed works, 1 something is broken; an extra that is absent is not.
    """
    from kilter.health import doctor as look
    from kilter.tell.health_text import health_text

    answer = look().to_dict()
    emit(as_json(answer) if json else health_text(answer), output)
    return DOCTOR[answer["works"]]
