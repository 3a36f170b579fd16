"""Sentences and tables of an answer: moving parts, forces, pushes, loads, patches, gaps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from kilter.errors import some
from kilter.tell.body_words import body_sentences, support_words
from kilter.tell.check_facts import Answer
from kilter.tell.contact_words import gap_words
from kilter.tell.facts import kind_of
from kilter.tell.ladder_words import TOUCHES
from kilter.tell.margin_facts import part_level_words
from kilter.tell.motion_rows import motion_of, motion_rows
from kilter.tell.numbers import Name, count, counts, force, mass, number, percent, plain, vector
from kilter.tell.open_words import deciding_option
from kilter.tell.place_words import PACKING_HEAD, item_cells
from kilter.tell.plan_words import step_cells, support_cells
from kilter.tell.scene_words import SCENE_HEAD, moved_cells, moved_head, object_cells, scene_order
from kilter.tell.verify_words import verify_sentence
from kilter.tell.why_words import WHY_HEAD, why_cells

INTERFERENCE = "an interference fit: a press fit or a thread"
NO_FORCE = 1e-9
"""A force below this share of the greatest force is left out, since it comes from rounding [-]."""
NO_MOVEMENT = 1e-6
"""A component of a movement below this share of the largest is shown as 0 [-]."""
NO_GAP = 1e-14
"""A gap below this share of the largest part is shown as 0, since it comes from rounding [-]."""
NO_ACCELERATION = (
    "No accelerations that obey the contact law were found. The motion of the proof is shown: it "
    "gains energy, but it does not tell how fast the parts start to move."
)
KINDS = {
    "none": "No direction of gravity is stable.",
    "ray": "One direction of gravity is stable, and none near it.",
    "line": "Two opposite directions of gravity are stable, and none near them.",
    "fan": "The stable directions of gravity are a fan: a flat sector.",
    "half-plane": "The stable directions of gravity are a half-plane.",
    "plane": "The stable directions of gravity are all those of a plane.",
    "cone": "The stable directions of gravity are a solid cone, like a pyramid.",
    "wedge": "The stable directions of gravity are a wedge between two planes.",
    "half-space": "The stable directions of gravity are a half-space.",
    "all": "Every direction of gravity is stable: it is locked.",
}
HELD = (
    "With friction, held means that forces that hold it exist: 'kilter check --down' reports what "
    "friction guarantees."
)
LEFT_OUT = "Without friction and without the contacts that are not modelled:"


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """A table in an answer: title, column heads and rows."""

    title: str
    head: Sequence[str]
    """Column heads; empty for a list without heads."""
    items: Sequence[Any]
    """Listed items, one for each row."""
    row: Callable[[Any], Sequence[str]]
    """Function from an item to its cells, each words or a `Name`."""
    complete: bool = False
    """Whether a terminal shows all rows."""

    def rows(self, limit: int) -> list[Sequence[str]]:
        """Return the cells of the first `limit` rows, or of all rows of a complete table."""
        if self.complete:
            limit = len(self.items)
        return [self.row(item) for item in self.items[:limit]]


def sentences(answer: Answer) -> list[str]:
    """Return the first lines of an answer, which state its result."""
    kind = kind_of(answer)
    if kind == "region":
        return [_region_sentence(answer)]
    if kind == "contacts":
        patches = answer["patches"]
        pairs = len({tuple(patch["parts"]) for patch in patches})
        points = sum(len(patch["points"]) for patch in patches)
        lines = [f"Parts touch in {counts(pairs=pairs, patches=len(patches), points=points)}."]
        left_open = len(answer["open_pairs"])
        if left_open:
            decides = "does not determine how they touch"
            lines.append(f"Open: {count(left_open, 'pair')}, since the geometry {decides}.")
        return [*lines, *body_sentences(answer["bodies"], answer["units"])]
    if kind == "assembly":
        return [f"An assembly of {count(len(answer['parts']), 'part')}."]
    if kind == "verify":
        return [verify_sentence(answer)]
    lines = [str(answer["sentence"])]
    if kind == "check" and answer["verdict"] == "unstable":
        moving = sum(part["moves"] for part in answer["parts"])
        if moving and all(part["acceleration"] is None for part in answer["parts"]):
            lines.append(NO_ACCELERATION)
    return lines


def region_sentence(kind: str, *, friction: bool) -> str:
    """Return the sentence about a region of stable directions, by its kind.

    Examples
    --------
    >>> region_sentence("all", friction=True)
    'Every direction of gravity is held: it is locked.'
    """
    return KINDS[kind].replace("stable", "held") if friction else KINDS[kind]


def _region_sentence(answer: Answer) -> str:
    """Return the sentence about a region, and the forces that it includes or leaves out."""
    head = region_sentence(answer["kind"], friction=answer["friction"])
    inner = _lower_case(head)
    if answer["pairs_decide"]:
        joined, friction = "forces that hold it exist for gravity as given.", answer["friction"]
        if answer["if_joined"] is not None:  # None for a large assembly
            joined = _lower_case(region_sentence(answer["if_joined"]["kind"], friction=friction))
        pairs = some([" and ".join(map(plain, pair["parts"])) for pair in answer["open_pairs"]])
        counted = "with friction" if friction else "without friction"
        return (
            f"Undecided, since open pairs decide ({pairs}). As drawn, {counted}, {inner} "
            f"If these pairs are joined, {joined}"
        )
    if answer["friction"]:
        return f"{head} {HELD}"
    return head if answer["complete"] else f"{LEFT_OUT} {inner}"


def _lower_case(sentence: str) -> str:
    """Return a sentence with a small first letter, for use inside another sentence."""
    return f"{sentence[0].lower()}{sentence[1:]}"


def tables(answer: Answer) -> list[Table]:
    """Return the tables below the facts of an answer, without empty tables."""
    kind = kind_of(answer)
    if kind == "margin":
        return [table for table in (push_table(answer), load_table(answer)) if len(table.items)]
    if kind == "plan" and answer["steps"]:
        return [_step_table(answer)]
    if kind == "hold" and answer["supports"]:
        return [_support_table(answer)]
    if kind == "scene":
        rows = scene_order(answer["objects"])
        return [Table("objects:", SCENE_HEAD, rows, object_cells, complete=True)]
    if kind == "why" and answer["objects"]:
        return [Table("bodies:", WHY_HEAD, answer["objects"], why_cells)]
    if kind == "settle" and answer["moved"]:
        return [Table("moved:", moved_head(answer), answer["moved"], partial(moved_cells, answer))]
    if kind == "check-plan":
        return [Table("items:", PACKING_HEAD, list(enumerate(answer["items"], 1)), item_cells)]
    if kind == "check":
        return [table for table in [fastened_table(answer)] if len(table.items)]
    if kind == "contacts":
        every = [
            open_table(answer),
            _body_table(answer),
            _held_table(answer),
            fastened_table(answer),
            _fit_table(answer),
            _patch_table(answer),
            _gap_table(answer),
            *_rejected_tables(answer),
        ]
        return [table for table in every if len(table.items)]
    return []


def moving_table(answer: Answer, *, brief: bool = False) -> Table | None:
    """Return the table of the moving parts, the fastest first; None without a motion.

    `brief`: whether parts with equal motions share a row, in at most `MOST_MOTIONS` rows.
    """
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
    parts = sorted(
        answer["parts"],
        key=lambda part: (not part.get("moved_by_proof"), -max(part["relative"] or (0.0,))),
    )
    moving = [part for part in parts if part["moves"]]
    if verdict == "undecided" and not moving:  # the numbers, or a time limit, gave no proof
        return None
    title = _moving_title(answer, moving)
    if not moving and verdict != "potentially-stable":
        moving = [part for part in parts if part["slow_motion"] is not None]

    if not moving:
        return None
    if brief:
        proof = bool(answer["open_pairs"])  # the title counts the parts that the proof moves
        return Table(title, (), motion_rows(moving, by_proof=proof), tuple, complete=True)

    def row(part: Answer) -> Sequence[str]:
        return Name(part["name"]), motion_of(part)

    return Table(title, (), moving, row)


def _certain_alone(answer: Answer, moving: Sequence[Answer]) -> bool:
    """Return whether the listed motions come from the certain contacts alone."""
    return answer["verdict"] == "undecided" or (bool(answer["open_pairs"]) and bool(moving))


def _moving_title(answer: Answer, moving: Sequence[Answer]) -> str:
    """Return the title of the table of moving parts, with their number and the proved part."""
    parts = answer["parts"]
    counts = f"{len(moving)} of {sum(not part['grounded'] for part in parts)} free parts"
    if _certain_alone(answer, moving):
        if not answer["open_pairs"]:
            return f"{counts} move without friction at the contacts that kilter models:"
        title = f"{counts} move if the open pairs carry no force"
        proved = sum(bool(part.get("moved_by_proof")) for part in moving)
        if 0 < proved < len(moving):
            first = "the first moves" if proved == 1 else f"the first {proved} move"
            title += f"; it is proved that {first} in any case"
        return f"{title}:"
    if answer["verdict"] == "potentially-stable":
        return f"{counts} could move:"
    if moving or not parts:
        return f"{counts} move:"
    return f"No part starts faster than {answer['tolerance']['moves']:g} g; the fastest:"


def fastened_table(answer: Answer) -> Table:
    """Return the table of pairs that options joined because they look fastened or overlap."""
    whys = [joint.get("why") for joint in answer["joints"]]
    rows = zip(answer["joints"], whys, strict=True)
    joined = [joint for joint, why in rows if why not in (None, TOUCHES)]
    title = f"Fastened by option: {count(len(joined), 'pair')}"
    return Table(title, (), joined, lambda joint: (*_names(joint), joint["why"]))


def ranges_table(answer: Answer) -> Table:
    """Return the table of the least and the greatest forces of pairs of parts."""
    if not answer["ranges"]:
        return Table("No ranges of forces: no equilibrium is known.", (), (), tuple)

    def end(entry: Answer, value: Answer) -> str:
        if entry["value"] is not None:
            size = force(entry["value"]) if value["moment"] is None else number(entry["value"])
            return size + ("" if entry["proved"] else " (not proved)")
        return "no limit" if entry["proved"] else "unknown"

    def row(one: Answer) -> Sequence[str]:
        names = [Name(name) for name in one["parts"]]
        return (
            names[0],
            names[1] if len(names) > 1 else "all",
            end(one["least"], one),
            end(one["greatest"], one),
        )

    along, moment = answer["ranges"][0]["along"], answer["ranges"][0]["moment"]
    single = all(len(one["parts"]) == 1 for one in answer["ranges"])
    on = "on the held part" if single else "on the second part"
    what = "Normal forces" if along is None else f"Forces {on} along {vector(along, 3)}"
    if moment is not None:
        what = f"Moments [N m] {on} about {vector(moment, 3)}"
    title = f"{what}, least and greatest of all equilibria:"
    return Table(title, ["part", "and part", "least", "greatest"], answer["ranges"], row, True)


def movement_tables(answer: Answer) -> list[Table]:
    """Return the outcome of moving supports, contacts that open, and movements of parts."""
    found, unit = answer["movement"], answer["units"]
    low, high = (found[end]["value"] for end in ("least_work", "greatest_work"))
    words = [found["sentence"]]
    if low is not None and high is not None:
        words.append(f"Work of the forces on the supports: {low:.5g} to {high:.5g} J.")
    if found["moves"] and not found["exact"]:
        words.append("The movement is one of a flow that opens as it slides: not exact.")

    def opened(one: Answer) -> Sequence[str]:
        names = [Name(name) for name in one["parts"]]
        kind = "slides" if one["slides"] else "opens"
        return *names, kind, number(one["opening"]), number(one["angle"]), vector(one["at"], 3)

    def small(values: Sequence[float]) -> str:
        """Three numbers with digits of their own; those from rounding are 0."""
        most = NO_MOVEMENT * max(map(abs, values))
        return f"({', '.join(number(x if abs(x) > most else 0.0, 4) for x in values)})"

    def moved(one: Answer) -> Sequence[str]:
        return Name(one["part"]), small(one["translation"]), small(one["rotation"])

    head = ["part", "and part", "", unit, "deg", f"at {unit}"]
    tables = [
        Table(" ".join(words), head if found["opened"] else (), found["opened"], opened, True)
    ]
    if found["moves"]:
        head = ["part", f"moves by {unit}", "turns by deg"]
        tables.append(Table("Movements, the largest first:", head, found["moves"], moved, True))
    return tables


def forces_table(answer: Answer) -> Table:
    """Return the table of contact forces of one equilibrium, the largest first."""
    forces = answer["forces"]
    head = ["part", "on part", "force", "direction", f"at {answer['units']}", "friction needed"]
    if forces is None:
        return Table("No contact forces: no equilibrium exists.", (), (), tuple)
    bonded = any(patch["bond_utilisation"] is not None for patch in forces["patches"])
    head += ["bond used"] * bonded
    patches = sorted(forces["patches"], key=lambda patch: -math.hypot(*patch["resultant"]))
    most = math.hypot(*patches[0]["resultant"]) if patches else 0.0
    patches = [patch for patch in patches if math.hypot(*patch["resultant"]) > NO_FORCE * most]

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

    which = "with the least sum of squares" if forces["least"] else "from the proof of the verdict"
    return Table(f"One possible set of contact forces ({which}):", head, patches, row)


def _step_table(answer: Answer) -> Table:
    """Return the table of the steps of a plan, in order."""
    numbered = list(enumerate(answer["steps"], 1))

    def row(item: tuple[int, Answer]) -> Sequence[str]:
        number, step = item
        return str(number), Name(", ".join(step["parts"])), *step_cells(step)

    return Table("Put in, in this order:", (), numbered, row)


def _support_table(answer: Answer) -> Table:
    """Return the table of supports of `kilter hold`."""

    def row(support: Answer) -> Sequence[str]:
        kind, part, *rest = support_cells(support, answer["units"])
        return kind, Name(part), *rest

    return Table("Hold it by:", (), answer["supports"], row)


def push_table(answer: Answer) -> Table:
    """Return the table of the least push that moves each part, the weakest part first."""

    def row(push: Answer) -> Sequence[str]:
        level = part_level_words(answer, "pushes", push["part"])
        if push["force"] is None:
            return Name(push["part"]), "unlimited", level.removeprefix("; ")
        along = f"along {vector(push['direction'], 3)}"
        return Name(push["part"]), force(push["force"]), along + level

    def size(push: Answer) -> float:
        return math.inf if push["force"] is None else float(push["force"])

    exist = " (forces that hold it exist)" if answer["level"] == "equilibrium" else ""
    title = (
        "Greatest push that each part resists at its centre of mass, in its weakest "
        f"direction{exist}:"
    )
    return Table(title, (), sorted(answer["pushes"], key=size), row)


def load_table(answer: Answer) -> Table:
    """Return the table of the largest extra weight that each part carries, the least first."""

    def row(entry: Answer) -> Sequence[str]:
        level = part_level_words(answer, "loads", entry["part"])
        if entry["load"] is None:
            return Name(entry["part"]), "unlimited", "", level.removeprefix("; ")
        starts = some([plain(name) for name in entry["moves"]], 3)
        words = f"then {starts} start{'s' if len(entry['moves']) == 1 else ''} to move"
        moves = (words * bool(starts) + level).removeprefix("; ")
        return Name(entry["part"]), force(entry["load"]), mass(entry["mass"]), moves

    def size(entry: Answer) -> float:
        return math.inf if entry["load"] is None else float(entry["load"])

    exist = " (forces that hold it exist)" if answer["level"] == "equilibrium" else ""
    title = (
        "Greatest additional load that each part carries, straight down at its centre of "
        f"mass{exist}:"
    )
    return Table(title, (), sorted(answer["loads"], key=size), row)


def _patch_table(answer: Answer) -> Table:
    """Return the table of contact patches."""
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
    return Table("Contact patches:", head, answer["patches"], row)


def open_table(answer: Answer) -> Table:
    """Return the table of undecided (open) pairs, each with an option that decides it."""
    unit = answer["units"]

    def row(pair: Answer) -> Sequence[str]:
        size = ""
        if pair["depth"] is not None:
            size = f"{number(pair['depth'], 3)} {unit} deep"
        elif pair["gap"]:
            size = f"gap {number(pair['gap'], 3)} {unit}"
        return *_names(pair), pair["kind"], size, pair["why"], deciding_option(pair)

    head = ("part a", "part b", "kind", "distance", "why", "decided by")
    return Table("Open pairs, on which a verdict may depend:", head, answer["open_pairs"], row)


def _body_table(answer: Answer) -> Table:
    """Return the table of bodies, those on a floor first; empty for a single body."""
    bodies = answer["bodies"] if len(answer["bodies"]) > 1 else []
    units = answer["units"]

    def row(body: Answer) -> Sequence[str]:
        name, parts = Name(body["name"]), str(len(body["parts"]))
        near = "" if body["nearest"] is None else Name(body["nearest"])
        apart = "" if near == "" else f"{number(body['distance'], 3)} {units}"
        return name, parts, mass(body["mass"]), apart, near, support_words(body, units)

    head = ("largest part", "parts", "mass", "distance", "nearest part", "support")
    return Table("Bodies of parts that touch or overlap:", head, bodies, row)


def _held_table(answer: Answer) -> Table:
    """Return the table of held parts that touch nothing, the smallest gap to a part first."""

    def row(entry: Answer) -> Sequence[str]:
        if entry["nearest"] is None:
            return Name(entry["part"]), "", ""
        return Name(entry["part"]), gap_words(entry, answer["units"]), Name(entry["nearest"])

    def gap(entry: Answer) -> float:
        return math.inf if entry["gap"] is None else float(entry["gap"])

    held = sorted((entry for entry in answer["nearest"] if entry["grounded"]), key=gap)
    return Table("Held, but touching nothing:", ("part", "gap", "nearest part"), held, row)


def _fit_table(answer: Answer) -> Table:
    """Return the table of shafts in holes."""
    unit = answer["units"]

    def row(fit: Answer) -> Sequence[str]:
        play = "0" if fit["fit"] == "size on size" else number(fit["clearance"], 3)
        return *_names(fit), number(fit["radius"]), play, number(fit["length"], 4), fit["fit"]

    head = ("shaft", "hole", f"radius [{unit}]", f"clearance [{unit}]", f"length [{unit}]", "fit")
    return Table("Shafts in holes (radial clearance):", head, answer["fits"], row)


def _gap_table(answer: Answer) -> Table:
    """Return the histogram of gaps between faces: a row with a bar for each power of ten."""
    edges, counts = answer["histogram"]["edges"], answer["histogram"]["counts"]
    most = max(counts, default=1)
    bins = [(k, many) for k, many in enumerate(counts) if many]
    least, largest = answer["sizes"]
    span = number(least, 3) if least == largest else f"{number(least, 3)} to {number(largest, 3)}"

    def row(item: tuple[int, int]) -> Sequence[str]:
        k, many = item
        low, high = (
            math.copysign(math.inf, side) if edge is None else edge
            for side, edge in ((-1, edges[k]), (1, edges[k + 1]))
        )
        bar = "#" * max(1, round(30 * many / most))
        return f"{low:8.0e} to {high:8.0e}", str(many), bar

    title = (
        f"Gaps of opposing faces, divided by the size of the smaller part (sizes {span} "
        f"{answer['units']}; a negative gap is a penetration):"
    )
    return Table(title, ("gap / size", "faces", ""), bins, row)


def _rejected_tables(answer: Answer) -> list[Table]:
    """Return tables of unmodelled contacts, near pairs, and overlaps of joined or held parts."""
    unit = answer["units"]
    odd, near, over = (answer[key] for key in ("unsupported", "rejected", "overlaps"))
    left_open = {frozenset(pair["parts"]) for pair in answer["open_pairs"]}
    over = [pair for pair in over if frozenset(pair["parts"]) not in left_open]

    def unsupported(pair: Answer) -> Sequence[str]:
        return *_names(pair), pair["kind"], f"at {vector(pair['point'])}"

    def rejected(pair: Answer) -> Sequence[str]:
        size = f"gap {number(pair['gap'], 3)} {unit}"
        return *_names(pair), size, f"angle {number(pair['angle_deg'], 3)} deg", pair["why"]

    def overlap(pair: Answer) -> Sequence[str]:
        volume = pair["volume"]
        return (
            *_names(pair),
            f"depth {number(pair['depth'], 3)} {unit}",
            "" if volume is None else f"volume {number(volume, 3)} {unit}^3",
            INTERFERENCE if pair["why"] == "interfere" else pair["why"],
        )

    kinds, faces, joined = (count(len(pairs), "pair") for pairs in (odd, near, over))
    return [
        Table(f"Contacts of a kind that is not modelled yet: {kinds}", (), odd, unsupported),
        Table(f"Near, but not touching: {faces} of faces", (), near, rejected),
        Table(f"Overlapping, but joined or held: {joined}", (), over, overlap),
    ]


def _names(pair: Answer) -> tuple[Name, Name]:
    first, second = pair["parts"]
    return Name(first), Name(second)
