"""kilter's own file, as a dict, to an assembly and back.

What is written reads back as the same values to the last digit: a shape in its own kind,
numbers as they are, defaults left out.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.assembly import Assembly, Bond, Feature, FrictionPair, GivenContact, Joint, Load, Part
from kilter.assembly.brick import BRICK_PLATES, Brick
from kilter.errors import InputError, nearest_name
from kilter.files.checked_solid import checked
from kilter.files.complaints import complaint
from kilter.files.limits import Tally
from kilter.files.named_files import NamedFiles
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Prism, Shape, Sphere
from kilter.shape.solid import Solid, Surface
from kilter.validate import frozen

if TYPE_CHECKING:
    from kilter.files.models import AssemblyFile, BrickEntry, PartEntry, SolidEntry

__all__ = ["from_dict", "schema", "to_dict"]

VERSION = 1
GRAVITY = [0.0, 0.0, -9.81]


def schema() -> dict[str, Any]:
    """The JSON schema of the kilter file.

    Examples
    --------
    >>> schema()["title"]
    'kilter assembly'
    """
    text = resources.files("kilter.files").joinpath("assembly.schema.json").read_text("utf-8")
    found: dict[str, Any] = json.loads(text)
    return found


# reading -------------------------------------------------------------------------------


def from_dict(data: Any, *, folder: str | Path = ".", source: str = "") -> Assembly:
    """The assembly that a kilter file describes.

    Parameters
    ----------
    data : dict
        The file as JSON values.
    folder : path
        What paths of meshes are relative to.
    source : str
        The file's name, for messages.

    Raises
    ------
    InputError
        If an entry is unknown, missing or wrong; it names the part and the place.

    Examples
    --------
    >>> cube = {"name": "C1", "box": [1, 1, 1], "densty": 7850}
    >>> from_dict({"kilter": 1, "parts": [cube]})
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: part 'C1': unknown key 'densty'; did you mean 'density'?
    """
    try:
        entries = _validated(data)
        named = NamedFiles(Path(folder), entries.units)
        tally = Tally()
        parts = [_part(entry, named, tally) for entry in entries.parts]
        return Assembly(
            parts,
            units=entries.units,
            gravity=entries.gravity,
            friction=entries.friction,
            friction_pairs=[FrictionPair(_pair(e.parts), e.mu) for e in entries.friction_pairs],
            loads=[Load(e.part, e.force, e.torque, e.point) for e in entries.loads],
            contacts=_each("contacts", entries.contacts, _contact),
            joints=_each("joints", entries.joints, _joint),
            bonds=_each("bonds", entries.bonds, _bond),
            planar=entries.planar,
            detect=entries.detect,
            source=source,
            notes=named.notes,
        )
    except InputError as error:
        raise error.located(file=source or None) from None


def _validated(data: Any) -> AssemblyFile:
    from pydantic import ValidationError

    from kilter.files.models import AssemblyFile

    example = f'begin with {{"kilter": {VERSION}, "units": "mm", "parts": [...]}}'
    if not isinstance(data, dict):
        raise InputError("the file is not a JSON object", hint=example)
    if "kilter" not in data:
        near = nearest_name("kilter", data)
        hint = f"did you mean 'kilter' by {near!r}?" if near else example
        raise InputError("key 'kilter' is missing: not a kilter file", hint=hint)
    version = data["kilter"]
    if type(version) is not int or version != VERSION:
        raise InputError(
            f"version of the file, kilter, is {version!r:.40}",
            hint=f"this kilter reads version {VERSION}",
        )
    try:
        return AssemblyFile.model_validate(data)
    except ValidationError as error:
        raise complaint(error, data, AssemblyFile) from None


def _part(entry: PartEntry, named: NamedFiles, tally: Tally) -> Part:
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
            brick=None if entry.brick is None else _brick(entry.brick),
        )
    except InputError as error:
        raise error.located(part=entry.name) from None


def _brick(entry: BrickEntry) -> Brick:
    across, along = entry.cells
    return Brick((across, along), entry.plates, entry.color)


def _shape(entry: PartEntry, named: NamedFiles) -> Shape:
    given = [key for key in entry.shapes() if getattr(entry, key) is not None]
    if len(given) != 1:
        what = f"has {' and '.join(given)}" if given else "has no shape"
        raise InputError(what, hint=f"give exactly one of {', '.join(entry.shapes())}")
    if (entry.depth is None) == (entry.polygon is not None):
        raise InputError(
            "polygon without depth" if entry.polygon else "depth without polygon",
            hint="a prism has both",
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
        one = entry.step
        return named.step(one) if isinstance(one, str) else named.step(one.path, one.name)
    if entry.solid is not None:
        return _solid(entry.solid)
    if isinstance(entry.mesh, str):
        return named.mesh(entry.mesh)
    assert entry.mesh is not None
    return Mesh(entry.mesh.vertices, entry.mesh.faces, accuracy=entry.mesh.accuracy)


def _solid(entry: SolidEntry) -> Solid:
    numbers = entry.model_dump()
    surfaces = []
    for given in numbers.pop("surfaces"):
        surfaces.append(Surface(**given))
        _keep(surfaces[-1], "axis", given["axis"])
    return checked(Solid(**numbers, surfaces=tuple(surfaces)))


def _each(name: str, entries: Sequence[Any], build: Callable[[Any], Any]) -> list[Any]:
    """Values of a list of entries; a fault names its place in the list."""
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
    return names[0], names[1]


def _contact(entry: Any) -> GivenContact:
    given = entry.feature
    pair = None if given is None else (_feature(given[0]), _feature(given[1]))
    contact = GivenContact(_pair(entry.parts), entry.points, entry.normal, entry.mu, pair)
    _keep(contact, "normal", entry.normal)
    return contact


def _feature(entry: Any) -> Feature:
    feature = Feature(entry.kind, entry.along, entry.curvature, entry.point, entry.axis)
    for name in ("along", "axis"):
        given = getattr(entry, name)
        if given is not None:
            _keep(feature, name, given)
    return feature


def _joint(entry: Any) -> Joint:
    joint = Joint(_pair(entry.parts), entry.kind, entry.point, entry.axis)
    if entry.axis is not None:
        _keep(joint, "axis", entry.axis)
    return joint


def _bond(entry: Any) -> Bond:
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


def _keep(
    value: Feature | GivenContact | Joint | Bond | Surface, name: str, numbers: list[float]
) -> None:
    """Leave a direction of length 1 (up to rounding) as it is written.

    To divide it by its length once more may change the last digit, and what was written
    must read back the same.
    """
    if abs(float(np.linalg.norm(numbers)) - 1.0) <= 4 * np.finfo(float).eps:
        object.__setattr__(value, name, frozen(numbers, (3,)))


# writing -------------------------------------------------------------------------------


def to_dict(assembly: Assembly) -> dict[str, Any]:
    """The assembly as the JSON values of a kilter file; defaults are left out.

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
        "friction_pairs": [{"parts": list(p.parts), "mu": p.mu} for p in assembly.friction_pairs],
        "loads": [_load_dict(load) for load in assembly.loads],
        "contacts": [
            _given(
                parts=list(c.parts),
                points=c.points,
                normal=c.normal,
                mu=c.mu,
                feature=c.feature and [_feature_dict(one) for one in c.feature],
            )
            for c in assembly.contacts
        ],
        "joints": [
            _given(parts=list(j.parts), kind=j.kind, point=j.point, axis=j.axis)
            for j in assembly.joints
        ],
        "bonds": [
            _given(
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
    }
    data |= {key: entries for key, entries in lists.items() if entries}
    if assembly.planar:
        data["planar"] = True
    if not assembly.detect:
        data["detect"] = False
    return data


def _given(**entries: Any) -> dict[str, Any]:
    """Entries that are there, arrays as lists."""
    return {
        key: value.tolist() if isinstance(value, np.ndarray) else value
        for key, value in entries.items()
        if value is not None
    }


def _part_dict(part: Part) -> dict[str, Any]:
    pose = _given(
        position=part.pose.position if part.pose.position.any() else None,
        rotation=None if part.pose.rotation.tolist() == [1, 0, 0, 0] else part.pose.rotation,
    )
    return {
        "name": part.name,
        **_shape_dict(part.shape),
        **_given(
            pose=pose or None,
            grounded=bool(part.grounded) or None,
            density=part.density,
            mass=part.mass,
            center_of_mass=part.center_of_mass,
            brick=None if part.brick is None else _brick_dict(part.brick),
        ),
    }


def _brick_dict(brick: Brick) -> dict[str, Any]:
    plates = None if brick.plates == BRICK_PLATES else brick.plates
    return _given(cells=list(brick.cells), plates=plates, color=brick.color)


def _shape_dict(shape: Shape) -> dict[str, Any]:
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
    mesh = _given(
        vertices=shape.vertices,
        faces=shape.triangles,
        accuracy=None if shape.accuracy == largest * 2.0**-53 else shape.accuracy,
    )
    return {"mesh": mesh}


def _solid_dict(solid: Solid) -> dict[str, Any]:
    entries = _given(**{name: getattr(solid, name) for name in Solid.__slots__})
    for name in ("holes", "stand_in", "uncertainty"):  # of a sound solid they say nothing
        if not entries[name]:
            del entries[name]
    entries["surfaces"] = [
        _given(**{name: getattr(surface, name) for name in Surface.__slots__})
        for surface in solid.surfaces
    ]
    return entries


def _feature_dict(feature: Feature) -> dict[str, Any]:
    k, across = feature.curvature.tolist()
    alone = feature.kind == "edge" or k == across
    return _given(
        kind=feature.kind,
        along=feature.along,
        curvature=((k or None) if alone else [k, across]),
        point=feature.point,
        axis=feature.axis,
    )


def _load_dict(load: Load) -> dict[str, Any]:
    return _given(
        part=load.part,
        point=load.point,
        force=load.force if load.force.any() else None,
        torque=load.torque if load.torque.any() else None,
    )
