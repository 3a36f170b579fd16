"""Read scenes in XML: MJCF, URDF or SDF; the root element selects the reader."""

from __future__ import annotations

from pathlib import Path

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.format_options import FormatOptions
from kilter.files.objects.mujoco_objects import ModelScene
from kilter.files.reader_guard import reader_guard
from kilter.files.robots.scene_process import read_scene
from kilter.files.robots.sdf import read_sdf
from kilter.files.robots.urdf import read_urdf
from kilter.files.robots.xml_text import xml_root


def load_xml(path: Path, choices: FormatOptions) -> tuple[Assembly, bool]:
    """Read an MJCF, URDF or SDF file; also return whether it fixes the direction of gravity.

    Returns `states_gravity`: always True: these formats fix the direction of gravity. Raises
    `InputError` if the file is none of these, or is damaged; the error names the file.
    """
    root = xml_root(path)
    with reader_guard(path):
        if root.tag in ("robot", "sdf") and choices.states is not None:
            kind = {"robot": "URDF", "sdf": "SDF"}[root.tag]
            raise InputError(
                f"states belong to an MJCF scene, and this is {kind}", hint="leave the state out"
            )
        if root.tag == "sdf":
            return read_sdf(root, path), True
        if root.tag == "robot":
            return read_urdf(root, path, choices), True
        if root.tag == "mujoco":
            model = read_scene("mjcf", path, choices)
            return ModelScene(model, choices).assembly(str(path)), True
        raise InputError(
            f"the root element is {root.tag!r:.40}",
            hint="MJCF begins with <mujoco>, URDF with <robot>, SDF with <sdf>",
        )
