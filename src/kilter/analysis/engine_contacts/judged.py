"""`kilter.judge`: why a state of MuJoCo moves, judged with the engine's own contacts."""

from __future__ import annotations

import time
from typing import Any, ClassVar, Literal

import numpy as np

from kilter.analysis.analysis_tolerances import LIMIT_AGREES
from kilter.analysis.engine_contacts.engine_bodies import EngineBodies
from kilter.analysis.engine_contacts.given_contacts import verdict_on
from kilter.analysis.load_limit import NoLimit, find_limit, gravity_wrench
from kilter.analysis.verdict.verdict import Verdict
from kilter.analysis.verdict.verdict_answer import ProofErrors
from kilter.arrays import Array, Mask, connected
from kilter.assembly import Assembly
from kilter.assembly.question import Question, question
from kilter.errors import InputError
from kilter.files.objects.mujoco_state import take_state
from kilter.mechanics.program import build_program
from kilter.tell.levels import REQUIRE, VerdictWord, holds
from kilter.tell.record import (
    Answer,
    InPython,
    LevelWord,
    OrNull,
    Record,
    UnitWord,
    Vector,
    key,
)
from kilter.tell.why_words import why_sentence
from kilter.validate import number

JudgedState = Literal["holds", "falls", "pushed-out", "floats"]
WORST: tuple[JudgedState, ...] = ("falls", "pushed-out", "floats", "holds")
"""States of an object, the worst first; that of the answer is the worst of its objects."""
DEEPER = 0.5
"""Share of the depth of a contact that its parameters do not explain, above which the contact is
too deep [-]."""
PUSHED = 0.05
"""Acceleration with which a contact that is too deep separates [g]."""
MOST_CREEP = 100.0
"""Longest simulation [s]."""


class JudgedObject(Record):
    """A moving body of a state of an engine."""

    name: str
    """Name of the body."""
    state: JudgedState | None
    """Its state; null: undecided."""
    depth: float | None = None
    """Depth of its deepest contact [m]; null without a contact."""
    other: str | None = None
    """The other body at this contact; of a floating body, the nearest body."""
    unexplained: float | None = None
    """Part of this depth that load and contact parameters do not explain [m]."""
    height: float | None = None
    """Distance of a floating body from the nearest body [m]; null for other states."""
    speed: float
    """Speed of its centre of mass in the given state [m/s]."""
    motion: str | None = None
    """How it starts to move, in words; null if it does not move."""


class MotorForce(Record):
    """The force of a motor that presses a body of a robot against loose bodies."""

    name: str
    """Name of the body."""
    force: float
    """Force along its slide [N], or torque about its hinge [N m]."""
    kind: Literal["prismatic", "revolute"]
    """Kind of its joint."""


class Creep(Record):
    """Movement in a simulation from rest, with changed settings of the engine."""

    setting: str
    """Settings as in MJCF; "as is" for those of the model."""
    distance: float
    """Largest distance by which a loose body moves [m]."""
    name: str | None
    """Name of this body."""


class Judged(Answer):
    """Answer of `kilter.judge`: whether the contacts of an engine hold its bodies, and why not."""

    answer: ClassVar[str] = "why"

    state: JudgedState | None
    """Worst state of an object; "holds" without an object, null: undecided."""
    level: LevelWord | None
    """Level of the verdict; null: it does not hold."""
    require: LevelWord = REQUIRE
    """The required level."""
    factor: OrNull
    """Largest factor of gravity that holds, with all other forces fixed [-]; null: unlimited, or
    no factor is known to hold."""
    objects: tuple[JudgedObject, ...]
    """All bodies that are not held."""
    contacts: int
    """Number of contact points of these bodies."""
    held_by_motors: tuple[str, ...]
    """Bodies of robots, which count as held."""
    presses: tuple[MotorForce, ...]
    """Bodies of robots that count as moving, with the forces of their motors."""
    seconds_simulated: float
    """Time of each simulation of `creep` [s]; 0 without simulations."""
    creep: tuple[Creep, ...]
    """Movement in the simulations, that with the model's settings first."""
    gravity: Vector
    """Gravity [m/s^2]."""
    units: UnitWord = "m"
    """Length unit."""
    warnings: tuple[str, ...]
    """Warnings about features that are left out, and about the numbers."""
    seconds: float
    """Duration [s]."""
    verdict: InPython[Verdict | None]
    """The verdict on the bodies with these contacts, with its proof; None if no body moves."""

    @property
    @key
    def sentence(self) -> str:
        """The answer in a sentence."""
        return why_sentence(self.data_without("sentence"))

    @property
    @key
    def certificate(self) -> ProofErrors | None:
        """Kind of the proof, and its numerical errors; null if no body moves."""
        return None if self.verdict is None else self.verdict.certificate

    @property
    def holds(self) -> bool:
        """Whether the state holds at the required level."""
        return self.state == "holds" and holds(self.level, self.require)

    @property
    def assembly(self) -> Assembly | None:
        """The bodies with the engine's contacts, of which the proof is; None if no body moves."""
        return None if self.verdict is None else self.verdict.assembly

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """The proof of the verdict as JSON data, about `assembly`.

        Raises
        ------
        InputError
            If no body moves, or the verdict is undecided.
        """
        if self.verdict is None:
            raise InputError("no body moves, so there is nothing to prove")
        return self.verdict.proof(options=options)

    def __bool__(self) -> bool:
        raise TypeError("a judged state is neither true nor false: use .holds, or .state")


@question(lacks="friction down ground floor contacts tolerance progress assume")
def judge(
    model: Any, data: Any, *, asked: Question, creep: float = 0.0, loose_robots: bool = False
) -> Judged:
    """Decide whether the contacts of MuJoCo hold its bodies in the given state, and why not.

    The contacts are those of the engine's own collision detection at the positions of `data`.
    Motors, springs and applied forces count with the forces that they have at rest. Robots, which
    are bodies with motors on the world, are held. The last body of a robot's branch moves if its
    motor presses it against a loose body, such as the finger of a gripper. `data` does not change.

    Parameters
    ----------
    model : mujoco.MjModel
    data : mujoco.MjData
        The state; no call of ``mj_forward`` is needed.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which `Judged.holds` is true. "equilibrium" is the quickest: it decides only
        whether forces at the contacts balance every body.
    creep : float
        Time for which the engine simulates the state from rest with several settings of its
        solver [s]; 0: no simulation. `Judged.creep` compares how far the bodies move.
    loose_robots : bool
        Whether robots move, with the forces of their motors as loads.

    Returns
    -------
    Judged

    Raises
    ------
    InputError
        If `model` and `data` are not of MuJoCo, the model has no gravity, or an argument is
        invalid.

    See Also
    --------
    kilter.check_contacts : the same from arrays, for any engine.
    kilter.scene : a verdict from the geometry of a scene, without the engine's contacts.
    """
    seconds = number(creep, "creep", lowest=0)
    if seconds > MOST_CREEP:
        raise InputError(f"creep is {seconds:g} s", hint=f"give at most {MOST_CREEP:g} s")
    import mujoco

    if not isinstance(model, mujoco.MjModel) or not isinstance(data, mujoco.MjData):
        kinds = f"{type(model).__name__} and {type(data).__name__}"
        raise InputError(f"judge got {kinds}", hint="give an MjModel and its MjData")
    state = take_state(mujoco, model, data, seconds)
    return judge_bodies(EngineBodies(state, loose_robots), asked, seconds)


def judge_bodies(bodies: EngineBodies, asked: Question, simulated: float = 0.0) -> Judged:
    """Judge the bodies of a state of an engine.

    Arguments: `simulated`: time of each simulation in the state [s].
    """
    started = time.perf_counter()
    assembly = bodies.assembly()
    verdict, factor = None, np.inf
    rows: tuple[JudgedObject, ...] = ()
    if assembly is not None:
        verdict = verdict_on(assembly, asked)
        factor = _factor(verdict)
        rows = _objects(bodies, verdict)
    return Judged(
        state=_worst(rows),
        level=verdict.level if verdict is not None else "strict",
        require=asked.require,
        factor=factor,
        objects=rows,
        contacts=len(bodies.kept),
        held_by_motors=tuple(bodies.held_by_motors),
        presses=tuple(
            MotorForce(
                name=bodies.names[each.body],
                force=each.force,
                kind="prismatic" if each.slides else "revolute",
            )
            for each in bodies.pressing.values()
        ),
        seconds_simulated=simulated,
        creep=_creep(bodies),
        gravity=bodies.state.gravity,
        warnings=(*bodies.notes, *(verdict.notes if verdict is not None else ())),
        seconds=time.perf_counter() - started,
        verdict=verdict,
    )


def _worst(rows: tuple[JudgedObject, ...]) -> JudgedState | None:
    """The worst state of all bodies; None if it is undecided."""
    states = {row.state for row in rows}
    if None in states:
        return None
    return next((each for each in WORST if each in states), "holds")


def _factor(verdict: Verdict) -> float:
    """Largest factor of gravity that the contacts hold; infinite, or nan if none is known."""
    program = build_program(verdict.assembly, verdict.contact_set)
    limit = find_limit(program, gravity_wrench(program, program.down))
    if isinstance(limit, NoLimit):
        return np.nan
    factor = 1.0 + limit.value
    return factor if factor > LIMIT_AGREES else 0.0


def _objects(bodies: EngineBodies, verdict: Verdict) -> tuple[JudgedObject, ...]:
    """The state of each moving body."""
    state, names = bodies.state, bodies.part_names
    depth, ends = state.depth[bodies.kept], bodies.ends
    decided = verdict.level is not None or verdict.verdict == VerdictWord.UNSTABLE
    moves = verdict.motion.moves
    if not (verdict.motion.known and moves.any()):  # barely unstable, or the motion is not known
        moves = verdict.moved_by_proof
    linked = _linked_to_held(verdict)
    rows = []
    for k, body in enumerate(bodies.movers):
        mine = np.flatnonzero((ends == k).any(axis=1))
        row: dict[str, Any] = {"name": names[k], "speed": float(state.speed[body])}
        state_of: JudgedState | None = "holds" if decided else None
        if len(mine):
            deepest = int(mine[np.argmax(depth[mine])])
            pushed = mine[_too_deep(bodies)[mine]]
            if len(pushed):
                deepest = int(pushed[np.argmax(depth[pushed])])
                state_of = "pushed-out" if decided else None
            row |= {
                "depth": float(depth[deepest]),
                "unexplained": float(state.unexplained[bodies.kept[deepest]]),
                "other": names[int(ends[deepest][ends[deepest] != k][0])],
            }
        if verdict.verdict == VerdictWord.UNSTABLE and moves[k]:
            state_of = "falls" if linked[k] else "floats"
            row["motion"] = verdict.words(k)
        if state_of == "floats" and not len(mine):
            geom, way = state.near.get(body, (-1, np.inf))
            if geom >= 0:
                row |= {"other": _geom_owner(bodies, geom), "height": way}
        rows.append(JudgedObject(state=state_of, **row))
    return tuple(rows)


def _too_deep(bodies: EngineBodies) -> Mask:
    """Mask of the kept contacts that are deeper than load and parameters explain, (K,)."""
    state, kept = bodies.state, bodies.kept
    g = float(np.linalg.norm(state.gravity))
    fast = state.push[kept] > PUSHED * g
    return np.asarray(fast & (state.unexplained[kept] > DEEPER * state.depth[kept]))


def _linked_to_held(verdict: Verdict) -> Mask:
    """Mask of the parts that contacts and joints link to a held part, (N,)."""
    program = build_program(verdict.assembly, verdict.contact_set)
    count = len(program.names)
    first, second = (np.where(part < 0, count, part) for part in (program.part_a, program.part_b))
    groups = connected(count + 1, first, second)
    held = np.append(groups[:-1][~program.free], groups[-1])
    return np.isin(groups[:-1], held)


def _geom_owner(bodies: EngineBodies, geom: int) -> str:
    """Name of the body of a geom; of the world, that of the geom."""
    body = int(bodies.state.geom_bodyid[geom])
    return bodies.names[body] if body else bodies.state.geom_names[geom] or "world"


def _creep(bodies: EngineBodies) -> tuple[Creep, ...]:
    """The largest movement of a loose body in each simulation."""
    loose = [body for body in bodies.movers if body not in bodies.pressing]
    rows = []
    for setting, ways in bodies.state.creep.items():
        way: Array = ways[loose]
        most = int(np.argmax(way)) if len(way) else -1
        name = bodies.names[loose[most]] if len(way) else None
        rows.append(Creep(setting=setting, distance=float(way.max(initial=0.0)), name=name))
    return tuple(rows)
