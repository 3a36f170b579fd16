"""Pydantic models of the kilter file: its keys, their types, and the published schema.

The module is imported only when a file is read, since importing pydantic is slow. Conditions on
several entries together (names that exist, polygons that do not cross) are verified by the
values that are built from them.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from kilter.files.own.plain_entries import SHAPES

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
Axes = Annotated[list[Vector], Field(max_length=3)]
SixNumbers = Annotated[list[Number], Field(min_length=6, max_length=6)]
Quaternion = Annotated[list[Number], Field(min_length=4, max_length=4)]
Pair = Annotated[list[Name], Field(min_length=2, max_length=2)]
PiecePair = Annotated[
    list[Annotated[int, Field(strict=True, ge=0)]], Field(min_length=2, max_length=2)
]


class Entry(BaseModel):
    """An object of the assembly file; unknown keys are errors."""

    # only the model of a whole file validates, so the models of its entries need no validators
    model_config = ConfigDict(extra="forbid", defer_build=True)


class PoseEntry(Entry):
    """Position and orientation of a part: the transform from its own frame to the world frame."""

    position: Vector = Field([0.0, 0.0, 0.0], description="[length unit]")
    rotation: Quaternion = Field([1.0, 0.0, 0.0, 0.0], description="quaternion w x y z")


class MeshEntry(Entry):
    """A closed surface of triangles or polygons."""

    vertices: list[Vector]
    faces: list[Annotated[list[Whole], Field(min_length=3)]]
    accuracy: NotNegative | None = Field(
        None, description="largest error of a coordinate [length unit]"
    )
    pieces: list[Whole] | None = Field(
        None,
        description="number of the piece of each triangle, for friction pairs with pieces; "
        "default 0; all faces are triangles then",
    )
    members: list[MemberEntry] | None = Field(
        None, description="shapes of which the surface is the union, as a table of five boxes"
    )


class MemberEntry(Entry):
    """A shape of a compound, with exactly one of box, cylinder, sphere and mesh."""

    box: Size | None = Field(None, description="lengths along x, y, z")
    cylinder: CylinderEntry | None = None
    sphere: SphereEntry | None = None
    mesh: MeshEntry | None = None
    pose: PoseEntry | None = Field(None, description="in the frame of the compound")
    piece: Whole = Field(0, description="number of its piece, for friction pairs with pieces")


class StepEntry(Entry):
    """A solid of a STEP file."""

    path: Name = Field(description="path of the STEP file, relative to this file")
    name: Name | None = Field(
        None,
        description="name of the solid, as `kilter contacts` prints it; needed if the file has "
        "several solids",
    )


class SurfaceEntry(Entry):
    """The exact surface of a face; lengths in the length unit, angles in rad."""

    kind: Literal["plane", "cylinder", "cone", "sphere", "torus"]
    point: Vector = Field(
        description="point on a plane or on the axis of a cylinder; apex of a cone; centre of a "
        "sphere or torus"
    )
    axis: Vector = Field(
        [0.0, 0.0, 1.0],
        description="outward normal of a plane; axis of a cylinder or torus; direction from the "
        "apex into a cone",
    )
    radius: NotNegative = Field(
        0.0, description="radius of a cylinder or sphere, or of the centre line of a torus"
    )
    tube: NotNegative = Field(0.0, description="radius of the tube of a torus")
    half_angle: NotNegative = Field(
        0.0, description="angle between the axis and the side of a cone [rad]"
    )
    hollow: Flag = Field(
        False, description="true: the material is outside of the surface, as around a hole"
    )


class SolidEntry(Entry):
    """Entry of the kilter file for a STEP solid: its exact surfaces and its triangles."""

    vertices: list[Vector]
    triangles: list[Annotated[list[Whole], Field(min_length=3, max_length=3)]]
    surfaces: list[SurfaceEntry]
    triangle_surface: list[Whole] = Field(
        description="index of the surface of each triangle; -1: no listed surface"
    )
    volume: Positive
    centroid: Vector
    second_moment: Annotated[list[Vector], Field(min_length=3, max_length=3)] = Field(
        description="integral of x x^T over the volume, x from the centroid"
    )
    sagitta: NotNegative = Field(0.0, description="largest distance of a triangle from its face")
    accuracy: NotNegative = Field(0.0, description="largest error of a coordinate [length unit]")
    holes: list[Annotated[list[Vector], Field(min_length=2, max_length=2)]] = Field(
        [], description="boxes in which faces are missing: lower and upper corner of each"
    )
    stand_in: Flag = Field(
        False, description="true: the triangles bound the solid, but its exact faces are unknown"
    )
    uncertainty: NotNegative = Field(
        0.0, description="largest error of a point, as the STEP file states [length unit]"
    )


class CylinderEntry(Entry):
    """A solid cylinder about z, centred on the pose of the part."""

    radius: Positive
    height: Positive


class SphereEntry(Entry):
    """A solid sphere, centred on the pose of the part."""

    radius: Positive


class BrickEntry(Entry):
    """A box as a toy brick, which is drawn with studs and in its colour."""

    cells: Annotated[list[Whole], Field(min_length=2, max_length=2)] = Field(
        description="number of studs along x and along y"
    )
    plates: Whole = Field(3, description="height in plates; a brick has 3")
    color: Whole | None = Field(None, description="LDraw colour code")


def _mesh_kind(value: Any) -> str:
    """Tag by which pydantic chooses the model for the value of `mesh`."""
    return "as path" if isinstance(value, str) else "inline"


def _step_kind(value: Any) -> str:
    """Tag by which pydantic chooses the model for the value of `step`."""
    return "as path" if isinstance(value, str) else "named"


class PartEntry(Entry):
    """A rigid part with exactly one shape: mesh, box, cylinder, sphere, polygon, step or solid."""

    model_config = ConfigDict(
        extra="forbid",
        defer_build=True,
        json_schema_extra={"oneOf": [{"required": [key]} for key in SHAPES]},
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
        None, description="corners in the x-z plane, in order around the polygon"
    )
    depth: Positive | None = Field(None, description="length of the polygon's prism along y")
    step: (
        Annotated[
            Annotated[Name, Tag("as path")] | Annotated[StepEntry, Tag("named")],
            Discriminator(_step_kind),
        ]
        | None
    ) = Field(
        None, description="a STEP file with a single solid, or a file and the name of the solid"
    )
    solid: SolidEntry | None = None
    pose: PoseEntry | None = None
    grounded: Flag = Field(False, description="true: the part is held, it cannot move")
    density: Positive | None = Field(None, description="[kg/m^3]; default 1000 if no mass is given")
    mass: Positive | None = Field(None, description="[kg]")
    center_of_mass: Vector | None = Field(None, description="in the part's own frame")
    inertia: SixNumbers | None = Field(
        None,
        description="xx, yy, zz, xy, xz, yz about the centre of mass, in the part's own frame "
        "[kg x length unit^2]; default: that of the shape, in proportion to the mass",
    )
    brick: BrickEntry | None = None
    color: str | None = Field(
        None, pattern="^#[0-9a-f]{6}$", description='colour in drawings, as "#rrggbb"'
    )
    material: str | None = Field(
        None, min_length=1, description="name of the material; nothing is computed from it"
    )
    layer: str | None = Field(None, min_length=1, description="name of the layer in CAD")


class FrictionPairEntry(Entry):
    """Friction coefficient of every contact between two parts, or between a piece of each."""

    parts: Pair
    mu: NotNegative
    pieces: PiecePair | None = Field(
        None, description="numbers of the pieces of both parts that the coefficient is for"
    )


class LoadEntry(Entry):
    """A force [N] and a torque [N x length unit] on a part, fixed in the world."""

    part: Name
    point: Vector | None = Field(
        None, description="point of attack, world frame; default the part's centre of mass"
    )
    force: Vector = [0.0, 0.0, 0.0]
    torque: Vector = [0.0, 0.0, 0.0]


class FeatureEntry(Entry):
    """The touching face, edge or vertex of a part at a given contact.

    Curvatures are positive on the convex side [1/length unit].
    """

    kind: Literal["face", "edge", "vertex"] = Field(description="a circular rim is an edge")
    along: Vector | None = Field(
        None, description="tangent of an edge; a principal direction of a face"
    )
    curvature: Number | Curvatures = Field(
        0.0, description="curvature of an edge; or of a face, along `along` and across it"
    )
    point: Vector | None = Field(None, description="point on `axis`")
    axis: Vector | None = Field(
        None, description="axis of revolution of the face or rim, through `point`"
    )


class ContactEntry(Entry):
    """Given contact points of two parts; kilter then detects no contacts of that pair."""

    parts: Pair
    points: list[Vector] = Field(description="an empty list: the parts do not touch")
    normal: Vector = Field(description="from the first part to the second")
    mu: NotNegative | None = None
    feature: Annotated[list[FeatureEntry], Field(min_length=2, max_length=2)] | None = Field(
        None,
        description="features of the first and of the second part; without them the second-order "
        "test is undecided",
    )
    pieces: PiecePair | None = Field(
        None,
        description="without points: numbers of the pieces of both parts that do not touch; "
        "contacts of other pieces are detected",
    )


class JointEntry(Entry):
    """A joint between two parts, or between a part and "ground", that pushes and pulls."""

    parts: Pair
    kind: Literal["fixed", "revolute", "prismatic", "cylindrical", "spherical", "general"]
    point: Vector | None = Field(
        None,
        description="required: a point on the axis (revolute, cylindrical), the centre "
        "(spherical), a point on all axes of turns (general)",
    )
    axis: Vector | None = Field(
        None, description="direction of the axis; required for revolute, prismatic, cylindrical"
    )
    limits: Annotated[list[Number], Field(min_length=2, max_length=2)] | None = Field(
        None,
        description="least and largest position of the first part relative to the second, about "
        "the axis [rad] or along it [length unit]; 0 is the drawn pose",
    )
    friction: NotNegative = Field(0.0, description="largest friction [N x length unit] or [N]")
    stiffness: NotNegative = Field(
        0.0, description="of a spring [N x length unit / rad] or [N / length unit]"
    )
    rest: Number = Field(
        0.0, description="position without a force of the spring [rad] or [length unit]"
    )
    slides: Axes = Field([], description="general: directions along which it slides")
    turns: Axes = Field([], description="general: axes about which it turns, in sequence")


class BondEntry(Entry):
    """A connection of two parts that resists pull up to a limit: glue, a stud, a magnet."""

    parts: Pair
    pull: NotNegative | None = Field(None, description="largest pull at each point [N]")
    pull_per_area: NotNegative | None = Field(
        None, description="instead of pull [N per square of the length unit]"
    )
    shear: NotNegative | Literal["mu"] | None = Field(
        None,
        description='largest sideways force at each point [N]; "mu": by friction; default no limit',
    )
    points: Annotated[list[Vector], Field(min_length=1)] | None = Field(
        None, description="default all contact points of the pair"
    )
    normal: Vector | None = Field(
        None, description="normal from the first part to the second; required if points are given"
    )
    kind: Literal["glue", "mortar", "magnet", "suction", "press-fit"] | None = None


class StrapEntry(Entry):
    """A belt that runs over parts along straight pieces, of known tension or of capacity."""

    name: str = Field("", description="name of the strap in answers")
    path: Annotated[list[tuple[Name, Vector]], Field(min_length=2)] = Field(
        description='part and point of each end and corner, world frame; "ground" is the world'
    )
    tension: Positive | None = Field(None, description="at the tensioned end [N]")
    mu: NotNegative = Field(0.0, description="friction coefficient at the corners")
    tensioned: Literal["first", "last"] | None = Field(
        None, description="tensioned end of the path, for friction at corners"
    )
    capacity: Positive | None = Field(
        None, description="largest pull of a strap that is not tensioned, instead of tension [N]"
    )


class AssemblyFile(Entry):
    """An assembly of rigid parts: shapes, poses, held parts, contacts, joints, bonds and loads."""

    model_config = ConfigDict(extra="forbid", defer_build=True, title="kilter assembly")

    kilter: Literal[1]
    units: Literal["m", "cm", "mm", "in"] = Field("m", description="unit of every length")
    gravity: Vector = Field([0.0, 0.0, -9.81], description="[m/s^2]")
    friction: NotNegative = Field(
        0.0, description="friction coefficient of contacts without a coefficient of their own"
    )
    parts: Annotated[list[PartEntry], Field(min_length=1)]
    friction_pairs: list[FrictionPairEntry] = []
    loads: list[LoadEntry] = []
    contacts: list[ContactEntry] = []
    joints: list[JointEntry] = []
    bonds: list[BondEntry] = []
    straps: list[StrapEntry] = []
    planar: Flag = Field(False, description="true: motions in the x-z plane only")
    detect: Flag = Field(True, description="false: only the listed contacts count")


def build_schema() -> dict[str, Any]:
    """The JSON schema of kilter's assembly file."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **AssemblyFile.model_json_schema(),
    }


# Pydantic model of a file of choices: its keys and their types.


class StudsEntry(Entry):
    """Rules for toy bricks: strength of the studs, and contact points between brick sides."""

    pull: NotNegative | None = Field(None, description="[N]")
    shear: NotNegative | Literal["unlimited", "mu"] | None = Field(None, description="[N]")
    sides: Literal["lower-edge", "face", "none"] | None = None


class OpenPairEntry(Entry):
    """Decision on two parts of which the geometry does not show whether they touch."""

    parts: Pair
    state: Literal["joined", "touching", "apart"] = Field(alias="as")


class MaterialEntry(Entry):
    """Material of the parts that match a pattern; its density replaces the mass in the file."""

    parts: Name = Field(description="a name; * and ? are wildcards")
    density: Positive = Field(description="[kg/m^3]")
    name: Name | None = Field(None, description="name of the material")


class ToleranceEntry(Entry):
    """Tolerances with which faces count as touching; null: the default."""

    gap: Positive | None = Field(None, description="[length unit]")
    angle_deg: Annotated[Positive, Field(lt=45)] | None = Field(None, description="[deg]")
    clearance: Positive | None = Field(None, description="[length unit]")


class ChoicesFile(Entry):
    """The choices of a user about a file: held parts, joined parts, friction and so on."""

    model_config = ConfigDict(extra="forbid", title="kilter choices")

    kilter: Literal[1]
    file: Name = Field(description="the file, relative to the choices, in their folder or below")
    sha256: Annotated[str, Field(strict=True, pattern="^[0-9a-f]{64}$")] | None = Field(
        None, description="digest of the file, for a warning if it changes"
    )
    units: Literal["m", "cm", "mm", "in"] | None = None
    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None
    gravity: Vector | None = Field(None, description="[m/s^2]")
    held: list[Name] | None = Field(None, description="names; * and ? are wildcards")
    floor: Flag | Number | None = Field(
        None, description="true: a table under the lowest point; a number: at this height"
    )
    fasten_suggested: Flag | None = None
    fasten_overlaps: Flag | None = None
    keep_copies: Flag | None = None
    assume: Literal["drawn", "play", "fits", "joined"] | None = None
    loose: Flag | None = None
    density: Positive | None = Field(None, description="[kg/m^3]")
    keyframe: str | None = None
    state: str | None = Field(
        None, description="FILE:ROW, a state of a simulator; the file is relative to the choices"
    )
    model: str | None = None
    base: Literal["fixed", "floating"] | None = None
    loose_robots: Flag | None = None
    studs: StudsEntry | None = None
    left_out: list[Name] | None = Field(None, description="names; * and ? are wildcards")
    joined: list[Pair] | None = None
    open_pairs: list[OpenPairEntry] | None = None
    materials: list[MaterialEntry] | None = None
    friction: NotNegative | None = None
    friction_pairs: list[FrictionPairEntry] | None = None
    joints: list[JointEntry] | None = None
    bonds: list[BondEntry] | None = None
    loads: list[LoadEntry] | None = None
    straps: list[StrapEntry] | None = None
    contacts: Literal["file", "geometry"] | None = None
    tolerance: ToleranceEntry | None = None
    poses: dict[str, PoseEntry] | None = Field(None, description="new poses of parts, by name")


def build_choices_schema() -> dict[str, Any]:
    """The JSON schema of a file of choices (a user's saved options for an assembly file)."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **ChoicesFile.model_json_schema(),
    }
