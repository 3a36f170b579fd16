"""What an answer lists: parts that move, forces, pushes, patches, gaps, as rows of words."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from kilter.errors import some
from kilter.tell.contact_words import gap_words
from kilter.tell.facts import kind_of
from kilter.tell.hold_words import support_cells
from kilter.tell.improve_words import HEAD, change_cells, improve_sentence
from kilter.tell.numbers import count, counts, force, mass, number, percent, plain, vector
from kilter.tell.open_words import settling_options
from kilter.tell.plan_words import step_cells
from kilter.tell.shared_facts import Answer
from kilter.tell.words import NAMED

__all__ = [
    "Name",
    "Table",
    "forces_table",
    "load_table",
    "moving_table",
    "open_table",
    "push_table",
    "region_sentence",
    "sentences",
    "tables",
]

INTERFERENCE = "an interference fit: a press fit or a thread"
NO_FORCE = 1e-9
"""A force below this fraction of the greatest is what rounding leaves of none [-]."""
NO_GAP = 1e-14
"""A gap below this fraction of the largest part is what rounding leaves of none [-]."""
KINDS = {
    "none": "No direction of gravity is stable.",
    "ray": "One direction of gravity is stable, and none near it.",
    "line": "Two opposite directions of gravity are stable, and none near them.",
    "fan": "The stable directions of gravity are a fan: a flat sector.",
    "half-plane": "The stable directions of gravity are a half-plane.",
    "plane": "The stable directions of gravity are all those of a plane.",
    "cone": "The stable directions of gravity are a cone with a tip.",
    "wedge": "The stable directions of gravity are a wedge between two planes.",
    "half-space": "The stable directions of gravity are a half-space.",
    "all": "Every direction of gravity is stable: it is locked.",
}
HELD = "With friction, where forces that hold it exist ('kilter check --down' tells the rest):"
TRIED = "Changes that were tried, the best first:"
LEFT_OUT = "Without friction and contacts not modelled:"


class Name(str):
    """A name from a file: each voice shows it as what cannot disturb it."""

    __slots__ = ()


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """A list in an answer.

    Attributes
    ----------
    title : str
    head : sequence of str
        Words above the columns; empty where they need none.
    items : sequence
        What is listed, a row each.
    row : callable
        The cells of an item: words, or a `Name`.
    """

    title: str
    head: Sequence[str]
    items: Sequence[Any]
    row: Callable[[Any], Sequence[str]]

    def rows(self, limit: int) -> list[Sequence[str]]:
        """The first rows."""
        return [self.row(item) for item in self.items[:limit]]


def sentences(answer: Answer) -> list[str]:
    """What an answer says first."""
    kind = kind_of(answer)
    if kind == "region":
        return [_region_sentence(answer)]
    if kind == "contacts":
        patches = answer["patches"]
        pairs = len({tuple(patch["parts"]) for patch in patches})
        points = sum(len(patch["points"]) for patch in patches)
        lines = [f"Parts touch in {counts(pairs=pairs, patches=len(patches), points=points)}."]
        left_open, alone = len(answer["open_pairs"]), len(answer["nearest"])
        if left_open:
            lines.append(f"Left open by the geometry: {count(left_open, 'pair')}.")
        if alone:
            lines.append(f"Touching nothing: {count(alone, 'part')}.")
        return lines
    if kind == "assembly":
        return [f"An assembly of {count(len(answer['parts']), 'part')}."]
    if kind == "verify":
        if not answer["holds"]:
            return ["The proof does not hold."]
        return [f"The proof holds: {answer['verdict']}."]
    if kind == "improve":
        return [improve_sentence(answer)]
    lines = [str(answer["sentence"])]
    moving = sum(part["moves"] for part in answer.get("parts", ()))
    if kind == "check" and answer["verdict"] == "unstable" and moving > NAMED:
        lines.append(f"Fastest: {answer['summary']}.")
    return lines


def region_sentence(kind: str, *, friction: bool) -> str:
    """Which directions of gravity an assembly holds for; with friction, which can be held.

    Examples
    --------
    >>> region_sentence("all", friction=True)
    'Every direction of gravity is held: it is locked.'
    """
    return KINDS[kind].replace("stable", "held") if friction else KINDS[kind]


def _region_sentence(answer: Answer) -> str:
    head = region_sentence(answer["kind"], friction=answer["friction"])
    inner = _lower_case(head)
    if answer["pairs_decide"]:
        joined = region_sentence(answer["if_joined"]["kind"], friction=answer["friction"])
        pairs = some([" and ".join(map(plain, pair["parts"])) for pair in answer["open_pairs"]])
        friction = "with friction" if answer["friction"] else "without friction"
        return (
            f"Undecided, since open pairs decide ({pairs}). As drawn, {friction}, {inner} "
            f"If these pairs are joined, {_lower_case(joined)}"
        )
    if answer["friction"]:
        return f"{HELD} {inner}"
    return head if answer["complete"] else f"{LEFT_OUT} {inner}"


def _lower_case(sentence: str) -> str:
    """A sentence with a small first letter, for use after a colon or comma."""
    return f"{sentence[0].lower()}{sentence[1:]}"


def tables(answer: Answer) -> list[Table]:
    """What an answer lists after its facts."""
    kind = kind_of(answer)
    if kind == "margin":
        return [one for one in (push_table(answer), load_table(answer)) if len(one.items)]
    if kind == "plan" and answer["steps"]:
        return [_steps(answer)]
    if kind == "hold" and answer["supports"]:
        return [_supports(answer)]
    if kind == "improve" and answer["tried"]:
        return [
            Table("Changes that were tried, the best first:", HEAD, answer["tried"], change_cells)
        ]
    if kind == "check":
        return [table for table in [fastened_table(answer)] if len(table.items)]
    if kind == "contacts":
        every = [
            open_table(answer),
            _lone(answer),
            fastened_table(answer),
            _fits(answer),
            _patches(answer),
            _gaps(answer),
            *_doubtful(answer),
        ]
        return [table for table in every if len(table.items)]
    return []


def moving_table(answer: Answer) -> Table | None:
    """The parts that move and how, the fastest first; None where it tells of none."""
    if kind_of(answer) not in ("check", "orient"):
        return None
    verdict = answer["verdict"]
    refuted = answer.get("guarantee") != "open"
    if verdict in ("stable", "settles", "found") or (
        verdict == "potentially-stable" and not refuted
    ):
        return None
    known = all(part["relative"] is not None for part in answer["parts"])
    if not known and not any(part["moves"] for part in answer["parts"]):
        return None
    parts = sorted(answer["parts"], key=lambda part: -max(part["relative"] or (0.0,)))
    free = sum(not part["grounded"] for part in parts)
    moving = [part for part in parts if part["moves"]]
    left_out = bool(answer["open_pairs"])
    if verdict == "undecided" or (left_out and moving):
        by = "certain contacts" if left_out else "modelled, frictionless contacts"
        title = f"By its {by} alone, {len(moving)} of {free} free parts move:"
    elif verdict == "potentially-stable":
        title = f"{len(moving)} of {free} free parts could move:"
    elif moving or not parts:
        title = f"{len(moving)} of {free} free parts move:"
    else:
        title = f"No part starts faster than {answer['tolerance']['moves']:g} g; the fastest:"
        moving = [part for part in parts if part["slow_motion"] is not None]

    def row(part: Answer) -> Sequence[str]:
        return Name(part["name"]), part["motion"] if part["moves"] else part["slow_motion"]

    return Table(title, (), moving, row)


def fastened_table(answer: Answer) -> Table:
    """What was joined as it looks or overlaps, not by name."""
    joined = [joint for joint in answer["joints"] if joint.get("why")]
    title = f"Fastened, as asked for: {count(len(joined), 'pair')}"
    return Table(title, (), joined, lambda joint: (*_names(joint), joint["why"]))


def forces_table(answer: Answer) -> Table:
    """The contact forces of an equilibrium, the greatest first; of bonds what they use."""
    found = answer["forces"]
    head = ["part", "on part", "force", "direction", f"at {answer['units']}", "friction used"]
    if found is None:
        return Table("No contact forces: there is no equilibrium.", (), (), tuple)
    bonded = any(patch["bond_utilisation"] is not None for patch in found["patches"])
    head += ["bond used"] * bonded
    patches = sorted(found["patches"], key=lambda patch: -math.hypot(*patch["resultant"]))
    most = math.hypot(*patches[0]["resultant"]) if patches else 0.0
    patches = [one for one in patches if math.hypot(*one["resultant"]) > NO_FORCE * most]

    def row(patch: Answer) -> Sequence[str]:
        size = math.hypot(*patch["resultant"])
        used = [patch["utilisation"], *[patch["bond_utilisation"]] * bonded]
        along = [c / size for c in patch["resultant"]] if size else [0.0, 0.0, 0.0]
        first, second = patch["parts"]
        return (
            Name(first),
            Name(second),
            force(size),
            vector(along, 3) if size else "-",
            "-" if patch["center"] is None else vector(patch["center"], 4),
            *("-" if share is None else percent(share) for share in used),
        )

    which = "least sum of squares" if found["least"] else "as the verdict's proof has them"
    return Table(f"Contact forces of equilibrium ({which}; one of many):", head, patches, row)


def _steps(answer: Answer) -> Table:
    """The steps of a plan, in their order."""
    numbered = list(enumerate(answer["steps"], 1))

    def row(item: tuple[int, Answer]) -> Sequence[str]:
        number, step = item
        return str(number), Name(", ".join(step["parts"])), *step_cells(step)

    return Table("Put in one after the other:", (), numbered, row)


def _supports(answer: Answer) -> Table:
    """The supports of a fixture."""

    def row(support: Answer) -> Sequence[str]:
        kind, part, *rest = support_cells(support, answer["units"])
        return kind, Name(part), *rest

    return Table("Hold it by:", (), answer["supports"], row)


def push_table(answer: Answer) -> Table:
    """The weakest push of each part, the weakest first."""

    def row(push: Answer) -> Sequence[str]:
        if push["force"] is None:
            return Name(push["part"]), "unlimited", ""
        return Name(push["part"]), force(push["force"]), f"along {vector(push['direction'], 3)}"

    def size(push: Answer) -> float:
        return math.inf if push["force"] is None else float(push["force"])

    return Table("Weakest push at the centre of mass:", (), sorted(answer["pushes"], key=size), row)


def load_table(answer: Answer) -> Table:
    """The load that each part takes straight down, the least first."""

    def row(one: Answer) -> Sequence[str]:
        if one["load"] is None:
            return Name(one["part"]), "unlimited", "", ""
        starts = some([plain(name) for name in one["moves"]], 3)
        words = f"then {starts} start{'s' if len(one['moves']) == 1 else ''} to move"
        return Name(one["part"]), force(one["load"]), mass(one["mass"]), words * bool(starts)

    def size(one: Answer) -> float:
        return math.inf if one["load"] is None else float(one["load"])

    title = "Load that is still taken, straight down at the centre of mass:"
    return Table(title, (), sorted(answer["loads"], key=size), row)


def _patches(answer: Answer) -> Table:
    unit = answer["units"]
    head = ["part a", "part b", "kind", f"area [{unit}^2]", f"gap [{unit}]", "normal a to b"]
    bonded = any(patch["pull"] is not None for patch in answer["patches"])
    largest = answer["sizes"][1]

    def row(patch: Answer) -> Sequence[str]:
        return (
            *_names(patch),
            patch["kind"],
            number(patch["area"]),
            f"{patch['gap']:.1e}" if abs(patch["gap"]) > NO_GAP * largest else "0",
            vector(patch["normal"], 4),
            number(patch["mu"], 4),
            str(len(patch["points"])),
            *["-" if patch["pull"] is None else force(patch["pull"])] * bonded,
        )

    head += ["mu", "points", *["bond pulls up to"] * bonded]
    return Table("Where they touch:", head, answer["patches"], row)


def open_table(answer: Answer) -> Table:
    """Pairs between which the geometry does not say what acts, and the option that settles each."""
    unit = answer["units"]

    def row(one: Answer) -> Sequence[str]:
        size = ""
        if one["depth"] is not None:
            size = f"{number(one['depth'], 3)} {unit} deep"
        elif one["gap"]:
            size = f"gap {number(one['gap'], 3)} {unit}"
        [option] = settling_options([{**one, "decides": True}])
        return *_names(one), one["kind"], size, one["why"], option

    head = ("part a", "part b", "kind", "how far", "why", "it holds with")
    return Table("Left open, so that a verdict may hang on it:", head, answer["open_pairs"], row)


def _lone(answer: Answer) -> Table:
    """Parts that touch nothing, the nearest to something first."""

    def row(one: Answer) -> Sequence[str]:
        if one["nearest"] is None:
            return Name(one["part"]), "", ""
        return Name(one["part"]), gap_words(one, answer["units"]), Name(one["nearest"])

    def gap(one: Answer) -> float:
        return math.inf if one["gap"] is None else float(one["gap"])

    head = ("part", "gap", "nearest part")
    return Table("Touching nothing:", head, sorted(answer["nearest"], key=gap), row)


def _fits(answer: Answer) -> Table:
    """Shafts in holes."""
    unit = answer["units"]

    def row(one: Answer) -> Sequence[str]:
        play = "0" if one["fit"] == "size on size" else number(one["clearance"], 3)
        return *_names(one), number(one["radius"]), play, number(one["length"], 4), one["fit"]

    head = ("shaft", "hole", f"radius [{unit}]", f"clearance [{unit}]", f"length [{unit}]", "fit")
    return Table("Shafts in holes (clearance of the radius):", head, answer["fits"], row)


def _gaps(answer: Answer) -> Table:
    """A row a decade of gaps that has any, with a bar."""
    edges, counts = answer["histogram"]["edges"], answer["histogram"]["counts"]
    most = max(counts, default=1)
    bins = [(k, many) for k, many in enumerate(counts) if many]
    least, largest = answer["sizes"]
    span = number(least, 3) if least == largest else f"{number(least, 3)} to {number(largest, 3)}"

    def row(one: tuple[int, int]) -> Sequence[str]:
        k, many = one
        low, high = (
            math.copysign(math.inf, side) if edge is None else edge
            for side, edge in ((-1, edges[k]), (1, edges[k + 1]))
        )
        bar = "#" * max(1, round(30 * many / most))
        return f"{low:8.0e} to {high:8.0e}", str(many), bar

    title = (
        f"Gaps of opposing faces over the size of the smaller part (sizes {span} "
        f"{answer['units']}; negative gaps penetrate):"
    )
    return Table(title, ("gap / size", "faces", ""), bins, row)


def _doubtful(answer: Answer) -> list[Table]:
    """What is not modelled, what came near, what overlaps."""
    unit = answer["units"]
    odd, near, over = (answer[key] for key in ("unsupported", "rejected", "overlaps"))
    left_open = {frozenset(one["parts"]) for one in answer["open_pairs"]}
    over = [one for one in over if frozenset(one["parts"]) not in left_open]

    def rejected(one: Answer) -> Sequence[str]:
        size = f"gap {number(one['gap'], 3)} {unit}"
        return *_names(one), size, f"angle {number(one['angle_deg'], 3)} deg", one["why"]

    def overlap(one: Answer) -> Sequence[str]:
        volume = one["volume"]
        return (
            *_names(one),
            f"depth {number(one['depth'], 3)} {unit}",
            "" if volume is None else f"volume {number(volume, 3)} {unit}^3",
            INTERFERENCE if one["why"] == "interfere" else one["why"],
        )

    return [
        Table(
            f"Touching in a way not modelled yet: {count(len(odd), 'pair')}",
            (),
            odd,
            lambda one: (*_names(one), one["kind"], f"at {vector(one['point'])}"),
        ),
        Table(f"Near, but not touching: {count(len(near), 'pair')} of faces", (), near, rejected),
        Table(f"Overlapping, and joined or held: {count(len(over), 'pair')}", (), over, overlap),
    ]


def _names(one: Answer) -> tuple[Name, Name]:
    first, second = one["parts"]
    return Name(first), Name(second)
