"""Read an assembly from a file, a folder, a stream or an object.

The ending of the path, and for JSON the content, select the reader.
"""

from __future__ import annotations

import dataclasses
import fnmatch
import math
import os
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kilter.assembly import Assembly
from kilter.assembly.assumption import valid_rung
from kilter.assembly.bricks import StudRules
from kilter.assembly.changed_copies import FLOOR
from kilter.assembly.question import LOWEST, holding, on_floor
from kilter.errors import InputError, some_names
from kilter.files.file_content import FileContent, read_path
from kilter.files.format_options import BASES, FormatOptions
from kilter.files.objects.state_files import state_row
from kilter.files.own.choices import Choices, digest, find_choices
from kilter.files.own.choices_writing import (
    released_in_part,
    require_off,
    require_saved,
    switched_off,
)
from kilter.files.own.saved_entries import (
    entries_for,
    known,
    lists,
    patterns_of,
    replacement,
    valid_entries,
    with_bodies,
    with_interactions,
)
from kilter.files.reading_options import ReadingOptions
from kilter.files.reading_steps import (
    on_carrier,
    with_contacts_of,
    with_density,
    with_friction,
    with_loads,
    with_masses,
)
from kilter.rigid import UP
from kilter.units import metres_per_unit
from kilter.values.guesses import guarded

__all__ = ["LOWEST", "Chosen", "Reading", "chosen"]

SOURCES = ("file", "geometry")
"""Values of the option `contacts`: the sources of the contacts."""
POSES = {"keyframe": "state", "state": "keyframe"}
"""Options that name the pose of a MuJoCo scene; a given one replaces the other one."""
NAMED = ("ground", "without", "fasten", "bond")
"""Options that name parts."""
_OR = " or "


@guarded
@dataclass(frozen=True, slots=True)
class Reading(ReadingOptions):
    """The options of reading a file, and the assembly that they make of its content.

    Raises `InputError` if `up`, `base`, `contacts`, `off`, a bond or a brick rule has an invalid
    value, or if two of the given options contradict each other.
    """

    def __post_init__(self) -> None:
        _ = self.studs
        object.__setattr__(self, "off", tuple(dict.fromkeys(self.off)))
        for *_names, pull in self.bond:
            if not (math.isfinite(pull) and pull >= 0):
                raise InputError(
                    f"bond has a pull of {pull:g} N", hint="give two names and newtons, 0 or more"
                )
        if self.base is not None and self.base not in BASES:
            raise InputError(f"the base is {self.base!r:.40}", hint=f"use {_OR.join(BASES)}")
        if self.assume is not None:
            valid_rung(self.assume)
        if self.up is not None and self.up not in UP:
            raise InputError(f"up is {self.up!r:.40}", hint=f"use {', '.join(UP)}")
        if self.up is not None and self.down is not None:
            raise InputError("up and down are both given", hint="give only up or down")
        if self.contacts is not None and self.contacts not in SOURCES:
            raise InputError(f"contacts are {self.contacts!r:.40}", hint=f"use {_OR.join(SOURCES)}")
        if self.off or self.release:
            given = {**self.options(), **self.entries}.keys() - set(self.saved)
            require_off(self.off, self.release, given)

    def without_off(self) -> Reading:
        """The reading whose `off` has only the floor, which is then not assumed either."""
        off = (FLOOR,) if "floor" in self.off else ()
        return dataclasses.replace(self, off=off)

    @property
    def fastens(self) -> bool:
        """Whether an option joins parts; this requires contact detection."""
        named = self.fasten or self.bond or "open_pairs" in self.entries
        return bool(named) or self.fasten_suggested or self.fasten_overlaps

    @property
    def format_options(self) -> FormatOptions:
        """The options of this reading that only specific file formats use."""
        if self.state is not None and self.keyframe is not None:
            raise InputError("state and keyframe are both given", hint="give only one of them")
        states = None if self.state is None else state_row(self.state)
        return FormatOptions(
            self.units,
            self.contacts,
            self.keyframe,
            states,
            self.model,
            self.base,
            self.loose_robots,
            self.keep_copies,
            self.studs,
        )

    @property
    def studs(self) -> StudRules:
        """Rules for toy bricks: the defaults of StableLego, except for the options that are set."""
        rules = {"pull": self.stud_pull, "shear": self.stud_shear, "sides": self.brick_sides}
        given: dict[str, Any] = {k: value for k, value in rules.items() if value is not None}
        return StudRules(**given)

    def options(self) -> dict[str, Any]:
        """The options of this reading that are set, as JSON data."""
        return {
            key: lists(value)
            for key, value in dataclasses.asdict(self).items()
            if value not in (None, (), {}) and value is not False
        }

    @classmethod
    def from_options(cls, options: Any) -> Reading:
        """Build a reading from JSON data: the inverse of `options`.

        Raises `InputError` if the options are invalid.
        """
        try:
            values = dict(options)
            for key in ("ground", "without", "down", "saved", "off", "release"):
                if key in values:
                    values[key] = tuple(values[key])
            values["fasten"] = tuple((str(a), str(b)) for a, b in values.get("fasten", ()))
            bonds = values.get("bond", ())
            values["bond"] = tuple((str(a), str(b), float(pull)) for a, b, pull in bonds)
            for key in ("fasten_suggested", "fasten_overlaps", "loose_robots", "keep_copies"):
                values[key] = bool(values.get(key, False))
            values["mass"] = tuple((str(a), float(kg)) for a, kg in values.get("mass", ()))
            loads = values.get("load", ())
            values["load"] = tuple((str(a), float(x), float(y), float(z)) for a, x, y, z in loads)
            if "accelerate" in values:
                values["accelerate"] = tuple(str(text) for text in values["accelerate"])
            values["entries"] = valid_entries(values.get("entries", {}))
            return cls(**values)
        except (TypeError, ValueError):
            raise InputError(
                "the proof's options cannot be read", hint="make a new proof"
            ) from None

    def read(self, source: Any, *, progress: Callable[[str], None] | None = None) -> Assembly:
        """Read an assembly with these options, except the options that join parts."""
        return self.read_content(self.content(source, progress=progress))

    def content(self, source: Any, *, progress: Callable[[str], None] | None = None) -> FileContent:
        """Read the content of a file, to which other options may be applied than these.

        Of these options it uses the length unit and those of the format, and the reader of a STEP
        file leaves out the parts of `without`.
        """
        if self.units is not None:
            metres_per_unit(self.units)
        if "ground" not in self.saved:
            require_saved(self.release)
        if not isinstance(source, str | os.PathLike):
            # imported late: files do not need these modules
            from kilter.files.objects.known_objects import read_object

            return FileContent(*read_object(source, self.format_options))
        if not os.fspath(source):
            raise InputError(f"a file's path is {source!r:.60}", hint="give a path, or '-'")
        return read_path(source, self.format_options, without=self.without, progress=progress)

    def read_content(self, content: FileContent) -> Assembly:
        """Apply these options to the content of a file, except the options that join parts.

        A note of the assembly names the parts of saved choices that do not exist.
        """
        # choices may name the floor that answers about a file without a held part assume
        assumed = () if content.assembly.file_up is None else ("floor",)
        names = (*content.assembly.names, *content.left_out, *assumed)
        here, missing = self.for_parts(names)
        assembly = here.applied(content)
        if missing:
            note = f"the choices name parts that do not exist: {some_names(missing)}; they are kept"
            assembly = dataclasses.replace(assembly, notes=[*assembly.notes, note])
        return assembly

    def for_parts(self, names: Collection[str]) -> tuple[Reading, list[str]]:
        """The reading without saved options for parts that do not exist, and their patterns.

        Options that are not `saved` stay: an unknown name is then an error.
        """
        everywhere = list(names) if self.floor is None else [*names, "floor"]
        of_choices = {key: value for key, value in self.entries.items() if key in self.saved}
        entries, missing = entries_for(of_choices, everywhere)
        own = {key: value for key, value in self.entries.items() if key not in self.saved}
        changes: dict[str, Any] = {"entries": {**own, **entries}}
        for key in set(NAMED) & set(self.saved):
            patterns = [patterns_of(value) for value in getattr(self, key)]
            gone = [[p for p in each if not known(p, everywhere)] for each in patterns]
            changes[key] = tuple(
                value for value, none in zip(getattr(self, key), gone, strict=True) if not none
            )
            missing += [pattern for none in gone for pattern in none]
        return dataclasses.replace(self, **changes), sorted(set(missing))

    def released(self, names: Sequence[str]) -> Reading:
        """The reading with held parts by name, less those that `release` matches.

        It is the reading itself if nothing is released.

        Raises `InputError` if a released name matches no held part.
        """
        if not self.release:
            return self
        held = [name for name in names if any(known(each, (name,)) for each in self.ground)]
        for pattern in self.release:
            if not known(pattern, held):
                raise InputError(
                    f"{pattern!r:.60} names no held part, so it cannot be released",
                    hint=f"the held parts are {some_names(held)}" if held else "no part is held",
                )
        kept = [name for name in held if not any(known(each, (name,)) for each in self.release)]
        return dataclasses.replace(self, ground=tuple(kept), release=())

    def over(self, choices: Choices) -> tuple[Reading, list[str]]:
        """Merge saved choices with these options, which win; also a sentence per overridden key.

        The options of this reading win over the keys of the choices.
        """
        given, saved = self.options(), choices.options()
        own, entries = given.pop("entries", {}), saved.pop("entries")
        given |= own
        direction = next((key for key in ("down", "up") if key in given), None)
        kept: dict[str, Any] = {}
        replaced = []
        for key, old in {**saved, **entries}.items():
            new = direction if key in ("up", "gravity") and direction else key
            new = "bond" if key == "bonds" else new
            new = POSES.get(key, new) if POSES.get(key) in given else new
            if new not in given:
                kept[key] = old
            elif new != key or given[new] != lists(old):
                replaced.append(replacement(new, given[new], key, old))
        if self.down is not None and "gravity" in entries:
            kept["gravity"] = entries["gravity"]  # its size counts, its direction does not
        values = {key: value for key, value in kept.items() if key in saved}
        values["entries"] = {k: value for k, value in kept.items() if k in entries} | own
        values["saved"] = tuple(kept)
        return dataclasses.replace(self, **values), replaced

    def applied(self, content: FileContent) -> Assembly:
        """Apply these options to an assembly as read, except the options that join parts."""
        bodies = self.for_parts(content.assembly.names)[0].entries
        assembly = with_contacts_of(content.assembly, self.contacts, floor=self.floor is not None)
        if self.density is not None:
            assembly = with_density(assembly, self.density, replaces=content.from_cad)
        assembly = with_bodies(assembly, bodies)
        remaining = [
            p
            for p in self.without
            if not fnmatch.filter(content.left_out, p) or fnmatch.filter(assembly.names, p)
        ]
        if remaining:  # the reader has left out the others
            assembly = assembly.without(remaining)
        assembly = with_masses(assembly, self.mass)
        if "floor" in self.off:
            assembly = dataclasses.replace(assembly, file_up=None)
        here, _ = self.for_parts(assembly.names)  # choices about parts that are left out
        if self.friction is not None:
            assembly = with_friction(assembly, self.friction)
        if self.up is not None:
            assembly = assembly.with_down([-x for x in UP[self.up]])
            if assembly.file_up is not None:
                assembly = dataclasses.replace(assembly, file_up=UP[self.up])
        here = here.released(assembly.names)
        if here.ground:
            assembly = holding(assembly, here.ground)
        directed = self.up is not None or self.down is not None or "gravity" in self.entries
        if not directed and not content.states_gravity:
            assembly = dataclasses.replace(assembly, up_assumed=True)
        floor = self.floor if self.floor is None else self.floor == LOWEST or float(self.floor)
        gravity = self.entries.get("gravity")
        assembly = on_floor(assembly, floor, gravity if self.down is None else self.down)
        if gravity is not None:  # of a typed direction only the size is saved
            size = math.hypot(*gravity)
            felt = gravity if self.down is None else (size * assembly.down).tolist()
            assembly = dataclasses.replace(assembly, gravity=felt)
        assembly = with_loads(with_interactions(assembly, here.entries), self.load)
        return on_carrier(assembly, self.accelerate)


@dataclass(frozen=True, slots=True)
class Chosen:
    """A file to read and the options for it: those saved with it, overridden by the caller's."""

    path: Path
    """The file that the choices name."""
    reading: Reading
    """Options of reading it, with its digest for proofs."""
    choices: Choices
    """The choices without the keys that are switched off."""
    notes: tuple[str, ...]
    """Sentences about replaced choices and about a changed file."""


def chosen(choices: Choices, reading: Reading | None = None) -> Chosen:
    """Merge the options of a file of choices with the caller's options, which have priority.

    Raises `InputError` if the file does not exist, or the choices do not hold a released part.
    """
    path = choices.path
    if find_choices(path) is not None:
        raise InputError(f"{choices.file} is a file of choices itself", hint="name its file")
    given = reading or Reading()
    partly = released_in_part(choices.held, given.release)
    choices, notes = switched_off(choices, given.off, given.release)
    merged, replaced = dataclasses.replace(given.without_off(), release=()).over(choices)
    notes += replaced
    present = digest(path)
    if choices.sha256 not in (None, present):
        notes.append(
            f"{choices.file} has changed since the choices were saved; 'kilter save' renews them"
        )
    merged = dataclasses.replace(
        merged, entries={**merged.entries, "sha256": present}, release=partly
    )
    return Chosen(path, merged, choices, tuple(notes))
