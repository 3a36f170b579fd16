"""STEP files (.step, .stp): assemblies of solids with exact faces.

Needs OCCT (the extra ``kilter[step]``), which is loaded when a STEP file is read, in a process of
its own: a file on which it breaks down is refused, and a solid on which it does stands aside
(`kilter.files.step_process`). The unit of the file is kept, and the accuracy that it states. A
solid that is used in several places is read once and shared.
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Callable, Sequence
from pathlib import Path

from kilter.errors import InputError
from kilter.files.placed import FileBodies
from kilter.files.raw import read_bytes
from kilter.files.step_process import read_apart

__all__ = ["read_step"]

_TEXTS = re.compile(rb"'[^']*(?:'|\Z)|/\*(?:.*?\*/|.*)", re.DOTALL)
"""Texts and comments; one that does not end reaches to the end, so that none is sought twice."""


def read_step(
    path: Path,
    *,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> FileBodies:
    """The solids of a STEP file.

    Parameters
    ----------
    without : sequence of str
        Names of solids, or globs, that are left out before they are cut into triangles.
    progress : callable, optional
        Called with a word at each stage.

    Raises
    ------
    InputError
        If OCCT is not installed, or the file is missing, no STEP file, damaged, or holds no
        solid.
    """
    try:
        _check_text(read_bytes(path))
        if importlib.util.find_spec("OCP") is None:
            raise InputError(
                "STEP files need OCCT, which is not installed",
                hint="pip install 'kilter[step]', or export it as 3MF, or one STL a part",
            )
        return read_apart(path, tuple(without), progress or (lambda stage: None))
    except InputError as error:
        raise error.located(file=str(path)) from None


def _check_text(data: bytes) -> None:
    """Refuse what does not begin and end as a STEP file does, or names what it does not define.

    OCCT breaks down, and Python with it, over references to entities that are not there.
    """
    start = data[:4096].lstrip(b"\xef\xbb\xbf \t\r\n\0")
    if not start.startswith((b"ISO-10303-21", b"/*")):
        raise InputError(
            "not a STEP file: it does not begin with ISO-10303-21",
            hint="export it as STEP (AP214 or AP242)",
        )
    if b"END-ISO-10303-21" not in data[-4096:]:
        raise InputError(
            "damaged STEP: cut short, it does not end with END-ISO-10303-21",
            hint="copy or export it again",
        )
    plain = _TEXTS.sub(b"", data)
    named = set(re.findall(rb"#(\d+)", plain))
    missing = named.difference(re.findall(rb"#(\d+)\s*=", plain))
    if missing:
        first = min(missing, key=lambda digits: (len(digits.lstrip(b"0")), digits)).decode()[:20]
        raise InputError(
            f"damaged STEP: {len(missing)} entities are named but not there, the first is #{first}",
            hint="copy or export it again",
        )
