"""Read COMPAS objects: assemblies of blocks, blocks, meshes, models and problems of compas_dem.

COMPAS serialises the object as in its files, and the reader of these files reads that text.
"""

from __future__ import annotations

from typing import Any

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.compas_files import from_compas
from kilter.files.complaints import parse_json
from kilter.files.format_options import FormatOptions


def read(value: Any, choices: FormatOptions) -> Assembly:
    """Convert an object of compas, compas_assembly or compas_dem to a kilter assembly.

    It is an Assembly, a Block, a Mesh, a BlockModel, or a Problem with its model.

    Raises
    ------
    InputError
        If the object is none of these.
    """
    import compas

    model = getattr(value, "_model", None) if hasattr(value, "model_id") else None
    text = compas.json_dumps(value if model is None else [model, value])
    try:
        return from_compas(
            parse_json(text.encode("utf-8")), units=choices.units, contacts=choices.contacts
        )
    except InputError as error:
        if error.part is not None:
            raise
        hint = (
            "give a compas_assembly Assembly or Block, a compas Mesh (Mesh.from_shape), or a "
            "compas_dem BlockModel or Problem with its model"
        )
        raise InputError(error.what, hint=hint) from None
