"""Jobs of the worker process of the workbench: open a file, answer, compute a tab, export.

Each job is a mapping with the key `job`. A job reports its results through a callable, which sends
them to the session.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from kilter.errors import InputError
from kilter.files.choices import digest, find_choices
from kilter.files.start_folder import only_below
from kilter.show.scene import view_box
from kilter.workbench.answering import (
    PHASES,
    answer_data,
    prepared_check,
    scene_data,
    tab_data,
)
from kilter.workbench.comparison import comparison_data
from kilter.workbench.exports import export
from kilter.workbench.live_assembly import LiveAssembly, Prepared
from kilter.workbench.opened_parts import OpenedParts
from kilter.workbench.settle_change import settling_action

__all__ = ["Jobs"]

ELSEWHERE = "if you trust the file, start 'kilter view' with --folder {folder}"
"""Remedy if a file names another file outside of the opened folder."""
Report = Callable[[str, Any], None]
Job = Mapping[str, Any]


class Jobs:
    """The jobs, and what they keep for the next job: file, contacts, and the last scene."""

    def __init__(self) -> None:
        self.live: LiveAssembly | None = None
        self.bodies = OpenedParts()
        self._folder: str | None = None
        self._shapes: Any = None
        self._prepared: tuple[Any, Prepared] | None = None

    def run(self, job: Job, report: Report) -> None:
        """Run a job; `report` is called with the kind and the data of each result.

        Raises `InputError` if the job cannot be done for a reason that the user can change.
        """
        steps = {
            "open": self._open,
            "answer": self._answer,
            "tab": self._tab,
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
        self._folder = job["folder"]
        report("opened", {"path": str(about), "keys": base, "bodies": bodies})

    def _prepare(self, job: Job) -> Prepared:
        """The assembly and contacts of a job; kept, as the next job is often about the same."""
        assert self.live is not None
        if self._prepared is None or self._prepared[0] != job["keys"]:
            self._prepared = job["keys"], self.live.prepare(job["keys"])
        return self._prepared[1]

    def _answer(self, job: Job, report: Report) -> None:
        """Answer the present choices: the scene, then the verdict in two phases."""
        assert self.live is not None
        self.live.progress = _teller(report)
        prepared = self._prepare(job)
        scene = scene_data(prepared, self.bodies)
        if scene["shapes"] == self._shapes:
            scene["shapes"] = None
        else:
            self._shapes = scene["shapes"]
        report("scene", scene)
        if not any(part.grounded for part in prepared.assembly.parts):
            raise InputError("nothing is held", hint="select a part and hold it, or add the floor")
        center = np.array(scene["center"])
        for phase in PHASES:
            verdict = prepared_check(prepared, phase, _teller(report))
            report("answer", answer_data(verdict, phase, center))

    def _tab(self, job: Job, report: Report) -> None:
        """Compute a tab for the present choices."""
        prepared = self._prepare(job)
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
        report("tab", data)

    def _settle(self, job: Job, report: Report) -> None:
        """Find the poses at rest, and report the action that moves the parts."""
        report("action", settling_action(self._prepare(job), job["keys"], _teller(report)))

    def _compare(self, job: Job, report: Report) -> None:
        """Compare the answers of two states of the session."""
        assert self.live is not None
        report("tab", comparison_data(self.live, job["labels"], job["states"], _teller(report)))

    def _export(self, job: Job, report: Report) -> None:
        """Make a file for the user to download."""
        prepared = self._prepare(job)
        with tempfile.TemporaryDirectory() as folder:
            path = export(job["kind"], prepared, Path(folder), job, _teller(report))
            report("file", {"name": path.name, "data": path.read_bytes()})


def _teller(report: Report) -> Callable[[str], None]:
    """A progress callable that reports each stage."""
    return lambda stage: report("progress", stage)
