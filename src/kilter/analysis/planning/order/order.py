"""Answer of `kilter.plan`: steps in the order of assembly, with their proofs.

Between two steps the hands grip and release parts. The succession of these grips and releases is
not planned.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from kilter.analysis.decision.decision import Decision
from kilter.analysis.decision.open_question import open_pairs_answer
from kilter.analysis.planning.order.locking import Locked
from kilter.analysis.planning.order.order_proof import order_proof
from kilter.analysis.planning.order.plan_step import FAR, VERDICTS, Step, lower_level
from kilter.analysis.planning.order.removal import Screw
from kilter.analysis.planning.states.holds import Holds
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.analysis.verdict.remarks import remarks
from kilter.arrays import Array
from kilter.errors import InputError
from kilter.tell.cells import InCells
from kilter.tell.csv_cells import csv_text
from kilter.tell.html import html_of
from kilter.tell.json_answer import AnswerInWords
from kilter.tell.levels import holds
from kilter.tell.numbers import count
from kilter.tell.plan_words import order_sentence

if TYPE_CHECKING:
    from kilter.tell.answer_data.plan_data import ImpossibleData, PlanData, StepData

__all__ = ["Order"]


@dataclass(frozen=True, slots=True, eq=False)
class Order(InCells, AnswerInWords):
    """Answer of `kilter.plan`: an order of assembly, or the proof that no order exists.

    Attributes
    ----------
    states : States
        States of the assembly.
    steps : tuple of Step
        Steps in the order of assembly; empty if no order was found. All steps of a given order.
    best : tuple of str
        Parts that can be inserted last, the last part first, if no order was found.
    falling : tuple of State
        Proof that no order without holds exists: a state for each part that no such order
        reaches. In it the part falls alone on all reached parts.
    locked : tuple of Locked
        Proof that no order exists for any holds: parts that lock each other.
    refused : tuple of Holds
        Proof that no order exists with up to `hold` held parts, along any paths: states that need
        more holds and together bar every order.
    whole : State
        State of the finished assembly.
    finished : Decision
        Decision on the finished assembly by the cascade of `kilter.check`.
    hold : int
        Largest number of parts allowed to be held at once.
    require : str
        Level that every step must reach.
    precedence : tuple of pairs of str
        Required pairs (earlier part, later part).
    never_held : tuple of str
        Parts that must not be held.
    directions : tuple
        Directions of motion that were tried.
    screws : tuple of Screw
        Bolts with their nuts.
    moved_as_one : tuple of tuples of str
        Groups of parts that move together.
    together : bool
        Whether parts that block each other were allowed to move together.
    press : float
        Force that presses each part in [N].
    carried : ndarray, shape () or (3,)
        Acceleration of the carrier that every state also carries [m/s^2]: a size, in every
        horizontal direction, or a vector.
    accelerations : ndarray, shape (n, 3)
        Accelerations at which every state is proved [m/s^2]; it carries all between them.
    turn : bool
        Whether the standing parts were allowed to be turned.
    given : bool
        Whether the caller gave the order.
    fewest : {"holds", "held-steps", "turns"}
        Quantity to be minimized.
    least : {"always", "as-tried"} or None
        Scope of the proof of the minimum: all orders, or orders along the tried paths; None
        without proof.
    exhausted, interrupted : bool
        Whether the search tried every removal; whether an interrupt stopped it.
    time_limit : float or None
        Limit that stopped the search [s]; None if the search did not reach it.
    counts : mapping
        Counts of states, programs, collision tests and stored motions.
    seconds : mapping
        Duration of each stage [s].
    """

    answer: ClassVar[str] = "plan"

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
    carried: Array
    accelerations: Array
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
        none = self.locked or self.refused or (self.falling and self.hold == 0)
        return "impossible" if none else "none-found"

    @property
    def found(self) -> bool:
        """Whether an order was found, or the given order is valid."""
        return self.verdict == "found"

    @property
    def level(self) -> str | None:
        """Lowest verdict level over all steps and the finished assembly; None without an order."""
        levels = [step.level for step in self.steps if step.level is not None]
        if not levels:
            return self.finished.level if self.found else None
        order = list(VERDICTS)
        return lower_level(max(levels, key=order.index), self.finished.level)

    @property
    def holds(self) -> bool:
        """Whether an order was found and every step reaches the required verdict level."""
        return self.found and holds(self.level, self.require)

    @property
    def holds_max(self) -> int:
        """Largest number of parts that are held at once in the order."""
        return max((len(step.held) for step in self.steps), default=0)

    @property
    def turns(self) -> int:
        """Number of times that the order turns the standing parts."""
        return sum(step.between is not None for step in self.steps)

    @property
    def held_steps(self) -> int:
        """Number of steps of the order during which a part is held."""
        return sum(bool(step.held) for step in self.steps)

    def to_dict(self) -> PlanData:
        """The plan as JSON data, as printed by ``kilter plan --json``."""
        assembly, counts = self.states.assembly, self.counts
        answer: PlanData = {
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
            "search": {
                "states": counts["states"],
                "programs": counts["programs"],
                "sweeps": counts["sweeps"],
                "no_goods": counts["no_goods"],
                "exhausted": self.exhausted,
                "hold": self.hold,
            },
            "assumes": {
                "directions": [d if isinstance(d, str) else list(d) for d in self.directions],
                "tolerance": self.states.contacts.searched.relative_gap,
                "screws": [[assembly.names[s.bolt], assembly.names[s.nut]] for s in self.screws],
                "groups": [list(group) for group in self.moved_as_one],
                "together": self.together,
                "press": self.press,
                "carried": self._carried(),
                "turn": self.turn,
            },
            "interrupted": self.interrupted,
            "time_limit": self.time_limit,
            "warnings": remarks(assembly, self.states.contacts),
            "seconds": {key: round(value, 6) for key, value in self.seconds.items()},
            "sentence": "",  # made below from the other data
        }
        answer["sentence"] = order_sentence(answer)
        return answer

    def _carried(self) -> float | list[float] | None:
        """The acceleration that every state also carries; None if none is required."""
        if not len(self.accelerations):
            return None
        return self.carried.tolist() if self.carried.ndim else float(self.carried)

    def _step(self, step: Step) -> StepData:
        """A step of the plan as JSON data."""
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

    def _impossible(self) -> ImpossibleData | None:
        """Proof that no order exists (or none without held parts) as JSON data; else None."""
        if self.whole.stable is False:
            motion = self.whole.motion
            moving = self.whole.moving
            index = self.states.assembly.index
            motions: list[dict[str, Any] | None] | None = (
                None
                if motion is None
                else [{name: motion.motion[index[name]].tolist() for name in moving}]
            )
            return {"kind": "falls", "holds": None, "parts": moving, "motions": motions}
        if self.locked:
            parts = [self.states.assembly.names[core.part] for core in self.locked]
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
        """The steps of the plan as CSV text: a line for each step, lists in a cell joined by ``;``.

        Columns: step, part, held, grips, releases, the direction of insertion (x, y, z), touches,
        level, pose of the part in the world frame once it is seated (px, py, pz [length unit],
        quaternion qw, qx, qy, qz), and the path: positions relative to the seat, the last zero.
        """
        head = "step,part,held,grips,releases,x,y,z,touches,level,px,py,pz,qw,qx,qy,qz,path"
        rows: list[list[Any]] = [head.split(",")]
        for k, step in enumerate(self.to_dict()["steps"], 1):
            pose = self.states.assembly[step["parts"][0]].pose
            path = [" ".join(f"{x:.12g}" for x in place) for place in step["path"]]
            cells = [
                str(k),
                *(step[key] for key in ("parts", "held", "grips", "releases")),
                *(f"{x:.12g}" for x in step["direction"] or [math.nan] * 3),
                step["touches"],
                step["level"] or "",
                *(f"{x:.12g}" for x in (*pose.position, *pose.rotation)),
                ";".join(path),
            ]
            rows.append(cells)
        return csv_text(rows)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proofs of the steps, or proof that no order exists, as JSON data for `kilter.verify`.

        Parameters
        ----------
        options : dict, optional
            Options with which the file is read.

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
            "hold": self.hold,
            "press": self.press,
            "carried": self.accelerations.tolist(),
            "turn": self.turn,
            "precedence": [list(pair) for pair in self.precedence],
            "groups": [list(group) for group in self.moved_as_one],
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

    def _repr_html_(self) -> str:
        """The plan as HTML for a notebook."""
        return html_of(self.to_dict())

    def __repr__(self) -> str:
        if not self.found:
            return f"<Order: {self.verdict}>"
        steps = count(len(self.steps), "step")
        return f"<Order: found, {steps}, {self.held_steps} with parts held>"

    def __bool__(self) -> bool:
        raise TypeError("an order is neither true nor false: use .found")
