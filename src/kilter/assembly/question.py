"""A question about an assembly: the keywords that the functions share, declared once.

`Question` is the record of these keywords: friction, down, ground, floor, contacts, tolerance,
require, effort, time_limit and progress. A function with the decorator `question` has them in its
signature and its docstring, and receives them as a single value.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import os
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, fields
from time import perf_counter
from typing import Any, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from kilter.assembly.assembly import Assembly, require_assembly
from kilter.assembly.assembly_tolerances import SAME_DOWN
from kilter.assembly.assumption import valid_rung
from kilter.errors import InputError, some_names
from kilter.hooks import hook
from kilter.rigid import in_brackets
from kilter.tell.levels import REQUIRE
from kilter.threads import on_one_thread
from kilter.validate import name_list, number
from kilter.values.guesses import guarded
from kilter.work import EFFORT, Work, facts_of, units_of

# Joints without friction and springs, for functions whose answers do not count them.


STRENGTH = ("friction", "stiffness")
"""Members of a joint whose forces do not grow with gravity."""
LEFT_OUT = {
    **dict.fromkeys(("region", "common_region", "orient", "plan", "states", "hold"), STRENGTH),
    **dict.fromkeys(("lashing", "place"), STRENGTH),
}
"""Members of joints that a function leaves out, by its name or by the kind of its proofs."""
WORDS = {"friction": "friction", "stiffness": "springs"}
"""Word of each member in a note."""


def plain_joints(assembly: Assembly, verb: str) -> Assembly:
    """The assembly without the members of joints that `verb` leaves out, and with a note of it.

    Examples
    --------
    >>> from kilter import Box, Joint, Part
    >>> rail = Joint(("lid", "ground"), "prismatic", axis=[1, 0, 0], limits=[0, 1], friction=2)
    >>> plain_joints(Assembly([Part("lid", Box(1, 1, 1))], joints=[rail]), "region").notes
    ('region leaves out the friction of 1 joint',)
    """
    names = LEFT_OUT.get(verb, ())
    odd = [bool(set(names) & set(joint.guide)) for joint in assembly.joints]
    if not any(odd):
        return assembly
    given = {name for joint in assembly.joints for name in names if name in joint.guide}
    *most, last = (WORDS[name] for name in names if name in given)
    words = " and ".join(filter(None, [", ".join(most), last]))
    count = f"{sum(odd)} joint{'s' if sum(odd) > 1 else ''}"
    joints = [joint.without(*names) for joint in assembly.joints]
    note = f"{verb} leaves out the {words} of {count}"
    return dataclasses.replace(assembly, joints=joints, notes=[*assembly.notes, note])


def require_plain_joints(assembly: Assembly, what: str) -> None:
    """Raise an InputError if a joint has friction or a spring, for a margin without them.

    Raises `InputError` if there is such a joint.
    """
    for joint in assembly.joints:
        if set(STRENGTH) & set(joint.guide):
            names = " and ".join(repr(name) for name in joint.parts)
            raise InputError(
                f"{what} does not support friction and springs of joints, such as that of {names}: "
                "they do not grow with gravity",
                file=assembly.source or None,
                hint="remove them, or leave this margin out",
            )


class SceneModel(Protocol):
    """A model of MuJoCo: a whole scene in its default pose."""

    @property
    def nbody(self) -> Any:
        """Number of bodies."""


AssemblyOrPath = Assembly | str | os.PathLike[str] | SceneModel | tuple[SceneModel, Any]
"""First argument of a verb: an assembly, the path of a file that `kilter.load` reads, or a model
of MuJoCo, alone or as the pair (model, data)."""
SIMULATORS = ("mujoco",)
"""Packages whose models are read without `kilter.load`: a model is a whole scene with its pose."""


def is_scene(value: object) -> bool:
    """Whether a value is a model of a simulator, or the pair (model, data)."""
    model = value[0] if isinstance(value, tuple) and len(value) == 2 else value
    return type(model).__module__.partition(".")[0] in SIMULATORS


Answer = TypeVar("Answer")


def _told(kind: str, *lines: str, annotation: str = "") -> dict[str, str]:
    """The text of a docstring about a keyword, and its annotation if it is a class of contacts."""
    return {"kind": kind, "text": "\n        ".join(lines), "annotation": annotation}


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """The record of the shared keywords; a function that gets it answers it without a change.

    The other fields are the function, the assembly with the changes of the keywords,
    and the time at which the question began [s].
    """

    friction: float | None = field(
        default=None,
        metadata=_told(
            "float, optional",
            "Coefficient of the contacts without a coefficient of their own [-].",
        ),
    )
    down: ArrayLike | None = field(
        default=None,
        metadata=_told(
            "array_like, shape (3,), optional",
            "Direction of gravity, whose magnitude stays [-].",
        ),
    )
    ground: str | Iterable[str] = field(
        default=(),
        metadata=_told(
            "str or iterable of str",
            "Parts that are also held; ``*`` and ``?`` are wildcards.",
        ),
    )
    floor: bool | float | None = field(
        default=None,
        metadata=_told(
            "bool or float, optional",
            "True adds a held table under the lowest point; a number is its height [length].",
        ),
    )
    contacts: Any = field(
        default=None,
        metadata=_told(
            "ContactSet, optional",
            "Contacts of this assembly; by default they are detected from its geometry.",
            annotation="ContactSet | None",
        ),
    )
    tolerance: Any = field(
        default=None,
        metadata=_told(
            "Tolerance, optional",
            "Tolerances of the detection: gap, angle and clearance. By default those of the",
            "assembly.",
            annotation="Tolerance | None",
        ),
    )
    require: str = field(
        default=REQUIRE,
        metadata=_told(
            '{"equilibrium", "settles", "proved", "strict"}',
            "Level from which the answer is yes.",
        ),
    )
    effort: float = field(
        default=EFFORT,
        metadata=_told(
            "float",
            "Work limit; each further unit allows about ten times more work [-]. 0 is quick and",
            "1 is usual. Work is counted in operations, not in time.",
        ),
    )
    time_limit: float | None = field(
        default=None,
        metadata=_told(
            "float, optional",
            "Time limit [s]. The clock is read between steps, so an answer at the limit may",
            "differ from run to run.",
        ),
    )
    progress: Callable[[str], None] | None = field(
        default=None,
        metadata=_told(
            "callable, optional",
            "Function that is called with the name of each stage.",
        ),
    )
    assume: str | None = field(
        default=None,
        metadata=_told(
            '{"drawn", "play", "fits", "joined"}, optional',
            "Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move",
            "within their play until they rest; pairs that look fastened are joined, too; parts",
            "that touch are joined, too. The default is that of the saved choices, else play for",
            "files of simulators, else drawn.",
        ),
    )
    verb: str = ""
    assembly: Assembly = field(default=cast("Assembly", None))
    begun: float = field(default_factory=perf_counter)

    def __post_init__(self) -> None:
        object.__setattr__(self, "effort", number(self.effort, "effort", lowest=0))
        if self.time_limit is not None:
            limit = number(self.time_limit, "time_limit", lowest=0)
            object.__setattr__(self, "time_limit", limit)
        if self.assume is not None:
            valid_rung(self.assume)

    def but(self, **changes: Any) -> Question:
        """The question with other values, and the same begin."""
        return dataclasses.replace(self, **changes)

    def within(self, seconds: float | None) -> Question:
        """The question with a time limit from now [s]."""
        return dataclasses.replace(self, time_limit=seconds, begun=perf_counter())

    def tell(self, stage: str) -> None:
        """Report a stage, if somebody listens."""
        if self.progress is not None:
            self.progress(stage)

    @property
    def seconds_left(self) -> float | None:
        """The time that is left [s]; None without a time limit."""
        if self.time_limit is None:
            return None
        return max(self.begun + self.time_limit - perf_counter(), 0.0)

    def work(self, share: float = 1.0, *, facts: bool = False) -> Work:
        """The work limit of the question, times a factor, with the time that is left."""
        told = facts_of(self.progress) if facts else None
        units = share * units_of(self.effort)
        return Work(units, self.progress, time_limit=self.seconds_left, facts=told)

    @property
    def changes(self) -> dict[str, Any]:
        """The keywords that change the assembly before the question, by name."""
        return {name: getattr(self, name) for name in CHANGES}

    def read(self, subject: object) -> Assembly:
        """An assembly, or that of a path or a model, with the changes of the keywords.

        Raises `InputError` if it is neither, the file cannot be read, a name matches no part, or
        contacts are given beside a keyword that changes them.

        Examples
        --------
        >>> from kilter import Box, Part
        >>> cube = Assembly([Part("cube", Box(1, 1, 1))])
        >>> Question(ground="cube", friction=0.5).read(cube).friction
        0.5
        >>> Question().read(cube) is cube
        True
        """
        changing = [name for name in ("friction", "floor") if getattr(self, name)]
        if self.contacts is not None and changing:
            raise InputError(
                f"{self.verb} got contacts and {changing[0]}, which changes the contacts",
                hint=f"leave out one of them, or find the contacts with the same {changing[0]}",
            )
        if isinstance(subject, str | os.PathLike) or is_scene(subject):
            loaded: Assembly = hook("load")(subject, **self.changes)
            return plain_joints(self.supported(loaded), self.verb)
        require_assembly(subject, self.verb)
        assembly = cast("Assembly", subject)
        if self.friction is not None:
            assembly = assembly.with_friction(self.friction)
        names = name_list(self.ground, "ground")
        if names:
            assembly = holding(assembly, names)
        assembly = on_floor(assembly, self.floor, self.down)
        return plain_joints(self.supported(assembly), self.verb)

    def supported(self, assembly: Assembly) -> Assembly:
        """The assembly with the support that the question assumes if its file holds no part.

        Given contacts are those without an assumed floor, so no floor is then added.
        """
        no_floor = self.floor is False or self.contacts is not None
        return supported(assembly, self.verb, floor=not no_floor)

    def require_unchanged(self, subject: object) -> None:
        """Reject keywords that would change the assembly of a complete answer.

        Examples
        --------
        >>> Question().require_unchanged("answer")
        """
        names = [self.ground] if isinstance(self.ground, str) else list(self.ground)
        values = {**self.changes, "ground": names or None}
        changing = [name for name, value in values.items() if value is not None]
        if changing:
            kind = type(subject).__name__
            raise InputError(
                f"{changing[0]} changes an assembly, but the type is {kind}",
                hint="give an assembly",
            )


SHARED = {entry.name: entry for entry in fields(Question) if entry.metadata}
"""The shared keywords by name."""
CHANGES = ("friction", "down", "ground", "floor")
"""Keywords that change the assembly before the question."""


def question(
    *, lacks: str = "", own_rungs: bool = False, **defaults: Any
) -> Callable[[Callable[..., Answer]], Callable[..., Answer]]:
    """Create a decorator that adds the shared keywords to a function ``act(asked, ...)``.

    If `asked` is the first parameter of the function, the public function has `assembly` in its
    place, and `asked.assembly` is this assembly with the changes. Else `asked` is a keyword.

    Parameters
    ----------
    lacks : str
        Names of shared keywords that the function does not have.
    own_rungs : bool
        Whether the function itself applies the rung of `assume`.
    **defaults
        Defaults of the function in place of those of `Question`.

    Examples
    --------
    >>> @question(lacks="effort contacts", require="equilibrium")
    ... def count(asked, *, twice=False):
    ...     return len(asked.assembly) * (1 + twice), asked.require
    >>> from kilter import Box, Part
    >>> count(Assembly([Part("cube", Box(1, 1, 1))]), ground="cube", twice=True)
    (2, 'equilibrium')
    >>> list(inspect.signature(count).parameters)[:3]
    ['assembly', 'friction', 'down']
    """

    def decorate(act: Callable[..., Answer]) -> Callable[..., Answer]:
        """Wrap a function so that its signature and docstring have the shared keywords."""
        own = dict(inspect.signature(act).parameters)
        reads = next(iter(own)) == "asked"
        asked_kind = own.pop("asked")
        shared = {
            name: asked_kind.replace(
                name=name,
                kind=inspect.Parameter.KEYWORD_ONLY,
                default=defaults.get(name, entry.default),
                annotation=entry.metadata["annotation"] or entry.type,
            )
            for name, entry in SHARED.items()
            if name not in lacks.split() and (reads or name != "assume")
        }
        first = [asked_kind.replace(name="assembly", annotation="AssemblyOrPath")] if reads else []
        by_place = [each for each in own.values() if each.kind is each.POSITIONAL_OR_KEYWORD]
        by_name = [each for each in own.values() if each.kind is each.KEYWORD_ONLY]
        others = [each for each in own.values() if each.kind is each.VAR_KEYWORD]
        before = [shared[name] for name in CHANGES if name in shared]
        after = [each for name, each in shared.items() if name not in CHANGES]
        signature = inspect.signature(act).replace(
            parameters=[*first, *by_place, *before, *by_name, *after, *others]
        )

        @functools.wraps(act)
        def ask(*given: Any, **named: Any) -> Answer:
            if given and isinstance(given[0], Question):
                return act(*given, **named)
            values = signature.bind(*given, **named).arguments
            said = {name: values.pop(name, each.default) for name, each in shared.items()}
            asked = Question(verb=act.__name__, **said)
            if reads:
                asked = asked.but(assembly=asked.read(values.pop("assembly")))
                if "assume" in shared and not own_rungs:
                    asked = hook("assumed")(asked)
            for each in others:
                values |= values.pop(each.name, {})
            return act(asked=asked, **values)

        ask.__signature__ = signature  # type: ignore[attr-defined]
        ask.__doc__ = _completed(act.__doc__ or "", list(shared))
        return guarded(on_one_thread(ask))

    return decorate


def _completed(text: str, names: list[str]) -> str:
    """A docstring whose section of parameters has the shared keywords that it leaves out."""
    own, *section = re.split(r"( {4}Parameters\n {4}-{10}\n)", text, maxsplit=1)
    if not section:  # an inner function, which the reference does not show
        return text
    parameters, rest = section
    listed, end, rest = re.split(r"(\n\n|\n {4}\Z)", rest, maxsplit=1)
    documented = {
        name for names in re.findall(r"(?m)^ {4}(\w[\w, ]*)", listed) for name in names.split(", ")
    }
    for name in names:
        if name not in {each.strip() for each in documented}:
            told = SHARED[name].metadata
            listed += f"\n    {name} : {told['kind']}\n        {told['text']}"
    return own + parameters + listed + end + rest


def holding(assembly: Assembly, patterns: Iterable[str]) -> Assembly:
    """The assembly with further held parts; a note names those whose loads have no effect.

    Examples
    --------
    >>> from kilter import Box, Load, Part
    >>> cube = Assembly([Part("cube", Box(1, 1, 1))], loads=[Load("cube", [0, 0, -1])])
    >>> holding(cube, ["cube"]).notes
    ("loads on held parts, without effect: 'cube'",)
    """
    chosen = assembly.matching(patterns)
    loaded = sorted({load.part for load in assembly.loads if load.part in chosen})
    held = assembly.with_grips(chosen)
    if not loaded:
        return held
    note = f"loads on held parts, without effect: {some_names(loaded)}"
    return dataclasses.replace(held, notes=[*held.notes, note])


def on_floor(assembly: Assembly, floor: bool | float | None, down: ArrayLike | None) -> Assembly:
    """The assembly on a floor across its own gravity, which is then turned to `down`.

    The floor belongs to the assembly as drawn, as in margins and regions. A note states this if
    gravity is oblique to it.

    Arguments: `floor`: True for a floor under the lowest point, or its height; None and False for
    no floor; `down` (3,): direction of gravity.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> cube = Assembly([Part("cube", Box(1, 1, 1))])
    >>> tilted = on_floor(cube, True, [0.1, 0, -1])
    >>> tilted["floor"].pose.position.tolist(), tilted.notes[0][:59]
    ([0.0, 0.0, -0.625], 'the floor lies across the up direction of the file, (0, 0, ')
    """
    has_floor = floor is not None and floor is not False
    if has_floor:
        assembly = assembly.with_floor(None if floor is True else floor)
    if down is None:
        return assembly
    turned = assembly.with_down(down)
    if not has_floor or np.linalg.norm(turned.down - assembly.down) <= SAME_DOWN:
        return turned
    note = (
        f"the floor lies across the up direction of the file, {in_brackets(-assembly.down)}, and "
        "turns with the parts: gravity is oblique to it"
    )
    return dataclasses.replace(turned, notes=[*turned.notes, note])


# Assume a support if the file holds no part: drawings and scenes rarely state held parts.


FREE_STANDING = ("contacts", "hold")
"""Functions that need no held part, and assume none."""
TURNED = ("orient", "region", "common_region")
"""Functions about all directions of gravity; a floor would be above the parts in half of them."""
LOWEST = "lowest"
"""Value of the option `floor`: a table under the lowest point."""
ASSUMED_FLOOR = "assumed: a floor under it; --ground NAME holds a part instead"


def supported(assembly: Assembly, verb: str, *, floor: bool = True) -> Assembly:
    """The assembly with an assumed support and a note of it, if its file holds no part.

    It is a floor under the lowest point, across the up direction of the file. `TURNED` functions
    hold the largest part instead, as do all if only the contacts of the file count. The assembly
    itself is returned if a part is held, or if nothing is assumed: for files of kilter, for
    assemblies made in Python, and for `FREE_STANDING` functions.

    Arguments: `verb`: name of the function; `floor`: whether a floor may be assumed.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> cubes = [Part("cube", Box(1, 1, 1)), Part("large", Box(2, 2, 2), [0, 0, 1.5])]
    >>> drawing = Assembly(cubes, file_up=[0, 0, 1])
    >>> supported(drawing, "check").names, supported(drawing, "hold").names
    (('cube', 'large', 'floor'), ('cube', 'large'))
    >>> supported(drawing, "region").notes
    ("assumed: 'large' is held, the largest part; --ground NAME holds another part instead",)
    """
    if assembly.file_up is None or assembly.holds or verb in FREE_STANDING:
        return assembly
    gravity, up_assumed = assembly.gravity, assembly.up_assumed
    if verb in TURNED or not assembly.detect:
        name = assembly.largest
        note = (
            f"assumed: {name!r} is held, the largest part; --ground NAME holds another part instead"
        )
        assumed: dict[str, Any] = {"ground": [name]}
        assembly = assembly.with_grips([name])
    elif floor:
        note, assumed = ASSUMED_FLOOR, {"floor": LOWEST}
        drawn = assembly.with_down(-np.asarray(assembly.file_up, dtype=np.float64))
        down = None if np.allclose(drawn.down, assembly.down, atol=SAME_DOWN) else assembly.down
        assembly = on_floor(drawn, True, down)
    else:
        return assembly
    return dataclasses.replace(
        assembly,
        gravity=gravity,
        up_assumed=up_assumed,
        notes=[*assembly.notes, note],
        assumed={**assembly.assumed, **assumed},
    )
