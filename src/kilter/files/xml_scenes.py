"""Scenes in XML: MJCF of MuJoCo, and URDF; told apart by the element at the top."""

from __future__ import annotations

import importlib
from pathlib import Path
from xml.etree import ElementTree

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.choices import Choices
from kilter.files.limits import require_few_entries
from kilter.files.raw import read_bytes
from kilter.files.urdf import read_urdf

__all__ = ["XML", "load_xml"]

XML = (".xml", ".mjcf", ".urdf")
"""Endings of such files."""


def load_xml(path: Path, choices: Choices) -> tuple[Assembly, bool]:
    """The assembly of a scene, and whether it says which way gravity points.

    Raises
    ------
    InputError
        If it is neither, or damaged; it names the file.
    """
    data = read_bytes(path)
    try:
        try:
            require_few_entries(data)
            root = ElementTree.fromstring(data)
        except (ElementTree.ParseError, ValueError) as error:
            raise InputError(f"its XML is wrong: {error}", hint="mend the file") from None
        if root.tag == "robot":
            return read_urdf(root, path, choices), True
        if root.tag == "mujoco":
            reader = importlib.import_module("kilter.files.objects.mujoco_objects")
            return reader.read_mjcf(path, choices), True
        raise InputError(
            f"its top element is {root.tag!r:.40}",
            hint="MJCF begins with <mujoco>, URDF with <robot>",
        )
    except InputError as error:
        raise error.located(file=str(path)) from None
