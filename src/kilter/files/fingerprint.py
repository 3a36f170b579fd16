"""Detect changes of the files of an assembly by their times and sizes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

__all__ = ["Stamp", "fingerprint"]

Stamp = tuple[str, int, int]
"""Path, time of the last change [ns] and size [bytes] of a file."""


def fingerprint(file: str) -> tuple[Stamp, ...]:
    """Modification times and sizes of the files of an assembly, by which a change is noticed.

    The files are those in a folder, or a file and the meshes and STEP files that its JSON names.
    Missing files are left out, so that a file that reappears is a change.
    """
    path = Path(file)
    if path.is_dir():
        files = sorted(p for p in path.iterdir() if p.is_file())
    else:
        files = [path, *_named_in(path)]
    return tuple(stamp for name in files if (stamp := _stamp(name)) is not None)


def _stamp(path: Path) -> Stamp | None:
    """Path, modification time and size of a file; None if it is missing."""
    try:
        state = path.stat()
    except OSError:
        return None
    return str(path), state.st_mtime_ns, state.st_size


def _named_in(path: Path) -> list[Path]:
    """Paths of the mesh and STEP files that a JSON assembly file names."""
    if path.suffix.lower() != ".json":
        return []
    try:
        data: Any = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):  # missing, half written, or nested too deeply
        return []
    parts = data.get("parts") if isinstance(data, dict) else None
    listed = [part for part in parts if isinstance(part, dict)] if isinstance(parts, list) else []
    named = [part.get(key) for part in listed for key in ("mesh", "step")]
    named.append(data.get("file") if isinstance(data, dict) else None)  # the file of choices
    # an inline mesh is no name
    return [path.parent / name for name in sorted({n for n in named if isinstance(n, str)})]
