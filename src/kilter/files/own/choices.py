"""Choices: the options about a file, saved beside it.

    {"kilter": 1, "file": "clamp.step", "held": ["base"], "floor": true, "friction": 0.3}

A file of choices is a kilter file with the key `file` in place of `parts`. Every command and
`kilter.load` read it as the named file with these options. Names of parts may have the wildcards
* and ? where the option of the command line has them.
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path, PurePosixPath, PureWindowsPath
from types import MappingProxyType
from typing import Any

from kilter.assembly.question import LOWEST
from kilter.errors import InputError
from kilter.files.complaints import complaint, parse_json
from kilter.files.file_tolerances import SAME_DIRECTION
from kilter.files.limits import is_file, read_bytes
from kilter.rigid import UP

SIGNS = ("file", "sha256", "held", "left_out", "joined", "open_pairs", "materials", "tolerance")
"""Keys that only a file of choices has at its top."""
OPTIONS = {
    "held": "ground",
    "left_out": "without",
    "joined": "fasten",
    **{
        key: key
        for key in (
            "units",
            "up",
            "fasten_suggested",
            "fasten_overlaps",
            "keep_copies",
            "density",
            "keyframe",
            "state",
            "model",
            "base",
            "loose_robots",
            "assume",
            "friction",
            "contacts",
        )
    },
}
"""Option of `kilter.files.reading.Reading` with the same value as a key."""
STUDS = {"pull": "stud_pull", "shear": "stud_shear", "sides": "brick_sides"}
"""Option of each key of `studs`."""
ENTRIES = (
    "gravity",
    "open_pairs",
    "materials",
    "friction_pairs",
    "joints",
    "bonds",
    "loads",
    "straps",
    "poses",
)
"""Keys without an option of their own. Bonds that only have a pull have the option `bond`."""


@dataclass(frozen=True, slots=True, eq=False)
class Choices:
    """A user's saved options for an assembly file (held parts, joints, friction and so on).

    Each key may be None, for the default. Two choices with equal keys are equal and have the same
    hash, wherever their file lies.

    Parameters
    ----------
    file : str
        Path of the file, relative to the choices, with ``/`` between folders. The file lies in the
        folder of the choices or below.
    sha256 : str, optional
        Digest of the file; a file with another digest gives one warning.
    units : {"m", "cm", "mm", "in"}, optional
        Length unit of a file that states none.
    up : {"x", "y", "z", "-x", "-y", "-z"}, optional
        The axis of the file that points up.
    gravity : sequence of 3 float, optional
        Acceleration of gravity, world frame [m/s^2].
    held, left_out : sequence of str
        Held parts, and parts that are left out; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True: a held table under the lowest point; a number: at this height [length unit].
    fasten_suggested, fasten_overlaps : bool
        Join the pairs that look fastened, or that overlap.
    keep_copies : bool
        Keep bodies that are in the file twice.
    loose : bool
        Loose tolerances, for scanned data.
    density : float, optional
        Density of parts without density and mass [kg/m^3].
    keyframe, state, model, base : str, optional
        Options of MJCF and URDF, see `kilter.load`.
    loose_robots : bool
        MJCF and URDF: bodies that motors move are free.
    studs : mapping, optional
        Bricks: `pull` [N], `shear` and `sides`.
    joined : sequence of pairs of str
        Parts that are joined rigidly where they touch; wildcards as for `held`.
    open_pairs : sequence of mapping
        `parts` (two names) and `as`: "joined", "touching" or "apart".
    materials : sequence of mapping
        `parts` (a name or pattern), `density` [kg/m^3] and, if wanted, `name`.
    friction : float, optional
        Friction coefficient of contacts without a coefficient of their own [-].
    friction_pairs, joints, bonds, loads, straps : sequence of mapping
        As in an assembly file; they are added to those of the file.
    contacts : {"file", "geometry"}, optional
        Source of the contacts, see `kilter.load`.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions, see `kilter.check`.
    tolerance : mapping, optional
        `gap` [length unit], `angle_deg` [deg] and `clearance` [length unit].
    poses : mapping, optional
        New pose of parts by name: `position` [length unit] and `rotation` (quaternion w x y z).
    folder : path
        Folder that `file` is relative to. It is not a key of the file.

    Raises
    ------
    InputError
        If a value is invalid, or `file` does not lie in the folder or below.

    Examples
    --------
    >>> choices = Choices("clamp.step", held=["base"], friction=0.3)
    >>> choices.to_dict()
    {'kilter': 1, 'file': 'clamp.step', 'held': ['base'], 'friction': 0.3}
    >>> Choices.from_dict(choices.to_dict()) == choices
    True
    >>> Choices.from_dict({"kilter": 1, "file": "clamp.step", "hold": ["base"]})
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: unknown key 'hold'; did you mean 'held'?
    """

    file: str
    sha256: str | None = None
    units: str | None = None
    up: str | None = None
    gravity: Any = None
    held: Any = ()
    floor: bool | float | None = None
    fasten_suggested: bool = False
    fasten_overlaps: bool = False
    keep_copies: bool = False
    loose: bool = False
    density: float | None = None
    keyframe: str | None = None
    state: str | None = None
    model: str | None = None
    base: str | None = None
    loose_robots: bool = False
    studs: Any = None
    left_out: Any = ()
    joined: Any = ()
    open_pairs: Any = ()
    materials: Any = ()
    friction: float | None = None
    friction_pairs: Any = ()
    joints: Any = ()
    bonds: Any = ()
    loads: Any = ()
    straps: Any = ()
    contacts: str | None = None
    assume: str | None = None
    tolerance: Any = None
    poses: Any = None
    folder: str | Path = Path()

    def __post_init__(self) -> None:
        for name in KEYS:
            object.__setattr__(self, name, _freeze(getattr(self, name), DEFAULT[name]))
        object.__setattr__(self, "folder", Path(self.folder))
        _validate(self.to_dict())

    def to_dict(self) -> dict[str, Any]:
        """The JSON data of these choices; keys that have their default value are left out."""
        values = ((name, plain(getattr(self, name))) for name in KEYS)
        return {"kilter": 1} | {name: value for name, value in values if not _is_default(value)}

    @classmethod
    def from_dict(cls, data: Any, *, folder: str | Path = Path()) -> Choices:
        """Build choices from JSON data.

        Raises
        ------
        InputError
            If a key is unknown (the error names the most similar key) or a value is invalid.
        """
        _validate(data)
        return cls(**{key: value for key, value in data.items() if key != "kilter"}, folder=folder)

    @classmethod
    def read(cls, path: str | Path) -> Choices:
        """Read choices from a JSON file.

        Raises
        ------
        InputError
            If the file is missing or invalid.
        """
        try:
            return cls.from_dict(parse_json(read_bytes(Path(path))), folder=Path(path).parent)
        except InputError as error:
            raise error.located(file=str(path)) from None

    @property
    def path(self) -> Path:
        """Path of the assembly file that these choices are about, from the working folder.

        Raises
        ------
        InputError
            If the file does not exist.
        """
        path = Path(self.folder, self.file)
        if not os.path.exists(path):  # also for a name that the system rejects
            raise InputError(
                f"the file {self.file!r:.80} is not in the folder {str(self.folder)!r}",
                hint="move it back, or correct the key 'file'",
            )
        return path

    def options(self) -> dict[str, Any]:
        """These choices as options of `kilter.files.reading.Reading`, without the `entries`."""
        given = {key: getattr(self, key) for key in OPTIONS}
        options = {
            OPTIONS[key]: value for key, value in given.items() if not _is_default(plain(value))
        }
        if self.state is not None:
            options["state"] = os.path.join(self.folder, self.state)
        options |= {STUDS[key]: value for key, value in (self.studs or {}).items()}
        if self.floor is not None and self.floor is not False:
            options["floor"] = LOWEST if self.floor is True else float(self.floor)
        pulls = [bond for bond in self.bonds if set(bond) == {"parts", "pull"}]
        if pulls:
            options["bond"] = tuple((*bond["parts"], float(bond["pull"])) for bond in pulls)
        entries = {key: plain(getattr(self, key)) for key in ENTRIES}
        entries["bonds"] = [plain(bond) for bond in self.bonds if bond not in pulls]
        options["entries"] = {k: value for k, value in entries.items() if value}
        return options

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Choices) and self.to_dict() == other.to_dict()

    def __hash__(self) -> int:
        return hash(_hashable(self.to_dict()))


KEYS = tuple(field.name for field in fields(Choices) if field.name != "folder")
"""Keys of a file of choices, in the order in which they are written."""
DEFAULT = {field.name: field.default for field in fields(Choices)}
"""Default of each key."""


def find_choices(source: Any) -> Choices | None:
    """The choices in the file at a path; None if the source is no file of choices.

    Raises `InputError` if the choices are invalid; the error names their file.
    """
    if isinstance(source, Choices):
        return source
    if not isinstance(source, str | os.PathLike):
        return None
    path = Path(source)
    if path.suffix.lower() != ".json" or not is_file(path):
        return None
    data = read_bytes(path)
    if not any(f'"{key}"'.encode() in data for key in SIGNS):
        return None
    try:
        content = parse_json(data)
    except InputError:
        return None  # the reader of assemblies reports the fault
    if not isinstance(content, dict) or "kilter" not in content:
        return None
    if not content.keys() & set(SIGNS):
        return None
    try:
        return Choices.from_dict(content, folder=path.parent)
    except InputError as error:
        raise error.located(file=str(path)) from None


def digest(path: Path) -> str:
    """SHA-256 of a file as hexadecimal text; of a folder, that of its file names and digests."""
    if not path.is_dir():
        return hashlib.sha256(read_bytes(path)).hexdigest()
    files = sorted(inner for inner in path.iterdir() if inner.is_file())
    listed = "\n".join(f"{digest(inner)} {inner.name}" for inner in files)
    return hashlib.sha256(listed.encode("utf-8", "surrogateescape")).hexdigest()


def _validate(data: Any) -> None:
    """Verify the keys and types of choices and the path of their file; raises `InputError`."""
    from pydantic import ValidationError

    from kilter.files.own.models import ChoicesFile

    if isinstance(data, dict) and "file" in data and "parts" in data:
        raise InputError(
            "the keys 'file' and 'parts' are both given",
            hint="remove 'parts' from choices, or 'file' from an assembly",
        )
    if isinstance(data, dict) and isinstance(data.get("file"), list | tuple):
        raise InputError("file names several files", hint="save choices for each file")
    try:
        ChoicesFile.model_validate(data)
    except ValidationError as error:
        raise complaint(error, data, ChoicesFile) from None
    name = data["file"]
    if _leaves_folder(name):
        raise InputError(
            f"the file {name!r:.60} does not lie in the folder of the choices or below",
            hint="move the choices beside the file, and name the file without its folder",
        )
    up, gravity = data.get("up"), data.get("gravity")
    if up is not None and gravity is not None:
        axis = [-x * math.hypot(*gravity) for x in UP[up]]
        if math.dist(axis, gravity) > SAME_DIRECTION * math.hypot(*gravity):
            raise InputError(f"gravity is {plain(gravity)}, but up is {up!r}", hint="remove a key")


def _leaves_folder(name: str) -> bool:
    """Whether a path is absolute or contains "..", by the rules of any system."""
    paths = PurePosixPath(name), PureWindowsPath(name)
    return any(path.is_absolute() or path.drive or ".." in path.parts for path in paths)


def _is_default(value: Any) -> bool:
    """Whether a plain value is empty or false, and so a default; the number 0 is not a default."""
    return value is None or value is False or value in ([], {})


def plain(value: Any) -> Any:
    """Convert a value to JSON data of lists and dicts; keys whose value is None are left out."""
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items() if inner is not None}
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [plain(inner) for inner in value]
    return value


def _freeze(value: Any, default: Any) -> Any:
    """Convert a value to tuples and read-only mappings; None gives the default."""
    if value is None:
        return default

    def fix(inner: Any) -> Any:
        if isinstance(inner, dict):
            return MappingProxyType({key: fix(entry) for key, entry in inner.items()})
        return tuple(map(fix, inner)) if isinstance(inner, list) else inner

    return fix(plain(value))


def _hashable(value: Any) -> Any:
    """JSON data converted to nested tuples, which can be hashed."""
    if isinstance(value, dict):
        return tuple(sorted((key, _hashable(inner)) for key, inner in value.items()))
    return tuple(map(_hashable, value)) if isinstance(value, list) else value


# Options of a reading as the words that a user types on the command line.


def option_words(options: Mapping[str, Any]) -> list[str]:
    """Words of the command line for the options of a reading; of its `entries`, the materials.

    Examples
    --------
    >>> option_words({"ground": ["base"], "floor": "lowest", "friction": 0.3})
    ['--ground', 'base', '--floor', '--friction', '0.3']
    """
    words: list[str] = []
    for key, value in options.items():
        option = f"--{key.replace('_', '-')}"
        if key == "entries":
            for entry in value.get("materials", ()):
                words += ["--material", f"{entry['parts']}={entry.get('name', entry['density'])}"]
        elif key == "saved":
            continue
        elif key == "floor":
            words += ["--floor"] if value == LOWEST else ["--floor", str(value)]
        elif key == "down":
            words += ["--down", *(repr(float(v)).removesuffix(".0") for v in value)]
        elif key == "accelerate":
            words += [option, *value]
        elif key in ("mass", "load"):
            numbers = [(name, ",".join(f"{x:.15g}" for x in each)) for name, *each in value]
            words += [word for name, text in numbers for word in (option, f"{name}={text}")]
        elif key == "fasten":
            words += [word for pair in value for word in ("--fasten", *pair)]
        elif key == "bond":
            words += [word for a, b, pull in value for word in ("--bond", a, b, f"{pull:.15g}")]
        elif value is True:
            words.append(option)
        elif isinstance(value, list | tuple):
            words += [word for entry in value for word in (option, str(entry))]
        else:
            words += [option, f"{value:.15g}" if isinstance(value, float) else str(value)]
    return words
