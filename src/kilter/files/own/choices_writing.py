"""Saved choices without the keys that the caller switches off, and without released parts."""

from __future__ import annotations

import fnmatch
import json
import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from kilter.assembly.question import LOWEST
from kilter.errors import InputError, nearest_name, some_names
from kilter.files.own.choices import OPTIONS, STUDS, Choices, digest, find_choices
from kilter.files.writing import json_lines, write_text

OFF: dict[str, tuple[str, str | None]] = {
    **{option: (key, None) for key, option in OPTIONS.items()},
    **{option: ("studs", key) for key, option in STUDS.items()},
    "floor": ("floor", None),
    "down": ("gravity", None),
    "bond": ("bonds", None),
    "straps": ("straps", None),
    "gap": ("tolerance", "gap"),
    "angle": ("tolerance", "angle_deg"),
    "clearance": ("tolerance", "clearance"),
    "loose": ("loose", None),
    "material": ("materials", None),
    "open": ("open_pairs", None),
}
"""Key of choices, and its inner key if any, of each option that can be switched off."""
WILD = "*?["
"""Signs of a wildcard."""


def require_off(off: Sequence[str], release: Sequence[str], given: Collection[str]) -> None:
    """Verify that options can be switched off, and that none of them is given as well.

    Raises `InputError` if a name is unknown (the error names the most similar option), or if an
    option is given and switched off.
    """
    for name in off:
        if name not in OFF:
            near = nearest_name(name, OFF)
            hint = f"did you mean {near!r}?" if near else f"use {', '.join(OFF)}"
            raise InputError(f"no saved option is named {name!r:.60}", hint=hint)
    twice = [name for name in off if name in given or OFF[name][0] in given]
    both = [f"{name} and no-{name}".replace("_", "-") for name in twice]
    both += ["ground and release"] if release and "ground" in given else []
    both += ["release and no-ground"] if release and "ground" in off else []
    if both:
        raise InputError(f"{both[0]} are both given", hint="give only one of the two")


def require_saved(release: Sequence[str]) -> None:
    """Reject released parts if the file is no file of choices; raises `InputError`."""
    if release:
        raise InputError(
            f"release names {release[0]!r:.60}, but the file is no file of choices",
            hint="release parts that saved choices hold",
        )


def switched_off(
    choices: Choices, off: Iterable[str], release: Sequence[str] = ()
) -> tuple[Choices, list[str]]:
    """Copy of saved choices without some keys and held parts, and a sentence for each removal.

    Raises `InputError` if a released name matches no saved name of a held part.

    Examples
    --------
    >>> saved = Choices("clamp.step", held=["base", "arm"], floor=True)
    >>> switched_off(saved, ["floor"], ["arm"])[0].to_dict()
    {'kilter': 1, 'file': 'clamp.step', 'held': ['base']}
    """
    data = choices.to_dict()
    notes = []
    for option in dict.fromkeys(off):
        key, inner = OFF[option]
        holder = data if inner is None else data.get(key, {})
        old = holder.pop(inner or key, None)
        if old is not None:
            words = json.dumps(old, ensure_ascii=False)
            name = option.replace("_", "-")
            notes.append(f"the option no-{name} replaces {inner or key} {words} of the choices")
    if release:
        held = data.get("held", [])
        data["held"] = _remaining(held, release)
        _require_held(held, release)
        new, old = (json.dumps(names, ensure_ascii=False) for names in (list(release), held))
        notes.append(f"the option release {new} replaces held {old} of the choices")
    if not notes:
        return choices, notes
    return Choices.from_dict(data, folder=choices.folder), notes


def _remaining(held: Sequence[str], release: Sequence[str]) -> list[str]:
    """The saved names of held parts that no released name matches."""
    gone = {name for pattern in release for name in fnmatch.filter(held, pattern)} | set(release)
    return [name for name in held if name not in gone]


def released_in_part(held: Sequence[str], release: Sequence[str]) -> tuple[str, ...]:
    """The released names that only some parts of a saved wildcard may match.

    Only the names of all parts show which parts of the wildcard remain held.
    """
    left = _remaining(held, release)
    return tuple(name for name in release if any(_may_overlap(name, saved) for saved in left))


def _may_overlap(name: str, saved: str) -> bool:
    """Whether a saved wildcard may match parts that a released name, or wildcard, matches."""
    both_wild = all(any(sign in word for sign in WILD) for word in (name, saved))
    return both_wild or fnmatch.fnmatchcase(name, saved)


def _require_held(held: Sequence[str], release: Sequence[str]) -> None:
    """Reject a released name that matches no saved name; raises `InputError`."""
    for name in release:
        if not fnmatch.filter(held, name) and not any(_may_overlap(name, saved) for saved in held):
            raise InputError(
                f"the choices do not hold {name!r:.60}",
                hint=f"they hold {some_names(held)}" if held else "name the held parts with ground",
            )


# Write choices beside the file that they are about.


SUFFIX = ".json"
"""Ending of a file of choices; the commands look for choices only in such files."""


def choices_about(path: Path, folder: Path, options: Mapping[str, Any], **keys: Any) -> Choices:
    """Build choices from the options with which a file is read: the inverse of `Choices.options`.

    Raises `InputError` if the file does not lie in the folder or below.
    """
    values = {key: options[option] for key, option in OPTIONS.items() if option in options}
    if "state" in values:
        values["state"] = os.path.relpath(values["state"], folder)
    studs = {key: options[option] for key, option in STUDS.items() if option in options}
    if studs:
        values["studs"] = studs
    if "floor" in options:
        values["floor"] = True if options["floor"] == LOWEST else options["floor"]
    entries = dict(options.get("entries", {}))
    pulls = [{"parts": [a, b], "pull": pull} for a, b, pull in options.get("bond", ())]
    entries["bonds"] = [*pulls, *entries.get("bonds", ())]
    entries["sha256"] = digest(path)
    return Choices(_relative(path, folder), folder=folder, **{**values, **entries, **keys})


def _relative(path: Path, folder: Path) -> str:
    """Path of a file relative to a folder that contains it, with "/" between folders."""
    inside = Path(os.path.realpath(path.parent), path.name)
    base = Path(os.path.realpath(folder))
    try:
        return inside.relative_to(base).as_posix()
    except ValueError:
        raise InputError(
            f"the file {str(path)!r} is outside {str(folder)!r}, the folder of the choices",
            hint=f"write them to the folder {str(path.parent)!r} or to a folder above it",
        ) from None


def require_place(output: Path) -> bool:
    """Verify that choices may be written to a file; return whether it already holds choices.

    Raises `InputError` if the file has another ending than .json, or has another content than
    choices.
    """
    if output.suffix.lower() != SUFFIX:
        raise InputError(
            "choices need a file that ends in .json", file=str(output), hint="give X.kilter.json"
        )
    if not os.path.exists(output):  # also for a name that the system rejects
        return False
    try:
        replaces = find_choices(output) is not None
    except InputError:
        replaces = False
    if not replaces:
        raise InputError(
            "is not overwritten, since it holds something other than saved choices",
            file=str(output),
            hint="write to another file",
        )
    return True


def write_choices(choices: Choices, output: str | Path, *, links: bool = True) -> None:
    """Write choices to a JSON file, a key in each line; a failure leaves the old file intact.

    `links` is that of `kilter.files.writing.write_bytes`.

    Raises `InputError` as `require_place`, or if the file cannot be written.
    """
    require_place(Path(output))
    write_text(output, json_lines(choices.to_dict()), links=links)
