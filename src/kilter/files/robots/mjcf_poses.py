"""Write new poses into a copy of a user's MJCF file, whose other text stays byte for byte.

The poses become a keyframe, or the positions of the bodies if the file has no keyframe. In another
folder than that of the file, the paths of its assets are changed as well. MuJoCo reads the copy
before it replaces the output: its positions must be the intended ones.
"""

from __future__ import annotations

import os
import re
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import quoteattr, unescape

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.format_options import FormatOptions
from kilter.files.limits import read_bytes
from kilter.files.objects.mujoco_joints import FREE
from kilter.files.objects.mujoco_snapshot import Snapshot
from kilter.files.objects.state_scenes import StateScene, open_scene
from kilter.files.robots.scene_process import is_mjcf
from kilter.files.writing import write_bytes

NEW_KEY = "rest"
"""Name of a keyframe that is added without a name."""
SAME = 1e-9
"""Largest difference of the positions that MuJoCo reads from the copy [m] or [rad]."""
TURNS = ("euler", "axisangle", "xyaxes", "zaxis")
"""Attributes of a body that state its orientation, besides its quaternion."""
TAG = re.compile(r"<(/?)([\w:.-]+)((?:[^<>\"']|\"[^\"]*\"|'[^']*')*?)(/?)>")
HIDDEN = re.compile(r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>", re.DOTALL)
ATTRIBUTE = re.compile(r"\s+([\w:.-]+)\s*=\s*(\"[^\"]*\"|'[^']*')")


class Element(NamedTuple):
    """A start tag in a text: its name, the names of the elements above, and its place."""

    name: str
    above: tuple[str, ...]
    start: int
    end: int

    def attributes(self, text: str) -> dict[str, tuple[str, int, int]]:
        """Value, start and end of each attribute of the tag."""
        inside = text[self.start : self.end]
        return {
            match[1]: (
                unescape(match[2][1:-1], {"&quot;": '"', "&apos;": "'"}),
                self.start + match.start(),
                self.start + match.end(),
            )
            for match in ATTRIBUTE.finditer(inside)
        }


@dataclass(slots=True)
class XmlText:
    """A text in XML, and replacements of some of its places."""

    text: str
    edits: list[tuple[int, int, str]] = field(default_factory=list)

    def elements(self) -> list[Element]:
        """The start tags in order, without those in comments."""
        shown = HIDDEN.sub(lambda match: " " * len(match[0]), self.text)
        above: list[str] = []
        found = []
        for match in TAG.finditer(shown):
            if match[1]:
                while above and above.pop() != match[2]:
                    pass
                continue
            found.append(Element(match[2], tuple(above), match.start(), match.end()))
            if not match[4]:
                above.append(match[2])
        return found

    def set(self, element: Element, values: Mapping[str, str | None]) -> None:
        """Set attributes of an element; those with None are removed."""
        given = element.attributes(self.text)
        added = ""
        for name, value in values.items():
            words = "" if value is None else f" {name}={quoteattr(value)}"
            if name in given:
                self.edits.append((given[name][1], given[name][2], words))
            else:
                added += words
        after = max([element.start + 1 + len(element.name), *(end for _, _, end in given.values())])
        if added:
            self.edits.append((after, after, added))

    def append(self, lines: Sequence[str]) -> None:
        """Add lines before the end of the root element."""
        shown = HIDDEN.sub(lambda match: " " * len(match[0]), self.text)
        place = shown.rindex("</mujoco")
        line = self.text.rfind("\n", 0, place) + 1
        newline = "\r\n" if "\r\n" in self.text else "\n"
        added = "".join(f"  {each}{newline}" for each in lines)
        if self.text[line:place].strip():  # the end does not begin its line
            line, added = place, newline + added
        self.edits.append((line, line, added))

    def edited(self) -> str:
        """The text with all replacements."""
        text = self.text
        for start, end, words in sorted(self.edits, reverse=True):
            text = text[:start] + words + text[end:]
        return text


def is_mjcf_file(path: Path) -> bool:
    """Whether a path is that of an MJCF file in XML."""
    return path.suffix.lower() in (".xml", ".mjcf") and path.is_file() and is_mjcf(path)


def key_to_write(source: Path, name: str | None) -> tuple[str | None, str | None]:
    """The keyframe to read and the keyframe to write for a name that a user gives.

    A keyframe that exists is read, and replaced in the copy. A name that does not exist is that of
    a new keyframe, and the default pose is read.
    """
    if name is None:
        return None, None
    keys = open_scene(source, FormatOptions()).snapshot.keys
    return (name if name in keys else None), name


def write_mjcf_poses(
    source: Path, output: Path, scene: StateScene, qpos: Array, key: str | None
) -> str:
    """Write a copy of an MJCF file with new positions of joints; return where they are in it.

    Arguments: `scene`: the scene in the pose that moved; `key`: name of the keyframe to write. By
    default it is that of the pose, or the bodies move if the pose is not that of a keyframe.
    Raises `InputError` if the keyframe is in an included file, or the copy cannot be read.
    """
    model = scene.snapshot
    text = read_bytes(source).decode("utf-8", "surrogateescape")
    if key is None and not model.keys:
        moved = XmlText(text)
        # a frame around a body, or a default, may change its pose: then a keyframe has the poses
        if _move_bodies(moved, model, qpos) and _written(moved, source, output, model, qpos, None):
            return "its bodies have the new poses"
    copy = XmlText(text)
    if key is None and scene.options.states is None and model.key is not None:
        index = model.key
        name, words = _replace_key(copy, model, qpos, model.keys[index], index)
    else:
        name, words = _replace_key(copy, model, qpos, key or _free_name(model), None)
    if not _written(copy, source, output, model, qpos, name):
        raise InputError(
            "MuJoCo reads other positions from a copy than the new ones",
            file=str(source),
            hint="write the poses to X.npy",
        )
    return words


def _free_name(model: Snapshot) -> str:
    """A name for a new keyframe."""
    names = [NEW_KEY, *(f"{NEW_KEY}_{k}" for k in range(2, len(model.keys) + 3))]
    return next(name for name in names if name not in model.keys)


def _move_bodies(copy: XmlText, model: Snapshot, qpos: Array) -> bool:
    """Set the poses of free bodies; False if the text does not state them all."""
    changed = qpos != model.qpos0
    bodies: dict[str, list[Element]] = {}
    for element in copy.elements():
        if element.name == "body" and element.above == ("mujoco", "worldbody"):
            name = element.attributes(copy.text).get("name", ("",))[0]
            bodies.setdefault(name, []).append(element)
    for joint in np.flatnonzero(model.jnt_type == FREE).tolist():
        start = int(model.jnt_qposadr[joint])
        place = slice(start, start + 7)
        if not changed[place].any():
            continue
        found = bodies.get(model.body_names[int(model.jnt_bodyid[joint])] or "\0", [])
        if len(found) != 1:
            return False
        pose = qpos[place]
        values = {"pos": _words(pose[:3])}
        if changed[start + 3 : start + 7].any():
            values["quat"] = _words(pose[3:])
        turns = _stated(found[0], copy, TURNS) if "quat" in values else []
        copy.set(found[0], {**values, **dict.fromkeys(turns)})
        changed[place] = False
    return not changed.any()


def _stated(element: Element, copy: XmlText, names: Sequence[str]) -> list[str]:
    """The given attributes that an element has."""
    given = element.attributes(copy.text)
    return [name for name in names if name in given]


def _replace_key(
    copy: XmlText, model: Snapshot, qpos: Array, name: str, index: int | None
) -> tuple[str | None, str]:
    """Replace the positions of a keyframe, or add one; return its name and words about it.

    Arguments: `index`: that of a keyframe of the model, which may have no name; None: by name.
    """
    keys = [e for e in copy.elements() if e.name == "key" and e.above == ("mujoco", "keyframe")]
    names = [element.attributes(copy.text).get("name", ("",))[0] for element in keys]
    place = None
    if name and name in names:
        place = names.index(name)
    elif not name and index is not None and len(keys) == len(model.keys):
        place = index
    if place is not None:
        old = dict.fromkeys(_stated(keys[place], copy, ["qvel"]))
        copy.set(keys[place], {"qpos": _words(qpos), **old})
        told = f"its keyframe {name!r}" if name else f"its keyframe {place}"
        return name or None, f"{told} has the new poses"
    if name and name in model.keys and index is None:
        raise InputError(
            f"the keyframe {name!r:.80} is in an included file", hint="give the name of a new one"
        )
    name = name if name and name not in model.keys else _free_name(model)
    values = {"name": name, "qpos": _words(qpos)}
    values |= {k: _words(v) for k, v in model.key_values.items() if np.size(v)}
    words = "".join(f" {k}={quoteattr(v)}" for k, v in values.items())
    copy.append(["<keyframe>", f"  <key{words}/>", "</keyframe>"])
    return name, f"its new keyframe {name!r} has the new poses"


def _words(values: Array) -> str:
    """Numbers as text that is read without a change."""
    return " ".join(repr(float(value) + 0.0).removesuffix(".0") for value in np.ravel(values))


def _written(
    copy: XmlText, source: Path, output: Path, model: Snapshot, qpos: Array, key: str | None
) -> bool:
    """Write a copy if MuJoCo reads the intended positions from it, in the folder of the output.

    Returns whether it was written. Raises `InputError` if MuJoCo rejects the copy.
    """
    folder = Path(os.path.realpath(output)).parent
    if folder != Path(os.path.realpath(source)).parent:
        _move_paths(copy, source, folder, model)
    data = copy.edited().encode("utf-8", "surrogateescape")
    trial = folder / f".{secrets.token_hex(8)}.xml"
    write_bytes(trial, data)
    try:
        read = open_scene(trial, FormatOptions(keyframe=key)).snapshot.qpos
    except InputError as error:
        raise InputError(
            f"the copy cannot be read: {error.what}",
            file=str(output),
            hint=f"write it beside {source.name!r}, where its assets are",
        ) from None
    finally:
        trial.unlink(missing_ok=True)
    if read.shape != qpos.shape or np.abs(read - qpos).max(initial=0.0) > SAME:
        return False
    write_bytes(output, data)
    return True


def _move_paths(copy: XmlText, source: Path, folder: Path, model: Snapshot) -> None:
    """Change the paths of included files, models and assets to those from another folder."""
    home = Path(os.path.realpath(source)).parent
    for element in copy.elements():
        if element.name in ("include", "model"):
            file = element.attributes(copy.text).get("file", ("",))[0]
            if file and not os.path.isabs(file):
                copy.set(element, {"file": _path_from(folder, home / file)})
    if model.asset_folders is not None:
        names = ("meshdir", "texturedir")
        places = [_path_from(folder, home / each) for each in model.asset_folders]
        words = "".join(
            f" {name}={quoteattr(place)}" for name, place in zip(names, places, strict=True)
        )
        copy.append([f"<compiler{words}/>"])


def _path_from(folder: Path, path: Path) -> str:
    """Path relative to a folder; absolute where no relative path exists."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # another drive
        return path.as_posix()
