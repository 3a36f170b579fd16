"""Survey of an MJCF scene before MuJoCo builds it: counts that it would make, files that it names.

A few bytes of MJCF can make millions of parts. A `replicate` multiplies its content, an `attach`
copies a model of another file, and sizes of height fields, meshes, textures and keyframes are
plain numbers. Each count is limited here. Files must be regular files, since a pipe has no end.

    n(element) = count * sum of n(children) + 1,     count = 1 except for `replicate`
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from math import prod
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from kilter.errors import InputError
from kilter.files.limits import (
    MOST_PARTS,
    MOST_TRIANGLES,
    SceneCount,
    require_below,
    require_count,
    require_regular,
)
from kilter.files.robots.xml_text import xml_root

MOST_KEYS = 50_000
"""Largest number of keyframes."""
MOST_ELEMENTS = 500_000
"""Largest number of elements after replication; MuJoCo needs about a kilobyte for each."""
MOST_PIXELS = 25_000_000
"""Largest number of pixels of all generated textures."""
FOLDERS = ("meshdir", "texturedir", "assetdir")
"""Attributes that name folders of assets."""
FLAT_MESHES = ("wedge", "plate")
"""Generated meshes whose two first parameters are resolutions; for others only the first is."""

Element = ElementTree.Element


class Survey(NamedTuple):
    """Size of all files of a scene [bytes], and number of elements after replication."""

    size: int
    elements: int


def survey_mjcf(path: Path) -> Survey:
    """Survey an MJCF scene: verify its counts and the files that it names.

    Raises `InputError` if the scene would make too many parts, points, keyframes or other elements,
    if it attaches itself, or if a file that it names is a device, a pipe, or outside of the start
    folder.
    """
    models: dict[Path, _Model] = {}
    main = _Model(path.resolve(), models)
    count = main._counted("whole", main.root, world=True)
    require_count("parts", count.parts, MOST_PARTS)
    require_count("elements", count.elements, MOST_ELEMENTS)
    made = sum((model.made for model in models.values()), Counter[str]())
    require_count("keyframes", made["keyframes"], MOST_KEYS)
    require_count("points of height fields", made["points"], MOST_TRIANGLES)
    require_count("triangles", made["triangles"], MOST_TRIANGLES)
    require_count("pixels of textures", made["pixels"], MOST_PIXELS)
    sizes: dict[Path, int] = {}
    for model in models.values():
        sizes |= model.sizes
    return Survey(sum(sizes.values()), count.elements)


class _Model:
    """An MJCF file with the scenes that it includes."""

    def __init__(self, path: Path, models: dict[Path, _Model]) -> None:
        models[path] = self
        self.folder = path.parent
        self.models = models
        self.root = xml_root(path)
        self.included: dict[str, Element] = {}
        self.made: Counter[str] = Counter()
        self.sizes = {path: path.stat().st_size}
        self.counts: dict[str, SceneCount | None] = {}
        """Count of each included file and of each attached body; None while it is made."""
        elements = [element for root in self._roots() for element in root.iter()]
        places = {self.folder / e.get(key, "") for e in elements for key in FOLDERS if e.get(key)}
        self.places = {self.folder, *((self.folder / name).parent for name in self.included)}
        self.places |= places
        for element in elements:
            self.made.update(_made(element))
            self._survey_files(element)
        self.attached = {
            element.get("name", ""): self.folder / element.get("file", "")
            for element in elements
            if element.tag == "model" and element.get("file")
        }

    def _roots(self) -> Iterator[Element]:
        """Root elements of the file and of the files that it includes, each file once."""
        waiting = [self.root]
        while waiting:
            root = waiting.pop()
            yield root
            for element in root.iter("include"):
                name = element.get("file", "")
                path = self.folder / name
                if name and name not in self.included and self._is_there(path):
                    self.included[name] = xml_root(path)
                    waiting.append(self.included[name])

    def _is_there(self, path: Path) -> bool:
        """Whether a named file exists; it must be a regular file in the start folder."""
        require_below(path)
        try:
            there = path.exists()
        except (OSError, ValueError):  # MuJoCo reports that it cannot read the file
            return False
        if there and not path.is_dir():
            require_regular(path)
        return there

    def _survey_files(self, element: Element) -> None:
        """Verify all places at which MuJoCo may look for the files that an element names."""
        for key, name in element.items():
            if key.startswith("file") and name:
                for place in self.places:
                    for path in {place / name, place / Path(name).name}:
                        if self._is_there(path) and path.is_file():
                            self.sizes[path] = path.stat().st_size

    def count(self, element: Element, *, world: bool) -> SceneCount:
        """Number of parts and elements that the children of an element make.

        `world`: whether the element belongs to the world, where each geom is a part.
        """
        total = SceneCount()
        for child in element:
            if child.tag == "include":
                total = total.plus(self._count_included(child.get("file", ""), world))
            elif child.tag == "attach":
                total = total.plus(self._count_attached(child))
            else:
                inside = self.count(child, world=world and child.tag != "body")
                times = max(_whole(child.get("count")), 0) if child.tag == "replicate" else 1
                part = child.tag == "body" or (child.tag == "geom" and world)
                own = prod(_numbers(child.get("count"))) if child.tag == "flexcomp" else 1
                total = total.plus(inside, times).plus(SceneCount(int(part), max(own, 1)))
        return total

    def _count_included(self, name: str, world: bool) -> SceneCount:
        """Number of parts and elements of an included scene."""
        root, key = self.included.get(name), f"include {world} {name}"
        if root is None or self.counts.get(key, SceneCount()) is None:
            return SceneCount()  # MuJoCo reports the missing file, or the loop
        return self._counted(key, root, world)

    def _count_attached(self, attach: Element) -> SceneCount:
        """Number of parts and elements of the model, or of its body, that is attached."""
        path = self.attached.get(attach.get("model", ""))
        if path is None or not self._is_there(path):
            return SceneCount()  # MuJoCo reports the fault
        path = path.resolve()
        model = self.models.get(path) or _Model(path, self.models)
        name = attach.get("body")
        bodies = [body for body in model.root.iter("body") if name and body.get("name") == name]
        key, root = (f"body {name}", bodies[0]) if bodies else ("whole", model.root)
        if None in model.counts.values():
            raise InputError(
                f"the model {path.name!r:.60} attaches itself", hint="remove the element <attach>"
            )
        return model._counted(key, root, world=True).plus(SceneCount(1, 1))

    def _counted(self, key: str, root: Element, world: bool) -> SceneCount:
        """The count of an element, which is made once and kept under a key."""
        known = self.counts.get(key)
        if known is None:
            self.counts[key] = None
            known = self.counts[key] = self.count(root, world=world)
        return known


def _made(element: Element) -> Counter[str]:
    """Numbers of keyframes, points, triangles and pixels that an element makes."""
    made: Counter[str] = Counter()
    if element.tag == "size":
        made["keyframes"] = _whole(element.get("nkey"))
    elif element.tag == "hfield":
        made["points"] = _whole(element.get("nrow")) * _whole(element.get("ncol"))
    elif element.tag == "mesh" and element.get("builtin"):
        first, second = [*_numbers(element.get("params")), 0, 0][:2]
        made["triangles"] = first * (second if element.get("builtin") in FLAT_MESHES else first)
    elif element.tag == "texture":
        width, height = _whole(element.get("width")), _whole(element.get("height"))
        made["pixels"] = width * (height or width)
    return made


def _numbers(text: str | None) -> list[int]:
    """The numbers in an attribute, rounded down; 0 for other words."""
    return [_whole(word) for word in (text or "").split()]


def _whole(word: str | None) -> int:
    """A number in an attribute, rounded down; 0 for another word."""
    try:
        return int(float(word or 0))
    except (ValueError, OverflowError):
        return 0
