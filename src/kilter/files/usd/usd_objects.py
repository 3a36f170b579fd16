"""Objects of a USD stage: rigid bodies, static colliders, instances, or single shapes.

    the stage has rigid bodies     each body is an object (a kinematic or disabled body is held);
                                   colliders outside of bodies are held, other shapes decoration
    it has no rigid body           every shape belongs to a free object

Outside of rigid bodies, an object is a component (by its kind), an instance, or a single shape with
the groups that have only this shape. Each instance of a point instancer is an object. An object has
the geometry of its colliders, or of its visual shapes if it has no colliders.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.limits import MOST_PARTS, Tally
from kilter.files.meshes.placed import distinct, tails
from kilter.files.usd.usd_values import array_of, place_of, require_finite_transform


@dataclass(frozen=True, slots=True, eq=False)
class UsdShape:
    """A shape of an object: its prim, and the transform from its frame to the world, (4, 4)."""

    prim: Any
    matrix: Array
    collides: bool


@dataclass(eq=False)
class UsdObject:
    """An object of a stage."""

    path: str
    """Path of the prim that moves the object."""
    matrix: Array
    """Transform of that prim, or of an instance, to the world, for column vectors, shape (4, 4)."""
    body: Any = None
    """Rigid body."""
    instance: int = -1
    """Number of the instance of a point instancer; -1 for others."""
    held: bool = False
    shapes: list[UsdShape] = field(default_factory=list)
    name: str = ""

    @property
    def geometry(self) -> str:
        """Kind of the shapes that represent the object: "collider" or "visual"."""
        return "collider" if any(shape.collides for shape in self.shapes) else "visual"

    @property
    def chosen(self) -> list[UsdShape]:
        """The colliders of the object, or its visual shapes if it has no collider."""
        colliders = [shape for shape in self.shapes if shape.collides]
        return colliders or self.shapes


def find_objects(stage: Any) -> tuple[list[UsdObject], int]:
    """The objects of a stage that have shapes, and the number of shapes that are decoration."""
    search = _Search(stage)
    search.run()
    found = [entry for entry in search.objects.values() if entry.shapes]
    paths = [_words(entry) for entry in found]
    for entry, name in zip(found, distinct(tails(paths)), strict=True):
        entry.name = name
    return found, search.decoration


def _words(entry: UsdObject) -> tuple[str, ...]:
    """Components of the path of an object, with the number of an instance."""
    words = tuple(entry.path.strip("/").split("/"))
    return words if entry.instance < 0 else (*words[:-1], f"{words[-1]}_{entry.instance}")


def matrix_of(matrix: Any) -> Array:
    """A matrix of USD, which multiplies row vectors, as a matrix for column vectors."""
    return np.array(matrix, dtype=np.float64).T


class _Search:
    """Traversal of a stage that collects its objects."""

    def __init__(self, stage: Any) -> None:
        from pxr import Kind, Usd, UsdGeom, UsdPhysics

        self.stage, self.kind, self.usd, self.geom, self.physics = (
            stage, Kind, Usd, UsdGeom, UsdPhysics,
        )  # fmt: skip
        self.cache = UsdGeom.XformCache(Usd.TimeCode.Default())
        self.objects: dict[tuple[str, int], UsdObject] = {}
        self.decoration = 0
        self.finite: set[Any] = set()
        self.tally = Tally("parts", MOST_PARTS)
        self.has_bodies = any(self._is_body(prim) for prim in self._prims(stage.GetPseudoRoot()))

    def _prims(self, root: Any) -> Any:
        """Range of all prims below a prim, also those within instances."""
        predicate = self.usd.TraverseInstanceProxies(self.usd.PrimDefaultPredicate)
        return self.usd.PrimRange(root, predicate)

    def run(self) -> None:
        """Collect the objects of the stage."""
        every: Any = iter(self._prims(self.stage.GetPseudoRoot()))
        for prim in every:
            if prim.IsA(self.geom.PointInstancer):
                every.PruneChildren()
                self._add_instances(prim)
            elif prim.IsA(self.geom.Gprim):
                self._add_shape(prim, matrix_of(self.cache.GetLocalToWorldTransform(prim)))

    # bodies and colliders ---------------------------------------------------------------

    def _is_body(self, prim: Any) -> bool:
        return bool(prim.HasAPI(self.physics.RigidBodyAPI))

    def _is_held(self, body: Any) -> bool:
        """Whether a rigid body is kinematic or disabled."""
        entry = self.physics.RigidBodyAPI(body)
        enabled, kinematic = entry.GetRigidBodyEnabledAttr(), entry.GetKinematicEnabledAttr()
        return enabled.Get() is False or kinematic.Get() is True

    def _collides(self, prim: Any, top: Any) -> bool:
        """Whether a shape is a collider, by its own schema or that of a prim up to `top`."""
        while prim and not prim.IsPseudoRoot():
            if prim.HasAPI(self.physics.CollisionAPI):
                return self.physics.CollisionAPI(prim).GetCollisionEnabledAttr().Get() is not False
            if prim == top:
                return False
            prim = prim.GetParent()
        return False

    def _is_visible(self, prim: Any) -> bool:
        """Whether a shape is drawn; guides and invisible shapes are not."""
        image = self.geom.Imageable(prim)
        hidden = image.ComputeVisibility() == self.geom.Tokens.invisible
        return not hidden and image.ComputePurpose() != self.geom.Tokens.guide

    # objects ----------------------------------------------------------------------------

    def _owner(self, prim: Any) -> tuple[Any, Any]:
        """The prim that moves a shape, and its rigid body or None."""
        return self._nearest(prim, self._is_body) or (self._outermost(prim), None)

    def _nearest(self, prim: Any, accept: Callable[[Any], bool]) -> tuple[Any, Any] | None:
        while prim and not prim.IsPseudoRoot():
            if accept(prim):
                return prim, prim
            prim = prim.GetParent()
        return None

    def _outermost(self, prim: Any) -> Any:
        """The outermost component or instance above a prim, else its group if it is alone there."""
        best, above, alone = prim, prim, True
        while above and not above.IsPseudoRoot():
            kind = self.usd.ModelAPI(above).GetKind()
            if above.IsInstance() or self.kind.Registry.IsA(kind, self.kind.Tokens.component):
                best, alone = above, False
            above = above.GetParent()
        above = prim.GetParent()
        while alone and self._is_group_of_one(above):
            best, above = above, above.GetParent()
        return best

    def _is_group_of_one(self, prim: Any) -> bool:
        """Whether a prim below the top level has a single child that may have a shape."""
        if prim.IsPseudoRoot() or prim.GetParent().IsPseudoRoot():
            return False
        return sum(bool(child.IsA(self.geom.Imageable)) for child in prim.GetChildren()) == 1

    def _object(self, prim: Any, body: Any, instance: int, matrix: Array) -> UsdObject:
        """The object that a prim moves; it is created at its first shape."""
        key = str(prim.GetPath()), instance
        if key not in self.objects:
            held = self.has_bodies if body is None else self._is_held(body)
            self.objects[key] = UsdObject(key[0], matrix, body, instance, held)
        return self.objects[key]

    def _require_finite(self, prim: Any) -> None:
        """Verify the transforms of a prim and of the prims above it, each once."""
        while prim and not prim.IsPseudoRoot() and prim not in self.finite:
            self.finite.add(prim)
            require_finite_transform(prim)
            prim = prim.GetParent()

    def _add_shape(self, prim: Any, matrix: Array) -> None:
        """Add a shape of the stage to its object, unless it is decoration."""
        owner, body = self._owner(prim)
        collides = self._collides(prim, owner)
        if not collides and not self._is_visible(prim):
            return
        if body is None and self.has_bodies and not collides:
            self.decoration += 1
            return
        self._require_finite(prim)
        frame = matrix_of(self.cache.GetLocalToWorldTransform(owner))
        self._object(owner, body, -1, frame).shapes.append(UsdShape(prim, matrix, collides))

    def _add_instances(self, prim: Any) -> None:
        """Add the instances of a point instancer: objects of their own, unless a body has them."""
        instancer = self.geom.PointInstancer(prim)
        time = self.usd.TimeCode.Default()
        above = matrix_of(self.cache.GetLocalToWorldTransform(prim))
        within = instancer.ComputeInstanceTransformsAtTime(
            time, time, instancer.IncludeProtoXform, instancer.IgnoreMask
        )
        indices = array_of(instancer.GetProtoIndicesAttr(), (-1,)).astype(int).tolist()
        prototypes = self._prototypes(prim, instancer)
        for number in (min(indices), max(indices)) if indices else ():
            if not 0 <= number < len(prototypes):
                raise InputError(
                    f"the point instancer {place_of(prim)} has the index {number}, but "
                    f"{len(prototypes)} prototypes",
                    hint="correct its protoIndices",
                )
        self._require_finite(prim)
        if len(within) != len(indices):
            places = len(array_of(instancer.GetPositionsAttr(), (-1, 3), ()))
            raise InputError(
                f"the point instancer {place_of(prim)} has {len(indices)} indices and {places} "
                "positions",
                hint="give all its attributes the same length",
            )
        mask = list(instancer.ComputeMaskAtTime(time)) or [True] * len(within)
        around = self._nearest(prim, self._is_body)
        for k, (number, matrix) in enumerate(zip(indices, within, strict=True)):
            if not mask[k]:
                continue
            root = prototypes[number]
            placed = above @ matrix_of(matrix)
            body = around[0] if around else (root if self._is_body(root) else None)
            self._add_instance(prim, k, root, placed, body, bool(around))

    def _prototypes(self, prim: Any, instancer: Any) -> list[Any]:
        """The prims that the instances of a point instancer are copies of."""
        found = []
        for path in instancer.GetPrototypesRel().GetForwardedTargets():
            root = self.stage.GetPrimAtPath(path.GetPrimPath())
            if not root or root.IsPseudoRoot() or not path.IsPrimPath():
                raise InputError(
                    f"the point instancer {place_of(prim)} has the prototype {path}, which does "
                    "not exist",
                    hint="correct its path",
                )
            found.append(root)
        return found

    def _add_instance(
        self, prim: Any, k: int, root: Any, placed: Array, body: Any, inside: bool
    ) -> None:
        """Add the shapes of a single instance of a prototype."""
        inverse = np.linalg.inv(matrix_of(self.cache.GetLocalToWorldTransform(root)))
        for each in self._prims(root):
            if not each.IsA(self.geom.Gprim):
                continue
            collides = self._collides(each, root)
            if not collides and not self._is_visible(each):
                continue
            if body is None and self.has_bodies and not collides:
                self.decoration += 1
                continue
            self._require_finite(each)
            local = inverse @ matrix_of(self.cache.GetLocalToWorldTransform(each))
            if inside:
                frame = matrix_of(self.cache.GetLocalToWorldTransform(body))
                target = self._object(body, body, -1, frame)
            else:
                target = self._object(prim, body, k, placed)
            target.shapes.append(UsdShape(each, placed @ local, collides))
            self.tally.add(1)
