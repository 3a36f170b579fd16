"""The kilter file as pydantic models: what may stand in it, and its published schema.

Imported only when a file is read, since pydantic takes its time. What several entries say
together (names that exist, polygons that do not cross) is asked by the values themselves.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

__all__ = ["AssemblyFile", "PartEntry", "build_schema"]

SHAPES = ("mesh", "box", "cylinder", "sphere", "polygon", "step", "solid")
"""Keys of which a part has exactly one."""

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0)]
Whole = Annotated[int, Field(strict=True)]
Flag = Annotated[bool, Field(strict=True)]
Name = Annotated[str, Field(strict=True, min_length=1)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Curvatures = Annotated[list[Number], Field(min_length=2, max_length=2)]
PlanePoint = Annotated[list[Number], Field(min_length=2, max_length=2)]
Size = Annotated[list[Positive], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[Number], Field(min_length=4, max_length=4)]
Pair = Annotated[list[Name], Field(min_length=2, max_length=2)]


class _Entry(BaseModel):
    model_config = ConfigDict(extra="forbid")


class PoseEntry(_Entry):
    """From the part's frame to the world."""

    position: Vector = Field([0.0, 0.0, 0.0], description="[length unit]")
    rotation: Quaternion = Field([1.0, 0.0, 0.0, 0.0], description="quaternion w x y z")


class MeshEntry(_Entry):
    """A closed surface; faces may be polygons."""

    vertices: list[Vector]
    faces: list[Annotated[list[Whole], Field(min_length=3)]]
    accuracy: NotNegative | None = Field(
        None, description="how far a coordinate may be from the truth [length unit]"
    )


class StepEntry(_Entry):
    """One solid of a STEP file."""

    path: Name = Field(description="relative to the file")
    name: Name | None = Field(None, description="as `kilter contacts` names it; of several solids")


class SurfaceEntry(_Entry):
    """The exact surface of a face; lengths in the length unit, angles in rad."""

    kind: Literal["plane", "cylinder", "cone", "sphere", "torus"]
    point: Vector = Field(description="on the plane or axis; apex of a cone; else the centre")
    axis: Vector = Field([0.0, 0.0, 1.0], description="a plane's outward normal; into the cone")
    radius: NotNegative = Field(0.0, description="of a torus: of its centre line")
    tube: NotNegative = 0.0
    half_angle: NotNegative = 0.0
    hollow: Flag = Field(False, description="the material lies outside: a hole")


class SolidEntry(_Entry):
    """A solid with exact faces, as a STEP file gives it."""

    vertices: list[Vector]
    triangles: list[Annotated[list[Whole], Field(min_length=3, max_length=3)]]
    surfaces: list[SurfaceEntry]
    triangle_surface: list[Whole] = Field(description="-1: on none of the surfaces")
    volume: Positive
    centroid: Vector
    second_moment: Annotated[list[Vector], Field(min_length=3, max_length=3)] = Field(
        description="integral of x x^T about the centroid"
    )
    sagitta: NotNegative = Field(0.0, description="greatest distance of a triangle from its face")
    accuracy: NotNegative = Field(0.0, description="of a coordinate [length unit]")
    holes: list[Annotated[list[Vector], Field(min_length=2, max_length=2)]] = Field(
        [], description="boxes in which faces are missing: lower and upper corner"
    )
    stand_in: Flag = Field(False, description="the triangles bound it, its faces are not known")
    uncertainty: NotNegative = Field(
        0.0, description="how far points may be off, as the file it came from states"
    )


class CylinderEntry(_Entry):
    """A cylinder about z, centred on the pose."""

    radius: Positive
    height: Positive


class SphereEntry(_Entry):
    """A sphere, centred on the pose."""

    radius: Positive


class BrickEntry(_Entry):
    """What a box is as a toy brick: it is drawn with studs, in its colour."""

    cells: Annotated[list[Whole], Field(min_length=2, max_length=2)] = Field(
        description="studs along x and along y"
    )
    plates: Whole = Field(3, description="height in plates: 3 of a brick")
    color: Whole | None = Field(None, description="code of LDraw's colours")


def _mesh_kind(value: Any) -> str:
    return "as path" if isinstance(value, str) else "inline"


def _step_kind(value: Any) -> str:
    return "as path" if isinstance(value, str) else "named"


class PartEntry(_Entry):
    """A rigid part: exactly one of mesh, box, cylinder, sphere, polygon, step, solid."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"oneOf": [{"required": [key]} for key in SHAPES]}
    )

    name: Name
    mesh: (
        Annotated[
            Annotated[Name, Tag("as path")] | Annotated[MeshEntry, Tag("inline")],
            Discriminator(_mesh_kind),
        ]
        | None
    ) = Field(None, description="a path relative to the file, or the mesh itself")
    box: Size | None = Field(None, description="lengths along x, y, z")
    cylinder: CylinderEntry | None = None
    sphere: SphereEntry | None = None
    polygon: Annotated[list[PlanePoint], Field(min_length=3)] | None = Field(
        None, description="corners in x-z, in order around it"
    )
    depth: Positive | None = Field(None, description="length of the polygon's prism along y")
    step: (
        Annotated[
            Annotated[Name, Tag("as path")] | Annotated[StepEntry, Tag("named")],
            Discriminator(_step_kind),
        ]
        | None
    ) = Field(None, description="a STEP file of one solid, or a file and the name of the solid")
    solid: SolidEntry | None = None
    pose: PoseEntry | None = None
    grounded: Flag = Field(False, description="held: it does not move")
    density: Positive | None = Field(None, description="[kg/m^3]; 1000 where no mass is given")
    mass: Positive | None = Field(None, description="[kg]")
    center_of_mass: Vector | None = Field(None, description="in the part's own frame")
    brick: BrickEntry | None = None

    @staticmethod
    def shapes() -> tuple[str, ...]:
        """Keys of which a part has exactly one."""
        return SHAPES


class FrictionPairEntry(_Entry):
    """Friction coefficient of every contact between two parts."""

    parts: Pair
    mu: NotNegative


class LoadEntry(_Entry):
    """A force [N] and a torque [N x length unit] on a part, fixed in the world."""

    part: Name
    point: Vector | None = Field(None, description="the part's centre of mass where absent")
    force: Vector = [0.0, 0.0, 0.0]
    torque: Vector = [0.0, 0.0, 0.0]


class FeatureEntry(_Entry):
    """What touches of one part; curvatures positive where it is convex [1/length unit]."""

    kind: Literal["face", "edge", "vertex"] = Field(description="a rim is an edge")
    along: Vector | None = Field(
        None, description="tangent of an edge; of a face, a principal direction"
    )
    curvature: Number | Curvatures = Field(
        0.0, description="of an edge along it; of a face, along `along` and across it"
    )
    point: Vector | None = Field(None, description="on `axis`")
    axis: Vector | None = Field(
        None, description="what the face or rim is of revolution about, through `point`"
    )


class ContactEntry(_Entry):
    """Contact points of two parts, used instead of detection for that pair."""

    parts: Pair
    points: Annotated[list[Vector], Field(min_length=1)]
    normal: Vector = Field(description="from the first part to the second")
    mu: NotNegative | None = None
    feature: Annotated[list[FeatureEntry], Field(min_length=2, max_length=2)] | None = Field(
        None, description="of the first part and of the second; without it second order is open"
    )


class JointEntry(_Entry):
    """A two-sided connection of two parts, or of a part and "ground"."""

    parts: Pair
    kind: Literal["fixed", "revolute", "prismatic", "cylindrical", "spherical"]
    point: Vector | None = Field(
        None, description="needed for revolute, cylindrical (on the axis) and spherical"
    )
    axis: Vector | None = Field(None, description="needed for revolute, prismatic, cylindrical")


class BondEntry(_Entry):
    """A connection of two parts that takes pull up to a limit: glue, a stud, a magnet."""

    parts: Pair
    pull: NotNegative | None = Field(None, description="at each point [N]")
    pull_per_area: NotNegative | None = Field(
        None, description="in place of pull [N per square of the length unit]"
    )
    shear: NotNegative | Literal["mu"] | None = Field(
        None, description="at each point [N], or by friction; any force where absent"
    )
    points: Annotated[list[Vector], Field(min_length=1)] | None = Field(
        None, description="all contact points of the pair where absent"
    )
    normal: Vector | None = Field(
        None, description="from the first part to the second; needed with points"
    )
    kind: Literal["glue", "mortar", "magnet", "suction", "press-fit"] | None = None


class AssemblyFile(_Entry):
    """An assembly of rigid parts: what they are, where, which are held, what pulls on them."""

    model_config = ConfigDict(extra="forbid", title="kilter assembly")

    kilter: Literal[1]
    units: Literal["m", "cm", "mm", "in"] = Field("m", description="unit of every length")
    gravity: Vector = Field([0.0, 0.0, -9.81], description="[m/s^2]")
    friction: NotNegative = Field(0.0, description="where a contact has no coefficient of its own")
    parts: Annotated[list[PartEntry], Field(min_length=1)]
    friction_pairs: list[FrictionPairEntry] = []
    loads: list[LoadEntry] = []
    contacts: list[ContactEntry] = []
    joints: list[JointEntry] = []
    bonds: list[BondEntry] = []
    planar: Flag = Field(False, description="motions in x-z only")
    detect: Flag = Field(True, description="false: only the given contacts count")


def build_schema() -> dict[str, Any]:
    """The JSON schema of the kilter file, as these models give it."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **AssemblyFile.model_json_schema(),
    }
