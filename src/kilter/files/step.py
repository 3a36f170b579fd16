"""STEP files (.step, .stp): assemblies of solids with exact faces.

Needs OCCT (the extra ``kilter[step]``), which is loaded when a STEP file is read. The unit of
the file is kept. A solid that is used in several places is read once and shared.
"""

from __future__ import annotations

import importlib.util
import re
from dataclasses import dataclass
from pathlib import Path

from kilter.assembly import Assembly, Part
from kilter.errors import InputError, nearest_name, some_names
from kilter.files.raw import read_bytes
from kilter.rigid import Pose
from kilter.shape.solid import Solid, moved_solid

__all__ = ["SUFFIXES", "StepSolids", "load_step", "read_step"]

SUFFIXES = (".step", ".stp")
"""Endings of STEP files, lower case."""
_TEXTS = re.compile(rb"'[^']*'|/\*.*?\*/", re.DOTALL)


@dataclass(frozen=True, slots=True, eq=False)
class StepSolids:
    """What a STEP file holds, in its own unit.

    Attributes
    ----------
    names : tuple of str
        Distinct, ``assembly/part_1``.
    solids : tuple of Solid
        In their own frames; one that is used several times is the same object.
    poses : tuple of Pose
        From the frame of the solid to that of the file.
    units : {"m", "cm", "mm", "in"}
    notes : tuple of str
    """

    names: tuple[str, ...]
    solids: tuple[Solid, ...]
    poses: tuple[Pose, ...]
    units: str
    notes: tuple[str, ...] = ()

    def named(self, name: str | None) -> Solid:
        """One solid, where the file has it; the name may be left out where there is one.

        Raises
        ------
        InputError
            If there is none of that name, or several and no name was given.
        """
        if name is None and len(self.names) > 1:
            raise InputError(
                f"it holds {len(self.names)} solids: {some_names(self.names)}",
                hint='name one: {"path": ..., "name": ...}',
            )
        if name is not None and name not in self.names:
            near = nearest_name(name, self.names)
            hint = f"did you mean {near!r}?" if near else f"there are: {some_names(self.names)}"
            raise InputError(f"it holds no solid {name!r}", hint=hint)
        k = 0 if name is None else self.names.index(name)
        return moved_solid(self.solids[k], self.poses[k])


def load_step(path: Path, *, units: str | None = None) -> Assembly:
    """An assembly of the solids of one STEP file.

    Raises
    ------
    InputError
        As `read_step`; and if `units` differ from those of the file.
    """
    found = read_step(path)
    if units is not None and units != found.units:
        raise InputError(
            f"the file is in {found.units}, {units} were asked for",
            file=str(path),
            hint="leave the units out",
        )
    try:
        rows = zip(found.names, found.solids, found.poses, strict=True)
        parts = [Part(name, solid, pose) for name, solid, pose in rows]
    except InputError as error:
        raise error.located(file=str(path)) from None
    return Assembly(parts, units=found.units, source=str(path), notes=found.notes)


def read_step(path: Path) -> StepSolids:
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


def _read(path: Path) -> StepSolids:
    from kilter.files.step_document import quiet, read_document
    from kilter.files.step_solids import read_solid

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
    return StepSolids(
        names=tuple(one.name for one in document.solids),
        solids=tuple(solids[one.key] for one in document.solids),
        poses=tuple(one.pose for one in document.solids),
        units=document.units,
        notes=document.notes,
    )
