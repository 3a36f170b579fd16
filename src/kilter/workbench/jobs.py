"""Jobs of the worker process of the workbench: open a file, answer, compute a tab, export.

Each job is a mapping with the key `job`. A job reports its results through a callable, which sends
them to the session.
"""

from __future__ import annotations

import asyncio
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kilter.analysis.assumptions.rungs import rung_of
from kilter.analysis.check import check_equilibrium
from kilter.analysis.everything import only_given
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.assumption import DRAWN
from kilter.assembly.question import FREE_STANDING, TURNED, Question
from kilter.errors import InputError
from kilter.files.limits import only_below
from kilter.files.own.choices import digest, find_choices
from kilter.files.writing import to_text
from kilter.show.scene import build_orientation, view_box
from kilter.workbench.answering import (
    PHASES,
    answer_data,
    on_rung,
    posed,
    prepared_check,
    scene_data,
    settling_action,
    tab_data,
)
from kilter.workbench.exports import comparison_data, export
from kilter.workbench.live_assembly import LiveAssembly, OpenedParts, Prepared
from kilter.workbench.worker_process import ENDED, LAST, WorkerProcess

# The jobs of a session: a single job runs, the others wait.


STOPPED = "the computation was stopped"
FAULT = "kilter failed in this computation"
"""Sentence about a fault of kilter itself."""


@dataclass(slots=True, eq=False)
class QueuedJob:
    """A job of the worker process."""

    number: int
    state: int
    """Number of the state of the session to which the job belongs."""
    job: dict[str, Any]
    """The job, as `kilter.workbench.jobs` does it."""
    waiter: asyncio.Future[Any] | None = None
    """Future of a caller that waits for the result; None: the result goes to the pages."""
    tab: str = ""
    """Name of the tab that the job computes; empty for other jobs."""

    @property
    def about(self) -> str:
        """Name of the tab, or kind of the job."""
        return self.tab or str(self.job["job"])


class JobQueue:
    """The running job and the waiting jobs of a session.

    Arguments: `progress`: called with the running job, or None, and the words of its present stage.
    """

    def __init__(
        self,
        reopening: Callable[[], dict[str, Any]],
        result: Callable[[QueuedJob, str, Any], None],
        failed: Callable[[QueuedJob, InputError], None],
        progress: Callable[[QueuedJob | None, str], None],
    ) -> None:
        self.worker = WorkerProcess(self._hear)
        self._reopening, self._result = reopening, result
        self._failed, self._progress = failed, progress
        self._numbers = 0
        self._running: QueuedJob | None = None
        self._waiting: list[QueuedJob] = []
        self._has_file = False

    @property
    def is_idle(self) -> bool:
        """Whether no job runs."""
        return self._running is None

    def add(self, state: int, job: dict[str, Any], *, tab: str = "") -> None:
        """Queue a job whose result goes to the pages."""
        if job["job"] == "answer":
            self._drop(lambda waiting: waiting.waiter is None)
            if self._running is not None and self._running.waiter is None:
                self.worker.interrupt()
        else:
            self._drop(lambda waiting: waiting.tab == tab)
        self._queue(QueuedJob(0, state, job, tab=tab))

    async def result_of(self, state: int, job: dict[str, Any]) -> Any:
        """Queue a job and wait for its result.

        Raises `InputError` if the job fails or is stopped.
        """
        waiter: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self._queue(QueuedJob(0, state, job, waiter))
        return await waiter

    def stop(self) -> None:
        """End the running job, and drop the waiting jobs; the pages hear of each job of a tab."""
        tabs = [job for job in self._waiting if job.tab]
        self._drop(lambda waiting: True)
        for job in tabs:
            self._failed(job, _stopped())
        self.worker.interrupt()

    def _drop(self, unwanted: Callable[[QueuedJob], bool]) -> None:
        """Remove waiting jobs; their callers get an error."""
        for job in self._waiting:
            if unwanted(job) and job.waiter is not None and not job.waiter.done():
                job.waiter.set_exception(InputError(STOPPED))
        self._waiting = [job for job in self._waiting if not unwanted(job)]

    def _queue(self, job: QueuedJob) -> None:
        self._waiting.append(job)
        self._next()

    def _next(self) -> None:
        """Start the next job if none runs."""
        if self._running is not None or not self._waiting:
            return
        if not self._has_file and self._waiting[0].job["job"] != "open":
            self._waiting.insert(0, QueuedJob(0, self._waiting[0].state, self._reopening()))
        job = self._running = self._waiting.pop(0)
        self._numbers += 1
        job.number = self._numbers
        self._progress(job, "reading" if job.job["job"] == "open" else "")
        self.worker.start(job.number, job.job)

    def _hear(self, number: int, kind: str, data: Any) -> None:
        """Take a message of the worker process."""
        if kind in ENDED:
            self._has_file = False
        job = self._running
        if job is None or number != job.number:
            return
        if kind == "progress":
            self._progress(job, data)
        elif kind in (*LAST, *ENDED):
            self._finish(job, kind, data)
        else:
            self._has_file = self._has_file or kind == "opened"
            if job.waiter is None:
                self._result(job, kind, data)
            elif not job.waiter.done():
                job.waiter.set_result(data)

    def _finish(self, job: QueuedJob, kind: str, data: Any) -> None:
        """End a job: report a failure to its caller or to the pages, and start the next job."""
        self._running = None
        self._progress(None, "")
        error = _failure(kind, data)
        if job.waiter is None:
            if error is not None:
                self._failed(job, error)
        elif not job.waiter.done():
            job.waiter.set_exception(error or InputError(STOPPED))
        self._next()


def _failure(kind: str, data: Any) -> InputError | None:
    """The error that ended a job; None if it ended without an error."""
    if kind == "error":
        return InputError(data["error"], hint=data["hint"])
    if kind == "fault":
        last = str(data).strip().splitlines()[-1] if data else ""
        return InputError(f"{FAULT}: {last}"[:300], hint="run 'kilter check' on the saved choices")
    if kind == "lost":
        return InputError(
            "the computing process ended unexpectedly; it was started again", hint="try again"
        )
    return _stopped() if kind in ("stopped", "killed") else None


def _stopped() -> InputError:
    """The error of a job that was stopped."""
    return InputError(STOPPED, hint="change something, or start it again")


ELSEWHERE = "if you trust the file, start 'kilter view' with --folder {folder}"
"""Remedy if a file names another file outside of the opened folder."""
CHANGED = re.compile(r"changed-(\d{1,4})\.kilter\.json", re.ASCII)
"""Name of the export of a changed assembly, by the number of its change."""
Report = Callable[[str, Any], None]
Job = Mapping[str, Any]


class Jobs:
    """The jobs, and what they keep for the next job: file, contacts, and the last scene."""

    def __init__(self) -> None:
        self.live: LiveAssembly | None = None
        self.bodies = OpenedParts()
        self._folder: str | None = None
        self._shapes: Any = None
        self._shown: Sequence[str] = ()
        self._prepared: tuple[Any, Prepared] | None = None
        self._at_rung: tuple[Prepared, Prepared] | None = None
        self._changed: tuple[Any, Sequence[Assembly]] = None, ()

    def run(self, job: Job, report: Report) -> None:
        """Run a job; `report` is called with the kind and the data of each result.

        Raises `InputError` if the job cannot be done for a reason that the user can change.
        """
        steps = {
            "open": self._open,
            "answer": self._answer,
            "tab": self._tab,
            "probe": self._probe,
            "settle": self._settle,
            "compare": self._compare,
            "export": self._export,
        }
        folder = job.get("folder") or self._folder
        assert folder is not None
        with only_below(folder, ELSEWHERE):
            steps[job["job"]](job, report)

    def _open(self, job: Job, report: Report) -> None:
        """Read a file, or the file that choices name, and report its parts and first choices."""
        path, base = Path(job["file"]), job.get("keys")
        choices = find_choices(path) if base is None else None
        about = path if choices is None else choices.path
        live = LiveAssembly(about, _teller(report))
        if base is None:
            base = {"kilter": 1, "file": about.name} if choices is None else choices.to_dict()
            base["file"] = about.name
        base = {**base, "sha256": digest(about)}
        if job.get("down") is not None:
            size = float(np.linalg.norm(live.gravity(base)))
            unit = np.array(job["down"]) / np.linalg.norm(job["down"])
            base = {**base, "gravity": (size * unit + 0.0).tolist()}
        bodies = live.opened_parts(base)
        self.live, self.bodies, self._shapes, self._prepared = live, bodies, None, None
        self._shown = ()
        self._folder = job["folder"]
        report("opened", {"path": str(about), "keys": base, "bodies": bodies})

    def _prepare(self, job: Job) -> Prepared:
        """The assembly and contacts of a job; kept, as the next job is often about the same."""
        assert self.live is not None
        verb = job["name"] if job.get("name") in (*FREE_STANDING, *TURNED) else "check"
        key = job["keys"], verb
        if self._prepared is None or self._prepared[0] != key:
            self._prepared = key, self.live.prepare(*key)
        return self._prepared[1]

    def _prepare_rung(self, job: Job, report: Report) -> Prepared:
        """The assembly of a job with the poses and joints of its rung; kept, too."""
        prepared = self._prepare(job)
        if self._at_rung is None or self._at_rung[0] is not prepared:
            self._at_rung = prepared, on_rung(prepared, _teller(report))
        return self._at_rung[1]

    def _answer(self, job: Job, report: Report) -> None:
        """Answer the present choices: the scene, then the verdict in two phases."""
        assert self.live is not None
        self.live.progress = _teller(report)
        prepared = self._prepare(job)
        moves = rung_of(Question(assembly=prepared.assembly)) != DRAWN
        held = any(part.grounded for part in prepared.assembly.parts)
        known = prepared.assembly.names == self._shown
        if not (moves and held and known):  # else the last poses are shown until the next
            center = self._show(prepared, report)
        if not held:
            raise InputError("nothing is held", hint="select a part and hold it, or add the floor")
        for phase in PHASES[moves:]:
            verdict = prepared_check(prepared, phase, _teller(report))
            if moves:
                center = self._show(posed(prepared, verdict), report)
            report("answer", answer_data(verdict, phase, center))

    def _show(self, prepared: Prepared, report: Report) -> Array:
        """Report the scene of an assembly; return the point to which its positions are relative."""
        scene = scene_data(prepared, self.bodies)
        self._shown = prepared.assembly.names
        if scene["shapes"] == self._shapes:
            scene["shapes"] = None
        else:
            self._shapes = scene["shapes"]
        report("scene", scene)
        return np.array(scene["center"])

    def _tab(self, job: Job, report: Report) -> None:
        """Compute a tab for the present choices; contacts are those of the drawn pose."""
        drawn = job["name"] == "contacts"
        prepared = self._prepare(job) if drawn else self._prepare_rung(job, report)
        center, _ = view_box(prepared.assembly)
        data = tab_data(
            job["name"],
            prepared,
            job["keys"],
            job.get("options") or {},
            saved=job.get("saved"),
            center=center,
            progress=_teller(report),
        )
        if "changed" in data:
            self._changed = job["keys"], data.pop("changed")
        report("tab", data)

    def _probe(self, job: Job, report: Report) -> None:
        """Decide equilibrium for another direction of gravity; the contacts are kept."""
        prepared = self._prepare_rung(job, report)
        turned = prepared.assembly.with_down(np.array(job["down"]))
        verdict = check_equilibrium(turned, prepared.contacts.of(turned))
        center, _ = view_box(prepared.assembly)
        answers = only_given(verdict)
        report("probe", {"given": build_orientation(answers, answers.given, center)})

    def _settle(self, job: Job, report: Report) -> None:
        """Find the poses at rest, and report the action that moves the parts."""
        report("action", settling_action(self._prepare(job), job["keys"], _teller(report)))

    def _compare(self, job: Job, report: Report) -> None:
        """Compare the answers of two states of the session."""
        assert self.live is not None
        report("tab", comparison_data(self.live, job["labels"], job["states"], _teller(report)))

    def _export(self, job: Job, report: Report) -> None:
        """Make a file for the user to download."""
        number = CHANGED.fullmatch(job["kind"])
        if number is not None:
            report("file", {"name": job["kind"], "data": self._changed_file(job, int(number[1]))})
            return
        prepared = self._prepare(job)
        with tempfile.TemporaryDirectory() as folder:
            path = export(job["kind"], prepared, Path(folder), job, _teller(report))
            report("file", {"name": path.name, "data": path.read_bytes()})

    def _changed_file(self, job: Job, number: int) -> bytes:
        """The file of a changed assembly of the tab "What helps"."""
        keys, changed = self._changed
        if keys != job["keys"] or number >= len(changed):
            raise InputError("the changes are not known any more", hint="compute them again")
        return to_text(changed[number]).encode()


def _teller(report: Report) -> Callable[[str], None]:
    """A progress callable that reports each stage."""
    return lambda stage: report("progress", stage)
