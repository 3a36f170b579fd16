"""Entries of choices that have no option: poses, materials, joints, straps and others.

Entries are JSON data, as `kilter.files.own.choices.Choices` writes them. An entry that names a part
that does not exist is left out by `entries_for`, so that choices outlive a change of their file.
"""

from __future__ import annotations

import dataclasses
import fnmatch
import json
from collections.abc import Callable, Collection, Mapping
from typing import Any

from kilter.assembly import Assembly, Bond, FrictionPair, Joint, Load, Part, Strap
from kilter.assembly.changed_copies import with_fields
from kilter.assembly.mesh_surface import reweighed
from kilter.assembly.part import GROUND
from kilter.errors import InputError
from kilter.files.own.choices import OPTIONS, Choices
from kilter.rigid import Pose

Entries = Mapping[str, Any]


def known(pattern: str, names: Collection[str]) -> bool:
    """Whether any of the names equals the pattern or matches it as a wildcard."""
    return pattern in names or bool(fnmatch.filter(names, pattern))


def entries_for(entries: Entries, names: Collection[str]) -> tuple[dict[str, Any], list[str]]:
    """The saved entries whose parts exist, and the name patterns that match no part."""
    everywhere = [*names, GROUND]
    kept: dict[str, Any] = {}
    missing: list[str] = []
    for key, value in entries.items():
        if isinstance(value, dict):
            kept[key] = {name: pose for name, pose in value.items() if name in names}
            missing += [name for name in value if name not in names]
        elif key in ("gravity", "sha256"):
            kept[key] = value
        else:
            unknown = [[n for n in _parts(entry) if not known(n, everywhere)] for entry in value]
            kept[key] = [entry for entry, gone in zip(value, unknown, strict=True) if not gone]
            missing += [name for gone in unknown for name in gone]
    return {key: value for key, value in kept.items() if value}, missing


def _parts(entry: Mapping[str, Any]) -> list[str]:
    """Names or patterns of the parts that a saved entry names."""
    if "path" in entry:
        return [name for name, _ in entry["path"]]
    named = entry.get("parts", entry.get("part"))
    return [named] if isinstance(named, str) else list(named or ())


def changed_poses(before: Assembly, after: Assembly) -> dict[str, Any]:
    """The entry `poses` of the parts of an assembly that have another pose afterwards."""
    return {
        new.name: {
            "position": new.pose.position.tolist(),
            "rotation": new.pose.rotation.tolist(),
        }
        for old, new in zip(before.parts, after.parts, strict=True)
        if new.pose != old.pose
    }


def with_bodies(assembly: Assembly, entries: Entries) -> Assembly:
    """The assembly with the saved poses and materials of a user's choices.

    A material replaces density and mass of each part that its pattern matches. If several patterns
    match a part, the last material counts.
    """
    poses, materials = entries.get("poses", {}), entries.get("materials", [])
    if not poses and not materials:
        return assembly
    chosen = {
        name: (material["density"], material.get("name"))
        for material in materials
        for name in assembly.matching([material["parts"]])
    }

    def changed(part: Part) -> Part:
        """The part with the saved pose and material, if any."""
        changes: dict[str, Any] = {}
        if part.name in poses:
            pose = poses[part.name]
            place, turn = pose.get("position", [0, 0, 0]), pose.get("rotation", [1, 0, 0, 0])
            changes["pose"] = Pose(place, turn)
        if part.name in chosen:
            density, name = chosen[part.name]
            changes |= {"density": density, "mass": None, "material": name or part.material}
        return reweighed(part, **changes) if changes else part

    return dataclasses.replace(assembly, parts=[changed(part) for part in assembly.parts])


def with_interactions(assembly: Assembly, entries: Entries) -> Assembly:
    """The assembly with the saved friction pairs, joints, bonds, loads and straps added.

    A friction pair replaces that of the file for the same parts, with those of their pieces, or
    that for the same pieces.
    """
    pairs = _each(
        entries, "friction_pairs", lambda e: FrictionPair(_pair(e), e["mu"], e.get("pieces"))
    )
    named = {pair.subject for pair in pairs}
    changes: dict[str, Any] = {
        "friction_pairs": [
            *(
                pair
                for pair in assembly.friction_pairs
                if named.isdisjoint((pair.subject, frozenset(pair.parts)))
            ),
            *pairs,
        ],
        "joints": [*assembly.joints, *_each(entries, "joints", _joint)],
        "bonds": [*assembly.bonds, *_each(entries, "bonds", _bond)],
        "loads": [*assembly.loads, *_each(entries, "loads", lambda e: Load(**e))],
        "straps": [*assembly.straps, *_each(entries, "straps", lambda e: Strap(**e))],
    }
    new: dict[str, Any] = {key: value for key, value in changes.items() if entries.get(key)}
    return with_fields(assembly, **new) if new else assembly


def _each(entries: Entries, key: str, build: Callable[[Any], Any]) -> list[Any]:
    """Build a value from each saved entry under a key; an error names the place in the list."""
    built = []
    for k, entry in enumerate(entries.get(key, ())):
        try:
            built.append(build(entry))
        except InputError as error:
            raise error.about(f"{key}[{k}]: {error.what}") from None
    return built


def _pair(entry: Mapping[str, Any]) -> tuple[str, str]:
    first, second = entry["parts"]
    return first, second


def _joint(entry: Mapping[str, Any]) -> Joint:
    return Joint(**{**entry, "parts": _pair(entry)})


def _bond(entry: Mapping[str, Any]) -> Bond:
    return Bond(**{**entry, "parts": _pair(entry)})


def patterns_of(value: Any) -> list[str]:
    """Name patterns in the value of an option that names parts."""
    return [value] if isinstance(value, str) else [name for name in value if isinstance(name, str)]


def replacement(option: str, new: Any, key: str, old: Any) -> str:
    """Sentence for the user: an option overrides a key of the saved choices.

    Examples
    --------
    >>> replacement("ground", ["a"], "ground", ("b",))
    'the option ground ["a"] replaces held ["b"] of the choices'
    """
    names = {option: name for name, option in OPTIONS.items()} | {"bond": "bonds"}
    words = json.dumps(new, ensure_ascii=False), json.dumps(lists(old), ensure_ascii=False)
    return (
        f"the option {option} {words[0]} replaces {names.get(key, key)} {words[1]} of the choices"
    )


def valid_entries(entries: Any) -> dict[str, Any]:
    """Validate saved entries that a proof lists, as those of a file; raises `InputError`."""
    given = dict(entries)
    Choices.from_dict({"kilter": 1, "file": "file", **given})
    return given


def lists(value: Any) -> Any:
    """Convert nested tuples to lists, for JSON."""
    return [lists(inner) for inner in value] if isinstance(value, tuple) else value
