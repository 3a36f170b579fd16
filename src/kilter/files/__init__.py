"""Files that describe an assembly, read and written.

What is read: kilter's own JSON (`kilter_json`), COMPAS JSON (`compas`), meshes of several
objects (`formats`: OBJ, STL, 3MF, GLB, STEP) and folders of meshes (`folder`). What is written:
kilter's own JSON. Every fault of a file is one `InputError` that names file and part.
"""

from kilter.files.kilter_json import from_dict, schema, to_dict
from kilter.files.reading import load
from kilter.files.writing import dump, to_text, write_bytes, write_text

__all__ = [
    "dump",
    "from_dict",
    "load",
    "schema",
    "to_dict",
    "to_text",
    "write_bytes",
    "write_text",
]
