"""Models of an SDF document, with their includes and the poses of all their frames.

A name inside a model is scoped: ``shelf::board``. A pose is relative to the frame that
`relative_to` names; by default to the model of a link or a nested model, to the child link of a
joint, and to the frame to which an explicit frame is attached.

References
----------
SDFormat, specification 1.4 to 1.12: model, include, frame, pose.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.limits import DEEPEST, MOST_LISTED, Tally, is_file, is_folder
from kilter.files.robots.xml_text import xml_root
from kilter.rigid import Pose

Element = ElementTree.Element
SCOPE = "::"
"""The mark between the name of a model and the name of an element inside it."""
PATHS = ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "SDF_PATH")
"""Environment variables with folders of models."""


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame: its pose relative to another frame, and the frame in it that the pose places."""

    above: str
    pose: Pose
    placed: str = ""


@dataclass(frozen=True, slots=True)
class Model:
    """A model of the document: its scoped name, its element, and the folder of its file."""

    name: str
    element: Element
    folder: Path
    static: bool
    top: str
    """Name of the outermost model that contains it."""


@dataclass(slots=True)
class Document:
    """The models of an SDF document, and its frames by scoped name."""

    models: list[Model] = field(default_factory=list)
    frames: dict[str, Frame] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    missing: dict[str, None] = field(default_factory=dict)
    """Names of the included models that are absent."""
    tally: Tally = field(default_factory=lambda: Tally("models and frames", MOST_LISTED))

    def pose(self, name: str, top: str = "") -> Pose:
        """Pose of a frame in the world, or in the model `top` around it.

        Raises `InputError` if a frame is unknown, or frames depend on each other in a loop.
        """
        chain: list[str] = []
        while name != top:
            if name in chain or len(chain) > DEEPEST:
                raise InputError("its pose depends on itself", part=name, hint="correct its frame")
            if name not in self.frames:
                raise InputError(f"the frame {name!r:.80} is unknown", hint="correct relative_to")
            chain.append(name)
            name = self.frames[name].above
        pose = Pose()
        for inner in reversed(chain):
            frame = self.frames[inner]
            pose = pose @ frame.pose
            if frame.placed:
                pose = pose @ self.pose(frame.placed, inner).inverse()
        return pose


def read_document(root: Element, path: Path) -> Document:
    """Read the models and frames of an SDF file, with those of the files that it includes.

    A note names the included models that are absent; the others are read.

    Raises `InputError` if a pose is invalid, or a model includes itself.
    """
    document = Document()
    worlds = root.findall("world")
    if len(worlds) > 1:
        names = ", ".join(repr(world.get("name", "")) for world in worlds[1:])
        document.notes.append(f"the first world is read, not {names}")
    within = worlds[0] if worlds else root
    _add_inside(document, within, "", path.parent, (), Model("", within, path.parent, False, ""))
    if document.missing:
        names = ", ".join(document.missing)
        document.notes.append(
            f"included models are absent, so they are left out: {names}; put their folders beside "
            "the file, or name their folder in GZ_SIM_RESOURCE_PATH"
        )
    return document


def words_of(element: Element | None, tag: str, default: str = "") -> str:
    """Text of the first element with a tag below an element, without spaces around it."""
    found = None if element is None else element.find(tag)
    return default if found is None else (found.text or "").strip() or default


def values_of(text: str, count: int, what: str) -> Array:
    """The `count` numbers of a text; raises `InputError` if they are invalid."""
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.empty(0)
    if len(values) != count or not np.isfinite(values).all():
        raise InputError(f"{what} is {text!r:.60}", hint=f"give {count} numbers")
    return values


def pose_of(element: Element) -> Pose:
    """The pose in the `pose` element of an element, without the frame that it is relative to."""
    row = element.find("pose")
    text = "" if row is None else (row.text or "").strip()
    if row is None or not text:
        return Pose()
    if row.get("rotation_format") == "quat_xyzw":
        values = values_of(text, 7, "a pose")
        return Pose(values[:3], values[[6, 3, 4, 5]])
    values = values_of(text, 6, "a pose")
    angles = np.deg2rad(values[3:]) if row.get("degrees") in ("true", "1") else values[3:]
    return Pose.from_euler(angles, values[:3])


def scoped(scope: str, name: str) -> str:
    """Name of a frame of a scope: ``__model__`` is the scope, ``world`` is the world."""
    if name in ("", "__model__"):
        return scope
    if name in ("world", "__root__"):
        return ""
    return f"{scope}{SCOPE}{name}" if scope else name


def relative_to(element: Element, scope: str, default: str) -> str:
    """Scoped name of the frame that the pose of an element is relative to."""
    row = element.find("pose")
    name = "" if row is None else row.get("relative_to") or row.get("frame") or ""
    return scoped(scope, name) if name else default


def _add_inside(
    document: Document,
    element: Element,
    scope: str,
    folder: Path,
    files: tuple[Path, ...],
    model: Model,
) -> None:
    """Add the models, links, joints and frames inside a model or a world to the document.

    `files`: files of the includes around the element.
    """
    for row in element:
        name = scoped(scope, row.get("name", ""))
        if row.tag in ("link", "frame", "joint"):
            document.tally.add(1)
            if name in document.frames:
                raise InputError("two elements have this name", part=name, hint="rename one")
        if row.tag == "link":
            document.frames[name] = Frame(relative_to(row, scope, scope), pose_of(row))
        elif row.tag == "frame":
            attached = scoped(scope, row.get("attached_to", ""))
            document.frames[name] = Frame(relative_to(row, scope, attached), pose_of(row))
        elif row.tag == "joint":
            child = scoped(scope, words_of(row, "child"))
            document.frames[name] = Frame(relative_to(row, scope, child), pose_of(row))
        elif row.tag == "model":
            _add_model(document, row, row, folder, files, (scope, model))
        elif row.tag == "include":
            _include(document, row, folder, files, (scope, model))


def _add_model(
    document: Document,
    element: Element,
    placing: Element,
    folder: Path,
    files: tuple[Path, ...],
    around: tuple[str, Model],
) -> None:
    """Add a model; `placing`: the element with its name and pose, its own or that of an include."""
    scope, outer = around
    name = scoped(scope, words_of(placing, "name") or element.get("name", "model"))
    if len(files) > DEEPEST or name.count(SCOPE) > DEEPEST:
        raise InputError("models are nested too deeply", part=name, hint="remove a model")
    document.tally.add(1)
    if name in document.frames:
        raise InputError("two models have this name", part=name, hint="rename one")
    placer = element if placing.find("pose") is None else placing
    frame = words_of(placing, "placement_frame") or element.get("placement_frame", "")
    static = words_of(placing, "static") or words_of(element, "static")
    model = Model(
        name,
        element,
        folder,
        static in ("true", "1") or outer.static,
        outer.top or name,
    )
    placed = scoped(name, frame) if frame and frame != "__model__" else ""
    document.frames[name] = Frame(relative_to(placer, scope, scope), pose_of(placer), placed)
    document.models.append(model)
    _add_inside(document, element, name, folder, files, model)


def _include(
    document: Document,
    row: Element,
    folder: Path,
    files: tuple[Path, ...],
    around: tuple[str, Model],
) -> None:
    """Add the model of a file that an `include` element names."""
    uri = words_of(row, "uri")
    file = next(_model_files(uri, folder), None)
    if file is None:
        document.missing[repr(uri)[:80]] = None
        return
    if file in files:
        raise InputError(f"the model {uri!r:.60} includes itself", hint="remove the include")
    root = xml_root(file)
    if root.tag != "sdf":
        document.missing[f"{uri!r:.80} (no SDF)"] = None
        return
    for element in root.findall("model")[:1]:
        _add_model(document, element, row, file.parent, (*files, file), around)


def _model_files(uri: str, folder: Path) -> Iterator[Path]:
    """Yield the file of an included model: a folder of models, or a file."""
    for path in named_paths(uri, folder):
        if is_file(path):
            yield path
        elif is_folder(path):
            stated = path / "model.config"
            names = [words_of(xml_root(stated), "sdf")] if is_file(stated) else []
            for name in [*names, "model.sdf"]:
                if name and is_file(path / name):
                    yield path / name


def named_paths(uri: str, folder: Path) -> Iterator[Path]:
    """Yield the places of a file or folder that a URI names, those beside the file first."""
    scheme, mark, name = uri.partition("://")
    if not mark:
        yield folder / uri
        return
    if scheme == "file":
        yield folder / name
    if scheme not in ("model", "package"):
        return
    places = [Path(text) for key in PATHS for text in os.environ.get(key, "").split(":") if text]
    for place in (folder, *folder.resolve().parents, *places):
        yield place / name
        yield place / "models" / name
        if place.name == name.partition("/")[0]:
            yield place.parent / name
