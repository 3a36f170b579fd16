"""Verify a plan file independently of the search: succession of the steps, rules and paths.

`kilter.analysis.verification` verifies by forces or a motion that each state holds or falls. This
module verifies that the proofs together form an order:

- each state follows from the state before by the parts of a step, up to the whole assembly, under
  the gravity, friction and loads of the file;
- every inserted part touches a standing part, and no part blocks its path: the collision tests
  are repeated;
- the held parts stand, may be held, and are no more than the rules allow;
- if the states must carry accelerations: each step and the finished assembly has a proof at each
  of them, and no other acceleration is used by a motion;
- the order keeps the precedence, and groups move together; a nut moves along the axis of its bolt,
  and the thread is detected again;
- if the file claims that fewer holds are not enough: no smaller set has a part of each motion.

For an impossibility the module verifies one of three claims. The states that need more holds than
allowed bar every order along any paths. The parts that fall alone are exactly those that no order
without holds reaches. The multipliers prove that the other parts and the base lock each part.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.planning.order.locking import holding_rows, opening, shuts
from kilter.analysis.planning.order.plan import leads_nowhere
from kilter.analysis.planning.order.removal import find_screws, press_loads
from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.analysis.planning.order.turning import OPPOSITE
from kilter.analysis.planning.states.holds import bits_of, members
from kilter.analysis.planning.states.known_proofs import build_state_programs
from kilter.analysis.smallest_set import least_hitting_set
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import some_names
from kilter.rigid import unit

# Rules of an order of assembly, read from its proof file: holds, precedence, groups, threads.


AXIS = 1e-9
"""Largest sine of the angle between a path along a thread and its axis [-]."""


@dataclass(frozen=True, slots=True)
class Rules:
    """Rules that an order of assembly must keep."""

    hold: int
    """Largest number of parts held at once."""
    precedence: list[tuple[str, str]]
    groups: list[set[str]]
    """Parts that move together."""
    never_held: set[str]
    threads: dict[tuple[str, str], tuple[float, float, float]]
    """Axis of the thread (unit), detected again, by the names of bolt and nut."""

    @classmethod
    def of(cls, assembly: Assembly, contacts: ContactSet, data: Mapping[str, Any]) -> Rules:
        """Read the rules of an order from the data of a proof file.

        Raises `InputError` if a name matches no part, or no thread joins a bolt and its nut.
        """
        screws = [(bolt, nut) for bolt, nut, _ in data["screws"]]
        names = assembly.names
        threads = find_screws(contacts, screws)
        axes = {(names[screw.bolt], names[screw.nut]): screw.axis for screw in threads}
        return cls(
            int(data["hold"]),
            [(first, second) for first, second in data["precedence"]],
            [set(group) for group in data["groups"]],
            set(data["never_held"]),
            {pair: axes[pair] for pair in screws},
        )

    def broken(self, step: Mapping[str, Any], standing: set[str]) -> Iterator[str]:
        """Yield the rules that a step breaks if it follows after the standing parts."""
        parts, held = set(step["parts"]), step["change"]["held"]
        present = standing | parts
        if len(held) > self.hold or len(set(held)) < len(held):
            yield f"{len(held)} parts are held, more than {self.hold}"
        for name in held:
            if name in self.never_held or name not in standing:
                yield f"{name!r} is held, but must not be held"
        for first, second in self.precedence:
            if second in parts and first not in present:
                yield f"{second!r} is inserted before {first!r}"
        for group in self.groups:
            if parts & group and not group <= parts:
                yield f"{min(group - parts)!r} does not move with its group"
        for bolt, nut in self.threads:
            if bolt in parts and nut in standing:
                yield f"the nut {nut!r} is inserted before its bolt {bolt!r}"
        yield from self._thread(parts, step["over"], step["legs"], standing)

    def _thread(
        self, parts: set[str], over: str | None, legs: Any, standing: set[str]
    ) -> Iterator[str]:
        """Yield the reasons why a nut does not move along the thread that its step names."""
        on = [bolt for bolt, nut in self.threads if nut in parts and bolt in standing]
        if over is None and not on:
            return
        nut = min(parts)
        if over not in on or len(parts) > 1:
            yield f"{nut!r} moves along {over!r}, which is not its bolt or not in place"
            return
        axis = np.array(self.threads[over, nut])
        if len(legs) != 1 or np.linalg.norm(np.cross(axis, legs[0][0])) > AXIS:
            yield f"{nut!r} does not move along the axis of its thread"


About = Mapping[str, Any]
CHANGES = {"without", "held"}
MORE = {
    "pressed": {"loads"},
    "step": {"down"},
    "turned": {"down"},
    "carried": {"gravity"},
    "not fewer": {"gravity"},
    "falls alone": {"gravity"},
    "finished falls": {"gravity"},
    "refused": {"gravity"},
}
"""Keys of a file that a proof of this kind may change."""


def wrong_order(
    assembly: Assembly, contacts: ContactSet, bundle: Mapping[str, Any], verdicts: Sequence[str]
) -> Iterator[str]:
    """Yield the reasons why the proofs in a plan file show neither an order nor that none exists.

    The statements have the form of `kilter.analysis.planning.plan_proof_form`.
    """
    entries: dict[str, list[About]] = {kind: [] for kind in FALLS}
    for entry, verdict in zip(bundle["proofs"], verdicts, strict=True):
        kind, change = entry["about"], entry["change"]
        if kind not in FALLS:
            yield f"it has a proof of the unknown kind {kind!r:.40}"
            continue
        entries[kind].append(entry)
        if (verdict == "unstable") != FALLS[kind]:
            yield f"{kind} {_subject_names(entry)}: its proof gives the verdict {verdict}"
        if set(change) - CHANGES - MORE.get(kind, set()):
            subject = _subject_names(entry)
            more = "it changes more than which parts are present and which are held"
            yield f"{kind} {subject}: {more}"
    shows = ["step", "finished falls", "locked", "refused"]
    if not bundle["rules"]["hold"]:
        shows.append("falls alone")  # such parts exclude only orders without held parts
    if not (any(entries[kind] for kind in shows) or _is_held(assembly, entries)):
        yield "it has neither an order nor a proof that there is none"
    if entries["finished falls"] and not _is_finished(entries["finished falls"]):
        yield "the motion is not a motion of the finished assembly"
    yield from _wrong_accelerations(assembly, bundle["rules"], entries)
    yield from _wrong_construction(assembly, contacts, bundle["rules"], entries)
    yield from _wrong_impossibility(assembly, contacts, bundle["rules"], entries)


def _wrong_accelerations(
    assembly: Assembly, given: Mapping[str, Any], entries: Mapping[str, list[About]]
) -> Iterator[str]:
    """Yield the reasons why the states do not carry the accelerations that the rules require."""
    required = [assembly.gravity - np.array(one) for one in given.get("carried") or []]
    size = float(np.linalg.norm(assembly.gravity))

    def of_entry(entry: About) -> int | None:
        """Position of the gravity of an entry among the required ones; None for another."""
        felt = np.array(entry["change"]["gravity"], dtype=float)
        same = [k for k, one in enumerate(required) if np.abs(felt - one).max() <= SAME_LOAD * size]
        return same[0] if same else None

    changed = [e for group in entries.values() for e in group if "gravity" in e["change"]]
    if any(of_entry(entry) is None for entry in changed):
        yield "a proof is at an acceleration that the rules do not require"
    states = [{"without": [], "held": []}, *(step["change"] for step in entries["step"])]
    found: dict[int, set[int | None]] = {}
    for entry in entries["carried"]:
        number, change = entry["step"], entry["change"]
        if number not in range(len(states)) or any(
            change[key] != states[number][key] for key in CHANGES
        ):
            yield f"carried accelerations of step {number}: the proof is about another state"
        else:
            found.setdefault(number, set()).add(of_entry(entry))
    if entries["step"]:
        for number in range(len(states)):
            if not set(range(len(required))) <= found.get(number, set()):
                where = f"step {number}" if number else "the finished assembly"
                yield f"{where} is not proved at every required acceleration"


def _is_finished(entries: list[About]) -> bool:
    """Whether the entries of a plan file are a single proof of the finished assembly."""
    changes = [
        {key: value for key, value in entry["change"].items() if key != "gravity"}
        for entry in entries
    ]
    return changes == [{"without": [], "held": []}]


def _is_held(assembly: Assembly, entries: Mapping[str, list[About]]) -> bool:
    """Whether all parts are held and the finished assembly is proved, so that no step is needed."""
    return bool(assembly.geometry.grounded.all()) and _is_finished(entries["whole"])


def _wrong_construction(
    assembly: Assembly,
    contacts: ContactSet,
    given: Mapping[str, Any],
    entries: Mapping[str, list[About]],
) -> Iterator[str]:
    """Yield the reasons why the steps of a plan do not build the assembly under its rules."""
    if not entries["step"]:
        kinds = (
            "not fewer",
            "pressed",
            "turned",
            "carried",
            *([] if _is_held(assembly, entries) else ["whole"]),
        )
        if any(entries[kind] for kind in kinds):
            yield "it is about an order, but has no steps"
        return
    if not _is_finished(entries["whole"]):
        yield "the finished assembly has no proof"
    rules = Rules.of(assembly, contacts, given)
    yield from _wrong_steps(assembly, contacts, rules, entries["step"])
    yield from _enough(assembly, rules, entries["step"], entries["not fewer"])
    yield from _wrong_pressing(assembly, float(given["press"]), entries["step"], entries["pressed"])
    yield from _wrong_turns(assembly, bool(given["turn"]), entries["step"], entries["turned"])


def _wrong_impossibility(
    assembly: Assembly,
    contacts: ContactSet,
    given: Mapping[str, Any],
    entries: Mapping[str, list[About]],
) -> Iterator[str]:
    """Yield the reasons why the proofs of a plan do not exclude every order under its rules."""
    excludes = bool(entries["falls alone"] or entries["refused"])
    if excludes and (given["groups"] or given["turn"]):
        yield (
            "a proof that no order exists is valid only if parts move one at a time and gravity "
            "does not turn"
        )
    yield from _wrong_closure(assembly, entries["falls alone"])
    if entries["refused"]:
        rules = Rules.of(assembly, contacts, given)
        yield from _wrong_exhaustion(assembly, contacts, rules, entries["refused"])
    if entries["locked"] and given["groups"]:
        yield "parts that lock each other may leave together as a group"
    if entries["locked"]:
        yield from _wrong_locking(assembly, contacts, given["screws"], entries["locked"])


FALLS = {
    "whole": False,
    "step": False,
    "not fewer": True,
    "falls alone": True,
    "finished falls": True,
    "refused": True,
    "locked": False,
    "pressed": False,
    "carried": False,
    "turned": False,
}
"""Kinds of proof in a plan, and whether the state of such a proof falls."""


def _subject_names(entry: About) -> str:
    """Names of the parts that a proof in a plan file concerns."""
    return some_names([entry["part"]] if "part" in entry else entry.get("parts", []))


def _wrong_steps(
    assembly: Assembly, contacts: ContactSet, rules: Rules, steps: Sequence[About]
) -> Iterator[str]:
    """Yield the reasons why the steps of a plan do not lead from the base to the whole assembly."""
    sweeps = Sweeps(contacts)
    standing = {part.name for part in assembly if part.grounded}
    touching = _neighbours_of_parts(assembly, contacts)
    for number, step in enumerate(steps, 1):
        parts, over = step["parts"], step["over"]
        moved = [assembly.index_of(part) for part in parts]
        said, reasons = some_names(parts), [*rules.broken(step, standing)]
        if standing.intersection(parts) or len(set(parts)) < len(parts) or not parts:
            reasons.append(f"{said} is standing already")
        if set(step["change"]["without"]) != set(assembly.names) - standing:
            reasons.append("its state differs from the parts that stand before the step")
        if not _hang_on(standing, parts, touching):
            reasons.append(f"{said} touches no standing part")
        is_present = np.array([name in standing and name != over for name in assembly.names])
        if any(
            _is_blocked(assembly, sweeps, part, bits_of(is_present), step["legs"]) for part in moved
        ):
            reasons.append(f"a part blocks the path of {said}")
        yield from (f"step {number}: {reason}" for reason in reasons)
        standing.update(parts)
    missing = set(assembly.names) - standing
    if missing:
        yield f"no step inserts {min(missing)!r}"


def _hang_on(standing: set[str], parts: Sequence[str], touching: dict[str, set[str]]) -> bool:
    """Whether each of the inserted `parts` is connected by contacts with the standing parts."""
    reached, left = set(standing), set(parts)
    while left:
        near = {part for part in left if touching[part] & reached}
        if not near:
            return False
        reached |= near
        left -= near
    return True


def _neighbours_of_parts(assembly: Assembly, contacts: ContactSet) -> dict[str, set[str]]:
    """For each part, the names of the parts that it touches or is joined to."""
    neighbours: dict[str, set[str]] = {name: set() for name in assembly.names}
    pairs = [(assembly.names[a], assembly.names[b]) for a, b in contacts.patch_parts.tolist()]
    for a, b in [*pairs, *(joint.parts for joint in assembly.joints)]:
        for first, other in ((a, b), (b, a)):
            if first in neighbours:  # the ground is no part
                neighbours[first].add(other)
    return neighbours


def _is_blocked(assembly: Assembly, sweeps: Sweeps, part: int, present: int, legs: Any) -> bool:
    """Whether a present part blocks the path, or the path ends before the part is out."""
    start = np.zeros(3)
    others = present & ~(1 << part)
    for vector, length in legs:
        x, y, z = (float(component) for component in unit(np.array(vector, dtype=float)).round(12))
        distance = np.inf if length is None else float(length)
        if not distance > 0:
            return True
        if np.isinf(distance) and not start.any():
            return sweeps.stops(part, others, (x, y, z))
        if any(
            sweeps.pair_stops(part, other, (x, y, z), distance=distance, start=start)
            for other in members(others, len(assembly)).tolist()
        ):
            return True
        if np.isinf(distance):
            return False
        start = start + distance * np.array([x, y, z])
    return True


def _enough(
    assembly: Assembly, rules: Rules, steps: Sequence[About], cuts: Sequence[About]
) -> Iterator[str]:
    """Yield the steps in which the given motions do not prove that fewer held parts fail."""
    base = {part.name for part in assembly if part.grounded}
    sets: dict[int, list[int]] = {}
    for cut in cuts:
        number, parts, change = cut["step"], set(cut["parts"]), cut["change"]
        standing = set(assembly.names) - set(change["without"])
        known = number in range(1, len(steps) + 1)
        if not known or set(steps[number - 1]["change"]["without"]) != set(change["without"]):
            yield f"fewest held parts of step {number}: the proof is about another state"
        elif set(change["held"]) != standing - base - parts:
            yield f"fewest held parts of step {number}: other parts are free in the proof"
        else:
            may = np.array([name in parts - rules.never_held for name in assembly.names])
            sets.setdefault(number, []).append(bits_of(may))
    for number, values in sets.items():
        held = len(steps[number - 1]["change"]["held"])
        if least_hitting_set(values, held - 1) is not None:
            yield f"step {number}: fewer than {held} held parts may be enough"


def _wrong_closure(assembly: Assembly, falling: Sequence[About]) -> Iterator[str]:
    """Yield the parts without a proof that they fall, if all reachable parts stand and are held."""
    alone = {entry["part"] for entry in falling}
    base = {part.name for part in assembly if part.grounded}
    reached = set(assembly.names) - alone
    for entry in falling:
        change = entry["change"]
        present = set(assembly.names) - set(change["without"])
        if present != reached | {entry["part"]} or set(change["held"]) != reached - base:
            yield f"{entry['part']!r} is not proved to fall from the parts that can stand"


def _wrong_exhaustion(
    assembly: Assembly, contacts: ContactSet, rules: Rules, cuts: Sequence[About]
) -> Iterator[str]:
    """Yield the reasons why the given motions do not exclude every order for any paths."""
    names, grounded = assembly.names, assembly.geometry.grounded
    base = {part.name for part in assembly if part.grounded}
    motions: dict[int, list[int]] = {}
    for cut in cuts:
        parts, change = set(cut["parts"]), cut["change"]
        standing = set(names) - set(change["without"])
        if set(change["held"]) != standing - base - parts:
            yield f"rejected state of {_subject_names(cut)}: other parts are free in the proof"
            return
        present = bits_of(np.array([name in standing for name in names]))
        may = bits_of(np.array([name in parts - rules.never_held for name in names]))
        motions.setdefault(present, []).append(may)
    touching = _neighbours_of_parts(assembly, contacts)

    def goes_on(part: int, rest: int) -> bool:
        """Whether the parts `rest` (a bit set) may remain after the removal of `part`."""
        present = {name for k, name in enumerate(names) if rest >> k & 1}
        moved = names[part.bit_length() - 1]
        early = any(first == moved and second in present for first, second in rules.precedence)
        if early or not _hang_on(base, sorted(present - base), touching):
            return False
        return least_hitting_set(motions.get(rest, []), rules.hold) is not None

    whole = bits_of(np.ones(len(names), dtype=bool))
    if not leads_nowhere(whole, bits_of(grounded), goes_on):
        yield "the motions do not exclude every order"


def _wrong_locking(
    assembly: Assembly, contacts: ContactSet, threads: Any, locked: Sequence[About]
) -> Iterator[str]:
    """Yield the parts that no multipliers prove to be blocked by the other parts and the base."""
    base = {part.name for part in assembly if part.grounded}
    core = {entry["part"] for entry in locked}
    screws = frozenset(
        (assembly.index_of(bolt), assembly.index_of(nut)) for bolt, nut, _ in threads
    )
    states = build_state_programs(assembly, contacts)
    for entry in locked:
        name, change = entry["part"], entry["change"]
        standing = set(assembly.names) - set(change["without"])
        if name in base or standing != core | base or set(change["held"]) != core - {name}:
            yield f"the proof for {name!r} has other parts than the base and the locked parts"
            continue
        present = np.array([other in standing for other in assembly.names])
        held = present & (np.array(assembly.names) != name)
        program, part = states.of(present, held), assembly.index_of(name)
        multipliers = np.array(entry["multipliers"], dtype=float)
        rows = holding_rows(program, part, screws)
        if multipliers.shape != rows.shape or not shuts(
            opening(program, part, rows), multipliers[rows]
        ):
            yield f"the multipliers do not prove that {name!r} cannot move"


def _wrong_pressing(
    assembly: Assembly, force: float, steps: Sequence[About], pressed: Sequence[About]
) -> Iterator[str]:
    """Yield the steps without a proof that the parts withstand the pressing force."""
    if sorted(entry["step"] for entry in pressed) != (
        list(range(1, len(steps) + 1)) if force else []
    ):
        yield "not every step has a proof with the pressing force"
        return
    mass = dict(zip(assembly.names, assembly.geometry.mass.tolist(), strict=True))
    given_loads = [(load.part, load.force, load.torque, load.point) for load in assembly.loads]
    for entry in pressed:
        step = steps[entry["step"] - 1]
        change, parts = entry["change"], step["parts"]
        x, y, z = (-float(value) for value in unit(np.array(step["legs"][0][0], dtype=float)))
        press = press_loads(parts, [mass[name] for name in parts], (x, y, z), force)
        wanted = given_loads + [
            (load["part"], load["force"], load["torque"], None) for load in press
        ]
        given = [tuple(load[key] for key in LOAD) for load in change["loads"]]
        standing = set(step["change"]["without"]) - set(parts)
        if set(change["without"]) != standing or change["held"] != step["change"]["held"]:
            yield f"step {entry['step']}: the proof presses parts that the step does not insert"
        elif len(given) != len(wanted) or not all(map(_same_load, given, wanted)):
            yield f"step {entry['step']}: the proof has another pressing force"


LOAD = ("part", "force", "torque", "point")
"""Keys of a load in the file."""


def _same_load(first: Sequence[Any], other: Sequence[Any]) -> bool:
    """Whether two loads of a file are equal up to rounding."""
    if first[0] != other[0] or (first[3] is None) != (other[3] is None):
        return False
    pairs = [(a, b) for a, b in zip(first[1:], other[1:], strict=True) if a is not None]
    return all(np.allclose(a, b, rtol=SAME_LOAD, atol=0) for a, b in pairs)


SAME_LOAD = 1e-9
"""Relative rounding error of a load in a file [-]."""


def _wrong_turns(
    assembly: Assembly, may: bool, steps: Sequence[About], turned: Sequence[About]
) -> Iterator[str]:
    """Yield the reasons why turns of the parts between steps are not proved or not allowed."""
    given_down = assembly.down
    downs = [
        unit(np.array(entry["change"].get("down", given_down), dtype=float)) for entry in steps
    ] + [given_down]
    following = [entry["change"] for entry in steps[1:]] + [{"without": [], "held": []}]
    between = {entry["step"]: entry["change"] for entry in turned}
    if turned and not may:
        yield "it has turns, but its rules do not allow turns"
    for number, after in enumerate(following, 1):
        before, then = downs[number - 1 : number + 1]
        change = between.pop(number, None)
        if np.array_equal(before, then):
            continue
        if change is None or any(change[key] != after[key] for key in CHANGES):
            yield f"after step {number}: the turned parts are not proved to hold before the turn"
        elif not np.array_equal(unit(np.array(change["down"], dtype=float)), before):
            yield f"after step {number}: the turn starts from another direction"
        elif np.linalg.norm(before + then) < OPPOSITE:
            yield f"after step {number}: the turn is by 180 degrees, so its axis is not determined"
    if between:
        yield "it has a turn without a step or without a change of direction"
