"""Held parts and joints that the assembly workbench of FreeCAD states.

A joint names two parts, by paths of objects, and a frame in each of them: its parts turn about z of
the frames and slide along z. In a solved assembly the two frames agree in what the joint fixes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.assembly.interactions import NEEDS_AXIS, Joint, JointKind
from kilter.files.cad.freecad_document import FreeCadObject
from kilter.files.cad.freecad_tree import ASSEMBLY, FreeCadTree, PlacedShape
from kilter.files.file_tolerances import JOINT_FRAMES, SAME_ANGLE

KINDS = (
    *("Fixed", "Revolute", "Cylindrical", "Slider", "Ball", "Distance", "Parallel"),
    *("Perpendicular", "Angle", "RackPinion", "Screw", "Gears", "Belt"),
)
"""Kinds of joints of FreeCAD, in the order in which a file without a list numbers them."""
JOINTS: dict[str, JointKind] = {
    "Fixed": "fixed",
    "Revolute": "revolute",
    "Cylindrical": "cylindrical",
    "Slider": "prismatic",
    "Ball": "spherical",
}
"""The kind of joint for each kind of FreeCAD; the other kinds are relations of faces."""
LIMITS = ("EnableLengthMin", "EnableLengthMax", "EnableAngleMin", "EnableAngleMax")
_SUB_SHAPE = re.compile(r"(Face|Edge|Vertex)(\d{1,9})")


@dataclass(frozen=True, slots=True, eq=False)
class JointEnd:
    """One side of a joint: the shape that it names, the face, edge or vertex, and its frame."""

    shape: PlacedShape
    sub_shape: tuple[str, int] | None
    """Kind and number of a face, edge or vertex of the shape; None if it is unknown."""
    frame: Array
    """The 4 x 4 matrix of the frame of the joint in the document."""


@dataclass(frozen=True, slots=True, eq=False)
class FreeCadJoint:
    """A joint of the document that is active and has a kind of kilter."""

    label: str
    kind: JointKind
    ends: tuple[JointEnd, JointEnd]

    def between(self, first: str, second: str) -> Joint:
        """The joint of two named parts."""
        frame = self.ends[0].frame
        axis = frame[:3, 2] if self.kind in NEEDS_AXIS else None
        return Joint((first, second), self.kind, point=frame[:3, 3], axis=axis)

    @property
    def is_solved(self) -> bool:
        """Whether the two frames agree in what the joint fixes."""
        first, second = (end.frame for end in self.ends)
        axis = first[:3, 2] / np.linalg.norm(first[:3, 2])
        step = second[:3, 3] - first[:3, 3]
        across = np.linalg.norm(np.cross(axis, second[:3, 2])) / np.linalg.norm(second[:3, 2])
        tilted = across > SAME_ANGLE and self.kind in ("revolute", "cylindrical", "prismatic")
        off = np.cross(axis, step) if self.kind == "cylindrical" else step
        fixed = self.kind in ("revolute", "cylindrical", "spherical")
        return not tilted and not (fixed and np.linalg.norm(off) > JOINT_FRAMES)


@dataclass(frozen=True, slots=True, eq=False)
class StatedJoints:
    """Held shapes and joints of a document, and the labels of joints that do not count."""

    held: set[int]
    """Identities (`id`) of the placed shapes that do not move."""
    joints: list[FreeCadJoint]
    others: list[str]
    """Kind and label of each joint that is a relation of faces."""
    limited: list[str]
    """Labels of joints with limits, which do not count."""
    without_part: list[str]
    """Labels of joints with a part that is absent or not named."""


def stated_joints(tree: FreeCadTree) -> StatedJoints:
    """Find the held shapes and the joints of all assemblies of a document.

    Shapes are held by the assemblies of the document itself: an assembly that is inside another
    one is held by the outer one.
    """
    found = StatedJoints(set(), [], [], [], [])
    found.held.update(
        id(shape) for shape in tree.shapes if shape.held and shape.shape.document is tree.document
    )
    for assembly, place in tree.assemblies:
        inside = _inside(tree.shapes, place.trail)
        outer = any(item.kind == ASSEMBLY for item in place.trail[:-1])
        for item in _joints_of(assembly):
            if "ObjectToGround" in item.properties:
                names = [target.name for target in item.links("ObjectToGround")]
                held = () if outer else _named(inside, len(place.trail), assembly, names)
                found.held.update(map(id, held))
            else:
                _add_joint(found, item, inside, len(place.trail))
    return found


def _inside(shapes: Sequence[PlacedShape], trail: tuple[FreeCadObject, ...]) -> list[PlacedShape]:
    """The placed shapes whose trail begins with that of an assembly."""
    count = len(trail)
    return [
        shape
        for shape in shapes
        if len(shape.place.trail) >= count
        and all(a is b for a, b in zip(shape.place.trail, trail, strict=False))
    ]


def _joints_of(assembly: FreeCadObject) -> Iterator[FreeCadObject]:
    """Active joints in the groups of an assembly."""
    groups = [item for item in assembly.links("Group") if item.kind == "Assembly::JointGroup"]
    listed = [item for group in (assembly, *groups) for item in group.links("Group")]
    for item in dict.fromkeys(listed):
        is_joint = not item.properties.keys().isdisjoint(("JointType", "ObjectToGround"))
        if is_joint and item.flag("Activated", True) and not item.flag("Suppressed"):
            yield item


def _add_joint(
    found: StatedJoints, item: FreeCadObject, inside: list[PlacedShape], above: int
) -> None:
    """Add a joint to the joints that are found, or its label to those that do not count."""
    index, words = item.choice("JointType")
    words = words or list(KINDS)
    kind = words[index] if 0 <= index < len(words) else str(index)
    if kind not in JOINTS:
        found.others.append(f"{kind} {item.label!r:.80}")
        return
    ends = [_end(item, side, inside, above) for side in "12"]
    if ends[0] is None or ends[1] is None:
        found.without_part.append(item.label)
        return
    if any(item.flag(limit) for limit in LIMITS):
        found.limited.append(item.label)
    found.joints.append(FreeCadJoint(item.label, JOINTS[kind], (ends[0], ends[1])))


def _end(item: FreeCadObject, side: str, inside: list[PlacedShape], above: int) -> JointEnd | None:
    """One side of a joint; None if it names no shape, or several."""
    content = item.properties.get(f"Reference{side}")
    if content is None or not len(content):
        return None
    link = content[0]
    named = next((sub.get("value", "") for sub in link.iter("Sub")), link.get("sub", ""))
    steps = [link.get("name", ""), *named.split(".")]
    shapes = _named(inside, above, item, steps)
    if len(shapes) != 1:
        return None
    shape = shapes[0]
    found = _SUB_SHAPE.fullmatch(steps[-1])
    # the numbers of faces are those of the last object on the path
    known = {shape.shape.name, *(each.name for each in shape.place.trail)}
    tip = shape.shape.links("Tip")
    known.update(each.name for each in tip)
    last = steps[-2] if len(steps) > 1 else ""
    sub_shape = (found[1], int(found[2])) if found and last in known else None
    return JointEnd(shape, sub_shape, shape.place.matrix @ item.matrix(f"Placement{side}"))


def _named(
    shapes: Sequence[PlacedShape], above: int, owner: FreeCadObject, steps: Sequence[str]
) -> list[PlacedShape]:
    """The shapes with the most objects of a path on their trail, in the order of the path.

    Arguments: `above`: number of objects of the trail above the assembly and itself; `owner`: an
    object of the document to which the first name of the path belongs.
    """
    best, chosen = 0, list[PlacedShape]()
    for shape in shapes:
        position = count = 0
        for item in shape.place.trail[above:]:
            ours = count > 0 or item.document is owner.document
            if ours and item.name in steps[position:]:
                position = steps.index(item.name, position) + 1
                count += 1
        if count > best:
            best, chosen = count, []
        if count and count == best:
            chosen.append(shape)
    return chosen
