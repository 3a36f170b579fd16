"""Read files with their saved choices, and save choices about them.

`load` reads an assembly with the options of `kilter.files.reading_options.ReadingOptions`. Saved
choices may join parts, which needs contacts: therefore these functions are above both packages.
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from kilter.assembly import Assembly
from kilter.assembly.question import LOWEST, supported
from kilter.contact import Tolerance
from kilter.contact.fits.fastening import fasten_as_read
from kilter.errors import InputError
from kilter.files.own.choices import Choices, find_choices
from kilter.files.own.choices_writing import choices_about, require_place, write_choices
from kilter.files.reading import Reading, chosen
from kilter.files.reading_options import ReadingOptions
from kilter.validate import finite, number
from kilter.values.guesses import guarded

NAMES = "str | Iterable[str]"
AS_GIVEN = {
    **dict.fromkeys(("ground", "without", "off", "release"), NAMES),
    "floor": "bool | float | None",
    "down": "ArrayLike | None",
}
"""Types of keywords of `load` that are not those of the options."""
BESIDE = [
    "assume",
    "fasten",
    "fasten_suggested",
    "fasten_overlaps",
    "bond",
    "entries",
    "saved",
    "mass",
    "load",
    "accelerate",
]
"""Options of reading that are no keywords of `load`."""


def _with_options(act: Callable[..., Assembly]) -> Callable[..., Assembly]:
    """Decorate ``act(source, reading)`` so that the options of reading are its keywords."""
    source, reading = inspect.signature(act).parameters.values()
    keywords = [
        reading.replace(
            name=each.name,
            kind=inspect.Parameter.KEYWORD_ONLY,
            default=each.default,
            annotation=AS_GIVEN.get(each.name, each.type),
        )
        for each in fields(ReadingOptions)
        if each.name not in BESIDE
    ]
    signature = inspect.signature(act).replace(parameters=[source, *keywords])

    @functools.wraps(act)
    def read(*given: Any, **named: Any) -> Assembly:
        values = signature.bind(*given, **named).arguments
        return act(values.pop("source"), reading_for(**values))

    read.__signature__ = signature  # type: ignore[attr-defined]
    return guarded(read)


@_with_options
def load(source: Any, reading: Reading) -> Assembly:
    """Read an assembly from a file, a folder, standard input (``-``) or an object.

    Every command has the same options. They are applied in the order `without`, `friction`,
    `down`, `ground`, `floor`.

    Parameters
    ----------
    source : path or object
        A kilter file or COMPAS assembly (.json), a mesh file (.obj, .stl, .3mf, .glb,
        .gltf, .ply, .off, .dae, .3dm), a STEP or IGES file (.step, .stp, .igs, .iges), a FreeCAD
        document (.FCStd), a scene of a simulator (.xml, .mjcf, .urdf, .sdf, .usd), a model of
        toy bricks (LDraw .ldr and .mpd, StableLego .json, BrickGPT .txt), a folder of meshes,
        or ``-`` for JSON on standard input.
        Or `kilter.Choices`, or the path of their file: the file that they name, with the saved
        options. The options given here win over them; a note of the assembly names what they
        replace.
        Or an object: a trimesh Trimesh or Scene, a pair of arrays (vertices, faces), a
        shape or assembly of build123d or CadQuery, a COMPAS Assembly, Block or Mesh, a
        model of MuJoCo or (model, data); a list of these, or a dict of them by name.
    units : {"m", "cm", "mm", "in"}, optional
        Length unit of a format that states none; default mm for STL, else m.
    density : float, optional
        Density of parts without density and mass [kg/m^3]; of all parts of STEP files.
    ground, without : str or iterable of str
        Names of the parts to hold, and of the parts to leave out; ``*`` and ``?`` are globs.
    floor : bool or float, optional
        True: a held table under the lowest point, with respect to the up direction of the file; a
        number: at that height [length unit]; False: no floor, also if the choices have a floor.
    down : array_like, shape (3,), optional
        Direction of gravity; its magnitude stays that of the file. A floor turns with the parts.
    up : {"x", "y", "z", "-x", "-y", "-z"}, optional
        The axis of the file that points up, against gravity: ``"y"`` turns gravity to [0, -1, 0],
        and a floor lies across this axis.
    friction : float, optional
        Friction coefficient of contacts that have no coefficient of their own [-].
    contacts : {"file", "geometry"}, optional
        "file": only the contacts that the file lists (interfaces of COMPAS, `contacts` of a
        kilter file); "geometry": all contacts are detected. By default, the contacts of a kilter
        file replace detection for their pairs. Interfaces of COMPAS are then ignored, with a note.
    keyframe : str, optional
        MuJoCo: name of the keyframe whose pose is used; default the first keyframe.
    state : str, optional
        MuJoCo: ``FILE`` or ``FILE:ROW``, the state of this row in place of a keyframe. The file is
        that of `numpy.save`, or a pickled array; a row is qpos, or time, qpos and qvel.
    model : str, optional
        LDraw: name of the model of the file that is built; default the first.
    base : {"fixed", "floating"}, optional
        URDF: whether the root link is held; default "fixed".
    loose_robots : bool
        MuJoCo and URDF: free the bodies that motors move, which are held by default. In URDF,
        joints with a `transmission` have motors.
    stud_pull : float, optional
        Bricks: largest pull at each point of a stud [N]; default .98.
    stud_shear : float or {"unlimited", "mu"}, optional
        Bricks: largest sideways force at each point of a stud: a number [N], no limit, or
        mu (f_n + pull); default "unlimited".
    brick_sides : {"lower-edge", "face", "none"}, optional
        Bricks: the points at which neighbours side by side push each other; default "lower-edge".
    keep_copies : bool
        CAD and meshes: keep the bodies that are in the file twice; by default a copy, or a step of
        a feature beside its result, is left out, with a note.
    off : str or iterable of str
        Choices: options whose saved values are ignored, as in ``off=["floor", "loose"]``.
    release : str or iterable of str
        Choices: saved held parts that are not held; ``*`` and ``?`` are wildcards.

    Raises
    ------
    InputError
        If the source cannot be read; the message names the fault, its place and the remedy.

    See Also
    --------
    kilter.load_answer : reads an answer, not an assembly.
    kilter.example : a built-in assembly.
    """
    choices = find_choices(source)
    if choices is None:
        assembly, options = reading.read(source), reading.options()
        return replace(assembly, reading=options) if options else assembly
    return read_chosen(choices, reading)


def reading_for(
    *,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    without: str | Iterable[str] = (),
    down: ArrayLike | None = None,
    off: str | Iterable[str] = (),
    release: str | Iterable[str] = (),
    **others: Any,
) -> Reading:
    """Build a `Reading` from the keywords of `kilter.load`.

    Raises `InputError` if an option has an invalid value.
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
        off=(*_names(off), *(["floor"] if floor is False else [])),
        release=_names(release),
        **others,
    )


def _names(patterns: str | Iterable[str]) -> tuple[str, ...]:
    """Name patterns as a tuple, from a single pattern or several."""
    return (patterns,) if isinstance(patterns, str) else tuple(patterns)


def tolerance_of(choices: Choices) -> Tolerance:
    """The contact tolerance that a file of choices states; the default if it states none."""
    values = choices.tolerance or {}
    base = Tolerance.loose() if choices.loose else Tolerance()
    angle = values.get("angle_deg")
    return replace(
        base,
        gap=values.get("gap"),
        angle=base.angle if angle is None else math.radians(angle),
        clearance=values.get("clearance"),
    )


def read_chosen(
    choices: Choices, reading: Reading | None = None, *, tolerance: Tolerance | None = None
) -> Assembly:
    """Read the assembly that a file of choices describes, with its saved options and tolerance.

    A `tolerance` other than the default one wins over that of the choices.

    Raises `InputError` if the file cannot be read, or an option is invalid.
    """
    both = chosen(choices, reading)
    if tolerance in (None, Tolerance()):
        tolerance = tolerance_of(both.choices)
    assembly = both.reading.read(both.path)
    assembly, _ = fasten_as_read(assembly, both.reading, tolerance=tolerance)
    own = None if tolerance == Tolerance() else tolerance
    return replace(
        assembly,
        notes=[*assembly.notes, *both.notes],
        tolerance=own,
        reading=both.reading.options(),
    )


@guarded
def save(
    source: str | Path,
    output: str | Path,
    *,
    fasten: Iterable[Sequence[str]] = (),
    fasten_suggested: bool = False,
    fasten_overlaps: bool = False,
    bond: Iterable[tuple[str, str, float]] = (),
    materials: Iterable[Mapping[str, Any]] = (),
    open_pairs: Iterable[Mapping[str, Any]] = (),
    tolerance: Mapping[str, float | None] | None = None,
    loose: bool = False,
    **reading: Any,
) -> Choices:
    """Save the options with which a file is read, as ``kilter save`` does.

    The file is read with the options, so that a wrong name is an error here. If `source` has
    choices itself, the new choices are its choices with the given changes.

    Parameters
    ----------
    source : path
        A file or a folder that `kilter.load` reads.
    output : path
        File of the choices, which ends in .json, in the folder of `source` or above it.
    fasten : iterable of pairs of str
        Parts that are joined rigidly where they touch; ``*`` and ``?`` are wildcards.
    fasten_suggested, fasten_overlaps : bool
        Join the pairs that look fastened, or that overlap.
    bond : iterable of (str, str, float)
        Two parts and the pull that each contact point between them resists [N].
    materials, open_pairs, tolerance, loose
        See `kilter.Choices`.
    **reading
        Options of `kilter.load`: `ground`, `floor`, `friction` and so on.

    Returns
    -------
    Choices

    Raises
    ------
    InputError
        If the file cannot be read with the options, or the choices cannot be written.

    See Also
    --------
    kilter.dump : writes an assembly.
    kilter.load : reads a file with its saved options.
    """
    if not isinstance(source, str | Path):
        raise InputError(
            f"save keeps the options of reading a file, and got {type(source).__name__}",
            hint="write an assembly: kilter.dump(assembly, path)",
        )
    entries = {"materials": list(materials), "open_pairs": list(open_pairs)}
    read = reading_for(
        **reading,
        fasten=tuple((a, b) for a, b in fasten),
        fasten_suggested=fasten_suggested,
        fasten_overlaps=fasten_overlaps,
        bond=tuple((a, b, float(pull)) for a, b, pull in bond),
        entries={key: value for key, value in entries.items() if value},
    )
    path, earlier = Path(source), find_choices(source)
    keys: dict[str, Any] = {"tolerance": dict(tolerance or {}), "loose": loose}
    if earlier is not None:
        both = chosen(earlier, read)
        path, read = both.path, both.reading
        keys["tolerance"] = {**(both.choices.tolerance or {}), **keys["tolerance"]}
        keys["loose"] = loose or both.choices.loose
    return save_reading(path, output, read, keys)


def save_reading(
    path: Path,
    output: str | Path,
    reading: Reading,
    keys: Mapping[str, Any],
    *,
    progress: Callable[[str], None] | None = None,
) -> Choices:
    """Read a file with given options as a trial, then save these options as choices.

    Raises `InputError` if the file cannot be read with the options, or the choices cannot be
    written.
    """
    output = Path(output)
    require_place(output)
    if not path.exists():
        raise InputError("no such file", file=str(path), hint="check the path")
    assembly = reading.read(path, progress=progress)
    bodies = assembly.names if reading.floor is None else assembly.names[:-1]
    reading = reading.released(bodies)
    choices = choices_about(path, output.parent, reading.options(), **keys)
    tolerance: Tolerance = tolerance_of(choices)
    # joints may name the floor that answers about this file assume
    asked = supported(assembly, "check", floor=reading.floor is not False)
    fasten_as_read(asked, reading, tolerance=tolerance, progress=progress)
    if reading.down is not None:
        gravity = assembly.gravity.tolist()
        options = reading.options()
        choices = choices_about(path, output.parent, options, **keys, up=None, gravity=gravity)
    write_choices(choices, output)
    return choices
