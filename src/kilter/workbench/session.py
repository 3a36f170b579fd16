"""A session of the workbench: the opened file, the changes of the user, and the open pages.

All pages of a session show the same state. A message of a page changes the state or asks a
question; the session computes nothing itself but gives jobs to the worker process. A new state ends
the job about an older state, and messages about older states are dropped.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from kilter.errors import InputError
from kilter.files.file_content import ENDINGS
from kilter.files.limits import fingerprint, read_bytes
from kilter.files.own.choices import Choices, digest
from kilter.files.own.choices_writing import require_place, write_choices
from kilter.files.writing import dump, write_text
from kilter.scenes.registry import SCENES, scene
from kilter.tell.numbers import count
from kilter.workbench.actions import ACTIONS
from kilter.workbench.answering import command, needs_file, saved_name
from kilter.workbench.connections import direction_of, index_of, to_json
from kilter.workbench.history import (
    History,
    autosave_path,
    recent_files,
    remember_file,
    upload_autosave_path,
)
from kilter.workbench.jobs import JobQueue, QueuedJob
from kilter.workbench.live_assembly import MATERIALS, OpenedParts

Send = Callable[[str], None]
FEATURED = {
    "arch": "A stone arch: how far may it tilt, in which order is it built?",
    "bracket": "A bracket on a post: what must friction carry?",
    "books": "Eight books pressed together: may friction hold them?",
    "harmonic-stack": "Ten blocks that overhang an edge, just balanced.",
    "cad-export": "A lamp exported from CAD: play, a thread, a loose switch.",
    "three-cylinders": "A log on two logs: does it come to rest?",
}
"""Examples that the start page shows with a picture, and their questions."""
PASSED = ("scene", "answer", "tab", "action", "probe")
"""Kinds of results of the worker process that concern the pages."""
WATCH = 0.5
"""Interval at which the session looks for changes of the file [s]."""


@dataclass(slots=True, eq=False)
class _Sent:
    """The last messages of the present state, for pages that connect later."""

    scene: dict[str, Any] | None = None
    answer: dict[str, Any] | None = None
    problem: dict[str, Any] | None = None
    tabs: dict[str, dict[str, Any]] = field(default_factory=dict)


class Session:
    """The state that all pages of the workbench share."""

    def __init__(self, folder: Path, uploads: Path) -> None:
        self.folder = folder.resolve()
        self.uploads = uploads.resolve()
        self.pages: set[Send] = set()
        self.state = 0
        self.path: Path | None = None
        self.history = History({}, OpenedParts())
        self.saved: Path | None = None
        self.saved_keys: dict[str, Any] | None = None
        self.message = ""
        self.jobs = JobQueue(self._open_job, self._pass_on, self._tell_problem, self._tell_progress)
        self._sent = _Sent()
        self._busy = ""
        self._stamp: Any = None
        self._shapes: Any = None
        self._watch: asyncio.Task[None] | None = None
        self._autosaves = True
        self._listed: list[str] = []  # recent files as the pages list them
        self._recent: set[Path] = set()  # recent files that were opened; each may lie anywhere

    # pages -----------------------------------------------------------------------------

    def join(self, page: Send) -> None:
        """Add a page, and send it everything that the other pages show."""
        self.pages.add(page)
        self._listed = recent_files()
        page(to_json(self.session_data()))
        sent = self._sent
        if sent.scene is not None:
            page(to_json({**sent.scene, "page": {**sent.scene["page"], "shapes": self._shapes}}))
        for message in (sent.answer, sent.problem, *sent.tabs.values()):
            if message is not None:
                page(to_json(message))

    def leave(self, page: Send) -> None:
        """Remove a page."""
        self.pages.discard(page)

    def broadcast(self, message: Mapping[str, Any]) -> None:
        """Send a message to all pages."""
        text = to_json(message)
        for page in tuple(self.pages):
            page(text)

    def session_data(self) -> dict[str, Any]:
        """The state of the session as the pages show it."""
        keys = self.history.keys
        opened = self.path is not None
        return {
            "is": "session",
            "state": self.state,
            "file": self.path.name if self.path is not None else None,
            "folder": str(self.folder),
            "title": self.path.name if self.path is not None else "",
            "choices": keys,
            "changes": [
                {"label": change.label, "action": dict(change.action)}
                for change in self.history.changes
            ],
            "redo": [{"label": change.label} for change in reversed(self.history.undone)],
            "saved": None if self.saved is None else self.saved.name,
            "temporary": opened and self._is_upload,
            "dirty": opened and keys != self.saved_keys,
            "command": self.command("check") if opened else "kilter view",
            "command_needs_save": opened and needs_file(keys) and keys != self.saved_keys,
            "held_by_file": sorted(self.history.bodies.held),
            "materials": [
                {"name": one.name, "density": one.density, "source": one.source}
                for one in MATERIALS
            ],
            "files": self._files(),
            "recent": [{"name": Path(path).name, "path": path} for path in self._listed],
            "featured": FEATURED,
            "examples": _examples(),
            "busy": self._busy or None,
            "missing": _missing(),
            "message": self.message,
        }

    def command(self, name: str, *further: str) -> str:
        """The command line that answers a question about the present state."""
        saved = self.saved.name if self.saved is not None else None
        return command(name, self.history.keys, saved, further)

    def _files(self) -> list[str]:
        """Names of the files and folders of the folder that can be opened."""
        names = []
        with contextlib.suppress(OSError):
            for entry in sorted(self.folder.iterdir()):
                if entry.name.startswith(".") or entry.name.endswith(".workbench.json"):
                    continue
                if entry.suffix.lower() in ENDINGS and entry.is_file():
                    names.append(entry.name)
        return names[:MOST_FILES]

    # messages of pages -----------------------------------------------------------------

    async def handle(self, message: Mapping[str, Any]) -> dict[str, Any]:
        """Do what a page asks for, and return the reply.

        Raises `InputError` if the request is invalid.
        """
        what = message.get("do")
        if not isinstance(what, str):
            raise InputError(f"unknown request {what!r:.40}", hint="reload the page")
        if what in ACTIONS:
            self._require_file()
            self.history.add({k: v for k, v in message.items() if k != "id"})
            self._changed()
        elif what in ("undo", "redo", "revert", "go"):
            self._require_file()
            self._walk(what, message)
        elif what == "open":
            await self._open_asked(message)
        elif what == "close":
            self._close()
        elif what == "ask":
            self._ask(message)
        elif what == "settle":
            self._require_file()
            self.jobs.add(self.state, {"job": "settle", "keys": self.history.keys}, tab="settle")
        elif what == "probe":
            self._require_file()
            down = direction_of(message, "down")
            job = {"job": "probe", "keys": self.history.keys, "down": down}
            self.jobs.add(self.state, job, tab="probe")
        elif what == "compare":
            self._compare(message)
        elif what == "stop":
            self.jobs.stop()
        elif what == "save":
            name = message.get("file")
            return {"saved": self._save(None if name is None else str(name))}
        else:
            raise InputError(f"unknown request {what!r:.40}", hint="reload the page")
        return {}

    def _require_file(self) -> None:
        if self.path is None:
            raise InputError("no file is open", hint="open a file first")

    def _walk(self, what: str, message: Mapping[str, Any]) -> None:
        """Undo, redo, revert, or go to a number of changes."""
        if what == "undo":
            self.history.undo()
        elif what == "redo":
            self.history.redo()
        elif what == "revert":
            self.history.revert(index_of(message, "index"))
        else:
            self.history.go(index_of(message, "index"))
        self._changed()

    def _changed(self) -> None:
        """Answer the new state, and keep the changes beside the file."""
        self.state += 1
        self.message = ""
        self._sent.answer = self._sent.problem = None
        self._sent.tabs.clear()
        self._autosave()
        self.broadcast(self.session_data())
        self._answer()

    def _answer(self) -> None:
        self.jobs.add(self.state, {"job": "answer", "keys": self.history.keys})

    def _ask(self, message: Mapping[str, Any]) -> None:
        self._require_file()
        name, options = message.get("tab"), message.get("options") or {}
        if not isinstance(name, str) or not isinstance(options, dict):
            raise InputError(f"there is no tab {name!r:.40}", hint="reload the page")
        job = {
            "job": "tab",
            "name": name,
            "keys": self.history.keys,
            "options": options,
            "saved": None if self.saved is None else self.saved.name,
        }
        self.jobs.add(self.state, job, tab=name)

    def _compare(self, message: Mapping[str, Any]) -> None:
        self._require_file()
        counts = [index_of(message, key) for key in ("a", "b")]
        states = [self.history.keys_after(count) for count in counts]
        labels = [
            self.history.changes[count - 1].label if count else "as opened" for count in counts
        ]
        job = {"job": "compare", "labels": labels, "states": states}
        self.jobs.add(self.state, job, tab="compare")

    # files -----------------------------------------------------------------------------

    async def _open_asked(self, message: Mapping[str, Any]) -> None:
        """Open a file of the folder, an uploaded file, or an example."""
        if message.get("example"):
            path = self._write_example(str(message["example"]))
        elif message.get("recent"):
            path = Path(str(message["recent"]))
            if str(path) not in recent_files():
                raise InputError(f"{path.name!r:.80} is not among the recent files")
            self._recent.add(Path(os.path.realpath(path)))
        else:
            path = self._inside(str(message.get("file", "")))
        await self.open(path)

    def _inside(self, name: str) -> Path:
        """Path of a file in the folder or among the uploads.

        Raises `InputError` if the path leaves these folders, or does not exist.
        """
        for folder in (self.folder, self.uploads):
            with contextlib.suppress(OSError, ValueError):  # a name that the system rejects
                path = Path(os.path.realpath(folder / name))
                if name and path != folder and path.is_relative_to(folder) and path.exists():
                    return path
        raise InputError(
            f"there is no file {name!r:.80} in the opened folder", hint="drop the file on the page"
        )

    def _write_example(self, name: str) -> Path:
        """Write a built-in example to the folder of uploads; return its path."""
        if name not in SCENES:
            raise InputError(f"there is no example {name!r:.40}", hint="choose one of the list")
        path = self.uploads / f"{name}.kilter.json"
        dump(scene(name), path)
        return path

    def tell(self, message: str) -> None:
        """Show a sentence to the user."""
        self.message = message
        self.broadcast(self.session_data())

    async def open(
        self,
        path: Path,
        keys: dict[str, Any] | None = None,
        down: Sequence[float] | None = None,
    ) -> None:
        """Open a file and answer it; the state of an earlier session is restored.

        Raises `InputError` if the file cannot be read; the file that was open stays open.
        """
        self.jobs.stop()
        path = Path(os.path.realpath(path))
        try:
            job = {**self._job_of(path), "keys": keys, "down": down}
            opened = await self.jobs.result_of(self.state, job)
        except InputError:
            if self.path is not None:
                self._answer()  # the present file stays open, and its answer was stopped
            raise
        self.path = Path(opened["path"])
        bodies: OpenedParts = opened["bodies"]
        if path in self._recent:
            self._recent.add(self.path)
        self._stamp = fingerprint(str(self.path))
        if not self._is_upload:
            remember_file(path)
            self._listed = recent_files()
        self.saved = self.saved_keys = None
        base = opened["keys"]
        if keys is None and path != self.path:  # a file of choices was opened
            self.saved, self.saved_keys = path, base
        elif not base.keys() - {"kilter", "file", "sha256"}:
            self.saved_keys = base  # nothing to lose
        self.history = History(base, bodies)
        self.message, self._autosaves = "", True
        self._restore(bodies, given=keys is not None)
        self._sent = _Sent()
        self.state += 1
        self.broadcast(self.session_data())
        self._answer()
        if self._watch is None:
            self._watch = asyncio.create_task(self._watch_file())

    def _open_job(self) -> dict[str, Any]:
        """The job that makes a new worker process read the open file."""
        assert self.path is not None
        return {**self._job_of(self.path), "keys": self.history.base}

    def _job_of(self, path: Path) -> dict[str, Any]:
        """The job that opens a file, with the folder whose files it may read."""
        folder = self.uploads if path.is_relative_to(self.uploads) else self.folder
        if path in self._recent:
            folder = path.parent
        return {"job": "open", "file": str(path), "folder": str(folder)}

    def _restore(self, bodies: OpenedParts, *, given: bool) -> None:
        """Take over the changes of an earlier session that were not saved."""
        assert self.path is not None
        kept = self._autosave_path
        if given or os.path.islink(kept) or not os.path.isfile(kept):
            return
        base = self.history.base
        try:
            earlier = History.from_text(read_bytes(kept), bodies)
            before, now = (_without_place(keys) for keys in (earlier.base, base))
            if before != now or not (earlier.changes or earlier.undone):
                return
        except (InputError, OSError) as error:
            self.message = f"the changes of the earlier session could not be restored: {error}"
            return
        self.history, lost = earlier.on(base)
        changes = count(len(self.history.changes), "change")
        if self.history.changes or lost:
            self.message = f"{changes} of the earlier session restored; undo takes them back"
            self.message += _lost_words(lost)

    @property
    def _is_upload(self) -> bool:
        """Whether the open file lies in the temporary folder of uploads."""
        return self.path is not None and self.path.is_relative_to(self.uploads)

    @property
    def _autosave_path(self) -> Path:
        """The file that keeps the changes; those about an uploaded file outlive its folder."""
        assert self.path is not None
        if self._is_upload:
            return upload_autosave_path(str(self.history.base.get("sha256", "")))
        return autosave_path(self.path)

    def _autosave(self) -> None:
        """Keep the changes in a file beside the assembly file."""
        assert self.path is not None
        try:
            kept = self._autosave_path
            if self._is_upload:
                kept.parent.mkdir(parents=True, exist_ok=True)
            write_text(kept, self.history.to_text(), links=False)
            self._autosaves = True
        except (InputError, OSError) as error:
            if self._autosaves:
                self.message = f"the changes are not kept beside the file: {error}"
            self._autosaves = False

    def _save(self, name: str | None) -> str:
        """Write the choices to a file beside the assembly file; return its name."""
        self._require_file()
        assert self.path is not None
        target = self.path.parent / (saved_name(self.path.name) if name is None else name)
        if name is not None and (Path(name).name != name or "\\" in name):
            raise InputError("choices lie beside their file", hint="give a name without a folder")
        if name is not None and not name.endswith(".kilter.json"):
            raise InputError(f"the name is {name!r:.60}", hint="give X.kilter.json")
        if name is None and self.saved is not None:
            target = self.saved
        require_place(target)
        keys = self.history.keys
        if target.parent != self.path.parent:
            keys = {**keys, "file": self.path.relative_to(target.parent).as_posix()}
        write_choices(Choices.from_dict(keys, folder=target.parent), target, links=False)
        self.saved, self.saved_keys = target, self.history.keys
        self.message = f"saved as {target.name}"
        self.broadcast(self.session_data())
        return target.name

    def _close(self) -> None:
        """Return to the start page."""
        self.jobs.stop()
        self.path, self.history, self.message = None, History({}, OpenedParts()), ""
        self._sent = _Sent()
        self.state += 1
        self.broadcast(self.session_data())

    async def export(self, kind: str) -> dict[str, Any]:
        """Make a file for download; the result has its name and content.

        Raises `InputError` if no file is open, or this state has no such file.
        """
        self._require_file()
        assert self.path is not None
        job = {
            "job": "export",
            "kind": kind,
            "keys": self.history.keys,
            "title": self.path.name,
            "command": self.command("report", "-o", "report.html"),
        }
        made: dict[str, Any] = await self.jobs.result_of(self.state, job)
        return made

    async def _watch_file(self) -> None:
        """Read the file again whenever it changes on the disk."""
        while True:
            await asyncio.sleep(WATCH)
            if self.path is None or not self.jobs.is_idle:
                continue
            now = fingerprint(str(self.path))
            if now == self._stamp:
                continue
            self._stamp = now
            if not self.path.exists():
                self.message = f"{self.path.name} was removed; its last content is shown"
                self.broadcast(self.session_data())
                continue
            history, saved = self.history, (self.saved, self.saved_keys)
            try:
                await self.open(self.path, {**history.base, "sha256": digest(self.path)})
            except InputError as error:
                self.message = f"{error.what}; the last valid content is shown"
                self.broadcast(self.session_data())
                continue
            self.saved, self.saved_keys = saved
            self._reapply(history)

    def _reapply(self, history: History) -> None:
        """Apply the changes of a history to the file as it is now; name those that do not fit."""
        history.bodies = self.history.bodies
        self.history, lost = history.on(self.history.base)
        self._changed()
        self.message = f"the file changed and was read again{_lost_words(lost)}"
        self.broadcast(self.session_data())

    # results of jobs -------------------------------------------------------------------

    def _pass_on(self, job: QueuedJob, kind: str, data: Any) -> None:
        """Send a result of the present state to the pages, and keep it for later pages."""
        if job.state != self.state or kind not in PASSED:
            return
        if kind == "action":
            self._do(job, data)
            return
        if kind == "scene":
            self._shapes = data["shapes"] or self._shapes
            self._sent.scene = message = {"is": "scene", "state": self.state, "page": data}
        elif kind == "answer":
            self._sent.answer = message = {"is": "answer", "state": self.state, **data}
        elif kind == "probe":
            message = {"is": "probe", "state": self.state, **data}
        else:
            message = {"is": "tab", "state": self.state, "error": "", **data}
            self._sent.tabs[data["name"]] = message
        self.broadcast(message)

    def _do(self, job: QueuedJob, action: Mapping[str, Any]) -> None:
        """Do an action that a job has found, as if a page had sent it."""
        try:
            self.history.add(action)
        except InputError as error:
            self._tell_problem(job, error)
            return
        self._changed()

    def _tell_problem(self, job: QueuedJob, error: InputError) -> None:
        """Tell the pages why the present state, or a tab, has no answer."""
        if job.state != self.state:
            return
        words = {"error": error.what, "hint": error.hint or ""}
        if job.tab:
            message = {"is": "tab", "name": job.tab, "state": self.state, "html": "", **words}
        else:
            message = {"is": "problem", "state": self.state, **words}
            self._sent.problem = message
        self.broadcast(message)

    def _tell_progress(self, job: QueuedJob | None, words: str) -> None:
        """Tell the pages the stage of the running job."""
        self._busy = words
        about = "" if job is None else job.about
        working = {"what": about, "words": words or None, "working": job is not None}
        self.broadcast({"is": "progress", **working})

    async def end(self) -> None:
        """End the worker process and the watch."""
        if self._watch is not None:
            self._watch.cancel()
        self.jobs.worker.end()


MOST_FILES = 500
"""Largest number of files that the start page lists."""


def _without_place(keys: Mapping[str, Any]) -> dict[str, Any]:
    """Choices without the name and the digest of their file."""
    return {key: value for key, value in keys.items() if key not in ("file", "sha256")}


def _lost_words(labels: Sequence[str]) -> str:
    """Words for changes that the content of the file no longer admits; empty without them."""
    return f"; these changes do not fit any more: {', '.join(labels)}" if labels else ""


def _examples() -> list[str]:
    """Names of the built-in examples."""
    return sorted(SCENES)


def _missing() -> list[str]:
    """Sentences about extras that are not installed and that files or exports need."""
    missing = []
    if find_spec("OCP") is None:
        missing.append('STEP files need the extra "step": pip install "kilter[step]"')
    if find_spec("matplotlib") is None:
        missing.append('figures need the extra "figures": pip install "kilter[figures]"')
    return missing
