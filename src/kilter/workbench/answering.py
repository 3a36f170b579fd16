"""Answers of the workbench as JSON data for the page: scene, verdict, open pairs, tabs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from kilter.analysis.assumptions.assume import FASTENED
from kilter.analysis.assumptions.rung_verdict import assumed
from kilter.analysis.check import check, check_equilibrium
from kilter.analysis.everything import MARGIN_PARTS, only_directions, only_given
from kilter.analysis.force_ranges import ForceRange
from kilter.analysis.margins.margin import STAND_TILT, margin
from kilter.analysis.placing.place import Places, box_to_place, place
from kilter.analysis.planning.hold.hold import hold
from kilter.analysis.planning.order.explained import explain
from kilter.analysis.planning.order.order import Order
from kilter.analysis.planning.order.plan import plan
from kilter.analysis.settled_pose.settle import settle
from kilter.analysis.support_movement import SupportMovement
from kilter.analysis.transport.transport import transport
from kilter.analysis.turning.orientation import Orientation, orient
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.question import Question
from kilter.contact.fits.suggestions import suggest_joints
from kilter.errors import InputError, shell_words
from kilter.files.own.choices import Choices, option_words
from kilter.files.own.saved_entries import with_interactions
from kilter.show.ladder_card import build_ladder
from kilter.show.movement_scene import build_movement
from kilter.show.plan_scene import build_film
from kilter.show.scene import build_directions, build_orientation, build_things
from kilter.show.sections import answer_html, movement_html, placed_part, ranges_html
from kilter.tell.facts import facts
from kilter.tell.levels import REQUIRE
from kilter.tell.numbers import count
from kilter.tell.open_words import lie_words
from kilter.tell.scene_words import leaving_words, moved_words
from kilter.units import metres_per_unit
from kilter.workbench.improvements import helps_data
from kilter.workbench.live_assembly import OpenedParts, Prepared

# The command line that reproduces what the workbench shows.


TOLERANCE = {"gap": "--gap", "angle_deg": "--angle", "clearance": "--clearance"}
"""Option of each key of the tolerance."""


def needs_file(keys: Mapping[str, Any]) -> bool:
    """Whether choices contain a key without an option, so that a command needs them as a file.

    Examples
    --------
    >>> needs_file({"kilter": 1, "file": "a.step", "friction": 0.3})
    False
    >>> needs_file({"kilter": 1, "file": "a.step", "loads": [{"part": "a", "force": [0, 0, 1]}]})
    True
    """
    entries = Choices.from_dict(dict(keys)).options()["entries"]
    return bool(entries)


def command(
    name: str, keys: Mapping[str, Any], saved: str | None = None, further: Sequence[str] = ()
) -> str:
    """The command that answers a question about the present choices.

    Parameters
    ----------
    name : str
        Name of the command, such as "check".
    keys : mapping
        JSON data of the choices.
    saved : str, optional
        File that holds these choices. It is named if an option cannot express a choice; without it,
        the command begins with the name under which the choices would be saved.
    further : sequence of str
        Further words.

    Examples
    --------
    >>> command("check", {"kilter": 1, "file": "a.step", "held": ["base"], "friction": 0.3})
    'kilter check a.step --ground base --friction 0.3'
    """
    choices = Choices.from_dict(dict(keys))
    options = choices.options()
    if options["entries"]:
        return shell_words(["kilter", name, saved or saved_name(choices.file), *further])
    words = option_words({key: value for key, value in options.items() if key != "entries"})
    for key, value in (choices.tolerance or {}).items():
        if value is not None:
            words += [TOLERANCE[key], f"{value:.15g}"]
    if choices.loose:
        words.append("--loose")
    return shell_words(["kilter", name, choices.file, *words, *further])


def saved_name(file: str) -> str:
    """Name of the file of choices beside an assembly file.

    Examples
    --------
    >>> saved_name("clamp.step"), saved_name("wall.kilter.json")
    ('clamp.kilter.json', 'wall.choices.kilter.json')
    """
    name = file.rsplit("/", 1)[-1]
    if name.endswith(".kilter.json"):
        return f"{name.removesuffix('.kilter.json')}.choices.kilter.json"
    stem = name.rsplit(".", 1)[0] or name
    return f"{stem}.kilter.json"


# The change of the workbench that settles the parts: their poses at rest as choices.


PLACED = ("point", "axis", "points", "normal")
"""Keys of loads, joints and bonds that move with a part."""
ENTRIES = ("loads", "joints", "bonds")
"""Keys of choices whose entries may have points."""


def settle_offer(verdict: Verdict) -> dict[str, str] | None:
    """Parts that overlap, nearly touch or hang, in words; None if there is no such part.

    Examples
    --------
    >>> from kilter import check
    >>> from kilter.scenes import scene
    >>> settle_offer(check(scene("tower"))) is None
    True
    """
    contacts = verdict.contact_set
    kinds = [pair.kind for pair in contacts.open_pairs]
    free = ~verdict.assembly.geometry.grounded
    numbers = {
        "overlapping pair": kinds.count("overlap"),
        "nearly touching pair": kinds.count("near"),
        "hanging part": len({one.part for one in contacts.neighbours if free[one.part]}),
    }
    found = ", ".join(count(number, word) for word, number in numbers.items() if number)
    return {"parts": found} if found else None


def settling_action(
    prepared: Prepared, keys: Mapping[str, Any], progress: Callable[[str], None]
) -> dict[str, Any]:
    """The action that moves the parts to their pose at rest.

    Parts that leave the scene are in the pose in which they left it. Raises `InputError` if no part
    comes to rest, if the parts are at rest already, or if choices cannot state the pose.
    """
    answer = settle(
        prepared.assembly,
        contacts=prepared.contacts,
        tolerance=prepared.tolerance,
        effort=0.0,
        require="equilibrium",
        progress=progress,
    )
    data = answer.to_dict()
    moved = {entry["part"] for entry in data["moved"]}
    if answer.resting is None:
        raise InputError(data["sentence"].rstrip("."), hint="decide the open pairs instead")
    if not moved:
        raise InputError("no part moves: the parts are at rest as drawn")
    drawn, settled = answer.drawn, answer.assembly
    return {
        "do": "poses",
        "poses": {
            part.name: {
                "position": part.pose.position.tolist(),
                "rotation": part.pose.rotation.tolist(),
            }
            for part in settled.parts
            if part.name in moved
        },
        "replaced": {key: _replaced(key, drawn, settled, keys) for key in ENTRIES},
        "moved": "; ".join(filter(None, [moved_words(data), leaving_words(data)])),
        "sha256": keys.get("sha256"),
        "units": keys.get("units"),
    }


def _replaced(
    key: str, drawn: Assembly, settled: Assembly, keys: Mapping[str, Any]
) -> list[list[dict[str, Any]]]:
    """Pairs of an entry of the choices, as it is and as it moves with its part.

    Raises `InputError` if an entry of the file itself moves.
    """
    before, after = list(getattr(drawn, key)), list(getattr(settled, key))
    moved = {k for k, entry in enumerate(before) if entry != after[k]}
    pairs = []
    for entry in keys.get(key, []) if moved else []:
        built = getattr(with_interactions(drawn, {key: [entry]}), key)[-1]
        if built not in before:
            continue  # of a part that is left out
        k = before.index(built)
        if k in moved:
            places = {name: _as_list(getattr(after[k], name)) for name in PLACED if name in entry}
            pairs.append([dict(entry), {**entry, **places}])
            moved -= {j for j, other in enumerate(before) if other == built}
    if moved:
        raise InputError(
            f"the {key} of the file move with their parts, which choices cannot state",
            hint="'kilter settle FILE -o REST.kilter.json' writes the complete assembly",
        )
    return pairs


def _as_list(value: Any) -> Any:
    return None if value is None else np.asarray(value).tolist()


Tell = Callable[[str], None]
PHASES = ("equilibrium", "complete")
"""Phases of an answer, in order: the first is quick, the second is the answer of `check`."""
LASTING = ("stable", "settles")
"""Verdicts that no decision of a pair can improve."""
SAME_MOTION = 1e-6
"""Twists closer than this are equal [largest twist]."""
LISTED = 500
"""Largest number of open pairs and of suggestions that are sent to the page."""
NOT_LISTED = ("seconds", "level")
"""Facts that the page shows elsewhere, or not at all."""


def scene_data(prepared: Prepared, bodies: OpenedParts) -> dict[str, Any]:
    """Data of the picture: shapes, parts, contact patches, open pairs and loads."""
    assembly = prepared.assembly
    things = build_things(assembly, prepared.contacts)
    things["parts"]["held_by"] = [_held_by(assembly, k, bodies) for k in range(len(assembly.parts))]
    things["parts"]["density"] = [_density(assembly, k) for k in range(len(assembly.parts))]
    things["parts"]["full_names"] = list(assembly.names)
    things["friction"] = assembly.friction
    things["left_out"] = list(prepared.left_out)
    things["down"] = assembly.down.tolist()
    nothing = ("given", "recommended", "region", "rays", "map", "change")
    return {**things, **dict.fromkeys(nothing), "coincide": False, "notes": []}


def _held_by(assembly: Assembly, k: int, bodies: OpenedParts) -> str:
    """Reason why a part is held: "file", "floor", "assumed" or "choice"; empty for a free part."""
    part = assembly.parts[k]
    if not part.grounded:
        return ""
    if part.table and part.name not in bodies.names:
        return "assumed" if "floor" in assembly.assumed else "floor"
    return "file" if part.name in bodies.held else "choice"


def _density(assembly: Assembly, k: int) -> float | None:
    """Density of a part [kg/m^3]; None if its mass is given instead."""
    part = assembly.parts[k]
    return None if part.given_mass is not None else part.density


def prepared_check(prepared: Prepared, phase: str, progress: Tell | None = None) -> Verdict:
    """The verdict on the present choices, as `kilter check` computes it from the saved choices.

    The phase "equilibrium" stops when equilibrium is decided, and is about the drawn pose.
    """
    if phase == "equilibrium":
        return check_equilibrium(prepared.assembly, prepared.contacts)
    return check(
        prepared.assembly,
        contacts=prepared.contacts,
        tolerance=prepared.tolerance,
        require=REQUIRE,
        progress=progress,
    )


def on_rung(prepared: Prepared, progress: Tell) -> Prepared:
    """The assembly and the contacts with the poses and joints of their rung, for other questions.

    Raises `InputError` if the parts cannot come to rest.
    """
    asked = Question(
        assembly=prepared.assembly,
        contacts=prepared.contacts,
        tolerance=prepared.tolerance,
        progress=progress,
    )
    found = assumed(asked)
    assert found.contacts is not None
    poses = [part.pose for part in prepared.assembly.parts]
    moved = poses != [part.pose for part in found.assembly.parts]
    return replace(prepared, assembly=found.assembly, contacts=found.contacts, moved=moved)


def posed(prepared: Prepared, verdict: Verdict) -> Prepared:
    """The assembly and the contacts to which a verdict belongs, in the poses of its rung."""
    return replace(prepared, assembly=verdict.assembly, contacts=verdict.contact_set)


def answer_data(verdict: Verdict, phase: str, center: Array) -> dict[str, Any]:
    """Data of a verdict for the page.

    Arguments: `center` (3,): point to which the positions of the picture are relative, world frame
    [length unit].
    """
    answers = only_given(verdict)
    data = answers.given.check
    units = verdict.assembly.units
    complete = phase == "complete"
    pairs = [
        {
            "parts": pair["parts"],
            "kind": pair["kind"],
            "words": lie_words(pair, units),
            "decides": bool(pair.get("decides")) and data["verdict"] not in LASTING,
        }
        for pair in data["open_pairs"][:LISTED]
    ]
    return {
        "phase": phase,
        "given": build_orientation(answers, answers.given, center)
        | {"assumption": build_ladder(data, verdict.assembly) if complete else None},
        "facts": [[term, words] for term, words in facts(data) if term not in NOT_LISTED],
        "warnings": list(data["warnings"]),
        "open": pairs,
        "suggestions": _suggestions(verdict) if complete else [],
        "settle": settle_offer(verdict) if complete and data["verdict"] not in LASTING else None,
        "html": answer_html(data) if complete else "",
        "check": {key: data[key] for key in ("verdict", "level", "why")},
    }


def _suggestions(verdict: Verdict) -> list[dict[str, Any]]:
    """Pairs that look fastened, and whether a joint of the pair prevents the found motion."""
    found = suggest_joints(verdict.assembly, verdict.contact_set)
    if not found:
        return []
    moves = _relative_motion(verdict)
    return [
        {
            "parts": list(one.parts),
            "kind": one.kind,
            "words": one.why,
            "fixed": one.fixed,
            "decides": one.fixed and one.kind in FASTENED and moves(*one.parts),
        }
        for one in found[:LISTED]
    ]


def _relative_motion(verdict: Verdict) -> Callable[[str, str], bool]:
    """Test of a pair of parts: whether they move relative to each other in the found motion.

    A joint of a pair that moves as a single body, or rests, does not prevent the motion.
    """
    parts = [part for part in verdict.parts if part.acceleration is not None]
    if verdict.verdict != "unstable" or not parts:
        # no motion is known that a joint would have to stop, so any joint may decide
        return lambda first, second: verdict.verdict not in LASTING
    twists = np.array([part.acceleration for part in parts])
    index = {part.name: k for k, part in enumerate(parts)}
    assembly = verdict.assembly
    at = assembly.geometry.center[[assembly.index[name] for name in index]]
    at = at * metres_per_unit(assembly.units)
    twists[:, :3] -= np.cross(twists[:, 3:], at)  # velocity of the point at the origin
    size = float(np.abs(twists).max()) or 1.0

    def differ(first: str, second: str) -> bool:
        here = [index[name] for name in (first, second) if name in index]
        rest = np.zeros(6)
        one, other = [*twists[here], rest, rest][:2]
        return float(np.abs(one - other).max()) > SAME_MOTION * size

    return differ


# tabs ----------------------------------------------------------------------------------


def _orient(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    return orient(prepared.assembly, contacts=prepared.contacts, progress=tell), []


def _margin(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    loads = bool(options.get("loads"))
    pushes = sum(not part.grounded for part in prepared.assembly.parts) <= MARGIN_PARTS
    answer = margin(
        prepared.assembly,
        contacts=prepared.contacts,
        pushes=pushes,
        loads=loads,
        progress=tell,
    )
    return answer, ["--pushes"] * pushes + ["--loads"] * loads


def _helps(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    ask = partial(margin, prepared.assembly, contacts=prepared.contacts, progress=tell)
    if options.get("allow") is not None:
        kinds = _names(options["allow"], "the list of allowed changes")
        [tilt] = _numbers([options.get("tilt", STAND_TILT)], "the tilt")
        words = ["--make-stand", "--allow", ",".join(kinds), "--tilt", f"{tilt:.15g}"]
        return ask(make_stand=kinds, stand_tilt_deg=tilt), words
    parts = _names(options.get("parts") or [], "the list of parts")
    words = ["--improve", *(word for name in parts for word in ("--part", name))]
    return ask(improve=True, pushed=parts or None), words


def _names(values: Any, what: str) -> list[str]:
    """Names in the options of a tab.

    Raises `InputError` if a value is no name.
    """
    if not isinstance(values, list) or not all(isinstance(value, str) for value in values):
        raise InputError(f"{what} is {values!r:.60}", hint="give names")
    return values


def _plan(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    return plan(prepared.assembly, contacts=prepared.contacts, progress=tell), []


def _hold(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    return hold(prepared.assembly, contacts=prepared.contacts, progress=tell), []


def _transport(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    asked: dict[str, Any] = {}
    words: list[str] = []
    if options.get("code"):
        asked["code"] = str(options["code"])
        words = ["--code", asked["code"]]
    elif options.get("accelerate"):
        asked["accelerate"] = _numbers(options["accelerate"], "the acceleration")
        words = ["--accelerate", *(f"{x:.15g}" for x in asked["accelerate"])]
    answer = transport(prepared.assembly, contacts=prepared.contacts, progress=tell, **asked)
    return answer, words


def _place(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    size = _numbers(options.get("size") or (), "the size of the box")
    if len(size) != 3 or "mass" not in options:
        raise InputError(
            "the box to place is not given", hint="give its three lengths and its mass"
        )
    [mass] = _numbers([options["mass"]], "the mass")
    part = box_to_place(size, mass)
    answer = place(prepared.assembly, part, contacts=prepared.contacts, progress=tell)
    return answer, ["--box", "x".join(f"{x:.15g}" for x in size), "--mass", f"{mass:.15g}"]


def _numbers(values: Any, what: str) -> list[float]:
    """Numbers in the options of a tab.

    Raises `InputError` if a value is no number.
    """
    try:
        return [float(value) for value in values]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what} is {values!r:.40}", hint="give numbers") from None


def _forces(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    verdict = prepared_check(prepared, "complete", tell)
    pair = options.get("between")
    if pair is None:
        return _Ranges(verdict.force_ranges()), ["--forces"]
    if not isinstance(pair, list) or len(pair) != 2 or not all(isinstance(x, str) for x in pair):
        raise InputError(f"the pair is {pair!r:.60}", hint="select two parts that touch")
    return _Ranges(verdict.force_ranges([pair])), ["--between", *pair]


@dataclass(frozen=True, slots=True)
class _Ranges:
    """Ranges of contact forces as an answer."""

    ranges: Sequence[ForceRange]

    def to_dict(self) -> dict[str, Any]:
        """The data of the ranges, with a sentence."""
        ends = [end for one in self.ranges for end in (one.least, one.greatest)]
        sentence = "No contact forces are known that hold the assembly, so they have no range."
        if ends:
            proof = (
                "each end has a proof"
                if all(end.proved for end in ends)
                else "ends without a proof are marked"
            )
            sentence = f"Each force lies in this range in every equilibrium; {proof}."
        return {"ranges": [one.to_dict() for one in self.ranges], "sentence": sentence}


def _supports(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    moved = options.get("moved")
    if not isinstance(moved, dict) or not moved:
        raise InputError(
            "no support moves", hint="select a held part, and give its movement below its name"
        )
    ways = {name: _numbers(way, "the movement") for name, way in moved.items()}
    words = [f"{name}={','.join(f'{x:.15g}' for x in way)}" for name, way in ways.items()]
    verdict = prepared_check(prepared, "complete", tell)
    answer = _Moved(verdict.support_movement(ways), verdict.assembly)
    return answer, [word for one in words for word in ("--move", one)]


@dataclass(frozen=True, slots=True)
class _Moved:
    """A movement of supports as an answer."""

    found: SupportMovement
    assembly: Assembly

    def to_dict(self) -> dict[str, Any]:
        """The data of the movement, with its sentence."""
        movement = self.found.to_dict()
        sentence = self.found.sentence
        return {"movement": movement, "units": self.assembly.units, "sentence": sentence}


def _contacts(prepared: Prepared, options: Mapping[str, Any], tell: Tell) -> tuple[Any, list[str]]:
    return prepared.contacts, []


TABS = {
    "orient": _orient,
    "margin": _margin,
    "helps": _helps,
    "plan": _plan,
    "hold": _hold,
    "transport": _transport,
    "place": _place,
    "forces": _forces,
    "supports": _supports,
    "contacts": _contacts,
}
"""Function of each tab: it returns the answer, and the further words of its command."""
COMMANDS = {"forces": "check", "supports": "check", "helps": "margin"}
"""Command of each tab whose name is not that of its command."""
WRITES = {"forces": ranges_html, "supports": movement_html}
"""Function that writes the HTML of each tab that is no answer of a command."""


def tab_data(
    name: str,
    prepared: Prepared,
    keys: Mapping[str, Any],
    options: Mapping[str, Any],
    *,
    saved: str | None,
    center: Array,
    progress: Tell,
) -> dict[str, Any]:
    """Data of a tab: the answer of the command of the same name, with its command line.

    Raises `InputError` if there is no such tab, or this assembly does not admit the question.
    """
    if name not in TABS:
        raise InputError(f"there is no tab {name!r:.40}", hint=f"use {', '.join(TABS)}")
    answer, words = TABS[name](prepared, options, progress)
    data = answer.to_dict()
    return {
        "name": name,
        "data": data,
        "html": WRITES.get(name, answer_html)(data),
        "sentence": data.get("sentence", ""),
        "command": command(COMMANDS.get(name, name), keys, saved, words),
        **(
            helps_data(answer, prepared, keys, center)
            if name == "helps"
            else _drawn_data(prepared, answer, center, progress)
        ),
    }


def _drawn_data(prepared: Prepared, answer: Any, center: Array, progress: Tell) -> dict[str, Any]:
    """Data of an answer for the picture: the gravity ball, the film of a plan, the placed part."""
    if isinstance(answer, Orientation):
        directions = only_directions(prepared.assembly, prepared.contacts, answer, progress)
        return {"ball": build_directions(directions, center)}
    if isinstance(answer, Order):
        return {"film": build_film(answer, explain(answer), center)}
    if isinstance(answer, Places) and answer.prism is not None:
        return {"place": placed_part(answer.prism)}
    if isinstance(answer, _Moved) and answer.found.moves:
        return {"movement": build_movement(answer.found, answer.assembly, center)}
    return {}
