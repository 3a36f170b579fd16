"""Native formats of CAD programs, which only these programs read, and the export to use instead."""

from __future__ import annotations

from pathlib import Path

_STEP = "a STEP file (.step)"
EXPORTS: dict[str, str] = {
    **dict.fromkeys((".sldasm", ".sldprt"), f"SolidWorks: open it, then File, Save As, as {_STEP}"),
    **dict.fromkeys(
        (".iam", ".ipt"), f"Inventor: open it, then File, Export, CAD Format, as {_STEP}"
    ),
    **dict.fromkeys((".catproduct", ".catpart"), f"CATIA: open it, then File, Save As, as {_STEP}"),
    ".prt": f"NX: File, Export, STEP; or Creo: File, Save As, Save a Copy; each writes {_STEP}",
    ".asm": f"Creo: File, Save As, Save a Copy; or Solid Edge: Save As; each writes {_STEP}",
    **dict.fromkeys((".par", ".psm"), f"Solid Edge: open it, then Save As, as {_STEP}"),
    **dict.fromkeys((".f3d", ".f3z"), f"Fusion: open it, then File, Export, as {_STEP}"),
    ".jt": f"the CAD program that wrote it: export {_STEP} there",
    **dict.fromkeys(
        (".x_t", ".x_b", ".sat", ".sab"),
        f"a CAD program that imports it (Fusion, Onshape, Solid Edge): export {_STEP} there",
    ),
    ".skp": "SketchUp: File, Export, 3D Model, type OBJ, with a solid group for each part",
    ".blend": "Blender: File, Export, glTF (.glb), with an object for each part",
    ".ifc": "FreeCAD: open it with the BIM workbench, select the bodies, export a STEP file",
    ".scad": "OpenSCAD: render it (F6), then File, Export, type 3MF",
    ".dwg": f"the CAD program that wrote it: export its solids as {_STEP}",
}
"""For each ending of a native format (lower case): the program, and the export that works in it."""


def export_hint(path: Path) -> str | None:
    """Program and export for a file of a native format; None for other files."""
    # Creo appends the number of the version: frame.asm.7
    suffixes = [suffix.lower() for suffix in path.suffixes[-2:]]
    if len(suffixes) == 2 and suffixes[1][1:].isdigit():
        suffixes.pop()
    return EXPORTS.get(suffixes[-1]) if suffixes else None
