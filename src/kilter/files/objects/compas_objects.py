"""Read COMPAS objects: assemblies of blocks, blocks and meshes.

COMPAS serialises the object as in its files, and the reader of these files reads that text.
"""

from __future__ import annotations

from typing import Any

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.compas import from_compas
from kilter.files.complaints import parse_json
from kilter.files.format_options import FormatOptions


def read(value: Any, choices: FormatOptions) -> Assembly:
    """Convert a compas_assembly Assembly or Block, or a compas Mesh, to a kilter assembly.

    Raises
    ------
    InputError
        If the object is none of these.
    """
    import compas

    text = compas.json_dumps(value)
    try:
        return from_compas(
            parse_json(text.encode("utf-8")), units=choices.units, contacts=choices.contacts
        )
    except InputError as error:
        if error.part is not None:
            raise
        hint = "give a compas_assembly Assembly or Block, or a compas Mesh (Mesh.from_shape)"
        raise InputError(error.what, hint=hint) from None
