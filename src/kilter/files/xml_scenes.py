"""Read scenes in XML, MJCF or URDF; the root element selects the reader."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.format_options import FormatOptions
from kilter.files.limits import require_few_entries
from kilter.files.objects.mujoco_objects import read_mjcf
from kilter.files.raw import read_bytes
from kilter.files.urdf import read_urdf

__all__ = ["load_xml", "xml_root"]


def load_xml(path: Path, choices: FormatOptions) -> tuple[Assembly, bool]:
    """Read an MJCF or URDF file; also return whether it fixes the direction of gravity.

    Returns
    -------
    assembly : Assembly
    states_gravity : bool
        Always True: both formats fix the direction of gravity.

    Raises
    ------
    InputError
        If the file is neither MJCF nor URDF, or is damaged; the error names the file.
    """
    root = xml_root(path)
    try:
        if root.tag == "robot":
            return read_urdf(root, path, choices), True
        if root.tag == "mujoco":
            return read_mjcf(path, choices), True
        raise InputError(
            f"the root element is {root.tag!r:.40}",
            hint="MJCF begins with <mujoco>, URDF with <robot>",
        )
    except InputError as error:
        raise error.located(file=str(path)) from None


def xml_root(path: Path) -> ElementTree.Element:
    """Root element of an XML file.

    Raises
    ------
    InputError
        If the file cannot be read or is no XML; the error names the file.
    """
    data = read_bytes(path)
    try:
        require_few_entries(data)
        return ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError) as error:
        raise InputError(
            f"the XML is invalid: {error}", file=str(path), hint="correct the file"
        ) from None
    except InputError as error:
        raise error.located(file=str(path)) from None
