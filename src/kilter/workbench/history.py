"""The changes of a session: undo, redo, revert, and their file beside the assembly file.

The state of a session is the choices with which it began, and a list of actions. The list is kept
in a file after each change (autosave), so that no choice is lost if a process ends.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kilter.errors import InputError
from kilter.files.writing import write_text
from kilter.workbench.actions import apply, drag_of
from kilter.workbench.connections import parse_message
from kilter.workbench.live_assembly import OpenedParts

FORM = 1
"""Version of the form of the autosave file."""
MOST_CHANGES = 5000
"""Largest number of changes, since a restart applies each again."""
RECENT = "recent.json"
"""Name of the list of recent files."""
MOST = 8
"""Largest number of recent files."""
LONGEST_NAME = 200
"""Longest name of a file that the name of its autosave file repeats [bytes]."""


@dataclass(frozen=True, slots=True)
class Change:
    """An action of the user, with its label in the list of changes."""

    action: Mapping[str, Any]
    label: str


@dataclass(slots=True)
class History:
    """The choices with which a session began, and the changes since then.

    Examples
    --------
    >>> history = History({"kilter": 1, "file": "a.step"}, OpenedParts(("plate", "rod")))
    >>> history.add({"do": "hold", "parts": ["plate"], "on": True})
    >>> history.add({"do": "friction", "mu": 0.3})
    >>> history.keys
    {'kilter': 1, 'file': 'a.step', 'held': ['plate'], 'friction': 0.3}
    >>> history.revert(0)
    >>> history.keys
    {'kilter': 1, 'file': 'a.step', 'friction': 0.3}
    >>> history.undo(), history.keys
    ('friction 0.3', {'kilter': 1, 'file': 'a.step'})
    """

    base: dict[str, Any]
    """JSON data of the first choices."""
    bodies: OpenedParts
    changes: list[Change] = field(default_factory=list)
    """The changes that count, in order."""
    undone: list[Change] = field(default_factory=list)
    """Changes that were undone; `redo` applies the last of them."""
    _states: list[dict[str, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._states = [self.base]
        changes, self.changes = self.changes, []
        for change in changes:
            self._append(change.action)

    @property
    def keys(self) -> dict[str, Any]:
        """JSON data of the present choices."""
        return self._states[-1]

    def keys_after(self, count: int) -> dict[str, Any]:
        """JSON data of the choices after the first `count` changes.

        Raises `InputError` if there are not so many changes.
        """
        if not 0 <= count < len(self._states):
            raise InputError(f"there are {len(self.changes)} changes", hint="choose one of them")
        return self._states[count]

    def add(self, action: Mapping[str, Any]) -> None:
        """Apply an action. A position of a drag replaces the position before it.

        Undone changes are dropped.

        Raises `InputError` if the action is invalid; nothing changes then.
        """
        if len(self.changes) >= MOST_CHANGES:
            raise InputError(f"there are {MOST_CHANGES} changes", hint="save, and open it again")
        drag = drag_of(action)
        replaces = bool(drag and self.changes) and drag == drag_of(self.changes[-1].action)
        if replaces:
            keys, label = apply(action, self._states[-2], self.bodies)
            self.changes[-1] = Change(dict(action), label)
            self._states[-1] = keys
        else:
            self._append(action)
        self.undone.clear()

    def undo(self) -> str:
        """Undo the last change and return its label; empty if there is none."""
        if not self.changes:
            return ""
        self.undone.append(self.changes.pop())
        self._states.pop()
        return self.undone[-1].label

    def redo(self) -> str:
        """Redo the change that was undone last and return its label; empty if there is none."""
        if not self.undone:
            return ""
        change = self.undone.pop()
        self._append(change.action)
        return change.label

    def revert(self, index: int) -> None:
        """Take back a single change; the later changes are applied again without it.

        `redo` applies the reverted change again.

        Raises `InputError` if there is no such change, or a later change needs it; nothing changes
        then.
        """
        if not 0 <= index < len(self.changes):
            raise InputError(f"there are {len(self.changes)} changes", hint="choose one of them")
        rest = [*self.changes[:index], *self.changes[index + 1 :]]
        gone = self.changes[index]
        try:
            without = History(self.base, self.bodies, rest)
        except InputError as error:
            raise InputError(
                f"a later change needs {gone.label!r}: {error.what}", hint="undo the later change"
            ) from None
        self.changes, self._states = without.changes, without._states
        self.undone.append(gone)

    def go(self, count: int) -> None:
        """Undo or redo changes until `count` changes count.

        Raises `InputError` if there are not so many changes.
        """
        if not 0 <= count <= len(self.changes) + len(self.undone):
            raise InputError(f"there are {len(self.changes)} changes", hint="choose one of them")
        while len(self.changes) > count:
            self.undo()
        while len(self.changes) < count:
            self.redo()

    def on(self, base: dict[str, Any]) -> tuple[History, list[str]]:
        """The changes on other first choices, and the labels of the changes that do not fit.

        Examples
        --------
        >>> history = History({"kilter": 1, "file": "a", "sha256": "1" * 64}, OpenedParts(("rod",)))
        >>> history.add({"do": "friction", "mu": 0.3})
        >>> pose = {"rod": {"position": [0, 0, 1], "rotation": [1, 0, 0, 0]}}
        >>> history.add({"do": "poses", "poses": pose, "sha256": "1" * 64})
        >>> changed, lost = history.on({"kilter": 1, "file": "a", "sha256": "2" * 64})
        >>> changed.keys["friction"], lost
        (0.3, ['place rod'])
        """
        history, lost = History(base, self.bodies), []
        for change in self.changes:
            try:
                history._append(change.action)
            except InputError:
                lost.append(change.label)
        history.undone = list(self.undone)
        return history, lost

    def _append(self, action: Mapping[str, Any]) -> None:
        keys, label = apply(action, self._states[-1], self.bodies)
        self.changes.append(Change(dict(action), label))
        self._states.append(keys)

    # file ------------------------------------------------------------------------------

    def to_text(self) -> str:
        """The text of the autosave file."""
        data = {
            "kilter_workbench": FORM,
            "base": self.base,
            "changes": [dict(change.action) for change in self.changes],
            "undone": [dict(change.action) for change in self.undone],
        }
        return json.dumps(data, ensure_ascii=False, indent=1) + "\n"

    @classmethod
    def from_text(cls, data: bytes, bodies: OpenedParts) -> History:
        """The history that an autosave file holds.

        Raises `InputError` if the file is no autosave file, or an action in it is invalid now.
        """
        try:
            content = parse_message(data.decode())
        except (InputError, UnicodeDecodeError):
            raise InputError("is a damaged list of changes", hint="remove the file") from None
        if content.get("kilter_workbench") != FORM:
            raise InputError("is no saved list of changes", hint="remove the file")
        try:
            if len(content["changes"]) + len(content["undone"]) > MOST_CHANGES:
                raise ValueError
            changes = [Change(dict(action), "") for action in content["changes"]]
            undone = [Change(dict(action), str(action["do"])) for action in content["undone"]]
            return cls(dict(content["base"]), bodies, changes, undone)
        except (KeyError, TypeError, ValueError, AttributeError):
            raise InputError("is a damaged list of changes", hint="remove the file") from None


def autosave_path(path: Path) -> Path:
    """Path of the autosave file of an assembly file: beside it, hidden.

    The name is that of the file, or its digest if the system would find the name too long.
    """
    name = path.name
    if len(os.fsencode(name)) > LONGEST_NAME:
        name = hashlib.sha256(os.fsencode(name)).hexdigest()[:32]
    return path.parent / f".{name}.workbench.json"


def upload_autosave_path(digest: str) -> Path:
    """Path of the autosave file of an uploaded file, in the user's folder for states of programs.

    Arguments: `digest`: SHA-256 of the file: the same file that is dropped again finds its changes.
    """
    return state_folder() / f"{digest[:32]}.json"


def state_folder() -> Path:
    """The user's folder for states of the workbench; it need not exist."""
    home = Path.home()
    default = home / "AppData" / "Local" if os.name == "nt" else home / ".local" / "state"
    folder = os.environ.get("XDG_STATE_HOME") or os.environ.get("LOCALAPPDATA") or str(default)
    return Path(folder) / "kilter" / "workbench"


def recent_files() -> list[str]:
    """Paths of the files that were opened last and still exist, the latest first."""
    with contextlib.suppress(OSError, ValueError):
        listed = json.loads((state_folder().parent / RECENT).read_text(encoding="utf-8"))
        return [path for path in listed if isinstance(path, str) and os.path.isfile(path)][:MOST]
    return []


def remember_file(path: Path) -> None:
    """Put a file at the top of the list of recent files; without write access nothing happens."""
    paths = [str(path), *(other for other in recent_files() if other != str(path))][:MOST]
    with contextlib.suppress(OSError, InputError):
        state_folder().parent.mkdir(parents=True, exist_ok=True)
        write_text(state_folder().parent / RECENT, json.dumps(paths), links=False)
