"""The command `doctor`: test of the installation."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from kilter.cli.exit_codes import DOCTOR
from kilter.cli.options import Json, Output, takes
from kilter.cli.output import as_json, emit, writes_json

__all__ = ["doctor"]


@dataclass(frozen=True, kw_only=True)
class DoctorOptions:
    """Options of `doctor`."""

    json: bool = Json()
    output: Path | None = Output()


@takes
def doctor(options: DoctorOptions) -> int:
    """Test whether this installation works: versions, solvers, extras, STEP, page, terminal.

    Each part computes something with a known result. The test uses no network. Copy its text into
    a bug report.

    Exit code: 0 all installed parts work, 1 a part is broken. A missing extra is not broken.
    """
    from kilter.health import doctor as look
    from kilter.tell.health_text import health_text

    answer = look().to_dict()
    emit(
        as_json(answer) if writes_json(options.json, options.output) else health_text(answer),
        options.output,
    )
    return DOCTOR[answer["works"]]
