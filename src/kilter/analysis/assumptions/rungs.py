"""The rung of assumptions that a question names, and the kinds of files that have a ladder."""

from __future__ import annotations

from pathlib import Path

from kilter.assembly import Assembly
from kilter.assembly.assumption import DRAWN, PLAY
from kilter.assembly.question import Question

SIMULATED = (".xml", ".mjcf", ".urdf", ".usd", ".usda", ".usdc", ".usdz", ".sdf", ".world")
"""Endings of the files of simulators, whose default rung is "play"."""
COLLIDER = "collider"
"""Geometry of a part of a simulator, whose model in memory has no file."""
DRAWINGS = (
    *(".step", ".stp", ".igs", ".iges", ".fcstd", ".3dm", ".3mf", ".stl", ".obj", ".ply", ".off"),
    *(".dae", ".gltf", ".glb"),
)
"""Endings of the files whose answers have a ladder; folders of such files have one, too."""


def is_simulated(assembly: Assembly) -> bool:
    """Whether an assembly comes from a file or a model of a simulator."""
    collides = any(part.geometry == COLLIDER for part in assembly.parts)
    return collides or Path(assembly.source).suffix.lower() in SIMULATED


def rung_of(asked: Question, default: str | None = None) -> str:
    """The rung of a question: the given one, else that of the saved choices, else the default.

    `default`: None for that of the file: play for files of simulators, else drawn.
    """
    saved = (asked.assembly.reading or {}).get("assume")
    of_file = PLAY if is_simulated(asked.assembly) else DRAWN
    return asked.assume or saved or default or of_file


def is_drawing(assembly: Assembly) -> bool:
    """Whether an assembly comes from CAD, from a mesh file, or from a folder of them."""
    source = Path(assembly.source)
    return bool(assembly.source) and (source.suffix.lower() in DRAWINGS or source.is_dir())
