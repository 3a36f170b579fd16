"""Names that users guess: a table from each guess to the right call.

A guess is an attribute of a value or an answer (``verdict.holds``), a keyword of a function or a
class (``load(held=...)``), a function of the module (``kilter.read``), or an option of the command
line (``--mu``). A guess that the table lacks keeps the message of Python.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Any, TypeVar, cast

from kilter.errors import InputError, nearest_name

Target = TypeVar("Target", bound=Callable[..., Any])


class GuessedAttribute(InputError, AttributeError):
    """Error: an attribute that users expect and that has another name."""


class GuessedKeyword(InputError, TypeError):
    """Error: a keyword that the function does not have."""


WORDS = {
    "friction": ("mu", "coefficient", "friction-coefficient", "cof", "static-friction"),
    "ground": ("held", "hold", "hold-part", "fixed", "fix", "anchor", "grounded", "support"),
    "floor": ("table", "ground-plane", "plane"),
    "down": ("gravity", "g", "direction", "gravity-direction"),
    "up": ("up-axis", "vertical", "axis"),
    "without": ("exclude", "remove", "omit", "skip", "ignore", "drop", "leave-out"),
    "fasten": ("join", "glue", "joint", "weld", "screw", "attach", "connect"),
    "bond": ("mortar", "magnet", "adhesive"),
    "fasten-suggested": ("auto-fasten", "suggested", "join-suggested", "fasten-all"),
    "fasten-overlaps": ("join-overlaps", "overlaps"),
    "units": ("unit", "scale", "length-unit"),
    "density": ("rho", "mass-density"),
    "material": ("materials",),
    "gap": ("tolerance", "tol", "eps", "epsilon", "contact-gap"),
    "angle": ("angle-tolerance", "angular-tolerance"),
    "clearance": ("play", "slack"),
    "centre-within": ("center-within", "com-within", "centre"),
    "output": ("out", "file", "save", "to"),
    "write": ("out-file",),
    "json": ("format", "as-json"),
    "quiet": ("silent", "q"),
    "verbose": ("details", "debug", "all"),
    "effort": ("budget", "iterations", "tries"),
    "time-limit": ("timeout", "limit", "max-time", "seconds"),
    "require": ("level", "at-level", "requires"),
    "proof": ("certificate", "proofs"),
    "processes": ("jobs", "workers", "threads", "cores", "j"),
    "sequence": ("order",),
    "hold": ("hands", "holds"),
    "most": ("max", "maximum", "at-most"),
}
"""Words that users type for an option of the command line and for a keyword of Python."""
MEANT = {word: name for name, words in WORDS.items() for word in words}

READ = "kilter.load(path)"
WRITE = 'kilter.dump(assembly, "a.kilter.json")'
PICTURE = 'kilter.draw({}, "picture.svg")'
POSES = 'answer.assembly["name"].pose, the pose of a part at rest'
DETECTS = (
    "kilter.check(assembly, tolerance=kilter.Tolerance({}=...)): the detection has the tolerances"
)
WHEN_READ = "kilter.load(path, {0}=...) when the file is read, or kilter.Part(..., {0}=...)"
HELD = "grounded=True"
PLACED = "pose=[x, y, z]"

RIGHT: dict[str, dict[str, str]] = {
    "kilter": {
        "read open from_file": READ,
        "write export to_file": WRITE,
        "is_stable stability analyse analyze solve": "kilter.check(assembly)",
        "plot render": PICTURE.format("assembly"),
        "simulate step": "kilter.settle(assembly)",
        "Scene Model World": "kilter.Assembly([kilter.Part(...), ...])",
        "Cuboid Block": "kilter.Box(x, y, z)",
        "Ball": "kilter.Sphere(radius)",
        "Plane Floor": "assembly.with_floor()",
    },
    "Verdict": {
        "holds is_stable ok success": "verdict.stable, or verdict.level",
        "report": 'kilter.report(assembly, "x.html")',
        "draw plot savefig": PICTURE.format("verdict"),
        "reason reasons message": "verdict.sentence",
        "falling unstable": "verdict.moving",
        "margin margins": "kilter.margin(verdict.assembly)",
    },
    "Settled": {
        "poses pose qpos positions": POSES,
        "stable holds": "answer.at_rest",
        "verdict": "answer.after, the verdict on the pose at rest",
    },
    "SceneReport": {
        "poses pose qpos positions": POSES,
        "stable holds": "report.at_rest",
        "verdict": 'report["name"].state, or report.verdicts',
    },
    "Judged": {"stable at_rest": "answer.holds"},
    "Order": {"order sequence": "[step.part for step in answer.steps]", "stable": "answer.found"},
    "Margin": {"angle tilt_angle": "answer.tilt_deg", "factor": "answer.load_factor"},
    "Transport": {"stable holds": "answer.carried"},
    "Fixture": {"stable found": "answer.holds"},
    "Assembly": {
        "with_mass": "dataclasses.replace(part, mass=2.0), and an assembly of the changed parts",
        "with_load": "assembly.with_loads([kilter.Load(name, force=[x, y, z])])",
        "with_gravity": "assembly.with_down([x, y, z])",
        "with_part add append": "assembly.with_parts([part])",
        "remove": "assembly.without(name)",
        "poses": "{part.name: part.pose for part in assembly}",
        "save dump write export to_file": WRITE,
        "check stable": "kilter.check(assembly)",
        "plot draw": PICTURE.format("assembly"),
    },
    "Part": {
        "fixed held static": "part.grounded",
        "position translation": "part.pose.position",
        "rotation orientation": "part.pose.rotation",
    },
    "Pose": {
        "translation origin": "pose.position",
        "quaternion orientation quat": "pose.rotation, a quaternion (w, x, y, z)",
        "rotation_matrix": "pose.matrix",
        "inv": "pose.inverse()",
    },
    "--": {
        "tilt slope incline": "--down X Y Z for a direction; 'kilter margin' computes the limit",
        "earthquake seismic": "'kilter transport --accelerate 0.2g 0 0'",
        "animate gif film movie": "'kilter draw FILE -o x.glb', a film",
        "html page": "'kilter report FILE -o x.html'",
        "picture plot png svg": "'kilter draw FILE -o x.png'",
        "forces": "'kilter check FILE --forces'",
        "verify": "'kilter verify FILE P.json'",
        "code forward": "'kilter transport FILE --code NAME --forward X Y Z', which checks each "
        "direction; 'kilter hold' with --straps has it, too",
    },
    "kilter()": {
        "density": WHEN_READ.format("density"),
        "mass": "kilter.Part(..., mass=...)",
        "units": "kilter.load(path, units=...) when the file is read",
        "gap": DETECTS.format("gap"),
        "angle": DETECTS.format("angle"),
        "clearance": DETECTS.format("clearance"),
        "straps": "assembly.with_straps([kilter.Strap(...)])",
        "joints": "assembly.with_joints([kilter.Joint(...)])",
        "bonds bond": "assembly.with_bonds([kilter.Bond(...)])",
        "fasten": "kilter.fastened(assembly, [(name, name)])",
        "code forward": "kilter.transport(assembly, code=...), which checks each direction",
        "proof": "verdict.proof(), the proof of the answer",
        "verbose quiet": "progress=print, which reports the stages; functions print nothing",
        "output path file": "the second argument, as in kilter.report(assembly, path)",
    },
    "Part()": {
        "fixed held static anchored ground": HELD,
        "position center centre location origin translation": PLACED,
        "friction mu": "kilter.Assembly(parts, friction=mu), or kilter.FrictionPair",
        "colour": 'color="#rrggbb"',
        "mesh": "shape=kilter.Mesh(vertices, faces)",
    },
    "Assembly()": {
        "ground held fixed": "kilter.Part(..., grounded=True), or assembly.with_grounded(name)",
        "floor": "assembly.with_floor()",
        "down": "gravity=[x, y, z], with its size [m/s^2]",
        "density": "kilter.Part(..., density=...)",
    },
    "Box()": {"width depth height length extents": "kilter.Box(x, y, z)"},
    "Cylinder()": {"diameter d": "radius=diameter / 2", "length h": "height=..."},
    "Sphere()": {"diameter d": "radius=diameter / 2"},
    "Pose()": {
        "matrix": "kilter.Pose(matrix) with a 4 x 4 matrix",
        "quaternion quat orientation": "rotation=[w, x, y, z]",
        "translation origin": "position=[x, y, z]",
        "euler rpy": "kilter.Pose.from_euler([roll, pitch, yaw])",
    },
    "Load()": {"at": "point=[x, y, z]", "moment": "torque=[x, y, z]"},
    "Joint()": {"type": "kind=..."},
}
"""The right call of each guess; several words may share it. An owner ends with () if its words
are keywords; the words of "kilter()" are keywords of any function, and those of "--" are options of
the command line."""

CALLS = {
    owner: {word: call for words, call in rows.items() for word in words.split()}
    for owner, rows in RIGHT.items()
}


def remedy_of(owner: str, word: str) -> str | None:
    """The remedy for a guessed name of an owner; None if the table lacks the name.

    Examples
    --------
    >>> remedy_of("Load()", "at")
    'use point=[x, y, z]'
    """
    call = CALLS.get(owner, {}).get(word)
    return None if call is None else f"use {call}"


def meant_word(typed: str, known: Collection[str]) -> str | None:
    """The real name of a guessed option or keyword; None if the table lacks the guess.

    Examples
    --------
    >>> meant_word("--mu", ["--up", "--friction"]), meant_word("held", ["ground"])
    ('--friction', 'ground')
    >>> meant_word("--mu", ["--up"]) is None
    True
    """
    word = typed.lstrip("-").split("=")[0].replace("_", "-").lower()
    name = MEANT.get(word)
    if name is None:
        return None
    written = f"--{name}" if typed.startswith("-") else name.replace("-", "_")
    return written if written in known else None


class Guessable:
    """Base class of values and answers: a guessed attribute gets the right call as its message."""

    __slots__ = ()

    if not TYPE_CHECKING:  # a type checker reports names that do not exist

        def __getattr__(self, name: str) -> Any:
            owners = (base.__name__ for base in type(self).__mro__)
            remedies = (remedy_of(owner, name) for owner in owners)
            remedy = next(filter(None, remedies), None)
            # a property that fails for another reason comes here too: its error is raised again
            if remedy is None or hasattr(type(self), name):
                return object.__getattribute__(self, name)
            kind = type(self).__name__
            raise GuessedAttribute(f"{kind} has no attribute {name!r}", hint=remedy)


def guarded(target: Target) -> Target:
    """Decorate a function or a class: a keyword that it lacks gets the right call as its message.

    Raises `GuessedKeyword` at a call with an unknown keyword.

    Examples
    --------
    >>> @guarded
    ... def turn(*, friction=0.0):
    ...     return friction
    >>> turn(mu=0.5)
    Traceback (most recent call last):
    ...
    kilter.values.guesses.GuessedKeyword: turn has no argument 'mu'; use friction
    """
    is_class = isinstance(target, type)
    call: Any = target.__init__ if is_class else target
    name = target.__name__
    parameters = inspect.signature(call).parameters
    if any(each.kind is inspect.Parameter.VAR_KEYWORD for each in parameters.values()):
        return target  # another function has the other keywords
    known = [each for each in parameters if each != "self"]
    allowed = frozenset(known)

    @functools.wraps(call)
    def checked(*args: Any, **given: Any) -> Any:
        if not allowed.issuperset(given):
            unknown = next(word for word in given if word not in allowed)
            raise _keyword_error(name, unknown, known, is_class=is_class)
        return call(*args, **given)

    if not is_class:
        return cast("Target", checked)
    cast("Any", target).__init__ = checked
    return target


def _keyword_error(
    name: str, unknown: str, known: Collection[str], *, is_class: bool
) -> GuessedKeyword:
    """The error for a keyword that a function or a class does not have."""
    word = meant_word(unknown, known)
    remedy = remedy_of(f"{name}()", unknown) or (word and f"use {word}")
    if remedy is None and not is_class:
        remedy = remedy_of("kilter()", unknown)
    near = nearest_name(unknown, known)
    hint = remedy or (f"did you mean {near!r}?" if near else f"it has {', '.join(known)}")
    return GuessedKeyword(f"{name} has no argument {unknown!r}", hint=hint)
