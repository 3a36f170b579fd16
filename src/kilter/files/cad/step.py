"""Read files of solids with exact faces: STEP, IGES (.igs, .iges) and FreeCAD (.FCStd).

The readers need OCCT (the extra ``kilter[step]``), which runs in a separate process. A file that
crashes OCCT is rejected, and a solid that crashes it is replaced by a stand-in
(`kilter.files.cad.step_process`). The unit and the accuracy that the file states are kept. A solid
that is used in several places is read once and shared.
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Callable, Sequence
from pathlib import Path

from kilter.errors import InputError
from kilter.files.cad.step_process import format_of, read_apart
from kilter.files.limits import read_bytes
from kilter.files.meshes.placed import FileBodies

_TEXTS = re.compile(rb"'[^']*(?:'|\Z)|/\*(?:.*?\*/|.*)", re.DOTALL)
"""Texts and comments; without a closing mark they extend to the end of the file."""

_IGES = re.compile(rb"(?:.{72}C[ \d]{7}\s+)?.{72}S[ \d]{7}\s")
"""Begin of an IGES file: the mark of its compressed form, if any, and the first line."""


def read_step(
    path: Path,
    *,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> FileBodies:
    """Read the solids of a STEP or IGES file, or of a FreeCAD document.

    Arguments: `without`: names of solids, or globs, that are left out before they are triangulated.
    Raises `InputError` if OCCT is not installed, or the file is missing or damaged, or no solid is
    in it.
    """
    try:
        data = read_bytes(path)
        if format_of(path) == "STEP":
            _check_text(data)
        if format_of(path) == "IGES" and not _IGES.match(data):
            raise InputError(
                "not an IGES file: its first line has no S in column 73",
                hint="export it as STEP, or as IGES in its text form",
            )
        if importlib.util.find_spec("OCP") is None:
            raise InputError(
                f"{path.suffix} files need OCCT, which is not installed",
                hint="pip install 'kilter[step]', or export 3MF, or an STL file for each part",
            )
        return read_apart(path, tuple(without), progress or (lambda stage: None))
    except InputError as error:
        raise error.located(file=str(path)) from None


def _check_text(data: bytes) -> None:
    """Verify that the text of a STEP file is complete and defines every entity that it uses.

    References to undefined entities crash OCCT, and Python with it.

    Raises `InputError` if a check fails.
    """
    start = data[:4096].lstrip(b"\xef\xbb\xbf \t\r\n\0")
    if not start.startswith((b"ISO-10303-21", b"/*")):
        raise InputError(
            "not a STEP file: it does not begin with ISO-10303-21",
            hint="export it as STEP (AP214 or AP242)",
        )
    if b"END-ISO-10303-21" not in data[-4096:]:
        raise InputError(
            "damaged STEP: incomplete, it does not end with END-ISO-10303-21",
            hint="copy or export it again",
        )
    plain = _TEXTS.sub(b"", data)
    named = set(re.findall(rb"#(\d+)", plain))
    missing = named.difference(re.findall(rb"#(\d+)\s*=", plain))
    if missing:
        first = min(missing, key=lambda digits: (len(digits.lstrip(b"0")), digits)).decode()[:20]
        raise InputError(
            f"damaged STEP: {len(missing)} entities are named but not defined, such as #{first}",
            hint="copy or export it again",
        )
