"""Read an assembly from a file, a folder, a stream or an object.

The ending of the path, and for JSON the content, select the reader.
"""

from __future__ import annotations

import dataclasses
import fnmatch
import os
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import ArrayLike

from kilter.assembly import Assembly, Part
from kilter.assembly.bricks import StudRules
from kilter.errors import InputError
from kilter.files.brick_text import BRICK_TEXT, load_brick_text
from kilter.files.choices import Choices
from kilter.files.compas import from_compas, is_compas
from kilter.files.folder import load_folder
from kilter.files.formats import FORMATS, load_bodies
from kilter.files.kilter_json import from_dict
from kilter.files.ldraw import LDRAW_FILES, load_ldraw
from kilter.files.lying import UP, note_on_up
from kilter.files.objects.known_objects import read_object
from kilter.files.raw import read_bounded, read_bytes
from kilter.files.stable_lego import from_stable_lego, is_stable_lego
from kilter.files.strict_json import parse_json
from kilter.files.urdf import BASES
from kilter.files.xml_scenes import XML, load_xml
from kilter.units import metres_per_unit
from kilter.validate import finite, number

__all__ = ["LOWEST", "Reading", "load", "read_json", "reading_for"]

STANDARD_INPUT = "-"
LOWEST = "lowest"
"""Value of `floor` that puts the floor under the lowest point of the assembly."""
SOURCES = ("file", "geometry")
"""Values of the option `contacts`: the sources of the contacts."""
_OR = " or "


@dataclass(frozen=True, slots=True)
class Reading:
    """The options of reading a file that change the assembly; a proof lists them.

    The options of `load`, and those of `kilter.fastened`: pairs of part names to join
    (`fasten`), whether to join pairs that look fastened, whether to join pairs that overlap.
    Each entry of `bond` has two part names and a pull [N]. `floor` is a height [length unit] or
    `LOWEST`.

    Raises
    ------
    InputError
        If `up`, `base`, `contacts` or a brick rule has an invalid value, or if both `up` and
        `down` are given.
    """

    ground: tuple[str, ...] = ()
    floor: float | str | None = None
    without: tuple[str, ...] = ()
    down: tuple[float, float, float] | None = None
    friction: float | None = None
    units: str | None = None
    density: float | None = None
    fasten: tuple[tuple[str, str], ...] = ()
    fasten_suggested: bool = False
    fasten_overlaps: bool = False
    up: str | None = None
    contacts: str | None = None
    keyframe: str | None = None
    base: str | None = None
    stud_pull: float | None = None
    stud_shear: float | str | None = None
    brick_sides: str | None = None
    bond: tuple[tuple[str, str, float], ...] = ()

    def __post_init__(self) -> None:
        _ = self.studs
        if self.base is not None and self.base not in BASES:
            raise InputError(f"the base is {self.base!r:.40}", hint=f"use {_OR.join(BASES)}")
        if self.up is not None and self.up not in UP:
            raise InputError(f"up is {self.up!r:.40}", hint=f"use {', '.join(UP)}")
        if self.up is not None and self.down is not None:
            raise InputError("up and down are both given", hint="give only up or down")
        if self.contacts is not None and self.contacts not in SOURCES:
            raise InputError(f"contacts are {self.contacts!r:.40}", hint=f"use {_OR.join(SOURCES)}")

    @property
    def fastens(self) -> bool:
        """Whether an option joins parts; joining needs the contacts."""
        return bool(self.fasten or self.bond) or self.fasten_suggested or self.fasten_overlaps

    @property
    def choices(self) -> Choices:
        """The options that only some formats use."""
        return Choices(self.units, self.contacts, self.keyframe, self.base, self.studs)

    @property
    def studs(self) -> StudRules:
        """The brick rules: those of StableLego, except for the options that are set."""
        rules = {"pull": self.stud_pull, "shear": self.stud_shear, "sides": self.brick_sides}
        given: dict[str, Any] = {k: value for k, value in rules.items() if value is not None}
        return StudRules(**given)

    def options(self) -> dict[str, Any]:
        """The options that are set, as JSON data."""
        return {
            key: _lists(value)
            for key, value in dataclasses.asdict(self).items()
            if value not in (None, ()) and value is not False
        }

    @classmethod
    def from_options(cls, options: Any) -> Reading:
        """The reading whose `options()` are given: the inverse of `options`.

        Raises
        ------
        InputError
            If the options are invalid.
        """
        try:
            values = dict(options)
            for key in ("ground", "without", "down"):
                if key in values:
                    values[key] = tuple(values[key])
            values["fasten"] = tuple((str(a), str(b)) for a, b in values.get("fasten", ()))
            bonds = values.get("bond", ())
            values["bond"] = tuple((str(a), str(b), float(pull)) for a, b, pull in bonds)
            for key in ("fasten_suggested", "fasten_overlaps"):
                values[key] = bool(values.get(key, False))
            return cls(**values)
        except (TypeError, ValueError):
            raise InputError(
                "the proof's options cannot be read", hint="make a new proof"
            ) from None

    def read(self, source: Any, *, progress: Callable[[str], None] | None = None) -> Assembly:
        """Read the assembly of a file or an object; the options that join parts are not applied."""
        if self.units is not None:
            metres_per_unit(self.units)
        if not isinstance(source, str | os.PathLike):
            content = _FileContent(*read_object(source, self.choices))
        elif not os.fspath(source):
            raise InputError(f"a file's path is {source!r:.60}", hint="give a path, or '-'")
        else:
            content = _read_path(source, self, progress)
        assembly = _with_contacts(self, content.assembly)
        if self.density is not None:
            assembly = _with_density(assembly, self.density)
        remaining = [p for p in self.without if not fnmatch.filter(content.left_out, p)]
        if remaining:  # the reader of STEP has left out the others
            assembly = assembly.without(remaining)
        if self.friction is not None:
            assembly = assembly.with_friction(self.friction)
        if self.up is not None:
            assembly = assembly.with_down([-x for x in UP[self.up]])
        if self.down is not None:
            assembly = assembly.with_down(self.down)
        if self.ground:
            assembly = assembly.with_grounded(self.ground)
        if self.up is None and self.down is None and not content.states_gravity:
            notes = note_on_up(assembly)
            if notes:  # an unchanged assembly keeps the geometry that it has computed
                assembly = dataclasses.replace(assembly, notes=[*assembly.notes, *notes])
        if self.floor is not None:
            assembly = assembly.with_floor(None if self.floor == LOWEST else float(self.floor))
        return assembly


def load(
    source: Any,
    *,
    units: str | None = None,
    density: float | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    without: str | Iterable[str] = (),
    down: ArrayLike | None = None,
    up: str | None = None,
    friction: float | None = None,
    contacts: str | None = None,
    keyframe: str | None = None,
    base: str | None = None,
    stud_pull: float | None = None,
    stud_shear: float | str | None = None,
    brick_sides: str | None = None,
) -> Assembly:
    """Read an assembly from a file, a folder, standard input (``-``) or an object.

    Every command has the same options. They are applied in the order `without`, `friction`,
    `down`, `ground`, `floor`.

    Parameters
    ----------
    source : path or object
        A kilter file or COMPAS assembly (.json), a mesh file (.obj, .stl, .3mf, .glb), a
        STEP file (.step, .stp), an MJCF or URDF scene (.xml, .mjcf, .urdf), a model of toy
        bricks (LDraw .ldr and .mpd, StableLego .json, BrickGPT .txt), a folder of meshes, or
        ``-`` for JSON on standard input.
        Or an object: a trimesh Trimesh or Scene, a pair of arrays (vertices, faces), a
        shape or assembly of build123d or CadQuery, a COMPAS Assembly, Block or Mesh, a
        model of MuJoCo or (model, data); a list of these, or a dict of them by name.
    units : {"m", "cm", "mm", "in"}, optional
        Length unit of a format that states none; default metres.
    density : float, optional
        Density of parts without density and mass [kg/m^3].
    ground, without : str or iterable of str
        Names of the parts to hold, and of the parts to leave out; ``*`` and ``?`` are globs.
    floor : bool or float, optional
        True: a held table under the lowest point; a number: at that height [length unit].
    down : array_like, shape (3,), optional
        Direction of gravity; its magnitude stays that of the file.
    up : {"x", "y", "z", "-x", "-y", "-z"}, optional
        The axis of the file that points up, against gravity: ``"y"`` is ``down=[0, -1, 0]``.
    friction : float, optional
        Friction coefficient of contacts that have no coefficient of their own [-].
    contacts : {"file", "geometry"}, optional
        "file": only the contacts that the file lists (interfaces of COMPAS, `contacts` of a
        kilter file); "geometry": all contacts are detected. By default, the contacts of a kilter
        file replace detection for their pairs. Interfaces of COMPAS are then ignored, with a note.
    keyframe : str, optional
        MuJoCo: name of the keyframe whose pose is used; default the first keyframe.
    base : {"fixed", "floating"}, optional
        URDF: whether the root link is held; default "fixed".
    stud_pull : float, optional
        Bricks: largest pull at each point of a stud [N]; default .98.
    stud_shear : float or {"unlimited", "mu"}, optional
        Bricks: largest sideways force at each point of a stud: a number [N], no limit, or
        mu (f_n + pull); default "unlimited".
    brick_sides : {"lower-edge", "face", "none"}, optional
        Bricks: the points at which neighbours side by side push each other; default "lower-edge".

    Raises
    ------
    InputError
        If the source cannot be read; the message names the fault, its place and the remedy.
    """
    return reading_for(
        units=units,
        density=density,
        ground=ground,
        floor=floor,
        without=without,
        down=down,
        up=up,
        friction=friction,
        contacts=contacts,
        keyframe=keyframe,
        base=base,
        stud_pull=stud_pull,
        stud_shear=stud_shear,
        brick_sides=brick_sides,
    ).read(source)


def reading_for(
    *,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    without: str | Iterable[str] = (),
    down: ArrayLike | None = None,
    **others: Any,
) -> Reading:
    """The `Reading` of the options of `load`.

    Raises
    ------
    InputError
        If an option has an invalid value.
    """
    height: float | str | None = LOWEST if floor is True else None
    if floor is not None and not isinstance(floor, bool):
        height = number(floor, "height of the floor")
    x, y, z = (0.0, 0.0, 0.0) if down is None else finite(down, (3,), "down").tolist()
    return Reading(
        ground=_names(ground),
        floor=height,
        without=_names(without),
        down=None if down is None else (x, y, z),
        **others,
    )


def _names(patterns: str | Iterable[str]) -> tuple[str, ...]:
    """Patterns of names as a tuple; a single string is one pattern."""
    return (patterns,) if isinstance(patterns, str) else tuple(patterns)


def _lists(value: Any) -> Any:
    """The value with nested tuples turned into lists, for JSON."""
    return [_lists(inner) for inner in value] if isinstance(value, tuple) else value


class _FileContent(NamedTuple):
    """An assembly as its source describes it, before the options are applied.

    `states_gravity`: whether the format fixes the direction of gravity; `left_out`: names of
    parts that the reader has left out already.
    """

    assembly: Assembly
    states_gravity: bool = False
    left_out: tuple[str, ...] = ()


def _read_path(
    source: str | os.PathLike[str], reading: Reading, progress: Callable[[str], None] | None
) -> _FileContent:
    """Read a path, or standard input, with the reader of its kind."""
    if os.fspath(source) == STANDARD_INPUT:
        return _from_json(
            read_bounded(sys.stdin.buffer, "standard input"), Path(), "standard input", reading
        )
    path, units = Path(source), reading.units
    suffix = path.suffix.lower()
    if _is_folder(path):
        return _FileContent(load_folder(path, units=units))
    if suffix in FORMATS:
        assembly, left_out = load_bodies(
            path, units=units, without=reading.without, progress=progress
        )
        return _FileContent(assembly, left_out=left_out)
    if suffix in XML:
        return _FileContent(*load_xml(path, reading.choices))
    if suffix in LDRAW_FILES:
        return _FileContent(load_ldraw(path, rules=reading.studs), states_gravity=True)
    if suffix in BRICK_TEXT:
        return _FileContent(load_brick_text(path, rules=reading.studs), states_gravity=True)
    data = read_bytes(path)
    if suffix == ".json":
        return _from_json(data, path.parent, str(path), reading)
    kinds = f".json, {', '.join([*FORMATS, *XML, *LDRAW_FILES, *BRICK_TEXT])}, or a folder of them"
    raise InputError(
        f"cannot read files of type {path.suffix or '(no ending)'}",
        file=str(path),
        hint=f"give {kinds}",
    )


def read_json(path: Path) -> Any:
    """Read the value of a JSON file.

    Raises
    ------
    InputError
        If the file is missing or is not JSON; the error names the file.
    """
    data = read_bytes(path)
    try:
        return parse_json(data)
    except InputError as error:
        raise error.located(file=str(path)) from None


def _is_folder(path: Path) -> bool:
    """Whether the path is a folder; False for a path that the system rejects."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def _from_json(data: bytes, folder: Path, source: str, reading: Reading) -> _FileContent:
    """The assembly of JSON data: COMPAS, StableLego or kilter, by its content."""
    try:
        content = parse_json(data)
    except InputError as error:
        raise error.located(file=source) from None
    if is_compas(content):
        units, contacts = reading.units, reading.contacts
        return _FileContent(from_compas(content, units=units, source=source, contacts=contacts))
    if is_stable_lego(content):
        bricks = from_stable_lego(content, data, rules=reading.studs, source=source)
        return _FileContent(bricks, states_gravity=True)
    assembly = from_dict(content, folder=folder, source=source)
    _check_units(assembly, reading.units)
    return _FileContent(assembly, states_gravity=True)


def _with_contacts(reading: Reading, assembly: Assembly) -> Assembly:
    """Apply the option `contacts`: keep only the contacts of the file, or drop them."""
    if reading.contacts == "geometry":
        return dataclasses.replace(assembly, contacts=(), detect=True)
    if reading.contacts != "file":
        return assembly
    if not assembly.contacts:
        raise InputError(
            "the file lists no contacts",
            file=assembly.source or None,
            hint="leave contacts='file' out",
            option="leave --contacts file out",
        )
    if reading.floor is not None:
        raise InputError(
            "only the contacts of the file count, and the file lists none with the floor",
            file=assembly.source or None,
            hint="hold parts with ground=[...] in place of the floor",
            option="hold parts with --ground NAME in place of --floor",
        )
    return dataclasses.replace(assembly, detect=False)


def _check_units(assembly: Assembly, units: str | None) -> None:
    """Raise `InputError` if the option `units` contradicts the units of the file."""
    if units is not None and units != assembly.units:
        raise InputError(
            f"the file is in {assembly.units}, but the units given are {units}",
            file=assembly.source,
            hint="leave the units out",
        )


def _with_density(assembly: Assembly, density: float) -> Assembly:
    """The assembly whose parts without density and mass have the given density [kg/m^3]."""

    def with_default(part: Part) -> Any:
        if part.density is not None or part.mass is not None:
            return part
        return dataclasses.replace(part, density=density)

    try:
        return dataclasses.replace(assembly, parts=[with_default(part) for part in assembly.parts])
    except InputError as error:
        raise InputError(error.what, hint=error.hint) from None
