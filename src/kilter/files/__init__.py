"""Files that describe an assembly, read and written.

What is read: kilter's own JSON (`kilter_json`), COMPAS JSON (`compas`), meshes of several
objects (`formats`: OBJ, STL, 3MF, GLB, STEP) and folders of meshes (`folder`). What is written:
kilter's own JSON. Every fault of a file is one `InputError` that names file and part.

What is public is imported when it is first used: the process that reads STEP starts before.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kilter.files.kilter_json import from_dict as from_dict
    from kilter.files.kilter_json import schema as schema
    from kilter.files.kilter_json import to_dict as to_dict
    from kilter.files.reading import load as load
    from kilter.files.writing import dump as dump
    from kilter.files.writing import to_text as to_text
    from kilter.files.writing import write_bytes as write_bytes
    from kilter.files.writing import write_text as write_text

_HOMES = {
    "dump": "writing",
    "from_dict": "kilter_json",
    "load": "reading",
    "schema": "kilter_json",
    "to_dict": "kilter_json",
    "to_text": "writing",
    "write_bytes": "writing",
    "write_text": "writing",
}
"""Where each public name is from."""

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    try:
        home = _HOMES[name]
    except KeyError:
        raise AttributeError(f"module 'kilter.files' has no attribute {name!r}") from None
    return getattr(importlib.import_module(f"kilter.files.{home}"), name)
