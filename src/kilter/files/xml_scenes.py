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
from kilter.files.start_folder import is_restricted, require_below
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
            if is_restricted():
                _require_named_below(root, path.parent)
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


FOLDERS = ("meshdir", "texturedir", "assetdir")
"""Attributes of MJCF that name folders of assets."""


def _require_named_below(root: ElementTree.Element, folder: Path) -> None:
    """Verify that MuJoCo will open only files below the start folder.

    Each attribute that begins with "file" is resolved in the folder of the scene and in each asset
    folder. Included scenes are examined too.

    Raises
    ------
    InputError
        If a named file may be outside.
    """
    waiting, seen = [root], {folder}
    folders = {folder}
    names: list[tuple[str, str]] = []
    while waiting:
        for element in waiting.pop().iter():
            folders |= {folder / element.get(key, "") for key in FOLDERS if element.get(key)}
            named = [value for key, value in element.items() if key.startswith("file") and value]
            names += [(element.tag, value) for value in named]
            for value in named if element.tag in ("include", "model") else ():
                if (folder / value) not in seen:
                    seen.add(folder / value)
                    folders.add((folder / value).parent)
                    waiting.append(ElementTree.fromstring(read_bytes(folder / value)))
    for _, value in names:
        for place in folders:
            require_below(place / value)
