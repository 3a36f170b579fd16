"""Read and write files that describe an assembly.

Readers: kilter's own JSON (`kilter_json`), COMPAS JSON (`compas`), meshes of several objects
(`formats`: OBJ, STL, 3MF, GLB, STEP) and folders of meshes (`folder`). The writer writes kilter's
own JSON. A fault in a file raises an `InputError` that names file and part.

Public names are imported at their first use, so that the process that reads STEP starts fast.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kilter.files.own.kilter_json import from_dict as from_dict
    from kilter.files.own.kilter_json import schema as schema
    from kilter.files.own.kilter_json import to_dict as to_dict
    from kilter.files.writing import dump as dump
    from kilter.files.writing import to_text as to_text
    from kilter.files.writing import write_bytes as write_bytes
    from kilter.files.writing import write_text as write_text

_HOMES = {
    "dump": "writing",
    "from_dict": "own.kilter_json",
    "schema": "own.kilter_json",
    "to_dict": "own.kilter_json",
    "to_text": "writing",
    "write_bytes": "writing",
    "write_text": "writing",
}
"""Module that defines each public name."""

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    try:
        home = _HOMES[name]
    except KeyError:
        raise AttributeError(f"module 'kilter.files' has no attribute {name!r}") from None
    return getattr(importlib.import_module(f"kilter.files.{home}"), name)
