"""Order: the answer of `plan`, its steps forwards, each with what proves it.

Between two steps some parts are gripped and some let go; in which succession the hands do so is not
asked.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.decision.decision import Decision
from kilter.analysis.open_pairs.open_question import open_pairs_answer
from kilter.analysis.planning.order.locking import Locked
from kilter.analysis.planning.order.order_proof import order_proof
from kilter.analysis.planning.order.plan_step import FAR, VERDICTS, Step, lower_level
from kilter.analysis.planning.order.removal import Screw
from kilter.analysis.planning.states.holds import Holds
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.errors import InputError
from kilter.tell.cells import InCells
from kilter.tell.html import html_of
from kilter.tell.levels import holds
from kilter.tell.numbers import count
from kilter.tell.plan_words import order_sentence

__all__ = ["Order"]


@dataclass(frozen=True, slots=True, eq=False)
class Order(InCells):
    """What `plan` found.

    Attributes
    ----------
    states : States
        Of the assembly.
    steps : tuple of Step
        In the order of assembly; empty where none was found. Of a given order all of them.
    best : tuple of str
        Where none was found: the parts that could be put in last, the last first.
    falling : tuple of State
        Where no order without holds exists: each part that cannot be reached by one, with the
        motion of it alone on all that can.
    locked : tuple of Locked
        Where no order exists, whatever is held: parts that lock one another.
    refused : tuple of Holds
        Where no order exists with up to `hold` held, whatever the paths: the states that bar them
        all, each with the motions for which more must be held.
    whole : State
        The finished assembly.
    finished : Decision
        The decision about the finished assembly, by the cascade of `kilter.check`.
    hold : int
        Most parts that might be held at once.
    require : str
        The level that is asked of every step.
    precedence : tuple of pairs of str
        That the order keeps to, as asked for.
    never_held : tuple of str
        Parts that were not to be held.
    directions : tuple
        That were tried.
    screws : tuple of Screw
    moved_as_one : tuple of tuples of str
        Groups that were asked for.
    together : bool
        Whether parts that stop one another might move as one.
    press : float
        Force with which parts are pressed in [N].
    turn : bool
        Whether what stands might be turned.
    given : bool
        Whether the order was given and judged, not searched.
    fewest : {"holds", "held-steps", "turns"}
        What there was to be least of.
    least : {"always", "as-tried"} or None
        Whether no order at all has less of it; none along the ways that were tried; or open.
    exhausted, interrupted : bool
        Whether the search came to its end; whether it was stopped from outside.
    time_limit : float or None
        What cut the search short [s].
    counts : mapping
    seconds : mapping
        Of each stage [s].
    """

    states: States
    steps: tuple[Step, ...]
    best: tuple[str, ...]
    falling: tuple[State, ...]
    locked: tuple[Locked, ...]
    refused: tuple[Holds[State], ...]
    whole: State
    finished: Decision
    hold: int
    require: str
    precedence: tuple[tuple[str, str], ...]
    never_held: tuple[str, ...]
    directions: tuple[Any, ...]
    screws: tuple[Screw, ...]
    moved_as_one: tuple[tuple[str, ...], ...]
    together: bool
    press: float
    turn: bool
    given: bool
    fewest: str
    least: str | None
    exhausted: bool
    interrupted: bool
    time_limit: float | None
    counts: Mapping[str, int]
    seconds: Mapping[str, float]

    @property
    def verdict(self) -> str:
        """What came of it.

        "found"; "impossible": no order exists, that is proved, or the finished assembly falls;
        "none-found"; "undecided": open pairs decide whether the finished assembly holds; of a
        given order "fails": parts would fall, touch nothing, or come too early, whatever the ways.
        """
        if not self.whole.stable:
            return "undecided" if self.whole.stable is None else "impossible"
        fails = [step for step in self.steps if step.fails]
        if self.steps and not fails:
            return "found"
        if fails:
            return "fails" if any(step.broken for step in fails) else "none-found"
        none = self.locked or self.refused or (self.falling and self.hold == 0)
        return "impossible" if none else "none-found"

    @property
    def found(self) -> bool:
        """Whether there is an order, or the given one is one."""
        return self.verdict == "found"

    @property
    def level(self) -> str | None:
        """The lowest level of its states, the finished assembly included; None without steps."""
        levels = [step.level for step in self.steps if step.level is not None]
        if not levels:
            return None
        order = list(VERDICTS)
        return lower_level(max(levels, key=order.index), self.finished.level)

    @property
    def holds(self) -> bool:
        """Whether it was found and every step reaches the level that is asked for."""
        return self.found and holds(self.level, self.require)

    @property
    def holds_max(self) -> int:
        """Most parts that are held at once."""
        return max((len(step.held) for step in self.steps), default=0)

    @property
    def turns(self) -> int:
        """How often all that stands is turned."""
        return sum(step.between is not None for step in self.steps)

    @property
    def held_steps(self) -> int:
        """Steps during which a part is held."""
        return sum(bool(step.held) for step in self.steps)

    def to_dict(self) -> dict[str, Any]:
        """The answer as JSON data, that of ``kilter plan --json``."""
        assembly = self.states.assembly
        answer: dict[str, Any] = {
            "found": self.found,
            "verdict": self.verdict,
            "level": self.level,
            "holds": self.holds,
            "require": self.require,
            "holds_max": self.holds_max,
            "held_steps": self.held_steps,
            "turns": self.turns,
            "units": assembly.units,
            "base": [part.name for part in assembly if part.grounded],
            "steps": [self._step(step) for step in self.steps],
            "finished": {"verdict": self.finished.verdict, "level": self.finished.level},
            "open_pairs": open_pairs_answer(assembly, self.states.contacts, self.finished.question),
            "precedence": [list(pair) for pair in self.precedence],
            "impossible": self._impossible(),
            "best": list(self.best),
            "given": self.given,
            "fewest": {"what": self.fewest, "least": self.least},
            "search": {**self.counts, "exhausted": self.exhausted, "hold": self.hold},
            "assumes": {
                "directions": [d if isinstance(d, str) else list(d) for d in self.directions],
                "tolerance": self.states.contacts.tolerance.relative_gap,
                "screws": [[assembly.names[s.bolt], assembly.names[s.nut]] for s in self.screws],
                "groups": [list(group) for group in self.moved_as_one],
                "together": self.together,
                "press": self.press,
                "turn": self.turn,
            },
            "interrupted": self.interrupted,
            "time_limit": self.time_limit,
            "warnings": self.states.contacts.remarks(),
            "seconds": {key: round(value, 6) for key, value in self.seconds.items()},
        }
        return {**answer, "sentence": order_sentence(answer)}

    def _step(self, step: Step) -> dict[str, Any]:
        far = FAR * float(np.ptp(self.states.assembly.geometry.vertices, axis=0).max())
        return {
            "parts": list(step.parts),
            "direction": None if step.direction is None else list(step.direction),
            "path": step.path(far).tolist(),
            "over": step.over,
            "touches": list(step.touches),
            "rubs": list(step.rubs),
            "held": list(step.held),
            "grips": list(step.grips),
            "releases": list(step.releases),
            "down": (self.states if step.turned is None else step.turned).assembly.down.tolist(),
            "verdict": "unstable" if step.level is None else VERDICTS[step.level],
            "level": step.level,
            "fails": list(step.fails),
        }

    def _impossible(self) -> dict[str, Any] | None:
        """Why there is no order, or none without holds."""
        if self.whole.stable is False:
            motion = self.whole.motion
            moving = self.whole.moving
            index = self.states.assembly.index
            motions = (
                None
                if motion is None
                else [{name: motion.motion[index[name]].tolist() for name in moving}]
            )
            return {"kind": "falls", "holds": None, "parts": moving, "motions": motions}
        if self.locked:
            parts = [self.states.assembly.names[one.part] for one in self.locked]
            return {"kind": "locking", "holds": None, "parts": parts, "motions": None}
        names = self.states.assembly.names
        if self.refused:
            bars = np.any([cut.parts for known in self.refused for cut in known.cuts], axis=0)
            parts = np.array(names)[bars].tolist()
            return {"kind": "exhaustion", "holds": self.hold, "parts": parts, "motions": None}
        if not self.falling:
            return None
        alone = [names[int(np.flatnonzero(state.free)[0])] for state in self.falling]
        return {
            "kind": "closure",
            "holds": 0,
            "parts": alone,
            "motions": [
                None if state.motion is None
                else {name: state.motion.motion[names.index(name)].tolist()}
                for name, state in zip(alone, self.falling, strict=True)
            ],
        }  # fmt: skip

    def table(self) -> str:
        """The steps as CSV text: a line each, what is in one cell joined by ``;``.

        Columns: step, part, held, grips, releases, the direction of insertion (x, y, z), touches,
        level, the place of the part's own frame in the world once it is in (px, py, pz [length
        unit], quaternion qw, qx, qy, qz), and its path: places relative to that, the last zero.
        """
        rows = ["step,part,held,grips,releases,x,y,z,touches,level,px,py,pz,qw,qx,qy,qz,path"]
        for k, step in enumerate(self.to_dict()["steps"], 1):
            pose = self.states.assembly[step["parts"][0]].pose
            path = [" ".join(f"{x:.12g}" for x in place) for place in step["path"]]
            cells = [
                str(k),
                *(";".join(step[key]) for key in ("parts", "held", "grips", "releases")),
                *(f"{x:.12g}" for x in step["direction"] or [math.nan] * 3),
                ";".join(step["touches"]),
                step["level"] or "",
                *(f"{x:.12g}" for x in (*pose.position, *pose.rotation)),
                ";".join(path),
            ]
            rows.append(",".join(map(_cell, cells)))
        return "\n".join(rows) + "\n"

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """The proofs of all its steps, or of the impossibility, for `kilter.verify`, as JSON data.

        Parameters
        ----------
        options : dict, optional
            How the file is read.

        Raises
        ------
        InputError
            If nothing was found and nothing is proved.
        """
        if self.verdict in ("none-found", "fails", "undecided"):
            raise InputError(
                "no order was found and nothing is proved, so there is no proof to write"
            )
        names = self.states.assembly.names
        rules = {
            "hold": self.hold,
            "press": self.press,
            "turn": self.turn,
            "precedence": [list(pair) for pair in self.precedence],
            "groups": [list(group) for group in self.moved_as_one],
            "never_held": list(self.never_held),
            "screws": [[names[one.bolt], names[one.nut], list(one.axis)] for one in self.screws],
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

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return html_of(self.to_dict())

    def __repr__(self) -> str:
        if not self.found:
            return f"<Order: {self.verdict}>"
        steps = count(len(self.steps), "step")
        return f"<Order: found, {steps}, {self.held_steps} with parts held>"

    def __bool__(self) -> bool:
        raise TypeError("an order is neither true nor false: use .found")


def _cell(text: str) -> str:
    """A cell of a CSV line."""
    if any(sign in text for sign in ',"\n\r'):
        return '"' + text.replace('"', '""') + '"'
    return text
