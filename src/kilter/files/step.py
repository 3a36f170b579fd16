"""STEP files (.step, .stp): assemblies of solids with exact faces.

Needs OCCT (the extra ``kilter[step]``), which is loaded when a STEP file is read. The unit of
the file is kept. A solid that is used in several places is read once and shared.
"""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

from kilter.errors import InputError
from kilter.files.placed import FileBodies
from kilter.files.raw import read_bytes
from kilter.files.step_document import quiet, read_document
from kilter.files.step_solids import read_solid
from kilter.shape.solid import Solid

__all__ = ["read_step"]

_TEXTS = re.compile(rb"'[^']*'|/\*.*?\*/", re.DOTALL)


def read_step(path: Path) -> FileBodies:
    """The solids of a STEP file.

    Raises
    ------
    InputError
        If OCCT is not installed, or the file is missing, no STEP file, damaged, holds no solid
        or one that is not closed.
    """
    try:
        _check_text(read_bytes(path))
        if importlib.util.find_spec("OCP") is None:
            raise InputError(
                "STEP files need OCCT, which is not installed",
                hint="pip install 'kilter[step]', or export it as 3MF, or one STL a part",
            )
        return _read(path)
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
        first = min(int(number) for number in missing)
        raise InputError(
            f"damaged STEP: {len(missing)} entities are named but not there, the first is #{first}",
            hint="copy or export it again",
        )


def _read(path: Path) -> FileBodies:

    document = read_document(path)
    solids: dict[int, Solid] = {}
    with quiet():
        for one in document.solids:
            if one.key in solids:
                continue
            try:
                solids[one.key] = read_solid(one.shape)
            except InputError as error:
                raise error.located(part=one.name) from None
    return FileBodies(
        names=tuple(one.name for one in document.solids),
        shapes=tuple(solids[one.key] for one in document.solids),
        poses=tuple(one.pose for one in document.solids),
        units=document.units,
        notes=document.notes,
    )
