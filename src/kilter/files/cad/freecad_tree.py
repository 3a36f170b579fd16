"""Walk the tree of a FreeCAD document: its placed shapes, and the assemblies that it contains.

    container    App::Part, groups, assemblies: placement x placement of each child
    link         placement x scale x the target, whose own placement counts with `LinkTransform`
    array        placement x scale x placement of each element x the target
    part         a body, or another object with a shape, that no other shape is made of

Sketches, planes and the inputs of Booleans are no parts. The sources of links are parts only if
they are visible and no assembly contains the links.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.cad.freecad_document import (
    FreeCadDocument,
    FreeCadObject,
    placement_matrix,
    python_class,
    stated_map,
)
from kilter.files.cad.product_tree import number_repeats
from kilter.files.limits import DEEPEST, MOST_PARTS, Tally

ASSEMBLY = "Assembly::AssemblyObject"
SUBASSEMBLY = "Assembly::AssemblyLink"
BODY = "PartDesign::Body"
A2PLUS = "a2p"
"""Begin of the names of the modules of A2plus."""
_NO_SOLID = re.compile(
    r"Sketcher::|Part::(Part2D|Datum|LocalCoordinateSystem)|TechDraw::"
    r"|PartDesign::(Plane|Line|Point|CoordinateSystem|ShapeBinder|SubShapeBinder)"
)
"""Types of objects with shapes that are never parts: sketches, datums, references."""
_REFERENCES = ("AttachmentSupport", "Support", "DirLink", "AxisLink", "MirrorPlane", "Spine")
"""Properties that name objects to which an object refers without being made of them."""
_DENSITY = re.compile(r"\s*([-+.\deE]+)\s*(t|kg|g|mg)\s*/\s*(m|dm|cm|mm)\s*(?:\^3|³)\s*")
"""A density as FreeCAD writes it."""
_KILOGRAMS = {"t": 1e3, "kg": 1.0, "g": 1e-3, "mg": 1e-6}
_METRES = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001}


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A place in the tree: how an object is reached, and what its containers state."""

    path: tuple[str, ...] = ()
    """Labels from the root of the tree."""
    trail: tuple[FreeCadObject, ...] = ()
    """Objects from the root of the tree; targets of links are not among them."""
    matrix: Array = field(default_factory=lambda: np.eye(4))
    hidden: bool = False
    density: float | None = None
    material: str | None = None
    depth: int = 0

    def below(self, item: FreeCadObject, label: str) -> Place:
        """The place of a child."""
        hidden = self.hidden or not item.visible
        trail = (*self.trail, item)
        return replace(self, path=(*self.path, label), trail=trail, hidden=hidden)

    def moved(self, matrix: Array) -> Place:
        """The place after a transform in its own frame; raises `InputError` if it is too deep."""
        if self.depth >= DEEPEST:
            raise InputError(
                f"objects and links are nested deeper than {DEEPEST}", hint="flatten the document"
            )
        return replace(self, matrix=self.matrix @ matrix, depth=self.depth + 1)


@dataclass(frozen=True, slots=True, eq=False)
class PlacedShape:
    """An object with a shape, and the place at which the tree shows it.

    `inner`: placement of the shape in the frame of the object; only that of the tip of a body
    without a shape of its own is not the identity.
    """

    shape: FreeCadObject
    place: Place
    inner: Array

    @property
    def held(self) -> bool:
        """Whether the object states that it does not move."""
        return self.shape.flag("fixedPosition")


@dataclass(frozen=True, slots=True)
class _Roles:
    """Names of the objects of a document that belong to others.

    - `inside`: objects inside a container.
    - `inputs`: objects of which the shape of another object is made.
    - `targets`: objects that a link shows.
    """

    inside: frozenset[str]
    inputs: frozenset[str]
    targets: frozenset[str]

    @classmethod
    def of(cls, document: FreeCadDocument) -> _Roles:
        """Find the roles of all objects of a document."""
        items = list(document.objects.values())
        links = [item for item in items if _is_link(item)]
        return cls(
            frozenset(child.name for item in items for child in _members(item)),
            frozenset(source.name for item in items for source in _inputs(item)),
            frozenset(target.name for item in links for target in item.links("LinkedObject")),
        )


@dataclass(slots=True)
class FreeCadTree:
    """The shapes that a document shows, its assemblies with their places, and notes."""

    document: FreeCadDocument
    shapes: list[PlacedShape] = field(default_factory=list)
    assemblies: list[tuple[FreeCadObject, Place]] = field(default_factory=list)
    missing: dict[str, list[str]] = field(default_factory=dict)
    """For each linked document that cannot be read the labels of its links."""
    sources: list[str] = field(default_factory=list)
    """Labels of objects that are shown only by links."""
    meshes: list[str] = field(default_factory=list)
    """Labels of meshes, which are not read."""
    _read: dict[Path, FreeCadDocument] = field(default_factory=dict)
    _roles: dict[Path, _Roles] = field(default_factory=dict)
    _tally: Tally = field(default_factory=lambda: Tally("objects and links", MOST_PARTS))

    def __post_init__(self) -> None:
        self._read[self.document.path.resolve()] = self.document
        self._children(self._roots(), Place())

    def _roots(self) -> list[FreeCadObject]:
        """Objects at the top of the tree that may be parts."""
        items = list(self.document.objects.values())
        roles = self._roles_in(self.document)
        assembled = any(item.kind == ASSEMBLY for item in items)
        roots = []
        for item in items:
            if item.name in roles.inside or not _shows(item):
                continue
            if assembled and item.name in roles.targets and item.kind != ASSEMBLY:
                self.sources.append(item.label)
            else:
                roots.append(item)
        return roots

    def _roles_in(self, document: FreeCadDocument) -> _Roles:
        """The roles of the objects of a document."""
        if document.path not in self._roles:
            self._roles[document.path] = _Roles.of(document)
        return self._roles[document.path]

    def _children(self, items: Sequence[FreeCadObject], place: Place) -> None:
        """Visit siblings in the tree, except inputs of shapes and hidden sources of links."""
        shown = []
        for item in dict.fromkeys(items):
            roles = self._roles_in(item.document)
            if not _shows(item) or item.name in roles.inputs:
                continue
            if item.name in roles.targets and (place.hidden or not item.visible):
                self.sources.append(item.label)
            else:
                shown.append(item)
        names = number_repeats([item.label for item in shown])
        alone = len(shown) == 1 and not place.path
        for name, item in zip(names, shown, strict=True):
            below = place.below(item, name)
            container = alone and not _is_link(item) and _is_container(item)
            self._visit(item, replace(below, path=()) if container else below)

    def _visit(self, item: FreeCadObject, place: Place, *, placed: bool = True) -> None:
        """Visit an object; `placed`: whether its own placement counts."""
        self._tally.add(1)
        if _is_link(item):
            self._link(item, place.moved(_link_matrix(item, placed=placed)))
            return
        place = _material_of(item, place.moved(item.placement if placed else np.eye(4)))
        if item.kind in (ASSEMBLY, SUBASSEMBLY):
            self.assemblies.append((item, place))
        if _is_container(item):
            self._children(_members(item), place)
        elif "Mesh" in item.properties:
            self.meshes.append("/".join(place.path) or item.label)
        else:
            self._shape(item, place)

    def _shape(self, item: FreeCadObject, place: Place) -> None:
        """Collect an object with a shape; a body without a shape has that of its tip."""
        shape, inner = item, np.eye(4)
        if not item.shape_file:
            for tip in item.links("Tip") if item.kind == BODY else ():
                shape, inner = tip, tip.placement
        if shape.shape_file:
            if not place.path:
                place = replace(place, path=(item.label,))
            self.shapes.append(PlacedShape(shape, place, inner))

    def _link(self, item: FreeCadObject, place: Place) -> None:
        """Visit the target of a link, once for each element of an array."""
        elements = item.links("ElementList")
        if elements:
            self._children(elements, place)
            return
        target = self._target(item)
        if target is None:
            return
        placed = item.flag("LinkTransform")
        rows = list(_element_matrices(item))
        if not rows:
            self._visit(target, place, placed=placed)
            return
        shown = (item.value("VisibilityList") or "")[::-1]
        names = number_repeats([item.label] * len(rows))
        for k, (name, matrix) in enumerate(zip(names, rows, strict=True)):
            hidden = place.hidden or shown[k : k + 1] == "0"
            element = replace(place, path=(*place.path[:-1], name), hidden=hidden)
            self._visit(target, element.moved(matrix), placed=placed)

    def _target(self, item: FreeCadObject) -> FreeCadObject | None:
        """The object that a link shows; None if its document cannot be read, or has no such object.

        The path inside the target that a link may name leads from object to object.
        """
        file = item.value("LinkedObject", "file") or ""
        document: FreeCadDocument | None = item.document
        if file:
            document = self._linked_document(item.document, file)
        name = item.value("LinkedObject", "name") or item.value("LinkedObject") or ""
        if document is None or name not in document:
            if name:
                self.missing.setdefault(file or str(item.document.path.name), []).append(item.label)
            return None
        target = document.objects[name]
        for step in (item.value("LinkedObject", "sub") or "").split("."):
            target = next((each for each in _members(target) if each.name == step), target)
        return target

    def _linked_document(self, owner: FreeCadDocument, file: str) -> FreeCadDocument | None:
        """A document beside another one, read once; None if it cannot be read."""
        try:
            path = owner.beside(file).resolve()
            if path not in self._read:
                self._read[path] = FreeCadDocument(path)
            return self._read[path]
        except InputError:
            return None


def _is_link(item: FreeCadObject) -> bool:
    """Whether an object shows another object; a sub-assembly with own components does not."""
    if "LinkedObject" not in item.properties or item.shape_file:
        return False
    return not item.links("Group")


def _members(item: FreeCadObject) -> list[FreeCadObject]:
    """The objects inside a container, or the elements of an array."""
    if item.kind.startswith("App::Origin"):
        return []
    return item.links("Group") + item.links("ElementList")


def _is_container(item: FreeCadObject) -> bool:
    """Whether the parts of an object are its members."""
    return item.kind != BODY and not item.shape_file and bool(_members(item))


def _shows(item: FreeCadObject) -> bool:
    """Whether an object may show parts."""
    if _NO_SOLID.match(item.kind):
        return False
    shape = item.kind == BODY or "Shape" in item.properties or "Mesh" in item.properties
    return shape or _is_link(item) or _is_container(item)


def _inputs(item: FreeCadObject) -> Iterator[FreeCadObject]:
    """Objects of which the shape of an object is made.

    Python objects and mirrored copies leave the objects visible that remain parts.
    """
    if item.kind.startswith("PartDesign::"):
        tools = item.links("Group") if item.kind == "PartDesign::Boolean" else ()
        yield from (*tools, *item.links("BaseFeature")) if item.kind != BODY else item.all_links(())
        return
    if not item.kind.startswith("Part::") or _NO_SOLID.match(item.kind) or not item.shape_file:
        return
    keeps = "Python" in item.kind or item.kind == "Part::Mirroring"
    for source in item.all_links(_REFERENCES):
        if not (keeps and source.visible):
            yield source


def _link_matrix(item: FreeCadObject, *, placed: bool) -> Array:
    """The 4 x 4 matrix of the placement, if it counts, and of the scale of a link."""
    matrix = item.placement if placed else np.eye(4)
    scale = [item.value("ScaleVector", f"value{axis}") for axis in "XYZ"]
    factors = [float(word or item.value("Scale") or 1.0) for word in scale]
    return matrix @ _scale_matrix(factors)


def _scale_matrix(factors: Sequence[float] | Array) -> Array:
    """The 4 x 4 matrix of a scale; raises `InputError` if a factor is zero or not finite."""
    values = np.asarray(factors, dtype=np.float64)
    if not np.isfinite(values).all() or not values.all():
        raise InputError(f"a link has the scale {values.tolist()}", hint="give other factors")
    return np.diag([*values, 1.0])


def _element_matrices(item: FreeCadObject) -> Iterator[Array]:
    """The 4 x 4 matrices of the elements of an array without objects of their own."""
    count = int(item.value("ElementCount") or 0)
    if count <= 0:
        return
    places = item.document.rows(item, "PlacementList", 7)
    scales = item.document.rows(item, "ScaleList", 3)
    Tally("elements of an array", MOST_PARTS).add(count)
    for k in range(count):
        matrix = placement_matrix(places[k]) if k < len(places) else np.eye(4)
        yield matrix @ _scale_matrix(scales[k]) if k < len(scales) else matrix


def _material_of(item: FreeCadObject, place: Place) -> Place:
    """The place with the material that an object states, or that its containers state."""
    stated = stated_map(item, "Material")
    for material in item.links("Material"):
        stated = stated_map(material, "Material") or stated
    density = density_of(str(stated.get("Density", "")))
    name = str(stated.get("Name", "")).strip()
    return replace(place, density=density or place.density, material=name or place.material)


def density_of(text: str) -> float | None:
    """A density of FreeCAD [kg/m^3]; None if the text states none.

    Examples
    --------
    >>> density_of("7900 kg/m^3"), density_of("2.7 g/cm³"), density_of("7.9e-06 kg/mm^3")
    (7900.0, 2700.0, 7900.0)
    >>> density_of("heavy") is None
    True
    """
    found = _DENSITY.fullmatch(text)
    if found is None:
        return None
    try:
        size = float(found[1]) * (_KILOGRAMS[found[2]] / _METRES[found[3]] ** 3)
    except ValueError:
        return None
    return float(f"{size:.12g}") if 0 < size < np.inf else None


def relations(document: FreeCadDocument) -> int:
    """Number of the constraints of A2plus in a document, without their mirrors."""
    return sum(
        module.startswith(A2PLUS) and name == "ConstraintObjectProxy"
        for module, name in map(python_class, document.objects.values())
    )
