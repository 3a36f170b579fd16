"""USD stages for tests, made with usd-core."""

from pathlib import Path
from typing import Any

import numpy as np


class Stage:
    """A stage that is built prim by prim; z up and metres unless stated."""

    def __init__(self, path: Path, *, up: str = "Z", metres: float = 1.0) -> None:
        from pxr import Usd, UsdGeom

        self.stage = Usd.Stage.CreateNew(str(path))
        UsdGeom.SetStageUpAxis(self.stage, up)
        UsdGeom.SetStageMetersPerUnit(self.stage, metres)
        self.stage.SetDefaultPrim(UsdGeom.Xform.Define(self.stage, "/World").GetPrim())

    def body(
        self, name: str, place: Any, *, turn: Any = None, scale: Any = None, **physics: Any
    ) -> str:
        """Add a rigid body; `physics` has the keys mass, density, kinematic, static."""
        from pxr import Gf, UsdGeom, UsdPhysics

        prim = UsdGeom.Xform.Define(self.stage, f"/World/{name}")
        prim.AddTranslateOp().Set(Gf.Vec3d(*map(float, place)))
        if turn is not None:
            prim.AddRotateXYZOp().Set(Gf.Vec3f(*turn))
        if scale is not None:
            prim.AddScaleOp().Set(Gf.Vec3f(*scale))
        if not physics.get("static"):
            entry = UsdPhysics.RigidBodyAPI.Apply(prim.GetPrim())
            if physics.get("kinematic"):
                entry.CreateKinematicEnabledAttr(True)
        if "mass" in physics or "density" in physics:
            values = UsdPhysics.MassAPI.Apply(prim.GetPrim())
            if "mass" in physics:
                values.CreateMassAttr(physics["mass"])
            if "density" in physics:
                values.CreateDensityAttr(physics["density"])
        return f"/World/{name}"

    def shape(self, path: str, kind: str = "Cube", *, collider: bool = True, **values: Any) -> Any:
        """Add a shape with these attribute values at a path."""
        from pxr import UsdGeom, UsdPhysics

        prim = getattr(UsdGeom, kind).Define(self.stage, path)
        for key, value in values.items():
            getattr(prim, f"Get{key[0].upper()}{key[1:]}Attr")().Set(value)
        if collider:
            UsdPhysics.CollisionAPI.Apply(prim.GetPrim())
        return prim

    def box(self, name: str, place: Any, size: Any, **physics: Any) -> str:
        """Add a rigid body with a box of this size as its collider."""
        from pxr import UsdGeom

        path = self.body(name, place, **physics)
        prim = self.shape(f"{path}/shape", size=1.0)
        UsdGeom.Xformable(prim).AddScaleOp(precision=UsdGeom.XformOp.PrecisionDouble).Set(
            tuple(map(float, size))
        )
        return path

    def mesh(self, path: str, points: Any, faces: Any, **values: Any) -> Any:
        """Add a mesh."""
        prim = self.shape(path, "Mesh", **values)
        prim.GetPointsAttr().Set([tuple(map(float, p)) for p in points])
        prim.GetFaceVertexCountsAttr().Set([len(face) for face in faces])
        prim.GetFaceVertexIndicesAttr().Set([int(k) for face in faces for k in face])
        return prim

    def material(self, name: str, **values: Any) -> Any:
        """Add a physics material with staticFriction, dynamicFriction or density."""
        from pxr import UsdPhysics, UsdShade

        material = UsdShade.Material.Define(self.stage, f"/World/{name}")
        entry = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
        for key, value in values.items():
            getattr(entry, f"Create{key[0].upper()}{key[1:]}Attr")(value)
        return material

    def bind(self, path: str, material: Any) -> None:
        """Bind a physics material to a prim."""
        from pxr import UsdShade

        prim = self.stage.GetPrimAtPath(path)
        UsdShade.MaterialBindingAPI.Apply(prim).Bind(material, materialPurpose="physics")

    def save(self) -> None:
        """Write the stage to its file."""
        self.stage.GetRootLayer().Save()


def faulty_room(path: Path, *, count: int, floating: int, overlapping: int, seed: int = 0) -> Any:
    """A room with shelves and many objects, of which some float and some overlap their support.

    Objects are boxes, cylinders, balls, meshes and stacks on four shelf boards, in centimetres with
    y up. The faults are at objects without another object on them.

    Returns
    -------
    faults : dict from str to float
        Name of each faulty object, and its shift upwards [cm].
    """
    random = np.random.default_rng(seed)
    room = Stage(path, up="Y", metres=0.01)
    room.box("floor", (0, -5, 0), (2000, 10, 400), static=True)
    heights = [0.0]
    for k in range(3):
        top = 60.0 * (k + 1)
        room.box(f"board_{k}", (0, top - 2, 0), (2000, 4, 60), static=True)
        heights.append(top)
    columns = -(-count // 4)
    faulty = random.choice(count, floating + overlapping, replace=False).tolist()
    faults: dict[str, float] = {}
    for k in range(count):
        x = (k // 4 - columns / 2) * (1900 / columns)
        stands = heights[k % 4]
        size = random.uniform(4, 14, 3)
        shift = 0.0
        kind = ("box", "can", "ball", "tetrahedron", "stack")[int(random.integers(5))]
        if k in faulty:
            amount = float(size.min() * 10 ** random.uniform(-3.5, -1))
            shift = amount if faulty.index(k) < floating else -amount
            faults[f"{kind}_{k}"] = shift
        _add_object(room, f"{kind}_{k}", kind, (x, stands + shift), size)
    room.save()
    return faults


def _add_object(room: Stage, name: str, kind: str, place: Any, size: Any) -> None:
    """Add an object whose lowest point is at the height `place[1]`."""
    x, low = place
    a, b, c = size.tolist()
    if kind == "box":
        room.box(name, (x, low + b / 2, 0), (a, b, c), turn=(0, a * 10, 0), mass=a / 10)
    elif kind == "can":
        path = room.body(name, (x, low + b / 2, 0))
        room.shape(f"{path}/can", "Cylinder", radius=a / 2, height=b, axis="Y")
    elif kind == "ball":
        path = room.body(name, (x, low + a / 2, 0))
        room.shape(f"{path}/ball", "Sphere", radius=a / 2)
    elif kind == "tetrahedron":
        path = room.body(name, (x, low, 0), mass=0.3)
        points = [(a, 0, 0), (-a / 2, 0, a), (-a / 2, 0, -a), (0, b, 0)]
        room.mesh(f"{path}/mesh", points, [(0, 2, 1), (0, 3, 2), (2, 3, 1), (1, 3, 0)])
    else:
        # only the upper of two boxes is shifted, so the lower box has no fault
        under = low if abs(low % 60) < 1e-9 else 60.0 * round(low / 60)
        room.box(f"{name}_base", (x, under + b / 2, 0), (a + 4, b, c + 4))
        room.box(name, (x + 1, low + b + c / 2, 0.5), (a, c, a))
