"""Answer of `kilter.plan`: steps in the order of assembly, with their proofs.

Between two steps the hands grip and release parts. The succession of these grips and releases is
not planned.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from kilter.analysis.decision.cascade import Decision, Word
from kilter.analysis.decision.open_question import AnsweredPair
from kilter.analysis.planning.order.locking import Locked
from kilter.analysis.planning.order.plan_step import VERDICTS, Step, lower_level
from kilter.analysis.planning.order.removal import Screw
from kilter.analysis.planning.states.holds import Cut, Holds
from kilter.analysis.planning.states.known_proofs import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Array
from kilter.errors import InputError
from kilter.mechanics.bundle import make_bundle
from kilter.tell.csv_cells import csv_text
from kilter.tell.html import InCells
from kilter.tell.levels import holds
from kilter.tell.numbers import count
from kilter.tell.plan_words import order_sentence
from kilter.tell.record import Answer, InPython, LevelWord, Record, Twist, UnitWord, Vector, key

# Proof of a plan as JSON data: its steps, the need for held parts, or that no order exists.


Stated = tuple[dict[str, Any], State, States]
"""A statement of a proof file: its description, the state that proves it, and all states."""


def order_proof(
    states: States,
    whole: State,
    steps: Sequence[Step],
    falling: Sequence[State],
    locked: Sequence[Locked],
    refused: Sequence[Holds[State]],
    rules: Mapping[str, Any],
    options: Mapping[str, Any],
) -> dict[str, Any]:
    """Proofs of a plan as data for a proof file.

    Arguments: `falling`: states of the parts that no order without holds reaches, each alone free
    on the reached parts.
    """
    names, proofs = states.assembly.names, []
    stated = _of_steps(states, whole, steps) if steps or not whole.free.any() else []
    if whole.stable is False:
        stated.append(({"about": "finished falls"}, whole, states))
    stated += [
        ({"about": "falls alone", "part": names[int(np.flatnonzero(entry.free)[0])]}, entry, states)
        for entry in falling
    ]
    stated += [
        (
            {
                "about": "locked",
                "part": names[entry.part],
                "multipliers": entry.multipliers.tolist(),
            },
            entry.state,
            states,
        )
        for entry in locked
    ]
    stated += [
        ({"about": "refused", "parts": _names(names, cut)}, cut.state, states)
        for known in refused
        for cut in known.cuts
    ]
    for about, state, of in stated:
        change: dict[str, Any] = {
            "without": [n for n, here in zip(names, state.present, strict=True) if not here],
            "held": states.held_names(state),
        }
        of = of.owner(state)
        proof = of.proof(state, options=dict(options))
        if about["about"] == "pressed":
            change["loads"] = proof["loads"]
        elif of in states.carried:
            change["gravity"] = of.assembly.gravity.tolist()
        elif of is not states:
            change["down"] = of.assembly.down.tolist()
        proofs.append(({**about, "change": change}, proof))
    return make_bundle("plan", proofs, rules=dict(rules))


def _of_steps(states: States, whole: State, steps: Sequence[Step]) -> list[Stated]:
    """List, for each proof of a plan, its description, its state and the `States` it belongs to."""
    names = states.assembly.names
    stated: list[Stated] = [({"about": "whole"}, whole, states)]
    for number, state in enumerate([whole, *(step.state for step in steps)] if steps else []):
        stated += [
            (
                {"about": "carried", "step": number},
                accelerated.judge(state.present, state.present & ~state.free),
                accelerated,
            )
            for accelerated in states.carried
        ]
    for number, step in enumerate(steps, 1):
        of = states if step.turned is None else step.turned
        stated.append((_step(step), step.state, of))
        if step.between is not None:
            stated.append(({"about": "turned", "step": number}, step.between, of))
        if step.pressed is not None and step.under is not None:
            stated.append(({"about": "pressed", "step": number}, step.pressed, step.under))
        if step.needs is None or not step.needs.fewest:
            continue
        for cut in step.needs.cuts:
            about = {"about": "not fewer", "step": number, "parts": _names(names, cut)}
            stated.append((about, cut.state, states))
    return stated


def _names(names: Sequence[str], cut: Cut[State]) -> list[str]:
    return [name for name, moves in zip(names, cut.parts, strict=True) if moves]


def _step(step: Step) -> dict[str, Any]:
    """A step of a plan as JSON data: its parts, path and held parts."""
    return {
        "about": "step",
        "parts": list(step.parts),
        "legs": [
            [list(leg.direction), leg.length if np.isfinite(leg.length) else None]
            for leg in step.legs
        ],
        "over": step.over,
    }


class Finished(Record):
    """Verdict and level of the finished assembly."""

    verdict: Word
    """Its verdict."""
    level: LevelWord | None
    """Its level."""


class Impossible(Record):
    """Proof that no order of assembly exists, or none with so few held parts."""

    kind: Literal["falls", "locking", "exhaustion", "closure"]
    """Kind of the proof."""
    holds: int | None = None
    """Number of held parts up to which no order exists; null: any number."""
    parts: Sequence[str]
    """Parts that the proof is about."""
    motions: Sequence[dict[str, Twist] | None] | None = None
    """Motions by part [length unit, rad]."""


class Fewest(Record):
    """The minimised quantity, and the scope of the proof."""

    what: str
    """The minimised quantity: holds, held-steps or turns."""
    least: Literal["always", "as-tried"] | None
    """Orders that the proof concerns: all, or those along the tried paths; null without a proof."""


class Search(Record):
    """Numbers of states, programs and other steps of the search for a plan."""

    states: int
    """Examined states."""
    programs: int
    """Solved programs."""
    sweeps: int
    """Collision tests."""
    no_goods: int
    """Stored motions."""
    exhausted: bool
    """Whether the search tried every removal."""
    hold: int
    """Largest number of parts allowed to be held at once."""


class Assumes(Record):
    """Assumptions of a plan."""

    directions: tuple[str | Vector, ...]
    """Directions of motion that were tried."""
    tolerance: float
    """Relative gap of the detection [-]."""
    screws: tuple[tuple[str, str], ...]
    """Bolts with their nuts."""
    groups: tuple[tuple[str, ...], ...]
    """Groups of parts that move together."""
    together: bool
    """Whether parts that block each other were allowed to move together."""
    press: float
    """Force that presses each part in [N]."""
    carried: float | Vector | None
    """Horizontal size or vector of the acceleration of the carrier [m/s^2]."""
    turn: bool
    """Whether the standing parts were allowed to be turned."""


class Order(InCells, Answer):
    """Answer of `kilter.plan`: an order of assembly, or the proof that no order exists."""

    answer: ClassVar[str] = "plan"

    require: LevelWord
    """Level that every step must reach."""
    units: UnitWord
    """Length unit."""
    base: tuple[str, ...]
    """Held parts of the file."""
    finished: Finished
    """Verdict and level of the finished assembly."""
    open_pairs: tuple[AnsweredPair, ...]
    """Open pairs of the finished assembly, the deciding pairs first."""
    steps: tuple[Step, ...]
    """Steps in the order of assembly; empty if no order was found. All steps of a given order."""
    precedence: tuple[tuple[str, str], ...]
    """Required pairs (earlier part, later part)."""
    best: tuple[str, ...]
    """Parts that can be inserted last, the last part first, if no order was found."""
    given: bool
    """Whether the caller gave the order."""
    fewest: Fewest
    """The minimised quantity, and the scope of the proof."""
    search: Search
    """Numbers of steps of the search."""
    assumes: Assumes
    """Assumptions."""
    interrupted: bool
    """Whether an interrupt stopped the search."""
    time_limit: float | None
    """Limit that stopped the search [s]; null if the search did not reach it."""
    warnings: list[str]
    """Warnings about file, geometry and contacts."""
    seconds: dict[str, float]
    """Duration of each stage [s]."""
    states: InPython[States]
    """States of the assembly."""
    falling: InPython[tuple[State, ...]]
    """Proof that no order without holds exists: a state for each part that no such order reaches.

    In it the part falls alone on all reached parts.
    """
    locked: InPython[tuple[Locked, ...]]
    """Proof that no order exists for any holds: parts that lock each other."""
    refused: InPython[tuple[Holds[State], ...]]
    """Proof that no order exists with up to `search.hold` held parts, along any paths.

    States that need more holds together bar every order.
    """
    whole: InPython[State]
    """State of the finished assembly."""
    decision: InPython[Decision]
    """Decision on the finished assembly by the cascade of `kilter.check`."""
    never_held: InPython[tuple[str, ...]]
    """Parts that must not be held."""
    screws: InPython[tuple[Screw, ...]]
    """Bolts with their nuts."""
    accelerations: InPython[Array]
    """Accelerations at which every state is proved, shape (n, 3) [m/s^2].

    Every state carries all between them.
    """

    @property
    @key
    def assumed(self) -> tuple[str, ...]:
        """Options that are assumed: "floor" or "ground" if the file holds no part, "units"."""
        return tuple(self.states.assembly.assumed)

    @property
    @key
    def verdict(self) -> Literal["found", "none-found", "impossible", "undecided", "fails"]:
        """Verdict of the plan as a word.

        "found": an order, which has no steps if every part is held; "none-found";
        "impossible": it is proved that no order exists, or the finished assembly falls;
        "undecided": open pairs decide whether the finished assembly holds; "fails": in the given
        order parts fall, touch nothing or come too early, for every path.
        """
        if not self.whole.stable:
            return "undecided" if self.whole.stable is None else "impossible"
        fails = [step for step in self.steps if step.fails]
        if not fails and (self.steps or not self.whole.free.any()):
            return "found"
        if fails:
            return "fails" if any(step.broken for step in fails) else "none-found"
        none = self.locked or self.refused or (self.falling and self.search.hold == 0)
        return "impossible" if none else "none-found"

    @property
    @key
    def found(self) -> bool:
        """Whether an order was found, or the given order is valid."""
        return self.verdict == "found"

    @property
    @key
    def level(self) -> LevelWord | None:
        """Lowest verdict level over all steps and the finished assembly; None without an order."""
        levels = [step.level for step in self.steps if step.level is not None]
        if not levels:
            return self.decision.level if self.found else None
        order = list(VERDICTS)
        return lower_level(max(levels, key=order.index), self.decision.level)

    @property
    @key
    def holds(self) -> bool:
        """Whether an order was found and every step reaches the required verdict level."""
        return self.found and holds(self.level, self.require)

    @property
    @key
    def holds_max(self) -> int:
        """Largest number of parts that are held at once in the order."""
        return max((len(step.held) for step in self.steps), default=0)

    @property
    @key
    def turns(self) -> int:
        """Number of times that the order turns the standing parts."""
        return sum(step.between is not None for step in self.steps)

    @property
    @key
    def held_steps(self) -> int:
        """Number of steps of the order during which a part is held."""
        return sum(bool(step.held) for step in self.steps)

    @property
    @key
    def impossible(self) -> Impossible | None:
        """Proof that no order exists, or none without held parts."""
        names = self.states.assembly.names
        if self.whole.stable is False:
            moving, motion = self.whole.moving, self.whole.motion
            motions = None if motion is None else [_motions(motion.motion, names, moving)]
            return Impossible(kind="falls", parts=moving, motions=motions)
        if self.locked:
            return Impossible(kind="locking", parts=[names[core.part] for core in self.locked])
        if self.refused:
            bars = np.any([cut.parts for known in self.refused for cut in known.cuts], axis=0)
            parts = np.array(names)[bars].tolist()
            return Impossible(kind="exhaustion", holds=self.search.hold, parts=parts)
        if not self.falling:
            return None
        alone = [names[int(np.flatnonzero(state.free)[0])] for state in self.falling]
        alone_motions = [
            None if state.motion is None else _motions(state.motion.motion, names, [name])
            for name, state in zip(alone, self.falling, strict=True)
        ]
        return Impossible(kind="closure", holds=0, parts=alone, motions=alone_motions)

    @property
    @key
    def sentence(self) -> str:
        """The answer in a sentence or two."""
        return order_sentence(self.data_without("sentence"))

    def table(self) -> str:
        """The steps of the plan as CSV text: a line for each step, lists in a cell joined by ``;``.

        Columns: step, part, held, grips, releases, the direction of insertion (x, y, z), touches,
        level, pose of the part in the world frame once it is seated (px, py, pz [length unit],
        quaternion qw, qx, qy, qz), and the path: positions relative to the seat, the last zero.
        """
        head = "step,part,held,grips,releases,x,y,z,touches,level,px,py,pz,qw,qx,qy,qz,path"
        rows: list[list[Any]] = [head.split(",")]
        for k, step in enumerate(self.steps, 1):
            pose = self.states.assembly[step.part].pose
            path = [" ".join(f"{x:.12g}" for x in place) for place in step.path]
            cells = [
                str(k),
                *map(list, (step.parts, step.held, step.grips, step.releases)),
                *(f"{x:.12g}" for x in step.direction or [math.nan] * 3),
                list(step.touches),
                step.level or "",
                *(f"{x:.12g}" for x in (*pose.position, *pose.rotation)),
                ";".join(path),
            ]
            rows.append(cells)
        return csv_text(rows)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proofs of the steps, or proof that no order exists, as JSON data for `kilter.verify`.

        `options` are those with which the file is read.

        Raises
        ------
        InputError
            If no order was found and its impossibility is not proved.
        """
        if self.verdict in ("none-found", "fails", "undecided"):
            raise InputError(
                "no order was found and nothing is proved, so there is no proof to write"
            )
        names = self.states.assembly.names
        rules = {
            "hold": self.search.hold,
            "press": self.assumes.press,
            "carried": self.accelerations.tolist(),
            "turn": self.assumes.turn,
            "precedence": [list(pair) for pair in self.precedence],
            "groups": [list(group) for group in self.assumes.groups],
            "never_held": list(self.never_held),
            "screws": [[names[s.bolt], names[s.nut], list(s.axis)] for s in self.screws],
        }
        return order_proof(
            self.states,
            self.whole,
            self.steps,
            self.falling,
            self.locked,
            self.refused,
            rules,
            options or {},
        )

    def __repr__(self) -> str:
        if not self.found:
            return f"<Order: {self.verdict}>"
        steps = count(len(self.steps), "step")
        return f"<Order: found, {steps}, {self.held_steps} with parts held>"

    def __bool__(self) -> bool:
        raise TypeError("an order is neither true nor false: use .found")


def _motions(motion: Array, names: Sequence[str], moving: Iterable[str]) -> dict[str, Twist]:
    """Motions of the moving parts by name, of all motions, shape (N, 6)."""
    return {name: motion[names.index(name)] for name in moving}
