"""`kilter.settle_states`: many states of a simulator's scene, each brought to rest.

The scene is read once. A run with an output file keeps each finished row beside it, so that a later
run continues an interrupted one. A worker that dies costs its state only.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.many.batch_rows import LocalWorkers, Task
from kilter.analysis.many.state_journal import StateJournal, open_journal
from kilter.analysis.many.state_rows import (
    StateQuestion,
    StateTask,
    failed_row,
    settled_rows,
)
from kilter.analysis.settled_pose.settle import valid_reach
from kilter.arrays import Array
from kilter.assembly.question import Question, question
from kilter.contact import Tolerance
from kilter.errors import InputError
from kilter.files.objects.mujoco_snapshot import StateRows, first_position
from kilter.files.objects.state_files import as_rows, read_states
from kilter.files.objects.state_scenes import open_scene, places_of
from kilter.files.own.choices import find_choices
from kilter.files.reading import Reading, chosen
from kilter.files.writing import write_array
from kilter.loading import reading_for, tolerance_of
from kilter.tell.levels import holds, require_level
from kilter.tell.record import Answer, InPython, Record, key
from kilter.tell.scene_words import states_sentence
from kilter.validate import whole

KILLED = "ended the process that settled it"
"""Reason of a row whose worker died."""


class StateRow(Record):
    """A state and where its objects came to rest."""

    index: int
    """Index of the state in its file."""
    state: str
    """Result as in `Settled.state`; "error": see `why`."""
    level: str | None
    """Level of the objects at rest; null without them."""
    free: int
    """Number of free objects."""
    rests: int
    """Number of free objects at rest."""
    leaves: tuple[str, ...]
    """Objects that leave the scene."""
    parts: tuple[str, ...]
    """Other objects without a pose at rest."""
    moved: float
    """Largest way of the centre of mass of an object that stays in the scene [length unit]."""
    farthest: str | None
    """The object with this way; null if none moved."""
    why: str | None
    """Reason for objects without a pose at rest; null without them."""
    seconds: float
    """Duration [s]."""


class SettledStates(Answer):
    """Answer of `kilter.settle_states`: a row for each state, and the new states."""

    answer: ClassVar[str] = "settle-states"

    states: tuple[StateRow, ...]
    """A row for each state, in order."""
    require: str
    """Level from which objects count as at rest."""
    counts: Mapping[str, int]
    """Number of states with each result, the most frequent first."""
    free: int
    """Number of free objects in all states."""
    rests: int
    """Number of free objects at rest in all states."""
    found_there: int
    """Number of states that an earlier run had settled."""
    seconds: float
    """Duration [s]."""
    qpos: InPython[Array]
    """New positions of joints, shape (n, nq).

    A state without an object at rest keeps its positions, and so does an object without a pose.
    """
    rows: InPython[Array]
    """New states in the form of the given ones, shape (n, width); velocities are zero.

    A state without an object at rest is unchanged.
    """

    @property
    @key
    def sentence(self) -> str:
        """The answer in a sentence."""
        return states_sentence(self.data_without("sentence"))

    @property
    def at_rest(self) -> bool:
        """True if in every state all objects are at rest at the required level."""
        return all(row.state == "at-rest" and holds(row.level, self.require) for row in self.states)

    def __repr__(self) -> str:
        words = ", ".join(f"{count} {word}" for word, count in self.counts.items())
        return f"<SettledStates: {len(self.states)} states, {words}>"


@question(lacks="friction down ground floor contacts progress assume")
def settle_states(
    scene: Any,
    states: str | Path | ArrayLike,
    *,
    asked: Question,
    output: str | Path | None = None,
    reach: float | None = None,
    keep: str | Iterable[str] = (),
    nearest: bool = False,
    ease: bool = False,
    processes: int = 1,
    progress: Callable[[int, int], None] | None = None,
    **reading: Any,
) -> SettledStates:
    """Bring many states of a MuJoCo scene to rest, as `kilter.settle` does each of them.

    Parameters
    ----------
    scene : path or MjModel
        An MJCF file, a file of choices about one, or a model.
    states : path or array_like, shape (n, width)
        A row for each state: qpos; qpos and qvel; or time, qpos and qvel, with or without
        activations. A file is that of `numpy.save`, or holds a pickled array.
    output : path, optional
        A NumPy file for the new states. A later run continues an interrupted one.
    reach, keep, nearest, ease
        See `kilter.settle`.
    processes : int
        Number of worker processes.
    time_limit : float, optional
        Time limit for each state [s].
    progress : callable, optional
        Called with the number of finished states, and the number of all.
    **reading
        How the scene is read, as of `kilter.load`: `ground`, `floor`, `friction` and so on.

    Returns
    -------
    SettledStates

    Raises
    ------
    InputError
        If the scene or the states cannot be read, do not belong together, or no body is free; or
        the output cannot be written, or has rows of another run.

    See Also
    --------
    kilter.settle : one state, with the complete answer.
    kilter.judge : why the bodies of one state move, by the contacts of MuJoCo.

    Examples
    --------
    >>> import mujoco
    >>> box = '<body pos="0 0 .2"><freejoint/><geom type="box" size=".1 .1 .1"/></body>'
    >>> scene = f'<mujoco><worldbody><geom type="plane" size="1 1 1"/>{box}</worldbody></mujoco>'
    >>> model = mujoco.MjModel.from_xml_string(scene)
    >>> answer = settle_states(model, [[0, 0, 0.2, 1, 0, 0, 0], [0.5, 0, 0.1, 1, 0, 0, 0]])
    >>> answer, answer.qpos[:, 2].round(9).tolist()
    (<SettledStates: 2 states, 2 at-rest>, [0.1, 0.1])
    """
    options = {
        "reach": valid_reach(reach),
        "keep": keep if isinstance(keep, str) else tuple(keep),
        "nearest": bool(nearest),
        "ease": bool(ease),
        "require": require_level(asked.require, strict=True),
        "effort": asked.effort,
        "time_limit": asked.time_limit,
    }
    tolerance = asked.tolerance
    return run_states(
        scene, states, reading_for(**reading), options,
        tolerance=tolerance, output=output, processes=processes, progress=progress,
    )  # fmt: skip


def run_states(
    scene: Any,
    states: str | Path | ArrayLike,
    reading: Reading,
    options: Mapping[str, Any],
    *,
    tolerance: Tolerance | None = None,
    output: str | Path | None = None,
    processes: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> SettledStates:
    """Settle states with validated keywords of `kilter.settle`. Otherwise as `settle_states`."""
    begun = time.perf_counter()
    count = whole(processes, "processes")
    rows = read_states(Path(states)) if isinstance(states, str | Path) else as_rows(states)
    if reading.state is not None:
        raise InputError("state and states are both given", hint="give only one of them")
    source, reading, tolerance = _chosen(scene, reading, tolerance)
    run = _StatesRun(source, rows, reading, tolerance, dict(options))
    with open_journal(output, run.identity) as journal:
        found_there = len(journal.rows)
        run.settle_missing(journal, count, progress or (lambda done, of: None))
        answer = run.answer(journal.rows, found_there, begun)
        if output is not None:
            write_array(output, answer.rows)
            journal.remove()
    return answer


def _chosen(
    scene: Any, reading: Reading, tolerance: Tolerance | None
) -> tuple[Any, Reading, Tolerance | None]:
    """The scene that choices name, with their options of reading and their tolerance."""
    choices = find_choices(scene)
    if choices is None:
        return scene, reading, tolerance
    both = chosen(choices, reading)
    saved = tolerance_of(both.choices)
    reading = replace(both.reading, state=None)
    return both.path, reading, tolerance or (None if saved == Tolerance() else saved)


@dataclass(slots=True, eq=False)
class _StatesRun:
    """The states to settle, and how."""

    source: Any
    rows: Array
    reading: Reading
    tolerance: Tolerance | None
    options: dict[str, Any]
    question: StateQuestion = field(init=False)

    def __post_init__(self) -> None:
        form = self.reading.format_options
        first = replace(form, states=StateRows.of(self.rows[:1]))
        self.question = StateQuestion(
            open_scene(self.source, first), self.reading, self.tolerance, self.options
        )
        assembly = self.question.assembly()
        if not assembly.holds:  # a floor below each state would differ from row to row
            raise InputError(
                "no body of the scene is static, so nothing supports the states", file=self._file,
                hint="give the height of a floor with floor=0.0, or hold a body with ground=NAME",
                option="give the height of a floor with --floor 0, or hold a body with "
                "--ground NAME",
            )  # fmt: skip
        assembly.matching(self.options["keep"])
        if assembly.geometry.grounded.all():
            raise InputError(
                "no body of the scene is free", file=self._file, hint="give a body a free joint"
            )

    @property
    def _file(self) -> str | None:
        return str(self.source) if isinstance(self.source, str | Path) else None

    @property
    def identity(self) -> str:
        """Digest of the scene, the states and the options; equal runs give equal rows."""
        model = self.question.scene.snapshot
        digest = hashlib.sha256(np.ascontiguousarray(self.rows).tobytes())
        for name, value in sorted(vars(model).items()):
            if isinstance(value, np.ndarray):
                digest.update(name.encode() + value.tobytes())
        told = [repr(self.rows.shape), self.options, self.reading.options(), repr(self.tolerance)]
        digest.update(json.dumps(told, default=str, sort_keys=True).encode())
        return digest.hexdigest()

    def settle_missing(
        self, journal: StateJournal, count: int, progress: Callable[[int, int], None]
    ) -> None:
        """Settle the states without a row, and add their rows to the journal."""
        missing = [k for k in range(len(self.rows)) if k not in journal.rows]
        progress(len(journal.rows), len(self.rows))
        if not missing:
            return
        tasks = self._tasks(missing)
        many = min(count, len(missing))
        rows = self._alone(tasks) if many == 1 else self._together(tasks, many)
        for row in rows:
            journal.add(row)
            progress(len(journal.rows), len(self.rows))

    def _tasks(self, missing: list[int]) -> Iterator[StateTask]:
        """The states without a row, with the places of their bodies."""
        form = self.reading.format_options
        for k, (_, places) in zip(
            missing, places_of(self.source, form, self.rows[missing]), strict=True
        ):
            yield k, places

    def _alone(self, tasks: Iterator[StateTask]) -> Iterator[dict[str, Any]]:
        """Rows of states that are settled in this process."""
        for task in tasks:
            yield from settled_rows([task], self.question)

    def _together(self, tasks: Iterator[StateTask], count: int) -> Iterator[dict[str, Any]]:
        """Rows of states that worker processes settle."""
        workers = LocalWorkers(count, self.question, settled_rows.__module__)
        under_way = 0
        try:
            waiting = next(tasks, None)
            while waiting is not None or under_way:
                while waiting is not None and workers.free:
                    workers.take(Task(waiting[0], (waiting,)))
                    under_way, waiting = under_way + 1, next(tasks, None)
                for task, rows in workers.finished(0.2):
                    under_way -= 1
                    yield from rows or [failed_row(task.chunk, KILLED)]
        finally:
            workers.end()

    def answer(
        self, rows: Mapping[int, dict[str, Any]], found_there: int, begun: float
    ) -> SettledStates:
        """The answer from the rows of all states."""
        model = self.question.scene.snapshot
        start = first_position(model, self.rows.shape[1])
        new = self.rows.copy()
        positions = slice(start, start + model.nq)
        velocities = slice(start + model.nq, start + model.nq + model.nv)
        entries = []
        for k in range(len(new)):
            entry = dict(rows[k])
            qpos = entry.pop("qpos")
            if qpos is not None:
                new[k, positions], new[k, velocities] = qpos, 0.0
            lost = {name: tuple(entry.pop(name)) for name in ("leaves", "parts")}
            entries.append(StateRow(**{**entry, **lost}))
        counts = Counter(entry.state for entry in entries)
        return SettledStates(
            states=tuple(entries),
            require=self.options["require"],
            counts=dict(counts.most_common()),
            free=sum(entry.free for entry in entries),
            rests=sum(entry.rests for entry in entries),
            found_there=found_there,
            seconds=time.perf_counter() - begun,
            qpos=new[:, positions].copy(),
            rows=new,
        )
