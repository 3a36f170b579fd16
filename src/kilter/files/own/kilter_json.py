"""Convert between an assembly and the JSON values of a kilter file.

Writing and reading back gives the same values to the last digit: every kind of shape has its own
key, numbers are not rounded, and defaults are left out.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.assembly import (
    Assembly,
    Bond,
    Feature,
    FrictionPair,
    GivenContact,
    Joint,
    Load,
    Part,
    Strap,
)
from kilter.assembly.interactions import FREE_AXES
from kilter.assembly.part import BRICK_PLATES, Brick
from kilter.errors import InputError, nearest_name
from kilter.files.cad.checked_solid import checked_solid
from kilter.files.complaints import complaint
from kilter.files.formats import NamedFiles
from kilter.files.limits import Tally
from kilter.files.own.plain_entries import SHAPES, plain_entries
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Prism, Shape, Sphere
from kilter.shape.solid import Solid, Surface
from kilter.validate import frozen

if TYPE_CHECKING:
    from kilter.files.own.models import (
        AssemblyFile,
        BrickEntry,
        MemberEntry,
        MeshEntry,
        PartEntry,
        SolidEntry,
    )


VERSION = 1
"""Version of the file format."""
GRAVITY = [0.0, 0.0, -9.81]
SCHEMA = ".schema.json"
"""End of the name of a published schema."""


def schema(name: str = "assembly") -> dict[str, Any]:
    """The JSON schema of a kilter file or answer, by its name: "assembly", "check" and so on.

    Examples
    --------
    >>> schema()["title"], schema("check")["title"]
    ('kilter assembly', 'kilter answer of check')
    """
    folder = resources.files("kilter.files").joinpath("schemas")
    names = sorted(file.name.removesuffix(SCHEMA) for file in folder.iterdir())
    if name not in names:
        raise InputError(f"no schema is named {name!r:.40}", hint=f"there are: {', '.join(names)}")
    content: dict[str, Any] = json.loads(folder.joinpath(name + SCHEMA).read_text("utf-8"))
    return content


# reading -------------------------------------------------------------------------------


def from_dict(data: Any, *, folder: str | Path = ".", source: str = "") -> Assembly:
    """Build an assembly from the JSON data of kilter's assembly file.

    Raises `InputError` if an entry is unknown, missing or invalid; the error names the part and the
    place.

    Examples
    --------
    >>> cube = {"name": "C1", "box": [1, 1, 1], "densty": 7850}
    >>> from_dict({"kilter": 1, "parts": [cube]})
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: part 'C1': unknown key 'densty'; did you mean 'density'?
    """
    try:
        entries = _validate(data)
        named = NamedFiles(Path(folder), entries.units)
        tally = Tally()
        parts = [_part(entry, named, tally) for entry in entries.parts]
        return Assembly(
            parts,
            units=entries.units,
            gravity=entries.gravity,
            friction=entries.friction,
            friction_pairs=_each("friction_pairs", entries.friction_pairs, _friction_pair),
            loads=[Load(e.part, e.force, e.torque, e.point) for e in entries.loads],
            contacts=_each("contacts", entries.contacts, _contact),
            joints=_each("joints", entries.joints, _joint),
            bonds=_each("bonds", entries.bonds, _bond),
            straps=_each("straps", entries.straps, _strap),
            planar=entries.planar,
            detect=entries.detect,
            source=source,
            notes=named.notes,
        )
    except InputError as error:
        raise error.located(file=source or None) from None


def _validate(data: Any) -> AssemblyFile:
    """Parse the JSON data of an assembly file into its entries; raises `InputError`."""
    example = f'begin with {{"kilter": {VERSION}, "units": "mm", "parts": [...]}}'
    if not isinstance(data, dict):
        raise InputError("the file is not a JSON object", hint=example)
    if "kilter" not in data:
        near = nearest_name("kilter", data)
        hint = f"the key {near!r} may be a misspelling of it" if near else example
        raise InputError("the key 'kilter' is missing: this is not a kilter file", hint=hint)
    version = data["kilter"]
    if type(version) is not int or version != VERSION:
        raise InputError(
            f"the file version (key 'kilter') is {version!r:.40}",
            hint=f"this program reads version {VERSION}",
        )
    entries: AssemblyFile | None = plain_entries(data)
    if entries is not None:
        return entries
    from pydantic import ValidationError

    from kilter.files.own.models import AssemblyFile

    try:
        return AssemblyFile.model_validate(data)
    except ValidationError as error:
        raise complaint(error, data, AssemblyFile) from None


def _part(entry: PartEntry, named: NamedFiles, tally: Tally) -> Part:
    """Build the part of a file entry; its triangles are added to the count `tally`."""
    try:
        pose, shape = entry.pose, _shape(entry, named)
        if isinstance(shape, Mesh | Solid):
            tally.add(len(shape.triangles))
        return Part(
            entry.name,
            shape,
            Pose() if pose is None else Pose(pose.position, pose.rotation),
            grounded=entry.grounded,
            density=entry.density,
            mass=entry.mass,
            center_of_mass=entry.center_of_mass,
            inertia=entry.inertia,
            brick=None if entry.brick is None else _brick(entry.brick),
            color=entry.color,
            material=entry.material,
            layer=entry.layer,
        )
    except InputError as error:
        raise error.located(part=entry.name) from None


def _brick(entry: BrickEntry) -> Brick:
    """Build the brick of a file entry."""
    across, along = entry.cells
    return Brick((across, along), entry.plates, entry.color)


def _shape(entry: PartEntry, named: NamedFiles) -> Shape:
    """Build the shape of a part's entry; raises `InputError` unless it has exactly one shape."""
    given = [key for key in SHAPES if getattr(entry, key) is not None]
    if len(given) != 1:
        what = f"has {' and '.join(given)}" if given else "has no shape"
        raise InputError(what, hint=f"give exactly one of {', '.join(SHAPES)}")
    if (entry.depth is None) == (entry.polygon is not None):
        raise InputError(
            "polygon without depth" if entry.polygon else "depth without polygon",
            hint="a prism needs both",
        )
    if entry.box is not None:
        return Box(entry.box)
    if entry.cylinder is not None:
        return Cylinder(entry.cylinder.radius, entry.cylinder.height)
    if entry.sphere is not None:
        return Sphere(entry.sphere.radius)
    if entry.polygon is not None and entry.depth is not None:
        return Prism(entry.polygon, entry.depth)
    if entry.step is not None:
        step = entry.step
        return named.step(step) if isinstance(step, str) else named.step(step.path, step.name)
    if entry.solid is not None:
        return _solid(entry.solid)
    if isinstance(entry.mesh, str):
        return named.mesh(entry.mesh)
    assert entry.mesh is not None
    return _mesh(entry.mesh)


def _mesh(entry: MeshEntry) -> Mesh:
    """Build the mesh of a file entry, with the shapes that it unites."""
    members = entry.members or []
    return Mesh(
        entry.vertices,
        entry.faces,
        accuracy=entry.accuracy,
        pieces=entry.pieces,
        members=_each("members", members, _member),
        member_pieces=[member.piece for member in members],
    )


def _member(entry: MemberEntry) -> tuple[Shape, Pose]:
    """Build a shape of a compound and its pose; raises `InputError` unless it has one shape."""
    pose = Pose() if entry.pose is None else Pose(entry.pose.position, entry.pose.rotation)
    built: list[Shape] = []
    if entry.box is not None:
        built.append(Box(entry.box))
    if entry.cylinder is not None:
        built.append(Cylinder(entry.cylinder.radius, entry.cylinder.height))
    if entry.sphere is not None:
        built.append(Sphere(entry.sphere.radius))
    if entry.mesh is not None:
        built.append(_mesh(entry.mesh))
    if len(built) != 1:
        raise InputError(
            f"has {len(built)} shapes", hint="give exactly one of box, cylinder, sphere and mesh"
        )
    return built[0], pose


def _solid(entry: SolidEntry) -> Solid:
    """Build the solid of a file entry, and check its volume."""
    numbers = entry.model_dump()
    surfaces = []
    for given in numbers.pop("surfaces"):
        surfaces.append(Surface(**given))
        _keep(surfaces[-1], "axis", given["axis"])
    return checked_solid(Solid(**numbers, surfaces=tuple(surfaces)))


def _each(name: str, entries: Sequence[Any], build: Callable[[Any], Any]) -> list[Any]:
    """Build a value from each entry of a list; an error names the place in the list."""
    built = []
    for k, entry in enumerate(entries):
        try:
            built.append(build(entry))
        except InputError as error:
            raise InputError(
                f"{name}[{k}]: {error.what}", part=error.part, hint=error.hint
            ) from None
    return built


def _pair(names: Sequence[str]) -> tuple[str, str]:
    """Two names as a tuple, from a list of two names."""
    return names[0], names[1]


def _friction_pair(entry: Any) -> FrictionPair:
    """Build the friction pair of a file entry."""
    return FrictionPair(_pair(entry.parts), entry.mu, entry.pieces)


def _contact(entry: Any) -> GivenContact:
    """Build the contact of a file entry."""
    given = entry.feature
    pair = None if given is None else (_feature(given[0]), _feature(given[1]))
    contact = GivenContact(
        _pair(entry.parts), entry.points, entry.normal, entry.mu, pair, entry.pieces
    )
    _keep(contact, "normal", entry.normal)
    return contact


def _feature(entry: Any) -> Feature:
    """Build the touching feature (face, edge or vertex) of a file entry."""
    feature = Feature(entry.kind, entry.along, entry.curvature, entry.point, entry.axis)
    for name in ("along", "axis"):
        given = getattr(entry, name)
        if given is not None:
            _keep(feature, name, given)
    return feature


def _joint(entry: Any) -> Joint:
    """Build the joint of a file entry."""
    joint = Joint(
        _pair(entry.parts),
        entry.kind,
        entry.point,
        entry.axis,
        limits=entry.limits,
        friction=entry.friction,
        stiffness=entry.stiffness,
        rest=entry.rest,
        slides=entry.slides,
        turns=entry.turns,
    )
    if entry.axis is not None:
        _keep(joint, "axis", entry.axis)
    for name in FREE_AXES:
        if getattr(entry, name):
            _keep(joint, name, getattr(entry, name))
    return joint


def _bond(entry: Any) -> Bond:
    """Build the bond of a file entry."""
    bond = Bond(
        _pair(entry.parts),
        entry.pull,
        entry.pull_per_area,
        entry.shear,
        entry.points,
        entry.normal,
        entry.kind,
    )
    if entry.normal is not None:
        _keep(bond, "normal", entry.normal)
    return bond


def _strap(entry: Any) -> Strap:
    """Build the strap of a file entry."""
    return Strap(entry.path, entry.tension, entry.mu, entry.tensioned, entry.capacity, entry.name)


def _keep(
    value: Feature | GivenContact | Joint | Bond | Surface, name: str, numbers: list[Any]
) -> None:
    """Keep the digits of a unit vector, or of several, as in the file, not normalised again.

    A second division by the length may change the last digit, but a file that is read and
    written again must be the same.
    """
    lengths = np.linalg.norm(numbers, axis=-1)
    if np.abs(lengths - 1.0).max() <= 4 * np.finfo(float).eps:
        object.__setattr__(value, name, frozen(numbers, np.shape(numbers)))


# writing -------------------------------------------------------------------------------


def to_dict(assembly: Assembly) -> dict[str, Any]:
    """The JSON data of kilter's assembly file for an assembly; defaults are left out.

    Examples
    --------
    >>> to_dict(Assembly([Part("C1", Box([1, 2, 3]), grounded=True)]))["parts"]
    [{'name': 'C1', 'box': [1.0, 2.0, 3.0], 'grounded': True}]
    """
    data: dict[str, Any] = {"kilter": VERSION, "units": assembly.units}
    if assembly.gravity.tolist() != GRAVITY:
        data["gravity"] = assembly.gravity.tolist()
    if assembly.friction:
        data["friction"] = assembly.friction
    data["parts"] = [_part_dict(part) for part in assembly.parts]
    lists = {
        "friction_pairs": [
            _without_none(parts=list(p.parts), mu=p.mu, pieces=p.pieces and list(p.pieces))
            for p in assembly.friction_pairs
        ],
        "loads": [_load_dict(load) for load in assembly.loads],
        "contacts": [
            _without_none(
                parts=list(c.parts),
                points=c.points,
                normal=c.normal,
                mu=c.mu,
                feature=c.feature and [_feature_dict(feature) for feature in c.feature],
                pieces=c.pieces and list(c.pieces),
            )
            for c in assembly.contacts
        ],
        "joints": [
            _without_none(
                parts=list(j.parts),
                kind=j.kind,
                point=j.point,
                axis=j.axis,
                **j.free_axes,
                **j.guide,
            )
            for j in assembly.joints
        ],
        "bonds": [
            _without_none(
                parts=list(b.parts),
                pull=b.pull,
                pull_per_area=b.pull_per_area,
                shear=b.shear,
                points=b.points,
                normal=b.normal,
                kind=b.kind,
            )
            for b in assembly.bonds
        ],
        "straps": [strap.to_dict() for strap in assembly.straps],
    }
    data |= {key: entries for key, entries in lists.items() if entries}
    if assembly.planar:
        data["planar"] = True
    if not assembly.detect:
        data["detect"] = False
    return data


def _without_none(**entries: Any) -> dict[str, Any]:
    """A dict of the given entries that are not None, with arrays as lists."""
    return {
        key: value.tolist() if isinstance(value, np.ndarray) else value
        for key, value in entries.items()
        if value is not None
    }


def _part_dict(part: Part) -> dict[str, Any]:
    """JSON data of a part."""
    return {
        "name": part.name,
        **_shape_dict(part.shape),
        **_without_none(
            pose=_pose_dict(part.pose) or None,
            grounded=bool(part.grounded) or None,
            density=part.density,
            mass=part.given_mass,
            center_of_mass=part.center_of_mass,
            inertia=part.inertia,
            brick=None if part.brick is None else _brick_dict(part.brick),
            color=part.color,
            material=part.material,
            layer=part.layer,
        ),
    }


def _pose_dict(pose: Pose) -> dict[str, Any]:
    """JSON data of a pose, without position and rotation if they are those of the frame."""
    return _without_none(
        position=pose.position if pose.position.any() else None,
        rotation=None if pose.rotation.tolist() == [1, 0, 0, 0] else pose.rotation,
    )


def _brick_dict(brick: Brick) -> dict[str, Any]:
    """JSON data of a brick."""
    plates = None if brick.plates == BRICK_PLATES else brick.plates
    return _without_none(cells=list(brick.cells), plates=plates, color=brick.color)


def _shape_dict(shape: Shape) -> dict[str, Any]:
    """JSON data of a shape: its key and the entry under it."""
    if isinstance(shape, Box):
        return {"box": shape.size.tolist()}
    if isinstance(shape, Cylinder):
        return {"cylinder": {"radius": shape.radius, "height": shape.height}}
    if isinstance(shape, Sphere):
        return {"sphere": {"radius": shape.radius}}
    if isinstance(shape, Prism):
        return {"polygon": shape.polygon.tolist(), "depth": shape.depth}
    if isinstance(shape, Solid):
        return {"solid": _solid_dict(shape)}
    largest = float(np.abs(shape.vertices).max(initial=0.0))
    mesh = _without_none(
        vertices=shape.vertices,
        faces=shape.triangles,
        accuracy=None if shape.accuracy == largest * 2.0**-53 else shape.accuracy,
        pieces=shape.pieces,
        members=_member_dicts(shape) or None,
    )
    return {"mesh": mesh}


def _member_dicts(shape: Mesh) -> list[dict[str, Any]]:
    """JSON data of the shapes of a compound; none if a shape has no entry."""
    kinds = (Box, Cylinder, Sphere, Mesh)
    if not all(isinstance(member, kinds) for member, _ in shape.members):
        return []
    return [
        {**_shape_dict(member), **_without_none(pose=_pose_dict(pose) or None, piece=piece or None)}
        for (member, pose), piece in zip(shape.members, shape.member_pieces, strict=True)
    ]


def _solid_dict(solid: Solid) -> dict[str, Any]:
    """JSON data of a solid with exact faces."""
    entries = _without_none(**{name: getattr(solid, name) for name in Solid.__slots__})
    for name in ("holes", "stand_in", "uncertainty"):  # defaults of a valid solid
        if not entries[name]:
            del entries[name]
    entries["surfaces"] = [
        _without_none(**{name: getattr(surface, name) for name in Surface.__slots__})
        for surface in solid.surfaces
    ]
    return entries


def _feature_dict(feature: Feature) -> dict[str, Any]:
    """JSON data of a touching feature; equal curvatures of a face become a single number."""
    k, across = feature.curvature.tolist()
    single = feature.kind == "edge" or k == across
    return _without_none(
        kind=feature.kind,
        along=feature.along,
        curvature=((k or None) if single else [k, across]),
        point=feature.point,
        axis=feature.axis,
    )


def _load_dict(load: Load) -> dict[str, Any]:
    """JSON data of a load."""
    return _without_none(
        part=load.part,
        point=load.point,
        force=load.force if load.force.any() else None,
        torque=load.torque if load.torque.any() else None,
    )
